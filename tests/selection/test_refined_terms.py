"""Terms that are nothing without another one: a rounded knee without a knee, damping of a mount without a mount."""

from __future__ import annotations

from dataclasses import replace

import pytest

import sprung
from sprung.errors import InputError
from sprung.estimation import fit_linear
from sprung.preprocess import prepare
from sprung.selection import ModelSearch, choose_structure
from sprung.selection.backward_elimination import hold_undetermined, leave_out_refused
from sprung.selection.terms import TERMS
from sprung.simulation import simulate
from sprung.vehicle import REFINED, TABLE_1_CAR, Vehicle

BALLAST = {
    "name": "ballast",
    "items": [
        {"mass": 90.0, "position": (-0.4, 0.4, 0.6), "inertia": (3.0, 4.0)},
        {"mass": 60.0, "position": (-2.2, -0.3, 0.6), "inertia": (2.0, 3.0)},
    ],
}

PASSES = (("fl", "fr", "rl", "rr"), ("fl", "rl"), ("fr", "rr"))
"""Wheels that run over the bump in each pass."""


def test_one_without_the_other_is_refused() -> None:
    campaign = simulate(TABLE_1_CAR, rate=250.0, noise=0.02, seed=1)
    for extra, refined in REFINED.items():
        with pytest.raises(InputError, match=f"Add '{refined}'"):
            choose_structure(campaign, "shared", (extra,))
        needed = {extra, refined, REFINED.get(refined, refined)}
        assert {*choose_structure(campaign, "shared", tuple(needed)).terms} == needed


def test_what_refines_a_forbidden_term_is_not_looked_for() -> None:
    campaign = simulate(TABLE_1_CAR, rate=250.0, noise=0.02, seed=1)
    forbids = replace(campaign.model, forbid=("damper-mount",))
    structure = choose_structure(replace(campaign, model=forbids))
    assert not {"damper-mount", "mount-damping"} & {*structure.open_terms}
    assert "rounded-knee" in structure.open_terms


def test_what_refines_a_refused_term_goes_with_it() -> None:
    """A curve whose slope does not change at its knee is none, and its knee has no rounding."""
    campaign = simulate(TABLE_1_CAR, rate=250.0, noise=0.02, seed=1, known={"total_mass": TABLE_1_CAR.total_mass})
    plain, decays = choose_structure(campaign), prepare(campaign).decays
    fit = fit_linear(decays, plain.linear_models, plain.sensors, plain.known)
    curved = plain.with_terms(("damper-curve", "rounded-knee"))
    search = ModelSearch(plain, fit, decays).refit(curved, most=0)
    assert search.selected == ["damper-curve", "rounded-knee"]
    assert leave_out_refused(search).selected == []


def test_undetermined_parts_are_held_once() -> None:
    """Where a model leaves so much that they stay undetermined, the term is left out next: the search comes to an end."""
    campaign = simulate(TABLE_1_CAR, rate=250.0, noise=0.02, seed=1)
    plain, decays = choose_structure(campaign), prepare(campaign).decays
    fit = fit_linear(decays, plain.linear_models, plain.sensors, plain.known)
    search = ModelSearch(plain, fit, decays)
    search = replace(search, structure=plain.with_terms(("damper-curve", "rebound-knee")))
    held = hold_undetermined(search, "rebound-knee", ["b_kr", "b_qr"])
    assert held is not None
    assert {*held.usual} == {"b_kr", "b_qr"}
    assert hold_undetermined(replace(search, structure=held), "rebound-knee", ["b_kr"]) is None
    assert hold_undetermined(replace(search, structure=held), "rebound-knee", ["b_kf", "b_kr"]) is not None
    knee = hold_undetermined(search, "damper-curve", ["v_kf", "q_f"])
    assert knee is not None
    assert knee.usual["q_f"].value == 1.0
    assert hold_undetermined(search, "damper-curve", ["v_kf", "v_kr", "q_f", "q_r"]) is None


@pytest.mark.slow
def test_a_knee_that_one_axle_does_not_reach_is_not_determined() -> None:
    """Nothing else is lost by it: the front wheels of a slow pass have come to rest when the rear ones leave the bump."""
    car = TABLE_1_CAR.with_values(v_kf=0.25, q_f=0.3, v_kr=0.05, q_r=0.3)
    drops = [{"wheels": list(wheels), "excitation": "pass", "speed": 4.0} for wheels in PASSES]
    result = sprung.identify(simulate(car, drops=drops, noise=0.01, seed=1, known={"total_mass": car.total_mass}))
    assert result.fit.model == ("damper-curve",)
    assert result.verdict.state == "doubtful"
    assert result.verdict.reasons == ("these drops do not determine v_kf, q_f",)
    for name in (*TABLE_1_CAR.parameters, "v_kr", "q_r"):
        estimate = result.parameters[name]
        assert estimate.value is not None
        assert estimate.std is not None
        assert abs(estimate.value - car.parameters[name]) < 4 * estimate.std, name


@pytest.mark.parametrize(
    "loss", [0.0, pytest.param(60.0, marks=pytest.mark.long)], ids=["elastic mounts", "mounts with damping"]
)
@pytest.mark.slow
def test_damping_of_mounts_is_found_where_it_is(loss: float) -> None:
    """A mount without damping of its own stays one: a fit that lets its damping go negative does not cost the mount."""
    car = TABLE_1_CAR.with_values(k_df=12 * TABLE_1_CAR.k_sf, k_dr=12 * TABLE_1_CAR.k_sr, c_df=loss, c_dr=loss)
    result = sprung.identify(simulate(car, loads=[BALLAST], rate=500.0, noise=0.01, seed=3))
    assert result.verdict.state == "accept"
    assert {"damper-mount", "mount-damping"} & {*result.fit.model} == {"damper-mount"} | (
        {"mount-damping"} if loss else set()
    )
    for name in ("k_df", "k_dr", *(("c_df", "c_dr") if loss else ())):
        found = result.parameters[name]
        assert found.std is not None
        assert found.value == pytest.approx(getattr(car, name), abs=4 * found.std)


def zener_of(car: Vehicle) -> dict[str, float]:
    """Return the damper and the Zener branch beside the spring that move as a damper behind a mount with damping does.

    Both are (k_d + c_d s) c/(k_d + (c + c_d) s), from rubber and damper in series, over the velocity.
    """
    found = dict(car.parameters)
    for axle in "fr":
        c, k_d, c_d = (car.parameters[f"{name}{axle}"] for name in ("c_s", "k_d", "c_d"))
        fast = c * c_d / (c + c_d)
        found |= {f"c_s{axle}": fast, f"c_z{axle}": c - fast, f"k_z{axle}": (c - fast) * k_d / (c + c_d)}
    return found


MOUNTED = TABLE_1_CAR.with_values(
    k_df=8 * TABLE_1_CAR.k_sf, k_dr=8 * TABLE_1_CAR.k_sr, c_df=0.03 * TABLE_1_CAR.c_sf, c_dr=0.03 * TABLE_1_CAR.c_sr
)


@pytest.mark.parametrize("k_z", [0.1, 0.3])
@pytest.mark.parametrize("time", [0.02, 0.2])
def test_a_zener_branch_that_is_a_damper_behind_a_mount_is_something_else(k_z: float, time: float) -> None:
    """Sizes and times of rubber beside springs are those that are usual (docs/studies/real_kinds.py)."""
    assert TERMS["zener"].is_something_else(zener_of(MOUNTED))
    rates = {f"k_z{axle}": k_z * TABLE_1_CAR.parameters[f"k_s{axle}"] for axle in "fr"}
    branches = {f"c_z{axle}": time * rates[f"k_z{axle}"] for axle in "fr"}
    assert not TERMS["zener"].is_something_else({**TABLE_1_CAR.parameters, **rates, **branches})


@pytest.mark.slow
def test_dampers_behind_mounts_are_not_taken_for_rubber_beside_the_springs() -> None:
    """Two of 24 cars with mounts once got a Zener branch, and dampers of 6 % of their rate."""
    known = {"total_mass": MOUNTED.total_mass}
    result = sprung.identify(simulate(MOUNTED, rate=250.0, noise=0.02, seed=1, known=known))
    assert result.verdict.state == "accept"
    assert {*result.fit.model} == {"damper-mount", "mount-damping"}
    for name in ("c_sf", "c_sr", "k_df", "k_dr", "c_df", "c_dr"):
        found = result.parameters[name]
        assert found.std is not None
        assert found.value == pytest.approx(getattr(MOUNTED, name), abs=4 * found.std)

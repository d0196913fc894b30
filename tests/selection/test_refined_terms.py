"""Terms that are nothing without another one: a rounded knee without a knee, damping of a mount without a mount."""

from __future__ import annotations

from dataclasses import replace

import pytest

import sprung
from sprung.errors import InputError
from sprung.estimation import fit_linear
from sprung.preprocess import prepare
from sprung.selection import ModelSearch, choose_structure
from sprung.selection.backward_elimination import leave_out_refused
from sprung.simulation import simulate
from sprung.vehicle import REFINED, TABLE_1_CAR

BALLAST = {
    "name": "ballast",
    "items": [
        {"mass": 90.0, "position": (-0.4, 0.4, 0.6), "inertia": (3.0, 4.0)},
        {"mass": 60.0, "position": (-2.2, -0.3, 0.6), "inertia": (2.0, 3.0)},
    ],
}


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

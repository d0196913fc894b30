"""Bounds of planned tests: against what a fit reports, against published ones, and the laws that every bound obeys."""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings

import sprung
from sprung.errors import InputError
from sprung.planning import CramerRaoBound, Plan, PlanRow
from sprung.report import plan_view, text_of
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Vehicle
from strategies import vehicles

MASS = {"total_mass": {"value": TABLE_1_CAR.total_mass, "std": 2.0}}
SCALED = {"m_s", "I_yy", "I_xx", "m_uf", "m_ur", "k_sf", "k_sr", "k_tf", "k_tr", "c_sf", "c_sr"}


def row(plan: Plan, label: str) -> PlanRow:
    return next(row for row in plan.rows if row.label == label)


def bound(plan: Plan, label: str) -> CramerRaoBound:
    found = row(plan, label).bound
    assert found is not None
    return found


def percents(plan: Plan, label: str) -> dict[str, float]:
    """Those of a test that determines everything."""
    found = {name: percent for name, percent in bound(plan, label).percents.items() if percent is not None}
    assert found.keys() == bound(plan, label).percents.keys()
    return found


@cache
def plain() -> Plan:
    """The usual five drops of the empty car, nothing weighed."""
    return sprung.plan(TABLE_1_CAR)


@cache
def weighed() -> Plan:
    return sprung.plan(TABLE_1_CAR, known=MASS)


def test_the_bound_is_what_a_fit_of_that_test_reports() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, noise=0.02, seed=0, known=MASS)
    result = sprung.identify(campaign)
    assert result.fit.inflation == 1
    expected = percents(weighed(), "as planned")
    for name, percent in expected.items():
        assert result.parameters[name].percent == pytest.approx(percent, rel=0.05)


DROPS = [{"wheels": wheels, "height": 0.01} for wheels in (("fl", "fr", "rl", "rr"), ("fl", "fr"), ("fl", "rl"))]
TWICE = [{**drop, "load": load} for drop in DROPS for load in ("empty", "tenth")]
TENTH = {"name": "tenth", "added": {"mass": 138.0, "I_yy": 244.0, "I_xx": 38.0}}
SCALES = {"total_mass": {"value": TABLE_1_CAR.total_mass, "std": 5.0}}
AXLES = {**SCALES, "a": {"value": 1.25, "std": 0.005}}
# Computed independently of this package, in a study of the same car: three drops of 10 mm, 256 Hz, eight sensors, geometry
# known, percent of m_s, I_yy, I_xx, m_uf, m_ur, k_sf, k_sr, k_tf, k_tr, c_sf, c_sr, a.
PUBLISHED: tuple[tuple[float, bool, dict[str, dict[str, float]], tuple[float, ...]], ...] = (
    (0.02, True, {}, (1.35, 1.38, 1.36, 1.7, 1.8, 1.8, 1.8, 1.7, 1.9, 1.7, 1.8, 1.3)),
    (0.02, False, SCALES, (0.32, 0.51, 0.40, 1.6, 1.9, 1.7, 1.8, 1.6, 1.9, 1.6, 1.9, 1.8)),
    (0.02, False, AXLES, (0.32, 0.43, 0.37, 0.5, 0.5, 0.6, 0.6, 0.5, 0.5, 0.5, 0.5, 0.4)),
    (0.1, True, {}, (6.8, 6.9, 6.8, 8.7, 9.2, 9.0, 9.1, 8.7, 9.3, 8.7, 9.2, 6.7)),
    (0.1, True, AXLES, (0.33, 1.1, 0.76, 0.7, 0.8, 1.3, 1.2, 0.8, 0.9, 0.7, 0.8, 0.4)),
)


@pytest.mark.parametrize(("noise", "loaded", "known", "published"), PUBLISHED)
def test_bounds_computed_elsewhere(
    noise: float, loaded: bool, known: dict[str, dict[str, float]], published: tuple[float, ...]
) -> None:
    plan = sprung.plan(
        TABLE_1_CAR,
        drops=TWICE if loaded else DROPS,
        loads=[TENTH] if loaded else [],
        rate=256,
        noise=noise,
        duration=3.1,
        known={"t_f": 0.74, "t_r": 0.74, **known},
    )
    found = percents(plan, "as planned")
    names = [name for name in found if name != "b"]
    # To the digits printed, and three percent for where exactly a decay begins and ends.
    digit = np.array([0.006 if value < 0.5 or round(value, 1) != value else 0.06 for value in published])
    np.testing.assert_array_less(
        np.abs(np.array([found[name] for name in names]) - published),
        np.maximum(digit, 0.051) + 0.03 * np.array(published),
    )


def test_nothing_tells_the_scale_without_load_or_weighing() -> None:
    for label in ("as planned", "drops 4 times", "noise / 5", "+ fl and rr"):
        found = bound(plain(), label)
        assert set(found.undetermined) == SCALED
        assert [set(one.parameters) for one in found.unidentifiable] == [SCALED]
        assert "weigh the vehicle" in found.unidentifiable[0].text
        assert found.percents["a"] is not None


def test_knowing_the_total_mass_tells_it() -> None:
    assert plain().next_step.labels == ("total mass",)
    assert plain().next_step.enough
    assert max(percents(plain(), "total mass").values()) < 1
    assert "knowing the total mass would determine 11 more parameters" in plain().next_step.text


def test_axle_loads_are_worth_more_than_a_load() -> None:
    plan = sprung.plan(TABLE_1_CAR, drops=DROPS, rate=256, known={"t_f": 0.74, "t_r": 0.74})
    worst = {label: max(percents(plan, label).values()) for label in ("total mass", "axle loads", "+ 10 % middle")}
    assert worst["axle loads"] < 0.5 * worst["+ 10 % middle"]
    assert worst["axle loads"] < 0.5 * worst["total mass"]
    sizes = [percents(plan, f"+ {size} % middle")["m_s"] for size in (5, 10, 20, 30)]
    assert sizes == sorted(sizes, reverse=True)
    assert plan.next_step.labels == ("axle loads",)


def test_repeats_and_noise_scale_as_they_must() -> None:
    # Of the parameters without scale, on which no weighing bears.
    once = bound(plain(), "as planned").percents
    for label, factor in (("drops twice", 2**0.5), ("drops 4 times", 2.0), ("noise / 2", 2.0), ("noise / 5", 5.0)):
        more = bound(plain(), label).percents
        for name in ("a", "b", "t_f", "t_r"):
            assert (once[name] or 0) / (more[name] or 1) == pytest.approx(factor, rel=1e-6)


def test_the_sampling_rate_tells_little_where_the_noise_has_a_density() -> None:
    for name, percent in percents(weighed(), "as planned").items():
        assert percents(weighed(), "1000 Hz")[name] == pytest.approx(percent, rel=0.05)


@settings(max_examples=4, deadline=None)
@given(vehicles)
@pytest.mark.slow
def test_more_never_tells_less(vehicle: Vehicle) -> None:
    plan = sprung.plan(vehicle, known={"total_mass": vehicle.total_mass}, noise=0.1)
    own = percents(plan, "as planned")
    steps = [row for row in plan.rows if row.cost is not None and row.bound is not None]
    assert len(steps) >= 8
    for step in steps:
        assert step.bound is not None
        assert all((step.bound.percents[name] or np.inf) <= percent * (1 + 1e-6) for name, percent in own.items())


def test_fewer_drops_tell_less_and_say_of_what() -> None:
    only = bound(weighed(), "only all wheels")
    assert {"I_xx", "t_f", "t_r"} <= set(only.undetermined)
    named = {name for one in only.unidentifiable for name in one.parameters}
    assert set(only.undetermined) <= named
    assert all(one.text for one in only.unidentifiable)


def test_the_cheapest_step_that_is_enough() -> None:
    one_drop = sprung.plan(TABLE_1_CAR, drops=[{}], known=MASS)
    assert one_drop.next_step.labels == ("+ left wheels",)  # a bounce does not roll
    assert one_drop.next_step.enough
    both = sprung.plan(TABLE_1_CAR, drops=[{}])
    assert both.next_step.labels == ("total mass", "+ left wheels")
    easy = weighed().next_step
    assert (easy.labels, easy.enough) == ((), True)
    assert easy.text.startswith("nothing more is needed")
    never = sprung.plan(TABLE_1_CAR, known=MASS, noise=20.0).next_step
    assert not never.enough
    assert "would stay above 1 %" in never.text


def test_a_step_takes_the_worst_from_what_it_is_to_what_it_would_be() -> None:
    axles = {"front_axle_mass": 836.0, "rear_axle_mass": 715.8}
    plan = sprung.plan(TABLE_1_CAR, known=axles, wanted=0.1)
    now = bound(plan, "as planned")
    assert now.worst is not None
    assert plan.next_step.labels == ("drops twice",)
    before, after = percents(plan, "as planned")[now.worst], percents(plan, "drops twice")[now.worst]
    said = f"doing every drop twice would take {now.worst} from {before:.2g} % to {after:.2g} %"
    assert plan.next_step.text.startswith(said)


@pytest.mark.slow
def test_what_is_known_is_not_offered() -> None:
    axles = {f"{axle}_axle_mass": {"value": 776.0, "std": 2.0} for axle in ("front", "rear")}
    labels = {row.label for row in sprung.plan(TABLE_1_CAR, known=axles).rows}
    assert not labels & {"total mass", "axle loads"}
    assert "m_s" not in sprung.plan(TABLE_1_CAR, known={"m_s": 1380.0}).rows[0].bound.percents  # type: ignore[union-attr]


@pytest.mark.slow
def test_a_campaign_goes_on_from_its_own_error_bars() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, drops=[{}, {"wheels": ("fl", "rl")}], noise=0.05, seed=3)
    result, plan = sprung.identify(campaign), sprung.plan(campaign)
    assert plan.next_step.text == result.next_step
    own = bound(plan, "as it is").percents
    for name, estimate in result.parameters.items():
        assert (own[name] is None) == (estimate.status == "unidentifiable")
        if own[name] is not None:
            assert own[name] == pytest.approx(estimate.percent, rel=1e-3)
    assert plan.next_step.enough
    # What the step promises, it keeps.
    kept = sprung.identify(
        dataclasses.replace(campaign, known={"total_mass": KnownValue(TABLE_1_CAR.total_mass, 1.55)})
    )
    for name, percent in bound(plan, "total mass").percents.items():
        assert percent is not None
        assert kept.parameters[name].percent == pytest.approx(percent, rel=0.1)


def test_separate_half_distances_and_extras() -> None:
    odd = TABLE_1_CAR.with_values(t_f1=0.6, k_af=5000.0, name="odd")
    found = bound(sprung.plan(odd, known={"total_mass": odd.total_mass}), "as planned")
    assert {"t_f1", "t_f2", "t_r1", "t_r2", "k_af", "k_ar"} <= found.percents.keys()


def test_a_load_under_which_the_vehicle_falls_over_is_refused() -> None:
    narrow = TABLE_1_CAR.with_values(a=0.15, b=2.61, name="nose-heavy")
    plan = sprung.plan(narrow)
    refused = [row for row in plan.rows if row.bound is None]
    assert all(row.refused for row in refused)
    assert {row.label for row in plan.rows} >= {"+ 20 % front", "+ 30 % middle"}


@pytest.mark.parametrize(
    ("arguments", "where"),
    [
        ({"wanted": 0.0}, "plan: wanted"),
        ({"wanted": float("nan")}, "plan: wanted"),
        ({"noise": 0.0}, "plan: noise"),
        ({"noise": -1.0}, "plan: noise"),
        ({"rate": 10.0}, "plan: rate"),
        ({"duration": 0.0}, "plan: duration"),
        ({"duration": 0.3}, "drop of Table 1 car"),
        ({"drops": []}, "plan: drops"),
        ({"drops": [{"load": "sand"}]}, "plan: drops"),
        ({"drops": [{"wheel": ("fl",)}]}, "plan: drops[0].wheel"),
        ({"known": {"mass": 3.0}}, "plan: known"),
        ({"known": {"t_f1": 0.74}, "model": {"tracks": "shared"}}, "known.t_f1"),
    ],
)
def test_bad_input(arguments: dict[str, object], where: str) -> None:
    with pytest.raises(InputError) as caught:
        sprung.plan(TABLE_1_CAR, **arguments)  # type: ignore[arg-type]
    assert len(caught.value.problems) == 1
    assert where in caught.value.problems[0].where


def test_every_fault_at_once() -> None:
    with pytest.raises(InputError) as caught:
        sprung.plan(TABLE_1_CAR, wanted=-1, rate=1, noise=0, drops=[])
    assert len(caught.value.problems) == 4


def test_an_undamped_vehicle_has_no_bound() -> None:
    with pytest.raises(InputError, match="c_sf: found 0"):
        sprung.plan(TABLE_1_CAR.with_values(c_sf=0.0))


def test_the_document_has_everything() -> None:
    document = plain().document()
    assert document.keys() == {
        "vehicle",
        "wanted",
        "noise",
        "rate",
        "alternatives",
        "next_step",
        "rejected",
        "terms",
    }
    first, second = document["alternatives"][:2]
    assert (first["name"], first["cost"], first["above"], first["percent"]["m_s"]) == ("as planned", None, 11, None)
    assert set(first["unidentifiable"][0]["parameters"]) == SCALED
    assert (second["name"], second["cost"], second["above"]) == ("total mass", "total mass", 0)


def test_parameters_that_are_missing_for_one_reason_are_named_together() -> None:
    """Roll is excited by no drop of both wheels of an axle."""
    drops = [{"wheels": wheels} for wheels in (("fl", "fr", "rl", "rr"), ("fl", "fr"))]
    plan = sprung.plan(TABLE_1_CAR, drops=drops, known=MASS)
    text = " ".join(text_of(plan_view(plan)).split())
    assert text.count("alone hardly changes these recordings") == 1
    assert "I_xx, t_f, t_r: each alone hardly changes these recordings" in text

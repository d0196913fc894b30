"""Known quantities that the recordings contradict: which one is wrong is told where it can be, and else none is used."""

from __future__ import annotations

from dataclasses import replace

import pytest

import sprung
from sprung.campaign import Campaign
from sprung.results import Result
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Item, Load

CAR = TABLE_1_CAR
FRONT, REAR = (
    CAR.m_s * CAR.b / CAR.wheelbase + 2 * CAR.m_uf,
    CAR.m_s * CAR.a / CAR.wheelbase + 2 * CAR.m_ur,
)
"""kg on each axle, from the moments about the other one."""

BALLAST = Load(name="ballast", items=(Item(mass=160.0, position=(-1.0, 0.2, 0.5)),))


def test_exchanged_masses_of_the_axles_are_put_right() -> None:
    result = identified(front_axle_mass=REAR, rear_axle_mass=FRONT)
    (fault,) = result.faults
    assert (fault.code, fault.where) == ("known", "known.front_axle_mass, known.rear_axle_mass")
    assert "are exchanged" in fault.what
    assert result.verdict.state == "accept"
    near_truth(result)


@pytest.mark.parametrize(
    "stated",
    [
        {"front_axle_mass": REAR, "rear_axle_mass": 1.1 * FRONT},
        {"total_mass": CAR.total_mass, "k_sf": 1.6 * CAR.k_sf},
        {"total_mass": CAR.total_mass, "k_sf": 1.1 * CAR.k_sf},
    ],
    ids=["axles", "rate far off", "rate near by"],
)
@pytest.mark.slow
def test_of_two_that_contradict_each_other_none_is_used(stated: dict[str, float]) -> None:
    """Either one scales the whole vehicle: with one of them, all masses and rates may be wrong, and ratios are right."""
    result = identified(**stated)
    (fault,) = result.faults
    assert (fault.code, fault.where) == ("known", ", ".join(f"known.{name}" for name in stated))
    assert result.verdict.state == "doubtful"
    assert result.parameters["m_s"].value is None
    ratio = result.scale.per_total_mass["k_sf"]
    assert abs(ratio.value - CAR.k_sf / CAR.total_mass) < 4 * ratio.std
    a = result.parameters["a"]
    assert a.value is not None
    assert a.std is not None
    assert abs(a.value - CAR.a) < 4 * a.std


@pytest.mark.parametrize("wrong", ["vehicle", "load"])
def test_a_mass_that_contradicts_the_load_leaves_a_doubt(wrong: str) -> None:
    """Nothing tells which of the two was weighed wrongly: the verdict says what follows if it is the load."""
    campaign = recorded({"total_mass": CAR.total_mass * (1.2 if wrong == "vehicle" else 1.0)}, BALLAST)
    if wrong == "load":
        stated = replace(BALLAST, items=(replace(BALLAST.items[0], mass=200.0),))
        campaign = replace(campaign, loads=(campaign.loads[0], stated))
    result = sprung.identify(campaign)
    assert [(fault.code, fault.where) for fault in result.faults] == [
        ("known", "known.total_mass"),
        ("known", "load 'ballast'"),
    ]
    assert result.verdict.state == "doubtful"
    factor = {"vehicle": 1.2, "load": 160 / 200}[wrong]
    assert f"are {factor:.2g}" in result.verdict.reasons[0]
    m_s = result.parameters["m_s"].value
    assert m_s is not None
    scale = {"vehicle": 1.0, "load": 200 / 160}[wrong]
    assert m_s == pytest.approx(scale * CAR.m_s, rel=0.02)


def recorded(known: dict[str, float], *loads: Load) -> Campaign:
    """Simulate drops, with these quantities stated."""
    campaign = sprung.simulate(CAR, loads=loads, rate=250.0, noise=0.02, seed=1, duration=2.4)
    return replace(campaign, known={name: KnownValue(value, 0.002 * value) for name, value in known.items()})


def identified(**known: float) -> Result:
    return sprung.identify(recorded(known))


def near_truth(result: Result) -> None:
    for name, truth in CAR.parameters.items():
        one = result.parameters[name]
        assert one.value is not None
        assert one.std is not None
        assert abs(one.value - truth) <= 4 * one.std, name

"""The mass of a load, or the wheelbase, that everything else contradicts: it is said what the recordings show instead."""

from __future__ import annotations

from dataclasses import replace

import pytest

import sprung
from sprung.campaign import Campaign
from sprung.results import Result
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Item, Load

CAR = TABLE_1_CAR
AXLES = {
    "front_axle_mass": KnownValue(CAR.m_s * CAR.b / CAR.wheelbase + 2 * CAR.m_uf, 2.0),
    "rear_axle_mass": KnownValue(CAR.m_s * CAR.a / CAR.wheelbase + 2 * CAR.m_ur, 2.0),
}
"""kg on each axle, from the moments about the other one."""


def recorded() -> Campaign:
    """Return ten drops, half of them with 140 kg in the boot, of sensors with usual errors."""
    ballast = {"name": "ballast", "items": [{"mass": 140.0, "position": (-2.2, 0.25, 0.6), "inertia": (5.0, 6.0)}]}
    return sprung.simulate(CAR, loads=[ballast], known=AXLES, sensor_errors=True, seed=5)


def near_truth(result: Result) -> None:
    """Check every parameter against the car that was simulated."""
    assert result.verdict.state == "accept"
    for name, true in CAR.parameters.items():
        found = result.parameters[name]
        assert abs((found.value or 0.0) - true) < 4 * (found.std or 0.0), name


@pytest.mark.parametrize("stated", [190.0, 100.0])
@pytest.mark.slow
def test_the_mass_of_a_load_that_was_stated_wrong(stated: float) -> None:
    """A sensor on the body was blamed, or both axles, and the campaign rejected."""
    wrong = Load(name="ballast", items=(Item(mass=stated, position=(-2.2, 0.25, 0.6), inertia=(5.0, 6.0)),))
    campaign = recorded()
    loads = tuple(wrong if load.name == "ballast" else load for load in campaign.loads)
    result = sprung.identify(replace(campaign, loads=loads))
    (fault,) = result.faults
    assert (fault.code, fault.where) == ("known", "load 'ballast'")
    assert f"its mass of {stated:g} kg" in fault.what
    shown = float(fault.what.partition("show ")[2].partition(" kg")[0])
    assert shown == pytest.approx(140.0, abs=1.5)  # 0.3 % of a car of 1.5 t, weighed to 2 kg
    near_truth(result)


def test_a_wheelbase_that_was_stated_wrong() -> None:
    """A sensor on the body was blamed, and parameters were off by up to 8 %."""
    wrong = KnownValue(0.96 * CAR.wheelbase, 0.0)
    result = sprung.identify(replace(recorded(), wheelbase=wrong))
    (fault,) = result.faults
    assert (fault.code, fault.where) == ("known", "vehicle.wheelbase")
    assert f"wheelbase = {wrong.value:g} m" in fault.what
    near_truth(result)


@pytest.mark.slow
def test_with_one_mass_alone_the_load_is_not_told_from_it() -> None:
    """What was weighed and what was loaded contradict each other: which of them is wrong nothing tells."""
    campaign = recorded()
    known = {"total_mass": KnownValue(1.2 * CAR.total_mass, 2.0)}
    result = sprung.identify(replace(campaign, known=known))
    assert next(fault.where for fault in result.faults if fault.code == "known") == "known.total_mass"
    assert result.verdict.state == "doubtful"

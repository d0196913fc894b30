"""Displays of parts of a vehicle: they state and draw what the part has, not a whole vehicle."""

from __future__ import annotations

import re
from functools import cache

import pytest

import sprung
from quarter_car import QUARTER
from sprung.report import report_html
from sprung.report.page.summary import model_text
from sprung.results import Result
from sprung.vehicle import LAYOUTS, TABLE_1_CAR, Vehicle, VehicleModel

PARTS: dict[VehicleModel, Vehicle] = {
    "full": TABLE_1_CAR,
    "pitch-plane": Vehicle(
        model="pitch-plane", m_s=1380, I_yy=2440, m_uf=81, m_ur=90.8, k_sf=34000, k_sr=44000, k_tf=384000, k_tr=384000,
        c_sf=3000, c_sr=3000, a=1.25, b=1.51,
    ),
    "roll-plane": Vehicle(
        model="roll-plane", m_s=690, I_xx=190, m_u=40.5, k_s=17000, k_t=192000, c_s=1500, t=0.74
    ),
    "quarter": QUARTER,
}  # fmt: skip
DROPS = {
    "full": (("fl", "fr", "rl", "rr"), ("fl", "rl"), ("fl", "fr")),
    "pitch-plane": (("front", "rear"), ("front",)),
    "roll-plane": (("left", "right"), ("left",)),
    "quarter": (("wheel",),),
}


@cache
def identified(model: VehicleModel) -> Result:
    vehicle = PARTS[model]
    drops = [{"wheels": list(wheels), "load": "empty"} for wheels in DROPS[model]]
    campaign = sprung.simulate(vehicle, drops=drops, noise=0.02, seed=1, known={"total_mass": vehicle.total_mass})
    return sprung.identify(campaign, extras=(), tracks="shared", fall=False)


@pytest.fixture(params=list(PARTS))
def result(request: pytest.FixtureRequest) -> Result:
    return identified(request.param)


WORDS = {"two": 2, "four": 4, "seven": 7}


def test_the_model_is_stated_with_its_degrees_of_freedom(result: Result) -> None:
    layout = result.vehicle.layout
    [number] = re.findall(r"(\w+) degrees of freedom", model_text(result))
    assert WORDS[number] == len(layout.coordinates)
    assert (layout.model.split("-")[0] in model_text(result)) == (layout != LAYOUTS["full"])
    found = re.findall(r"(\w+) degrees of freedom(?!, tests)", report_html(result))
    assert len(found) >= 2
    assert set(found) == {number}


@pytest.mark.parametrize(
    ("model", "sprung_mass"),
    [
        ("full", "the quarter car of each axle: half of the sprung mass on the axle, one spring"),
        ("pitch-plane", "each axle alone: the sprung mass on the axle, one spring"),
        ("roll-plane", "the quarter car of one side: half of the sprung mass, one spring"),
        ("quarter", "the quarter car: its sprung mass, one spring"),
    ],
)
def test_ride_and_wheel_hop_are_said_to_be_of_the_mass_that_was_computed_with(
    model: VehicleModel, sprung_mass: str
) -> None:
    assert f"Ride and wheel hop are those of {sprung_mass}" in " ".join(report_html(identified(model)).split())
    values = PARTS[model].parameters
    axle = "f" if model in ("full", "pitch-plane") else ""
    share = values["b"] / (values["a"] + values["b"]) if axle else 1.0
    half = 0.5 if "half" in sprung_mass else 1.0
    ride = identified(model).derived["front_ride_damping" if axle else "ride_damping"]
    mass = half * share * values["m_s"]
    expected = values[f"c_s{axle}"] / (2 * (values[f"k_s{axle}"] * mass) ** 0.5)
    assert ride.value is not None
    assert ride.std is not None
    assert abs(ride.value - expected) < 4 * ride.std

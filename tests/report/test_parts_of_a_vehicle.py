"""Displays of parts of a vehicle: they state and draw what the part has, not a whole vehicle."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

import sprung
from quarter_car import QUARTER
from sprung.report import report_html, solid_frame, wire_frame
from sprung.report.drawing.axis import axis_limits
from sprung.report.page.summary import model_text
from sprung.report.terminal.validation import validation_table
from sprung.results import (
    Result,
    characteristics_tables,
    derived_table,
    meaning_of,
    parameters_table,
)
from sprung.ride import ride_numbers, ride_tables
from sprung.uncertainty import Estimate
from sprung.vehicle import LAYOUTS, TABLE_1_CAR, Vehicle, VehicleModel

mpl.use("Agg")

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


def test_wire_frames_have_the_wheels_and_motions_of_the_vehicle(result: Result) -> None:
    layout, frame = result.vehicle.layout, solid_frame(result)
    hubs = list(frame.nodes.hubs)
    assert len(hubs) == len(layout.wheels)
    # Wheels lie apart exactly where the vehicle tells them apart, and each rises with its own coordinate alone.
    assert (np.ptp(frame.places[hubs, 0]) > 0) == layout.pitches
    assert (np.ptp(frame.places[hubs, 1]) > 0) == layout.rolls
    np.testing.assert_array_equal(frame.rows[hubs, layout.wheels_at], np.eye(len(hubs)))
    np.testing.assert_array_equal(frame.rows[hubs, : len(layout.body)], 0)
    # The body turns as a rigid one: every point of it rises by what its place says.
    body = range(hubs[0])
    turned = {"z_s": 1.0, "theta": -frame.places[body, 0], "phi": frame.places[body, 1]}
    for column, coordinate in enumerate(layout.body):
        np.testing.assert_array_equal(frame.rows[body, column], turned[coordinate])
    assert {node for pair in frame.nodes.edges for node in pair} <= set(body)
    assert [hub for hub, _ in frame.nodes.struts] == hubs
    picture = wire_frame(result)
    for node, radius in picture.circles:
        assert radius <= picture.places[node, 0] <= picture.width - radius


def test_pictures_of_modes_show_the_wheels_at_rest_too(result: Result) -> None:
    hop = next(mode for mode in reversed(result.modes["empty"]) if "hop" in mode.name)
    number = len(result.vehicle.layout.wheels)
    page = report_html(result)
    drawn = page[page.index(f'aria-label="{hop.name}') :]
    drawn = drawn[: drawn.index("</svg>")]
    assert drawn.count('<circle class="wheel"') == drawn.count('<circle class="rest"') == number
    axes = sprung.plot.mode(result, hop.name)
    circles = [line for line in axes.lines if len(np.asarray(line.get_xdata())) > 2]
    assert len([line for line in circles if line.get_linestyle() == "--"]) == number
    assert len(circles) == 2 * number
    plt.close("all")


def test_motions_that_the_vehicle_does_not_have_are_not_shown(result: Result) -> None:
    body = result.vehicle.layout.body
    motions = [name for name, one in (("vertical", "z_s"), ("pitch", "theta"), ("roll", "phi")) if one in body]
    drop = next(iter(result.series))
    assert [axes.get_ylabel().split(",")[0] for axes in sprung.plot.fit(result, drop)[::2]] == motions
    plt.close("all")
    headers = validation_table(result.name, result.validation, result.vehicle.layout).headers
    assert [header.removesuffix(" %") for header in headers[1 : headers.index("all %")]] == motions
    page = " ".join(report_html(result).split())
    words = {1: "Vertical", 2: "Vertical and {}", 3: "Vertical, pitch and roll"}[len(motions)].format(motions[-1])
    assert f"<p>{words} acceleration of the body: measured" in page


def test_a_quantity_that_is_zero_throughout_has_limits_that_can_be_read() -> None:
    assert axis_limits(np.zeros(5), margin=0.0) == (-1.0, 1.0)


def test_the_pitch_plane_has_stations_and_both_sides() -> None:
    """Its masses are those of both wheels of an axle, and of the whole body."""
    pitch, full = (ride_tables(ride_numbers(PARTS[model], roads=("C",))) for model in ("pitch-plane", "full"))
    assert {"sprung mass on a station, kg", "unsprung mass of a station, kg"} <= {row[0] for row in pitch[0].rows}
    assert {"sprung mass on a wheel, kg", "unsprung mass of a wheel, kg"} <= {row[0] for row in full[0].rows}
    assert (pitch[-1].title, pitch[-1].headers) == ("Pitch plane", ("both sides together", "pitch plane"))
    assert (full[-1].title, full[-1].headers[0]) == ("Half cars", "half car")
    mass, half = (float(table.rows[0][1]) for table in (pitch[-1], full[-1]))
    assert mass == 2 * half
    rows = parameters_table("", identified("pitch-plane").parameters).rows
    meanings = {row[0]: row[-1] for row in rows}
    assert meanings["m_uf"] == "unsprung mass, front station"
    assert "each" not in " ".join(meanings.values())
    assert (
        meaning_of("front_wheel_load", LAYOUTS["pitch-plane"])
        == "static load of the front station of the empty vehicle"
    )


def test_exact_derived_values_are_rounded() -> None:
    exact = Estimate(3780.463575, 0.0, (3780.463575, 3780.463575), "N", "known")
    [row] = derived_table("", {"wheel_load": exact}).rows
    assert row == ("wheel_load", "3780.46", "", "N")
    stated = replace(exact, value=1551.8, unit="kg")
    assert derived_table("", {"total_mass": stated}).rows[0][1] == "1551.8"
    [table] = characteristics_tables("", {"wheel_load": exact})
    assert table.rows[0][1] == "3780.46"

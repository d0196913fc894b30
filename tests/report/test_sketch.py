"""The sketch of the vehicle: to scale, nothing invented, no label on another."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest

import sprung
from sprung.campaign import Campaign, ModelChoice
from sprung.report import Disc, Drawing, Stroke, TextShape, blank_sketch, sketch_sheet, sketch_svg, vehicle_sketch
from sprung.report.sketch.labels import Box, Label, place_labels, text_box
from sprung.uncertainty import KnownValue
from sprung.vehicle import EMPTY, SCHOOL_BUS, WHEELS, Added, Item, Load, Sensor, Vehicle, VehicleModel, Wheel

KNOWN = {"a": KnownValue(1.25), "b": KnownValue(1.51), "t_f": KnownValue(0.74), "t_r": KnownValue(0.70, 0.01)}
CORNERS = [("fl", 0.1, 0.7), ("fr", 0.1, -0.7), ("rl", -2.9, 0.7), ("rr", -2.9, -0.7)]
SENSORS = (
    *(Sensor(channel=f"body_{name}", on="body", position=(x, y, 0.6)) for name, x, y in CORNERS),
    *(Sensor(channel=f"wheel_{name}", on=name) for name in WHEELS),
)
LOAD = Load(name="sand", items=(Item(mass=140, position=(-1.0, 0.3, 0.7)),))


def campaign(**changes: Any) -> Campaign:
    whole = Campaign("car", SENSORS, (), (EMPTY, LOAD), KnownValue(2.76), cg_height=0.55, wheel_height=0.3, known=KNOWN)
    return replace(whole, **changes)


def words(drawing: Drawing) -> list[str]:
    return [shape.text for shape in drawing.shapes if isinstance(shape, TextShape)]


def boxes(drawing: Drawing) -> Iterator[tuple[str, Box]]:
    for shape in drawing.shapes:
        if isinstance(shape, TextShape):
            yield shape.text, text_box(shape.text, shape.at, shape.anchor)


def dots(drawing: Drawing) -> list[tuple[float, float]]:
    return [shape.centre for shape in drawing.shapes if isinstance(shape, Disc) and shape.kind == "sensor"]


def written(svg: str) -> list[str]:
    """The texts of an SVG file."""
    return [re.sub(r"<[^>]*>", "", text) for text in re.findall(r"<text[^>]*>(.*?)</text>", svg)]


def assert_legible(drawing: Drawing) -> None:
    """No text covers another, and all of it is inside of the frame."""
    frame = Box(0, 0, drawing.width, drawing.height)
    for (one, first), (other, second) in combinations(boxes(drawing), 2):
        assert not first.overlaps(second), (one, other)
    for text, box in boxes(drawing):
        assert box.within(frame), text


def test_views_are_to_scale() -> None:
    plan, side = vehicle_sketch(campaign()).drawings
    scale_bar = next(
        s for s in plan.shapes if isinstance(s, Stroke) and s.kind == "dimension" and s.points[0][0] == 4.0
    )
    scale = scale_bar.points[1][0] - scale_bar.points[0][0]  # units per m
    body = np.array(dots(plan)[:4])
    stated = np.array([(x, -y) for _, x, y in CORNERS])
    np.testing.assert_allclose(body - body[0], scale * (stated - stated[0]), atol=1e-9)
    from_side = np.array(dots(side)[:4])
    np.testing.assert_allclose(np.ptp(from_side, axis=0), [scale * 3.0, 0.0], atol=1e-9)
    lengths = {
        shape.points[1][0] - shape.points[0][0]
        for view in (plan, side)
        for shape in view.shapes
        if isinstance(shape, Stroke) and shape.arrows == "both" and shape.points[0][1] == shape.points[1][1]
    }
    for length in (1.25, 1.51, 2.76):
        assert any(found == pytest.approx(scale * length) for found in lengths), length


def test_everything_known_is_written() -> None:
    plan, side = vehicle_sketch(campaign()).drawings
    assert {"a 1.25 m", "b 1.51 m", "t_f", "t_r", "0.74 m", "0.700 m", "sand 140 kg"} <= set(words(plan))
    assert {"wheelbase 2.76 m", "z 0.55 m", "z 0.3 m"} <= set(words(side))
    for channel in (sensor.channel for sensor in SENSORS):
        assert channel in words(plan)
        assert channel in words(side)
    assert vehicle_sketch(campaign()).unknown == ()


def test_separate_half_distances() -> None:
    separate = {"t_f1": KnownValue(0.5), "t_f2": KnownValue(0.6), "t_r1": KnownValue(0.55), "t_r2": KnownValue(0.65)}
    [plan, _] = vehicle_sketch(campaign(known=separate)).drawings
    assert {"t_f1", "t_f2", "t_r1", "t_r2", "0.5 m", "0.6 m", "0.55 m", "0.65 m"} <= set(words(plan))
    [plan, _] = vehicle_sketch(campaign(known={}, model=ModelChoice(tracks="separate"))).drawings
    assert {"t_f1", "t_f2", "t_r1", "t_r2"} <= set(words(plan))


def test_what_is_not_known_is_dashed_and_named() -> None:
    without = tuple(sensor for sensor in SENSORS if sensor.on != "body")
    sketch = vehicle_sketch(
        campaign(wheelbase=None, known={}, cg_height=None, wheel_height=None, sensors=without, loads=(EMPTY,))
    )
    named = "; ".join(sketch.unknown)
    for part in ("wheelbase", "a, b", "t_f", "t_r", "height of the centre of gravity", "height of the wheel centres"):
        assert part in named
    plan, side = sketch.drawings
    assert "not to scale: no length is known" in words(plan)
    assert {"a ?", "b ?"} <= set(words(plan))
    assert "wheelbase ?" in words(side)
    for drawing in sketch.drawings:
        dimensions = [s for s in drawing.shapes if isinstance(s, Stroke) and s.kind in ("dimension", "gravity")]
        assert all(shape.dashed for shape in dimensions)
        numbers = [text for text in words(drawing) if any(letter.isdigit() for letter in text)]
        assert numbers == []


def test_labels_of_crowded_sensors_do_not_overlap() -> None:
    """Sixteen sensors with long names within half a metre, two of them at one point."""
    names = [f"acceleration_{i:02d}_vertical_z" for i in range(16)]
    places = [(-1.3 + 0.05 * (i // 4), 0.1 * (i % 4), 0.5) for i in range(15)]
    crowd = tuple(
        Sensor(channel=name, on="body", position=place) for name, place in zip(names, [*places, places[0]], strict=True)
    )
    for drawing in vehicle_sketch(campaign(sensors=crowd)).drawings:
        assert_legible(drawing)
        assert set(names) <= set(words(drawing))


@pytest.mark.parametrize(
    "vehicle", [SCHOOL_BUS, Vehicle.from_parameters({**SCHOOL_BUS.parameters, "a": 0.9, "b": 6.0})]
)
def test_usual_vehicles_are_legible(vehicle: Vehicle) -> None:
    simulated = sprung.simulate(vehicle, drops=[{"wheels": ["fl"]}], noise=0.02, seed=1)
    for drawing in vehicle_sketch(simulated).drawings:
        assert_legible(drawing)


def test_short_half_distances_apart_are_legible() -> None:
    """Those of the paper's bus: 0.4 m beside a wheelbase of 3.95 m; the dampers' are not known."""
    known = {"t_f2": KnownValue(0.4), "t_r2": KnownValue(0.5), "a": KnownValue(2.22)}
    for drawing in vehicle_sketch(campaign(wheelbase=KnownValue(3.95), known=known)).drawings:
        assert_legible(drawing)


def test_a_position_that_is_not_known_is_named_and_not_drawn() -> None:
    """Of body sensors, of a wheel sensor whose station is open, and of a load of which only totals are known."""
    unplaced = [Sensor(channel="on_the_body", on="body"), Sensor(channel="on_a_wheel", on=None)]
    total = Load(name="totals", added=Added(mass=470))
    sketch = vehicle_sketch(campaign(sensors=(*SENSORS[:2], *unplaced), loads=(EMPTY, total, Load(name="open"))))
    assert "position of on_the_body" in sketch.unknown
    assert "wheel station of on_a_wheel" in sketch.unknown
    assert "position of load totals (470 kg in total)" in sketch.unknown
    assert "position of load open" in sketch.unknown
    for drawing in sketch.drawings:
        assert not {"on_the_body", "on_a_wheel"} & set(words(drawing))
        assert len(dots(drawing)) == 2


def test_a_blank_one_to_print_has_no_numbers() -> None:
    said = written(blank_sketch())
    assert {"wheelbase ________ m", "a ________ m", "b ________ m", "sensor (channel)", "not to scale"} <= set(said)
    assert not any(letter.isdigit() for text in said for letter in text)


def test_a_sketch_of_its_own_is_a_file() -> None:
    sheet = sketch_sheet(vehicle_sketch(campaign()))
    assert sheet.startswith("<?xml")
    assert "var(" not in sheet  # it needs no page's colours
    assert {"Plan view", "Side view", "body_fl", "wheelbase 2.76 m"} <= set(written(sheet))


def test_names_are_escaped_and_shortened() -> None:
    odd = ('<b> & "c"', "d" * 200, "x\x07y", *(sensor.channel for sensor in SENSORS[3:]))
    renamed = tuple(replace(s, channel=name) for s, name in zip(SENSORS, odd, strict=True))
    plan, _ = vehicle_sketch(campaign(sensors=renamed)).drawings
    svg = sketch_svg(plan)
    assert "<b>" not in svg
    assert "&lt;b&gt; &amp; " in svg
    assert "ddd…" in svg
    assert "\x07" not in svg


def test_a_label_leaves_a_dimension_line_free_where_there_is_a_place_near() -> None:
    label, frame = Label((100.0, 100.0), ("body_fl",), "sensor"), Box(0.0, 0.0, 200.0, 200.0)
    line = ((125.0, 50.0), (125.0, 150.0))
    [usual] = place_labels([label], (), frame)
    [moved] = place_labels([label], (), frame, [line])
    assert usual is not None
    assert moved is not None
    assert (usual.box.is_crossed(*line), moved.box.is_crossed(*line)) == (True, False)
    everywhere = [((x, 0.0), (x, 200.0)) for x in np.arange(5.0, 200.0, 10.0).tolist()]
    assert place_labels([label], (), frame, everywhere) != (None,)


@pytest.mark.parametrize(
    ("model", "stations", "lengths", "missing"),
    [
        ("quarter", ("wheel",), set(), set()),
        ("roll-plane", ("left", "right"), {"t"}, {"half-distance t"}),
        ("pitch-plane", ("front", "rear"), {"a ?", "b ?"}, {"wheelbase", "centre of gravity (a, b)"}),
    ],
)
def test_a_part_of_a_vehicle_has_its_own_wheels_and_lengths(
    model: VehicleModel, stations: tuple[Wheel, ...], lengths: set[str], missing: set[str]
) -> None:
    sensors = tuple(Sensor(channel=f"at_{station}", on=station) for station in stations)
    part = campaign(vehicle_model=model, sensors=sensors, wheelbase=None, known={}, loads=(EMPTY,))
    sketch = vehicle_sketch(part)
    plan, side = sketch.drawings
    tyres = [shape for shape in plan.shapes if isinstance(shape, Stroke) and shape.kind == "wheel" and shape.closed]
    assert len(tyres) == len(stations) == len(dots(plan))
    circles = [shape for shape in side.shapes if isinstance(shape, Disc) and shape.kind == "wheel" and not shape.filled]
    assert len(circles) == (2 if model == "pitch-plane" else 1)
    every = {"t", "t_f", "t_r", "a ?", "b ?"}
    assert every & set(words(plan)) == lengths
    assert ("wheelbase ?" in words(side)) == (model == "pitch-plane")
    assert set(sketch.unknown) == missing
    for drawing in sketch.drawings:
        assert_legible(drawing)


def test_labels_leave_tyres_and_outline_free_where_there_is_room() -> None:
    plan, _ = vehicle_sketch(campaign(loads=(EMPTY,))).drawings
    lines = [
        line
        for shape in plan.shapes
        if isinstance(shape, Stroke) and shape.closed and shape.kind in {"wheel", "outline"}
        for line in zip(shape.points, (*shape.points[1:], shape.points[0]), strict=True)
    ]
    channels = {sensor.channel for sensor in SENSORS}
    crossed = [text for text, box in boxes(plan) if text in channels and any(box.is_crossed(*line) for line in lines)]
    assert crossed == []

"""Pictures of the local page: differences between results, and dampers with the points of the measured accelerations."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

import sprung
from sprung.report import Curve, Points, damper_cloud_pictures, differences_picture, picture_svg
from sprung.report.drawing.svg import layout_of
from sprung.results import Result, damper_points
from sprung.uncertainty import NORMAL_95
from sprung.vehicle import TABLE_1_CAR


def identified(**changes: float) -> Result:
    car = TABLE_1_CAR.with_values(**changes)
    drops = [{"wheels": wheels, "load": "empty"} for wheels in (["fl", "fr", "rl", "rr"], ["fl", "rl"], ["fl", "fr"])]
    campaign = sprung.simulate(car, drops=drops, noise=0.02, seed=1, known={"total_mass": car.total_mass})
    return sprung.identify(campaign, extras=(), tracks="shared", fall=False)


@pytest.fixture(scope="module")
def results() -> tuple[Result, Result]:
    """The Table 1 car, and the same with front dampers that are 20 % stiffer."""
    return identified(), identified(c_sf=1.2 * TABLE_1_CAR.c_sf)


def test_differences_are_shown_with_their_intervals(results: tuple[Result, Result]) -> None:
    comparison = sprung.compare(results)
    picture = differences_picture(comparison)
    assert picture is not None
    (panel,) = picture.panels
    points = {mark.role: mark for mark in panel.marks if isinstance(mark, Points)}
    names = [name for _, name in picture.x.ticks]
    significant = points["fault"]
    assert [names[int(place)] for place in significant.x] == ["c_sf"]
    # Percent, as simulated; the uncertainty of the rate is 0.05 %.
    assert significant.y[0] == pytest.approx(20, abs=0.2)
    difference = comparison.parameters["c_sf"].differences[0]
    assert difference.std is not None
    first = comparison.parameters["c_sf"].values[0].value
    assert first is not None
    assert significant.bars is not None
    assert significant.bars[0] == pytest.approx(100 * NORMAL_95 * difference.std / first)
    assert len(points["simulated"].x) == len(names) - 1
    assert re.search(r"c_sf \+(19\.9|20|20\.1) %", picture.description)


def test_nothing_is_drawn_where_nothing_differs(results: tuple[Result, Result]) -> None:
    comparison = sprung.compare(results)
    none = {
        name: replace(row, differences=(replace(row.differences[0], percent=None),))
        for name, row in comparison.parameters.items()
    }
    assert differences_picture(replace(comparison, parameters=none)) is None


def test_dampers_have_the_curve_in_front_of_the_points(results: tuple[Result, Result]) -> None:
    result = results[0]
    points = [point for drop in result.series for point in damper_points(result, drop)]
    front, rear = damper_cloud_pictures(result, points)
    assert (front.title, rear.title) == ("Front dampers", "Rear dampers")
    above, below = front.panels
    cloud = next(mark for mark in above.marks if isinstance(mark, Points))
    curve = next(mark for mark in above.marks if isinstance(mark, Curve))
    assert above.marks.index(cloud) < above.marks.index(curve)
    rate = result.parameters["c_sf"]
    assert rate.value is not None
    assert rate.std is not None
    assert curve.y == pytest.approx(rate.value * curve.x)
    assert curve.band == pytest.approx(NORMAL_95 * rate.std * np.abs(curve.x))
    velocities = np.concatenate([point.velocity for point in points if point.wheel in {"fl", "fr"}])
    assert (curve.x[0], curve.x[-1]) == pytest.approx((velocities.min(), velocities.max()))
    left = next(mark for mark in below.marks if isinstance(mark, Points))
    assert left.y == pytest.approx(cloud.y - rate.value * cloud.x, abs=1e-6)
    assert len(cloud.x) <= 4000
    assert "style=" not in picture_svg(front)  # the page's Content-Security-Policy refuses it


def test_labels_beside_panels_of_dampers_stay_beside_them(results: tuple[Result, Result]) -> None:
    """Written upwards in 10.5 pixels, a letter is 5 units wide at least."""
    result = results[0]
    for picture in damper_cloud_pictures(result, damper_points(result, "empty_bounce")):
        for panel, box in zip(picture.panels, layout_of(picture).boxes, strict=True):
            assert all(5 * len(line) <= box.height for line in panel.y.label.split(", ", 1))

"""Inertias and the axes they are about, where heights are given and where they are not."""

from __future__ import annotations

from dataclasses import replace

import pytest

import sprung
from sprung.analysis.axes import ABOUT_ROLL_AXIS
from sprung.vehicle import TABLE_1_CAR, Vehicle

LOAD = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.3, 0.5)}]}


def dropped(**heights: float) -> sprung.Campaign:
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters, name="car", **heights)
    return sprung.simulate(car, loads=[LOAD], rate=250, noise=0.02, seed=1)


def test_with_heights_the_inertia_is_that_about_the_centre_of_gravity() -> None:
    """The roll inertia simulated, and with Steiner's part about the axis of roll, within four standard errors."""
    result = sprung.identify(dropped(cg_height=0.55, wheel_height=0.3, roll_axis_height=0.1))
    own, about_axis = result.parameters["I_xx"], result.derived[ABOUT_ROLL_AXIS]
    assert result.verdict.state == "accept"
    assert result.fit.model == ()
    for found, truth in ((own, 380.0), (about_axis, 380.0 + 1380.0 * 0.45**2)):
        assert found.value is not None
        assert found.std is not None
        assert found.value == pytest.approx(truth, abs=4 * found.std)
        assert found.std < 0.01 * truth
    assert "centre of gravity of the sprung mass (0.55 m" in result.fit.axes
    assert "carried at its wheels" in result.fit.axes


def test_without_heights_it_is_said_that_nobody_knows_which_axis_it_is() -> None:
    """Gravity is found all the same, and every rate is right; the roll inertia holds what the wheels do sideways."""
    campaign = dropped(cg_height=0.55, wheel_height=0.3)
    result = sprung.identify(replace(campaign, cg_height=None, wheel_height=None))
    assert result.fit.model == ("gravity",)
    assert ABOUT_ROLL_AXIS not in result.derived
    assert "no heights are given" in result.fit.axes
    carried = 2 * (TABLE_1_CAR.m_uf + TABLE_1_CAR.m_ur) * 0.25**2
    assert result.parameters["I_xx"].value == pytest.approx(380.0 + carried, rel=0.01)
    assert result.parameters["k_sf"].value == pytest.approx(17_000.0, rel=0.005)


def test_the_records_say_where_the_body_is_carried() -> None:
    """A vehicle carried 0.3 m up, of which it is said that its wheels are 0.45 m up and its axis of roll is at 0.3 m."""
    campaign = dropped(cg_height=0.55, wheel_height=0.3)
    told = replace(campaign, wheel_height=0.45, roll_axis_height=0.3)
    assert "carried at the axis of roll" in sprung.identify(told, extras=[]).fit.axes

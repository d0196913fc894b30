"""A fault of a car that has more than springs and dampers: both are found, and neither is taken for the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from real_campaigns import Truth, record
from real_kinds import draw_test

import sprung

Real = NDArray[np.float64]

FARTHEST = 4.5
"""Standard errors that the worst of seventeen parameters may be off by: one in ten thousand cars is further."""


def recorded(kind: str, seed: int) -> tuple[sprung.Campaign, Truth]:
    """Return the campaign of a car from a simulator that shares no equation with the package, and its parameters."""
    (one,) = record([draw_test(kind, seed)])
    return one


def with_fault(campaign: sprung.Campaign, change: Callable[[list[str], Real], None]) -> sprung.Campaign:
    """Return a campaign with the readings of each drop changed."""
    channels, recordings = [sensor.channel for sensor in campaign.sensors], []
    for one in campaign.recordings:
        values = one.values.copy()
        change(channels, values)
        recordings.append(replace(one, values=values))
    return campaign.with_recordings(recordings)


def assert_right(result: sprung.Result, truth: Truth) -> None:
    """Assert that every true parameter is within its error."""
    for name, true in truth.parameters.items():
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - true) < FARTHEST * found.std, name


def late(channels: list[str], values: Real) -> None:
    own = values[channels.index("body_rl")]
    own[5:] = own[:-5].copy()


def exchanged(first: str, second: str) -> Callable[[list[str], Real], None]:
    def change(channels: list[str], values: Real) -> None:
        both = [channels.index(first), channels.index(second)]
        values[both] = values[both[::-1]]

    return change


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (late, ("late", "body_rl")),
        (exchanged("wheel_fr", "wheel_rr"), ("exchanged", "wheel_fr, wheel_rr")),
        (exchanged("body_rl", "body_rr"), ("exchanged", "body_rl, body_rr")),
    ],
    ids=["late", "wheels exchanged", "bodies exchanged"],
)
@pytest.mark.slow
def test_a_fault_is_mended_and_the_mounts_of_the_dampers_are_found(
    change: Callable[[list[str], Real], None], fault: tuple[str, str]
) -> None:
    campaign, truth = recorded("mount", 1)
    result = sprung.identify(with_fault(campaign, change))
    assert [(one.code, one.where) for one in result.faults] == [fault]
    assert tuple(result.fit.model) == ("damper-mount",)
    assert result.verdict.state == "accept"
    assert_right(result, truth)


@pytest.mark.slow
def test_air_springs_are_no_faults_of_half_the_drops() -> None:
    # To springs that are linear, loads seemed exchanged, a clock wrong and a brake on: each explained a part of the rest.
    result = sprung.identify(recorded("air", 0)[0])
    assert not result.faults
    assert tuple(result.fit.model) == ("air",)
    assert result.verdict.state == "accept"


@pytest.mark.slow
def test_a_sensor_that_a_nonlinear_fit_takes_far_from_what_is_stated_is_named() -> None:
    def reads_less(channels: list[str], values: Real) -> None:
        values[channels.index("wheel_fr")] *= 0.8

    campaign, truth = recorded("tyre", 0)
    result = sprung.identify(with_fault(campaign, reads_less))
    assert ("unlike-others", "wheel_fr") in [(one.code, one.where) for one in result.faults]
    assert result.verdict.state == "doubtful"
    assert set(result.fit.model) == {"tyre-damping", "tyre-curve"}
    assert_right(result, truth)

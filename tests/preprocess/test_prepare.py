"""Decays against drops whose events are known exactly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from sprung.campaign import Campaign, Drop
from sprung.preprocess import prepare
from sprung.simulation import drop_from_blocks, simulate
from sprung.vehicle import EMPTY, SCHOOL_BUS, TABLE_1_CAR, Vehicle
from strategies import vehicles


def landing(vehicle: Vehicle, drop: Drop, rest: float) -> float:
    assert drop.height is not None
    return rest + drop_from_blocks(vehicle, EMPTY, drop.wheels, drop.height, duration=3.2).decay_start


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(vehicle=vehicles)
@pytest.mark.slow
def test_no_decay_begins_before_the_last_landing(vehicle: Vehicle) -> None:
    campaign = simulate(vehicle, noise=0.02, seed=1)
    for decay, drop in zip(prepare(campaign).decays, campaign.drops, strict=True):
        assert decay.start >= landing(vehicle, drop, 0.4) - 0.0021  # one sample at 500 Hz


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS])
def test_what_may_belong_to_a_decay_is_kept_back_to_the_landing(vehicle: Vehicle) -> None:
    """The certain start may be late; the fitted vehicle then says how much of what is before it belongs to the decay."""
    campaign = simulate(vehicle, noise=0.02, seed=2)
    for decay, drop in zip(prepare(campaign).decays, campaign.drops, strict=True):
        possible = decay.start - decay.earlier.shape[1] / decay.rate
        assert possible <= landing(vehicle, drop, 0.4) + 0.02
        assert possible > 0.4


def test_a_decay_moves_and_moves_back() -> None:
    decay = next(d for d in prepare(simulate(SCHOOL_BUS, noise=0.02, seed=3)).decays if d.earlier.shape[1] > 1)
    far = decay.earlier.shape[1]
    moved = decay.shifted(-far)
    assert moved.start == pytest.approx(decay.start - far / decay.rate)
    assert moved.end == pytest.approx(decay.end)
    np.testing.assert_array_equal(moved.shifted(far).values, decay.values)


def cut(campaign: Campaign, seconds: float) -> Campaign:
    return campaign.with_recordings(
        replace(r, values=r.values[:, : int(seconds * r.rate)]) for r in campaign.recordings
    )


def test_limits_given_by_the_user_hold() -> None:
    campaign = simulate(TABLE_1_CAR, drops=[{"start": 1.0, "end": 2.5}], noise=0.02, seed=4)
    decay = prepare(campaign).decays[0]
    assert decay.start == pytest.approx(1.0)
    assert decay.end == pytest.approx(2.5)
    assert decay.earlier.shape[1] == 0


def test_too_short_a_recording_is_left_out_and_told() -> None:
    campaign = simulate(TABLE_1_CAR, noise=0.02, seed=5)
    short = campaign.with_recordings((cut(campaign, 0.7).recordings[0], *campaign.recordings[1:]))
    prepared = prepare(short)
    assert len(prepared.decays) == 4
    ((drop, faults),) = prepared.left_out
    assert drop.label == "empty_bounce"
    assert faults[-1].code == "no-decay"
    assert "empty_bounce.csv" in faults[-1].where


def test_no_wheel_sensors_at_all() -> None:
    campaign = simulate(TABLE_1_CAR, noise=0.02, seed=6)
    body = [i for i, sensor in enumerate(campaign.sensors) if sensor.on == "body"]
    blind = replace(
        campaign.with_recordings(
            replace(r, values=r.values[body], channels=tuple(r.channels[i] for i in body)) for r in campaign.recordings
        ),
        sensors=tuple(campaign.sensors[i] for i in body),
    )
    for decay, drop in zip(prepare(blind).decays, campaign.drops, strict=True):
        assert decay.start >= landing(TABLE_1_CAR, drop, 0.4)


def test_a_dead_channel_is_left_out_of_its_drop_and_told() -> None:
    campaign = simulate(TABLE_1_CAR, noise=0.02, seed=7)
    values = campaign.recordings[1].values.copy()
    values[4] = 9.81
    dead = replace(campaign.recordings[1], values=values)
    decays = prepare(campaign.with_recordings((campaign.recordings[0], dead, *campaign.recordings[2:]))).decays
    assert [fault.code for fault in decays[1].faults] == ["flat"]
    assert campaign.sensors[4].channel in decays[1].faults[0].where
    assert list(np.flatnonzero(~decays[1].usable)) == [4]
    assert decays[0].usable.all()


def test_a_copy_tells_nothing_new() -> None:
    campaign = simulate(TABLE_1_CAR, noise=0.02, seed=8)
    copy = replace(campaign.recordings[0], name="again.csv")
    more = replace(campaign, drops=(*campaign.drops, replace(campaign.drops[0], file="again.csv", recording=copy)))
    prepared = prepare(more)
    assert len(prepared.decays) == 5
    assert prepared.left_out[0][1][0].code == "copy"


def test_two_parts_of_one_recording_are_no_copies() -> None:
    campaign = simulate(TABLE_1_CAR, noise=0.02, seed=8)
    parts = ((1.2, 2.0), (2.0, 3.0))
    twice = replace(
        campaign,
        drops=tuple(replace(campaign.drops[0], start=start, end=end) for start, end in parts),
    ).with_recordings((campaign.recordings[0], replace(campaign.recordings[0], name="empty_bounce.csv (2)")))
    prepared = prepare(twice)
    assert not prepared.left_out
    assert [decay.name for decay in prepared.decays] == ["empty_bounce", "empty_bounce (2)"]

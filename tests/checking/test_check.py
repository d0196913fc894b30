"""What `check` says of a drop, against drops whose events are known exactly."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter

import sprung
from sprung.campaign import Campaign
from sprung.checking import Check, DropReport
from sprung.checking.check import check_prepared
from sprung.preprocess import prepare
from sprung.simulation import drop_from_blocks
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Vehicle

REST = 0.4  # s before the release, as `simulate` has it


def changed(campaign: Campaign, change: dict[str, Any], drop: int = 0) -> Campaign:
    """Change a statement about a drop."""
    drops = list(campaign.drops)
    drops[drop] = replace(drops[drop], **change)
    return replace(campaign, drops=tuple(drops))


def spoilt(campaign: Campaign, values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Campaign:
    """Replace the values of the first recording."""
    return campaign.with_recordings((replace(campaign.recordings[0], values=values), *campaign.recordings[1:]))


@pytest.fixture(scope="module")
def car() -> Campaign:
    return sprung.simulate(TABLE_1_CAR, noise=0.02, seed=1)


@pytest.fixture(scope="module")
def seen(car: Campaign) -> Check:
    return sprung.check(car)


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS])
def test_events(vehicle: Vehicle) -> None:
    campaign = sprung.simulate(vehicle, noise=0.02, seed=1)
    for report, drop in zip(sprung.check(campaign).drops, campaign.drops, strict=True):
        assert drop.height is not None
        fall = drop_from_blocks(vehicle, campaign.load(drop.load), drop.wheels, drop.height, duration=3.2)
        landings = [event for event in fall.events if event.kind == "landing"]
        first = max(next(event.time for event in landings if event.wheel == wheel) for wheel in drop.wheels)
        assert report.release is not None
        assert report.landing is not None
        assert report.start is not None
        assert report.release == pytest.approx(REST, abs=0.0021)  # one sample at 500 Hz
        # The steepest rise of the wheel's reading comes a tenth of a period of wheel hop after the contact at most.
        assert report.landing == pytest.approx(REST + first, abs=0.01)
        assert report.start >= REST + landings[-1].time - 0.0021
        # In this order, and the decay begins with the sample after the last of them: no lift-off before a landing.
        last = report.landing if report.last_lift_off is None else report.last_lift_off + 1 / 500
        assert report.release <= report.landing <= last
        assert report.start == pytest.approx(last)


def test_kinds_and_wheels(car: Campaign, seen: Check) -> None:
    assert [drop.kind for drop in seen.drops] == ["bounce", "pitch front", "pitch rear", "roll left", "roll right"]
    assert [drop.wheels for drop in seen.drops] == [drop.wheels for drop in car.drops]
    assert all(drop.wheels_seen == drop.wheels and not drop.contradicted for drop in seen.drops)
    assert {drop.rate for drop in seen.drops} == {500.0}
    one = sprung.simulate(TABLE_1_CAR, drops=[{"wheels": ["fl"]}], seed=1)
    assert sprung.check(one).drops[0].kind == "fl"


@pytest.mark.parametrize("stated", [("rl", "rr"), ("fl", "fr", "rl", "rr"), ("fl",), ("fl", "rr")])
def test_wheels_that_fell_otherwise_than_stated(stated: tuple[str, ...]) -> None:
    front = changed(sprung.simulate(TABLE_1_CAR, drops=[{"wheels": ["fl", "fr"]}], seed=1), {"wheels": stated})
    report = sprung.check(front).drops[0]
    assert report.wheels == stated
    assert report.wheels_seen == ("fl", "fr")
    assert report.contradicted


def test_a_wheel_without_a_sensor_fell_as_stated() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, seed=1)
    without = [sensor for sensor in campaign.sensors if sensor.on != "rr"]
    report = sprung.check(sprung.simulate(TABLE_1_CAR, sensors=without, seed=1)).drops[0]
    assert report.wheels_seen == ("fl", "fr", "rl", "rr")
    assert "as the sensors do not tell when every wheel has landed" in report.why_start


def test_channels(car: Campaign, seen: Check) -> None:
    for drop in seen.drops:
        assert [channel.name for channel in drop.channels] == [sensor.channel for sensor in car.sensors]
        assert [channel.on for channel in drop.channels] == [sensor.on for sensor in car.sensors]
        noise = [channel.noise for channel in drop.channels]
        assert noise == pytest.approx([0.02] * 8, rel=0.25)  # what was simulated; 150 samples tell it to 6 %
        assert all(channel.used and channel.faults == () for channel in drop.channels)
    exact = sprung.simulate(TABLE_1_CAR, noise=0.0)
    peaks = [channel.peak for channel in sprung.check(exact).drops[0].channels]
    values = exact.recordings[0].values
    assert peaks == pytest.approx(np.abs(values - values[:, :1]).max(axis=1).tolist())


def test_limits_say_their_reason(car: Campaign, seen: Check) -> None:
    assert {drop.why_start for drop in seen.drops} <= {
        "no tyre can be off the ground any more",
        "every wheel that fell has landed and stays down",
    }
    assert {drop.why_end for drop in seen.drops} == {"the recording ends"}
    report = sprung.check(changed(car, {"start": 1.0, "end": 2.5})).drops[0]
    assert (report.start, report.end) == pytest.approx((1.0, 2.5))
    assert (report.why_start, report.why_end) == ("given as start", "given as end")
    assert report.release == pytest.approx(REST, abs=0.0021)


def test_clipping_says_until_when(car: Campaign) -> None:
    values = car.recordings[0].values.copy()
    values[4] = values[4].clip(-25, 25)
    check = sprung.check(spoilt(car, values))
    report = check.drops[0]
    clipped = np.flatnonzero(np.abs(values[4]) == 25)
    assert report.why_start == "until then wheel_fl clipped"
    assert report.start == pytest.approx((clipped[-1] + 1) / 500)
    assert report.channels[4].faults == ("clipped",)
    [mark] = check.recorded[0].marks
    assert (mark.code, mark.channel) == ("clipped", 4)
    np.testing.assert_array_equal(mark.samples, clipped)


def test_spikes_are_marked_where_they_were(car: Campaign) -> None:
    values = car.recordings[0].values.copy()
    values[5, [900, 1200]] = 300.0
    check = sprung.check(spoilt(car, values))
    assert check.drops[0].channels[5].faults == ("spike",)
    [mark] = check.recorded[0].marks
    assert (mark.code, mark.channel, mark.samples.tolist()) == ("spike", 5, [900, 1200])
    assert check.drops[0].channels[5].peak == pytest.approx(sprung.check(car).drops[0].channels[5].peak)


def test_without_a_release(car: Campaign) -> None:
    report = sprung.check(spoilt(car, car.recordings[0].values[:, 230:])).drops[0]
    assert (report.release, report.landing, report.last_lift_off, report.wheels_seen) == (None, None, None, None)
    assert report.why_start == "no release was found, so the first sample"
    assert {channel.noise for channel in report.channels} == {None}
    assert not report.contradicted


def test_a_channel_left_out(car: Campaign) -> None:
    values = car.recordings[0].values.copy()
    values[0] = 9.81
    check = sprung.check(spoilt(car, values))
    [flat, *others] = check.drops[0].channels
    assert (flat.used, flat.faults, flat.noise, flat.peak) == (False, ("flat",), None, None)
    assert all(channel.used for channel in others)
    assert check.recorded[0].values[0, 0] == np.float32(9.81)  # what was read can still be drawn


def test_a_drop_left_out(car: Campaign) -> None:
    report = sprung.check(spoilt(car, car.recordings[0].values[:, :300])).drops[0]
    assert (report.start, report.end, report.faults) == (None, None, ("no-decay",))
    assert report.release == pytest.approx(REST, abs=0.0021)
    assert report.wheels_seen == report.wheels
    assert not any(channel.used for channel in report.channels)
    assert all(channel.noise is not None for channel in report.channels)


@pytest.mark.parametrize("samples", [-2, 0, 3])
def test_a_start_that_the_fit_moved_changes_no_other_moment(car: Campaign, seen: Check, samples: int) -> None:
    """`check` and a report say one number for one drop, whatever the fit makes of it."""
    prepared = prepare(car)
    moved = prepared._replace(decays=tuple(decay.shifted(samples) for decay in prepared.decays))
    for one, decay, before in zip(check_prepared(car, moved).drops, moved.decays, seen.drops, strict=True):
        assert one.end == pytest.approx(before.end)
        assert replace(one, end=before.end, fit_start=None, why_fit="") == before
        said = (decay.start, "in the fitted vehicle every tyre is down for good")
        assert (one.fit_start, one.why_fit) == (said if samples else (None, ""))


def test_a_drop_that_ends_with_its_window_says_so(car: Campaign) -> None:
    """One file of a day holds several drops; where a drop's window ends the recording goes on."""
    last = car.recordings[0].time[-1]
    for end, said in ((last, "its window ends"), (last + 1.0, "the recording ends")):
        assert sprung.check(changed(car, {"window": (0.0, float(end))})).drops[0].why_end == said


def test_the_document_is_json_and_has_what_the_contract_says(seen: Check) -> None:
    document = json.loads(json.dumps(seen.document(), allow_nan=False))
    assert document.keys() == {"drops", "faults", "missing"}
    for drop in document["drops"]:
        assert drop.keys() >= {"file", "load", "start", "end", "faults"}
    again = TypeAdapter(tuple[DropReport, ...]).validate_json(json.dumps(document["drops"]))
    assert again == seen.drops


def test_what_an_older_sprung_wrote_can_be_read() -> None:
    older = {"file": "a.csv", "load": "empty", "start": 0.4, "end": 3.0, "faults": ["clipped"]}
    report = TypeAdapter(DropReport).validate_python(older)
    assert {key: asdict(report)[key] for key in older} == {**older, "faults": ("clipped",)}
    assert (report.kind, report.wheels, report.release, report.channels) == ("", (), None, ())
    assert not report.contradicted

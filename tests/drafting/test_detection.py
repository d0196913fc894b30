"""Drops in long recordings: simulated days whose drops are known, and in which much else happens."""

from __future__ import annotations

import tracemalloc
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from days import DISTURBANCES, Day, Disturbance, day, disturbed
from sprung.drafting import DetectedDrop, Detection, detect_drops, wheel_score
from sprung.simulation import simulate
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, WHEELS, Sensor, Vehicle, Wheel
from strategies import make_vehicle

BOUNCE: tuple[Wheel, ...] = WHEELS
FRONT: tuple[Wheel, ...] = ("fl", "fr")
REAR: tuple[Wheel, ...] = ("rl", "rr")
LEFT: tuple[Wheel, ...] = ("fl", "rl")
RIGHT: tuple[Wheel, ...] = ("fr", "rr")
KINDS: tuple[tuple[Wheel, ...], ...] = (BOUNCE, FRONT, REAR, LEFT, RIGHT, ("fl",), ("fl", "rr"), ("fr", "rl", "rr"))


def some_vehicle(random: np.random.Generator) -> Vehicle:
    def pair(low: float, high: float) -> tuple[float, float]:
        one, other = random.uniform(low, high, 2)
        return float(one), float(other)

    return make_vehicle(
        mass=float(np.exp(random.uniform(np.log(400), np.log(16000)))),
        share=float(random.uniform(0.35, 0.65)),
        body=pair(0.8, 3.0),
        hop=pair(8, 22),
        damping=pair(0.08, 0.7),
        wheel=pair(0.015, 0.06),
        spread=pair(0.7, 1.3),
        tracks=pair(0.22, 0.32),
    )


def drops_in(
    values: NDArray[np.float64], rate: float, sensors: Sequence[Sensor] | None = None, start: float = 0.0
) -> tuple[DetectedDrop, ...]:
    """Detect the drops in a recording that is in memory."""
    places = None if sensors is None else [sensor.on for sensor in sensors]
    return detect_drops([(0, values)], rate, places, start=start).drops


def in_pieces(one: Day, length: int, known: bool) -> Detection:
    values = one.values
    pieces = ((first, values[:, first : first + length]) for first in range(0, values.shape[1], length))
    return detect_drops(pieces, one.rate, [sensor.on for sensor in one.sensors] if known else None)


@pytest.mark.parametrize("seed", range(12))
def test_all_drops_of_a_random_day_are_found_and_none_is_invented(seed: int) -> None:
    random = np.random.default_rng(seed)
    rate = float(random.choice([100, 200, 250, 500, 1000]))
    one = day(
        some_vehicle(random),
        (BOUNCE, *(KINDS[i] for i in random.permutation(len(KINDS))[:3])),
        random,
        rate=rate,
        noise=float(random.choice([0.005, 0.02, 0.1, 0.3])),
        heights=(0.02, 0.1),
        high_pass=float(random.uniform(0.1, 1.5)) if seed % 3 == 0 else None,
    )
    known = seed % 2 == 0
    found = in_pieces(one, int(random.integers(1000, 20000)), known)
    assert [drop.release for drop in found.drops] == pytest.approx(one.releases, abs=max(0.012, 2.5 / rate))
    for drop, wheels in zip(found.drops, one.wheels, strict=True):
        assert {one.sensors[channel].on for channel in drop.dropped_channels} == set(wheels)
        assert not known or drop.wheels == tuple(wheel for wheel in WHEELS if wheel in wheels)
        assert drop.begin < drop.release < drop.landing < drop.faded <= drop.end


@pytest.mark.parametrize("what", DISTURBANCES)
def test_nothing_else_is_taken_for_a_drop(what: Disturbance) -> None:
    random = np.random.default_rng(DISTURBANCES.index(what))
    is_on_wheel = np.repeat([False, True], 4)
    happened = [disturbed(what, random, 500.0, is_on_wheel, (4.0, 6.0)) for _ in range(12)]
    values = np.concatenate(happened, axis=1)
    found = detect_drops([(0, values + 9.8 + 0.02 * random.standard_normal(values.shape))], 500.0)
    assert not found.drops
    assert all(refusal.why for refusal in found.rejected)


def test_where_pieces_are_cut_does_not_matter() -> None:
    one = day(TABLE_1_CAR, (BOUNCE, FRONT, REAR), np.random.default_rng(3), rate=200.0)
    whole = detect_drops([(0, one.values)], one.rate)
    for length in (37, 999, 4096, 12345):
        cut = in_pieces(one, length, known=False)
        assert [drop.window for drop in cut.drops] == [drop.window for drop in whole.drops]
        assert [drop.release for drop in cut.drops] == [drop.release for drop in whole.drops]


def test_memory_does_not_grow_with_the_length() -> None:
    one = day(TABLE_1_CAR, (BOUNCE,), np.random.default_rng(4), rate=200.0)
    length = one.values.shape[1]
    peaks = []
    for days in (2, 20):
        tracemalloc.start()
        found = detect_drops(((i * length, one.values) for i in range(days)), one.rate)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert len(found.drops) == days
    assert peaks[1] < 1.3 * peaks[0]


@pytest.mark.parametrize(("vehicle", "height"), [(TABLE_1_CAR, 0.02), (SCHOOL_BUS, 0.05), (TABLE_1_CAR, 0.15)])
def test_wheels_and_kind_of_the_papers_drops(vehicle: Vehicle, height: float) -> None:
    drops = [{"wheels": wheels, "height": height} for wheels in (BOUNCE, FRONT, REAR, LEFT, RIGHT)]
    campaign = simulate(vehicle, drops=drops, seed=1)
    for drop, recording, kind in zip(
        campaign.drops,
        campaign.recordings,
        ("bounce", "pitch front", "pitch rear", "roll left", "roll right"),
        strict=True,
    ):
        (found,) = drops_in(recording.values, recording.rate, campaign.sensors)
        assert (found.wheels, found.kind) == (drop.wheels, kind)
        assert found.release == pytest.approx(0.4, abs=1.5 / recording.rate)
        (anonymous,) = drops_in(recording.values, recording.rate, start=100.0)
        assert {campaign.sensors[channel].on for channel in anonymous.dropped_channels} == set(drop.wheels)
        assert anonymous.kind == ("bounce" if kind == "bounce" else None)
        assert anonymous.release == pytest.approx(100.4, abs=1.5 / recording.rate)


def test_wheels_are_told_from_the_body_by_how_they_move() -> None:
    for vehicle in (TABLE_1_CAR, SCHOOL_BUS):
        campaign = simulate(vehicle, seed=2)
        found = [drops_in(recording.values, recording.rate)[0] for recording in campaign.recordings]
        # The boundary is 1; over 150 random vehicles the body stays below 0.33 and wheels above 2.
        score = wheel_score(found)
        assert score[:4].max() < 0.4
        assert score[4:].min() > 1.9


def test_a_drop_shows_without_sensors_on_wheels() -> None:
    one = day(TABLE_1_CAR, (BOUNCE, FRONT, LEFT), np.random.default_rng(5))
    body = [i for i, sensor in enumerate(one.sensors) if sensor.on == "body"]
    found = detect_drops([(0, one.values[body])], one.rate, ["body"] * 4)
    assert [drop.release for drop in found.drops] == pytest.approx(one.releases, abs=0.01)
    assert all(drop.dropped_channels == () and drop.wheels == () and drop.kind is None for drop in found.drops)


def test_the_use_ends_before_the_next_disturbance() -> None:
    campaign = simulate(TABLE_1_CAR, drops=[{"wheels": WHEELS}], duration=6.0, seed=6)
    values, rate = campaign.recordings[0].values.copy(), campaign.recordings[0].rate
    (whole,) = drops_in(values, rate)
    knock = int(2.4 * rate)
    values[:, knock : knock + 10] += 20 * np.random.default_rng(6).standard_normal((8, 10))
    (found,) = drops_in(values, rate)
    assert found.release == whole.release
    assert 2.25 < found.end < 2.4 < whole.end
    assert "disturbance" in found.why_end


def test_a_drop_that_follows_another_needs_no_more_than_a_short_rest() -> None:
    recordings = simulate(SCHOOL_BUS, drops=[{"wheels": WHEELS}] * 3, duration=4.0, seed=7, rest=0.4).recordings
    values = np.concatenate([recording.values for recording in recordings], axis=1)
    found = drops_in(values, 500.0)
    assert [drop.release for drop in found] == pytest.approx([0.4, 4.8, 9.2], abs=0.005)
    assert all(first.end <= second.release for first, second in pairwise(found))


def test_gaps_and_channels_without_samples_do_no_harm() -> None:
    one = day(TABLE_1_CAR, (BOUNCE, RIGHT), np.random.default_rng(8), rate=500.0)
    values = one.values.copy()
    values[0] = np.nan
    values[:, ::97] = np.nan
    found = detect_drops([(0, values)], one.rate)
    assert [drop.release for drop in found.drops] == pytest.approx(one.releases, abs=0.01)
    assert np.isnan(found.drops[0].features.level[0])


def test_why_names_channels_and_numbers() -> None:
    campaign = simulate(TABLE_1_CAR, drops=[{"wheels": FRONT}], seed=9)
    recording = campaign.recordings[0]
    (found,) = drops_in(recording.values, recording.rate, campaign.sensors)
    why = "; ".join(found.why(recording.channels))
    assert "wheel_fl, wheel_fr fall" in why
    assert f"usable until {found.end:.2f} s" in why
    assert "at rest for 0.4" in why


def test_progress_ends_at_one() -> None:
    one = day(TABLE_1_CAR, (BOUNCE,), np.random.default_rng(10), rate=200.0)
    told: list[float] = []
    pieces = ((first, one.values[:, first : first + 5000]) for first in range(0, one.values.shape[1], 5000))
    detect_drops(pieces, one.rate, samples=one.values.shape[1], progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0


def test_nothing_in_a_recording_of_nothing() -> None:
    assert drops_in(np.full((4, 5000), 9.81), 500.0) == ()
    assert detect_drops([], 500.0) == Detection(())

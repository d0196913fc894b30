"""Full scales that the file, the sensor or nobody tells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sprung.campaign import Recording
from sprung.preprocess import prepare
from sprung.preprocess.clipping import check_full_scale, detect_clipping
from sprung.simulation import simulate
from sprung.vehicle import TABLE_1_CAR

FULL = 5 * 9.80665  # m/s²
CLEAN = simulate(TABLE_1_CAR, noise=0.02, seed=1)
RANGED = tuple(replace(sensor, range=5.0) for sensor in CLEAN.sensors)


def at_full_scale() -> Recording:
    """Return a recording of which single samples are at full scale, which no plateau would show."""
    one = CLEAN.recordings[0]
    return replace(one, values=np.clip(one.values, -FULL, FULL))


def test_the_file_tells_the_unit_of_the_range() -> None:
    clipped = at_full_scale()
    told = check_full_scale(replace(clipped, full_scale=(FULL,) * 8), RANGED)
    assert told.faults == ()
    np.testing.assert_array_equal(detect_clipping(told), np.abs(clipped.values) == FULL)
    assert detect_clipping(told).any()


def test_without_a_file_the_sensor_does_and_otherwise_it_is_si() -> None:
    in_g = tuple(replace(sensor, unit="g") for sensor in RANGED)
    assert check_full_scale(at_full_scale(), in_g).full_scale == (FULL,) * 8
    assert check_full_scale(replace(CLEAN.recordings[0], values=np.zeros((8, 9))), RANGED).full_scale == (5.0,) * 8
    assert check_full_scale(CLEAN.recordings[0], CLEAN.sensors).full_scale == (None,) * 8


def test_a_logger_that_shows_less_than_the_sensor_clips_as_well() -> None:
    """A range of 50 g is stated; the logger's input ends at 3 g, for some samples in a row."""
    one = CLEAN.recordings[0]
    cut = replace(one, values=np.clip(one.values, -0.6 * FULL, 0.6 * FULL), full_scale=(10 * FULL,) * 8)
    assert detect_clipping(cut).any()
    assert (np.abs(cut.values)[detect_clipping(cut)] == 0.6 * FULL).all()
    assert not detect_clipping(replace(one, full_scale=(10 * FULL,) * 8)).any()


def test_a_range_that_is_exceeded_is_none() -> None:
    """5 g, taken for 5 m/s², would be exceeded by gravity already: nothing may be called clipped for it."""
    prepared = prepare(replace(CLEAN, sensors=RANGED))
    faults = prepared.decays[0].faults
    assert [fault.code for fault in faults] == ["unit"] * 8
    assert "beyond the range of 5 m/s²; the range was not used" in faults[0].what
    assert prepared.decays[0].usable.all()


def test_a_range_changes_with_its_unit() -> None:
    """Numbers in g that nobody says are: range and readings are put right together."""
    clipped = at_full_scale()
    in_g = [replace(one, values=np.clip(one.values, -FULL, FULL) / 9.80665) for one in CLEAN.recordings]
    codes = {
        f.code for decay in prepare(replace(CLEAN.with_recordings(in_g), sensors=RANGED)).decays for f in decay.faults
    }
    assert codes == {"unit", "clipped"}
    assert (np.abs(clipped.values) == FULL).any()


def test_a_flat_turn_of_a_coarse_sensor_is_not_clipped_and_a_cut_one_is() -> None:
    """Twelve bits over ten g either way: a valley of which three samples fall on one step, as it turns, and a cut one."""
    step = 20 * 9.80665 / 2**12
    turn = np.array([4.12, 3.69, 3.26, 2.87, 2.49, 2.15, 1.87, 1.87, 1.87, 2.06, 2.3, 2.68, 3.16, 3.78, 4.4])
    level = 9.8 + step * (np.arange(40) % 2)
    one = np.concatenate([level, turn, level])
    cut = np.concatenate([level, np.maximum(9.8 - 6 * np.hanning(15), 5.0), level])
    values = step * np.round(np.array([one, cut]) / step)
    recording = replace(CLEAN.recordings[0], channels=("turn", "cut"), values=values)
    assert detect_clipping(recording).any(axis=1).tolist() == [False, True]

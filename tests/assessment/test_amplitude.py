"""Modes against amplitude: flat for what is linear, rising for what rubs, and sure of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hysteresis import measured
from numpy.typing import NDArray

import sprung
from sprung.assessment import AmplitudeCurve, BodyMotion, follow_modes
from sprung.assessment.mode_tracking import follow_mode
from sprung.estimation import FitStatistics
from sprung.vehicle import (
    SCHOOL_BUS,
    TABLE_1_CAR,
    NonlinearModel,
    free_decay,
    linear_elements,
    nonlinear_elements,
    sensor_rows,
)
from sprung.vibration import compute_modes

DATA = Path(__file__).resolve().parents[1] / "data"
Real = NDArray[np.float64]
RATE = 250.0
MODES = [mode for mode in compute_modes(TABLE_1_CAR.matrices()) if mode.pole.imag > 0]
BODY = [i for i, mode in enumerate(MODES) if (mode.name or "").startswith("body")]


def body_of(state: Real, seconds: float = 3.0) -> Real:
    return free_decay(TABLE_1_CAR.matrices(), state, 1 / RATE, int(seconds * RATE)).acceleration[:3]


@pytest.mark.parametrize("which", BODY)
def test_a_linear_vehicle_has_one_frequency_and_one_damping_ratio(which: int) -> None:
    """Also where every mode moves at once: the truth is the eigenvalue."""
    state = np.zeros(14)
    for mode in MODES:
        state += 0.01 * np.concatenate([mode.shape, mode.pole * mode.shape]).real
    trace = follow_mode("all", body_of(state), RATE, np.full(3, 1e-4), MODES, which, 1.0)
    assert len(trace.time) >= 5
    np.testing.assert_allclose(trace.frequency, MODES[which].frequency, rtol=2e-4)
    np.testing.assert_allclose(trace.damping_ratio, MODES[which].damping_ratio, atol=2e-4)
    # Its envelope is that of the mode, 0.01 at the start.
    envelope = 0.01 * np.exp(MODES[which].pole.real * trace.time)
    np.testing.assert_allclose(trace.amplitude, envelope, rtol=5e-3)


def test_it_is_as_sure_as_it_says() -> None:
    which = BODY[0]
    mode = MODES[which]
    clean = body_of(0.01 * np.concatenate([mode.shape, mode.pole * mode.shape]).real)
    misses = []
    for seed in range(12):
        noise = 0.01 * np.random.default_rng(seed).standard_normal(clean.shape)
        trace = follow_mode("", clean + noise, RATE, np.full(3, 0.01), MODES, which, 1.0)
        misses += ((trace.frequency - mode.frequency) / trace.frequency_std).tolist()
        misses += ((trace.damping_ratio - mode.damping_ratio) / trace.damping_ratio_std).tolist()
    assert len(misses) > 60
    # Neighbouring windows share most of their samples: a few dozen independent misses of standard deviation one.
    assert 0.7 < np.std(misses) < 1.35


def fall(trace: AmplitudeCurve) -> float:
    """Frequency at the smallest amplitude over that at the largest."""
    return float(trace.frequency[trace.amplitude.argmin()] / trace.frequency[trace.amplitude.argmax()])


@pytest.mark.slow
def test_of_a_linear_car_everything_is_flat() -> None:
    found = sprung.validate(sprung.read(DATA / "sedan"), extras=())
    assert [one.mode for one in found.amplitudes] == ["body bounce", "body pitch", "body roll"]
    for one in found.amplitudes:
        np.testing.assert_allclose(one.model.frequency, one.frequency, rtol=1e-3)
        for trace in one.records:
            away = np.abs(trace.frequency - one.frequency)
            assert (away < 0.01 * one.frequency + 4 * trace.frequency_std).all()
            assert trace.amplitude.max() > 5 * trace.amplitude.min()


DROPS = [{"wheels": wheels, "load": "empty", "height": 0.06} for wheels in (["fl", "fr", "rl", "rr"], ["fl", "rl"])]


def motions_of(bus: sprung.Vehicle) -> list[BodyMotion]:
    """Drops by equations and a solver that are not the package's own, from a quarter of a second after the release."""
    made = measured(bus, seed=1, noise=0.0, rate=250.0, drops=DROPS)
    rows = sensor_rows(made.sensors, ("a",)).at([bus.a])[:4, :3]
    motions = []
    for recording in made.recordings:
        values = np.linalg.pinv(rows) @ (recording.values[:4] - recording.values[:4].mean(axis=1, keepdims=True))
        begin = int(0.65 * 250)
        time = np.arange(values.shape[1] - begin) / 250.0
        motions.append(BodyMotion(recording.name, time, values[:, begin:], values[:, begin:], np.full(3, 0.01)))
    return motions


def sensors_of_the_bus() -> tuple[sprung.Sensor, ...]:
    sensors = sprung.simulate(SCHOOL_BUS, drops=DROPS[:1], noise=0.0).sensors
    return tuple(replace(sensor, gain_std=0.01) for sensor in sensors)


def fit_of(bus: sprung.Vehicle) -> FitStatistics:
    """A fit that found the truth, also of the sensors, whose unknowns come behind the vehicle's."""
    sensors = [name for sensor in sensors_of_the_bus() for name in sensor.uncertainties]
    names, nothing = (*bus.parameters, *sensors), np.zeros(0)
    values = np.array([*bus.parameters.values(), *np.zeros(len(sensors))])
    square = np.zeros((len(names), len(names)))
    known: dict[str, float] = {}
    return FitStatistics(
        names, values, values, square, square, nothing, nothing, nothing, 1.0, (), known, 0.0, 0, True, 1, 1
    )


def of_friction(bus: sprung.Vehicle) -> NonlinearModel:
    names, extras = tuple(bus.parameters), ("friction",)
    elements = linear_elements(bus.tracks, extras)
    return NonlinearModel.of(elements, nonlinear_elements(bus.tracks, extras), names)


@pytest.mark.long
def test_dry_friction_lets_frequencies_rise_as_the_motion_dies() -> None:
    """From those of springs and tyres to those of the body on its tyres, the springs held: figures 7 to 9."""
    bus = SCHOOL_BUS.with_values(F_f=1000.0, F_r=1500.0, s_f=2e6, s_r=3e6)
    held = compute_modes(SCHOOL_BUS.with_values(k_sf=SCHOOL_BUS.k_sf + 2e6, k_sr=SCHOOL_BUS.k_sr + 3e6).matrices())
    highest = {mode.name: mode.frequency for mode in held if mode.pole.imag > 0}
    found = follow_modes(fit_of(bus), of_friction(bus), sensors_of_the_bus(), motions_of(bus))
    bounce, roll = (next(one for one in found if one.mode == f"body {way}") for way in ("bounce", "roll"))
    for one, least in ((bounce, 1.5), (roll, 1.2)):
        assert fall(one.model) > least
        assert fall(one.records[0]) > least
        smallest = one.records[0].frequency[np.argsort(one.records[0].amplitude)[:5]]
        assert smallest.mean() == pytest.approx(highest[one.mode], rel=0.03)

"""Frequency and damping ratio of the body's modes against amplitude: from the records alone, and from the fitted vehicle.

A linear vehicle has one frequency and one damping ratio whatever the amplitude; with dry friction the frequency rises as the
motion dies, which is what the paper saw in figures 7 to 9.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.assessment.body_motion import BodyMotion, body_rows
from sprung.assessment.mode_tracking import AmplitudeCurve, follow_mode
from sprung.display import shown
from sprung.estimation import FitStatistics
from sprung.progress import Progress, counted, silent
from sprung.vehicle import (
    EMPTY,
    LinearModel,
    NonlinearModel,
    Sensor,
    Stepper,
    coordinates,
    free_decay,
    with_tyre_rates_at_rest,
)
from sprung.vibration import Mode, compute_modes

Real = NDArray[np.float64]

_STEP = 0.0025
"""s from one sample of the simulated decay to the next."""

_DROPS = 2
"""Drops of which a mode is followed, at the most: those in which it is the largest part of the motion."""

_LARGE_PART = 0.5
"""Part of the body's motion that a mode must be in all of them but the first."""

_WAVES = 8.0
"""Periods of a simulated decay."""

_TRIES, _LARGER, _REACHED = 6, 1.4, 0.9
"""Simulated decays at the most, factor between their amplitudes, and part of the measured amplitude to be reached."""


@shown
@dataclass(frozen=True, eq=False)
class ModeAmplitude:
    """One mode of the body against amplitude.

    Attributes
    ----------
    mode
        Its name.
    frequency, damping_ratio
        Of the fitted vehicle without its nonlinear forces, Hz and dimensionless.
    records
        From the records alone, one for each drop that shows it.
    simulated
        From the simulation of these drops: with dry friction a mode depends on the other motions.
    model
        From a free decay of the fitted vehicle in this mode alone, from the amplitude of the records.
    load
        On the vehicle in those drops.
    """

    mode: str
    frequency: float
    damping_ratio: float
    records: tuple[AmplitudeCurve, ...]
    simulated: tuple[AmplitudeCurve, ...]
    model: AmplitudeCurve
    load: str = EMPTY.name


def follow_modes(
    fit: FitStatistics,
    model: LinearModel | NonlinearModel,
    sensors: Sequence[Sensor],
    motions: Sequence[BodyMotion],
    progress: Progress = silent,
) -> tuple[ModeAmplitude, ...]:
    """Follow the modes of the body through the decays of one load.

    Parameters
    ----------
    fit
        The fit.
    model
        The fitted vehicle's equations of motion with this load, over the fit's parameters.
    sensors
        The sensors.
    motions
        Of the drops with this load.
    progress
        Called with each mode that is begun.

    Returns
    -------
    tuple of ModeAmplitude
        The underdamped modes of the body that the sensors determine, lowest first.
    """
    linear = model.linear if isinstance(model, NonlinearModel) else model
    estimates = dict(zip(fit.names, fit.values.tolist(), strict=True))
    values = np.array([estimates[name] for name in linear.names])  # without the unknowns of the sensors
    matrices = linear.matrices(with_tyre_rates_at_rest(linear, values))
    modes = [mode for mode in compute_modes(matrices, coordinates(linear.names)) if mode.pole.imag != 0]
    rows = body_rows(fit, sensors)
    determined = [motion for motion in motions if np.isfinite(motion.measured).all()]
    found = []
    of_body = [
        i for i, mode in enumerate(modes) if mode.name is not None and mode.name.startswith("body ") and determined
    ]
    for which in counted(progress, "following the modes of the body through the decays", of_body):
        mode = modes[which]
        shares = [_share(motion, modes, which, rows) for motion in determined]
        best = sorted(range(len(determined)), key=lambda i: -shares[i])[:_DROPS]
        noise = determined[best[0]].noise
        largest = float(np.abs(rows @ mode.shape[:3]).max())
        traces, simulations = [], []
        for motion in (determined[i] for i in best if i == best[0] or shares[i] > _LARGE_PART):
            rate = (len(motion.time) - 1) / float(motion.time[-1] - motion.time[0])
            traces.append(follow_mode(motion.name, motion.measured, rate, motion.noise, modes, which, largest))
            least = float(traces[-1].amplitude.min(initial=np.inf))
            simulations.append(
                follow_mode(motion.name, motion.simulated, rate, motion.noise, modes, which, largest, least)
            )
        seen = np.concatenate([trace.amplitude for trace in traces])
        if seen.size:
            begin = float(seen.max()) / largest
            for _ in range(_TRIES):
                decay = _decay(model, values, mode, begin)
                simulated = follow_mode("", decay, 1 / _STEP, noise, modes, which, largest, float(seen.min()))
                # Friction takes most of a large motion within its first period, before the middle of the first window.
                if simulated.amplitude.max(initial=0.0) > _REACHED * seen.max():
                    break
                begin *= _LARGER
            of_drops = tuple(traces), tuple(simulations)
            found.append(ModeAmplitude(str(mode.name), mode.frequency, mode.damping_ratio, *of_drops, simulated))
    return tuple(found)


def _share(motion: BodyMotion, modes: Sequence[Mode], which: int, rows: Real) -> float:
    """Return the part of the motion of the body's sensors that is in one mode of the body."""
    body = [i for i, mode in enumerate(modes) if mode.name is not None and mode.name.startswith("body ")]
    shapes = np.column_stack([(modes[i].shape[:3] * modes[i].pole ** 2).real for i in body])
    parts = np.linalg.pinv(shapes) @ motion.measured
    energies = np.sum((rows @ shapes) ** 2, axis=0) * np.sum(parts**2, axis=1)
    return float(energies[body.index(which)] / energies.sum())


def _decay(model: LinearModel | NonlinearModel, values: Real, mode: Mode, amplitude: float) -> Real:
    """Simulate free vibration from the shape of a mode: accelerations of the body, shape (3, time)."""
    samples = int(_WAVES / mode.frequency / _STEP)
    linear = model if isinstance(model, LinearModel) else model.linear
    begin = amplitude * np.concatenate([mode.shape, mode.pole * mode.shape[: linear.massive]]).real
    if isinstance(model, LinearModel):
        return free_decay(model.matrices(values), begin, _STEP, samples).acceleration[:3]
    stepper = Stepper.of([model], [_STEP], np.zeros(1, dtype=np.int64), values)
    path = stepper.integrate(begin[None], np.zeros((1, model.forces.memories)), samples - 1)
    inputs = np.concatenate([path.states[:, 0], path.forces[:, 0], np.ones((samples, 1))], axis=1)
    accelerations: Real = (inputs @ model.accelerations(values)[0].T).T[:3]
    return accelerations

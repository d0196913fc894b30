"""Modes of the identified vehicle, with the uncertainty that follows from that of its parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.estimation.modal_solution import differentiate_modes, solve_modes
from sprung.estimation.statistics import FitStatistics
from sprung.vehicle import (
    LinearModel,
    Readout,
    coordinates,
    differentiate_tyre_rates_at_rest,
    layout_of,
    with_tyre_rates_at_rest,
)
from sprung.vibration import Mode, is_vibration, largest_entry, name_modes, paper_name

Real = NDArray[np.float64]


UNNAMED = "unnamed"
"""What a mode is called whose shape is like no template."""

_DETERMINED = 0.5
"""Relative standard uncertainty from which a value counts as not determined."""


@shown
@dataclass(frozen=True)
class ModeEstimate:
    """One mode of the identified vehicle.

    Attributes
    ----------
    name
        After what moves: one of `sprung.modal.MODE_NAMES`, or ``unnamed`` where the shape is like none of them.
    pole
        [re, im], 1/s; im is 0 for a real pole, not negative for others.
    frequency, frequency_std
        Undamped natural frequency |pole|/2π and its standard uncertainty, Hz; the latter None where the data do not
        determine the mode.
    damped_frequency
        Hz.
    damping_ratio, damping_ratio_std
        -re/|pole|, dimensionless; 1 for a real pole.
    motion
        How the body's rigid motions, the wheels A to D and an engine on its mounts, where the vehicle has one, move: real and
        imaginary part of each, the largest 1; empty in results of older versions, or where the mode is from the records alone.
    paper_name
        What Table 3 of the paper calls it; None where it has no such mode, or an older sprung wrote the result.
    """

    name: str
    pole: tuple[float, float]
    frequency: float
    frequency_std: float | None
    damped_frequency: float
    damping_ratio: float
    damping_ratio_std: float | None
    motion: tuple[tuple[float, float], ...] = ()
    paper_name: str | None = None


def mode_estimates(fit: FitStatistics, model: LinearModel) -> tuple[ModeEstimate, ...]:
    """Return the modes of one load with their uncertainties, lowest frequency first.

    Parameters
    ----------
    fit
        The fit.
    model
        Equations of motion with the load.

    Returns
    -------
    tuple of ModeEstimate
    """
    no_sensors = Readout.of((), fit.names)
    values, by_parameter = (
        with_tyre_rates_at_rest(model, fit.values),
        differentiate_tyre_rates_at_rest(model, fit.values),
    )
    modes = solve_modes(model, no_sensors, values)
    slopes = by_parameter.T @ differentiate_modes(model, no_sensors, values, modes, 1.0)[0] * fit.slopes[:, None]
    # Along a direction that nothing determines a first-order uncertainty may say too little: the poles are followed there.
    away = [
        np.linalg.eigvals(model.matrices(with_tyre_rates_at_rest(model, fit.moved(way * direction))).state).astype(
            np.complex128
        )
        for direction in fit.undetermined.T
        for way in (-1, 1)
    ]
    vibrations = is_vibration(modes.poles, modes.displacements, model.matrices(values).M)
    upper = np.flatnonzero((modes.poles.imag >= 0) & vibrations)
    found = [Mode(complex(modes.poles[j]), modes.displacements[:, j]) for j in upper]
    names = coordinates(fit.names)
    named = name_modes(found, coordinates=names)
    drawn = [i for i, name in enumerate(names) if name in (*layout_of(fit.names).coordinates, "z_e")]
    left = set(upper.tolist())
    estimates = []
    for mode in named:
        nearest = min(left, key=lambda j: abs(modes.poles[j] - mode.pole))
        left.remove(nearest)
        estimates.append(_estimate(mode, slopes[:, nearest], away, fit, drawn))
    return tuple(estimates)


def _estimate(
    mode: Mode, slope: NDArray[np.complex128], away: list[NDArray[np.complex128]], fit: FitStatistics, drawn: list[int]
) -> ModeEstimate:
    pole, size = mode.pole, abs(mode.pole)
    of_size = (np.conj(pole) * slope).real / size
    of_damping = np.zeros_like(of_size) if pole.imag == 0 else -slope.real / size + pole.real * of_size / size**2
    followed = np.array([poles[np.argmin(np.abs(poles - pole))] for poles in away], dtype=complex)

    def std(direction: Real, value: float, values: Real) -> float | None:
        near = fit.spread(direction, value)
        far = float(np.abs(values - value).max(initial=0.0))
        return None if near is None or max(near, far) > _DETERMINED * abs(value) else max(near, far)

    return ModeEstimate(
        name=mode.name or UNNAMED,
        pole=(float(pole.real), float(pole.imag)),
        frequency=mode.frequency,
        frequency_std=std(of_size / (2 * np.pi), mode.frequency, np.abs(followed) / (2 * np.pi)),
        damped_frequency=mode.damped_frequency,
        damping_ratio=mode.damping_ratio,
        damping_ratio_std=std(of_damping, mode.damping_ratio, -followed.real / np.maximum(np.abs(followed), 1e-300)),
        motion=_largest_one(mode.shape[drawn]),
        paper_name=paper_name(mode.name),
    )


def _largest_one(shape: NDArray[np.complex128]) -> tuple[tuple[float, float], ...]:
    """Turn and scale a shape so that its largest entry is 1; real and imaginary part of each."""
    scaled = shape / shape[largest_entry(shape)]
    return tuple((float(part.real), float(part.imag)) for part in scaled)

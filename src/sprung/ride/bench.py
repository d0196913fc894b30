"""Suspension testers: a plate under one wheel oscillates, the others stand still.

EUSAMA: the plate moves by 6 mm from end to end, from 25 Hz down through the resonance of the wheel. The minimum of the force
on it over the static load is the adhesion.

EGEA SPECSUS2018, after Tsymberov (SAE 960735): the phase shift is the angle from the highest place of the plate to the middle
between the instants at which the force falls and rises through its static value, where it is smallest. It is 180° where the
force follows the plate, as at high frequencies; between the resonances of body and wheel it is small where little damping is.
Its minimum from 18 down to 6 Hz is the result; below 35° the damper fails.

Both are computed in the steady state, as the frequency falls slowly.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from sprung.ride.ride_model import RideModel
from sprung.ride.road_response import NotConvergedError
from sprung.vehicle import Wheel, linearise_harmonic

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

AMPLITUDE = 0.003
"""Of the plate, m."""

BAND = (1.0, 25.0)
"""Frequencies of the plate, Hz; below, the force hardly changes."""

PHASE_BAND = (6.0, 18.0)
"""Frequencies at which the minimum phase shift is searched for, Hz."""

PHASE_LIMIT = float(np.deg2rad(35.0))
"""Least phase shift of a damper that passes, rad."""

_STEP = 0.25
"""Hz, of the search."""

_NEAR = 0.1
"""Hz, to the frequencies beside the resonance from which its changes with the parameters are interpolated."""

_ITERATIONS = 400
_CLOSED = 1e-11
"""Largest number of steps to the amplitudes of the travels, and their change, m, at which they are found."""


class PlateResponse(NamedTuple):
    """The force of one wheel on its oscillating plate.

    Attributes
    ----------
    force
        Over the displacement of the plate, N/m, shape (line,).
    mean, amplitude
        Of the travels of the nonlinear elements, m, shape (line, row).
    """

    force: Complex
    mean: Real
    amplitude: Complex


class PlateTest(NamedTuple):
    """What a suspension tester finds of one wheel.

    Attributes
    ----------
    least_load
        Smallest force on the plate over the static load: 1 where nothing moves; negative where a wheel that could pull would.
    resonance
        Frequency of the largest force, Hz.
    phase
        Smallest phase shift, rad; None of a wheel with its resonance below 6 Hz, on which it says nothing.
    phase_frequency
        Where it is so, Hz.
    around, lowest
        The response near the resonance, and at the smallest phase shift.
    """

    least_load: float
    resonance: float
    phase: float | None
    phase_frequency: float | None
    around: PlateResponse
    lowest: PlateResponse | None = None


@dataclass(frozen=True, eq=False)
class Plate:
    """A plate that oscillates under one wheel.

    Attributes
    ----------
    model
        The vehicle on it.
    wheel
        Which wheel.
    amplitude
        m.
    """

    model: RideModel
    wheel: Wheel
    amplitude: float = AMPLITUDE

    def respond(self, values: Real, frequency: Real, near: PlateResponse | None = None) -> PlateResponse:
        """Return the force on the plate at frequencies in Hz, shape (line,).

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).
        frequency
            Hz, shape (line,).
        near
            Nearly the response.

        Raises
        ------
        NotConvergedError
            If the amplitudes of the nonlinear elements were not found.
        """
        omega, model = 2 * np.pi * frequency, self.model
        at = model.wheels.index(self.wheel)
        if model.nonlinear is None:
            force = model.tyre_forces(values, omega, model.displacements(values, omega))[:, at, at]
            nothing = np.zeros((len(omega), 0))
            return PlateResponse(force, nothing, nothing.astype(np.complex128))
        nonlinear, matrices = model.nonlinear, model.matrices(values)
        rows, directions = nonlinear.forces.rows.at(values), nonlinear.forces.directions(values)
        weight = nonlinear.load.matrices(values).M @ nonlinear.linear.heave * nonlinear.gravity
        offsets = nonlinear.travel_offsets(values)[0]
        if near is None:
            mean = np.tile(offsets - rows @ matrices.deflection(weight), (len(omega), 1))
            amplitude = np.full((len(omega), len(rows)), 0.5 * self.amplitude, dtype=np.complex128)
        else:
            mean, amplitude = near.mean, near.amplitude
        damping = 1.0
        before = np.inf
        for _ in range(_ITERATIONS):
            mean_force, stiffness = linearise_harmonic(nonlinear.forces, values, mean, np.abs(amplitude), omega)
            displacements = model.displacements(values, omega, stiffness)
            new = self.amplitude * (rows @ displacements)[:, :, at]
            rest = matrices.deflection((weight + mean_force @ directions).T)
            new_mean = offsets - (rows @ rest).T
            change = float(max(np.abs(new - amplitude).max(), np.abs(new_mean - mean).max()))
            if change < _CLOSED:
                return PlateResponse(model.tyre_forces(values, omega, displacements)[:, at, at], mean, amplitude)
            if change > 0.9 * before:
                damping = max(0.7 * damping, 0.1)
            before = change
            amplitude = amplitude + damping * (new - amplitude)
            mean = mean + damping * (new_mean - mean)
        raise NotConvergedError(f"no steady motion on a plate under wheel {self.wheel} was found")

    def test(self, values: Real, near: PlateTest | None = None) -> PlateTest:
        """Return what a tester finds.

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).
        near
            What it finds at neighbouring parameters: the frequencies are then not searched for.

        Raises
        ------
        NotConvergedError
            If the amplitudes of the nonlinear elements were not found.
        """
        static = float(self.model.static_loads(values)[self.model.wheels.index(self.wheel)])
        if near is None:
            grid = np.arange(BAND[0], BAND[1] + _STEP / 2, _STEP)
            force = self.respond(values, grid).force
            resonance = self._refined(grid, -np.abs(force), lambda at: -np.abs(self.respond(values, at).force))
            around = None
        else:
            resonance, around = near.resonance, near.around
        at = np.clip(resonance, BAND[0] + _NEAR, BAND[1] - _NEAR) + _NEAR * np.array([-1.0, 0.0, 1.0])
        around = self.respond(values, at, around)
        size = np.abs(around.force)
        first, second = (size[2] - size[0]) / 2, size[2] - 2 * size[1] + size[0]
        step = float(np.clip(-first / second, -1, 1)) if second < 0 else float(np.sign(first))
        top = float(size[1] + first * step + second * step**2 / 2)
        share, resonance = 1 - self.amplitude * top / static, float(at[1] + step * _NEAR)
        if near is not None:
            frequency = near.phase_frequency
        elif resonance < PHASE_BAND[0]:
            frequency = None
        else:
            inside = (grid >= PHASE_BAND[0] - _STEP / 2) & (grid <= PHASE_BAND[1] + _STEP / 2)
            shifts = phase_shift(force[inside])
            frequency = self._refined(grid[inside], shifts, lambda at: phase_shift(self.respond(values, at).force))
        if frequency is None:
            return PlateTest(share, resonance, None, None, around)
        # At a minimum, or at the end of the band, its place does not matter to first order.
        lowest = self.respond(values, np.array([frequency]), None if near is None else near.lowest)
        return PlateTest(share, resonance, float(phase_shift(lowest.force)[0]), frequency, around, lowest)

    def _refined(self, grid: Real, sizes: Real, function: Callable[[Real], Real]) -> float:
        """Return the frequency of the minimum of a function, from its values on a grid."""
        best = int(np.argmin(sizes))
        low, high = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
        found = minimize_scalar(
            lambda one: float(function(np.array([one]))[0]),
            bounds=(low, high),
            method="bounded",
            options={"xatol": 1e-4},
        )
        return float(found.x) if found.fun < sizes[best] else float(grid[best])


def phase_shift(force: Complex) -> Real:
    """Return the phase shift of EGEA, from the highest place of the plate to the smallest force.

    Parameters
    ----------
    force
        Over the displacement of the plate, N/m, any shape.

    Returns
    -------
    ndarray
        rad, 0 to π, of the shape of the force.
    """
    return np.asarray(np.pi - np.abs(np.angle(force)))

"""Equivalent linear elements: what nonlinear springs, dampers and dry friction are at the amplitudes of a motion.

For a random motion by statistical linearisation: the linear element whose force differs least from the true one in the mean
square, for Gaussian travel and rate (Booton 1954; Roberts and Spanos, Random Vibration and Statistical Linearization, 1990).
Its rate is E[f x]/σ², its damping E[f v]/σ². Dry friction with presliding, F m with l m' = v - |v| m, becomes l m' = α v - β m
with β = E|v| = √(2/π) σ_v and α = 1 - √(2/π) E[v m]/σ_v (Wen, J. Appl. Mech. 47 (1980) 150): a spring and a damper in series.

For a sinusoidal motion by harmonic linearisation: the first harmonic of the force over that of the travel (describing
function). The memory of friction has closed over a period: between the turning points at ±a it is 1 - (1 + tanh(a/l)) exp(-(x
+ a)/l).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ElementInput, ForceLaw
from sprung.vehicle.nonlinear_forces import NonlinearForces

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_MEAN_ABSOLUTE = np.sqrt(2 / np.pi)
"""Mean absolute value of a Gaussian variable over its standard deviation."""

_SHORTEST = 1e-7
"""m: least travel over which friction builds up, that of the force law."""

_NODES = np.linspace(-6.0, 6.0, 481)
_WEIGHTS = np.exp(-0.5 * _NODES**2) / np.exp(-0.5 * _NODES**2).sum()
"""Quadrature over a Gaussian variable: the trapezoidal rule, which converges as fast as the integrand is smooth."""

_PHASES = 2 * np.pi * (np.arange(256) + 0.5) / 256
"""Phases of a sinusoidal motion over one period."""


@dataclass(frozen=True, eq=False)
class RandomTravel:
    """Statistics of the travels of nonlinear elements, Gaussian.

    Attributes
    ----------
    mean, std, rate_std
        Of each row, m, m and m/s, shape (row,).
    memory
        Correlation of each memory with the rate of its travel, E[v m]/σ_v, dimensionless, shape (memory,).
    """

    mean: Real
    std: Real
    rate_std: Real
    memory: Real


@dataclass(frozen=True, eq=False)
class EquivalentElements:
    """Linear elements that replace nonlinear ones.

    Attributes
    ----------
    mean
        Mean force of each row, N, shape (row,).
    stiffness, damping
        Of each row, N/m and N s/m, shape (row,).
    sliding
        Force that each memory multiplies, N, shape (memory,).
    memory_gain, cutoff
        Of each memory m: m' = gain v - cutoff m with the rate v of its travel, 1/m and 1/s, shape (memory,). Force and memory
        together are a spring of the rate sliding × gain in series with a damper.
    memory_rows
        Row of each memory, shape (memory,).
    """

    mean: Real
    stiffness: Real
    damping: Real
    sliding: Real
    memory_gain: Real
    cutoff: Real
    memory_rows: NDArray[np.int64]

    def dynamic_stiffness(self, omega: Real) -> Complex:
        """Return the force of each row over its travel.

        Parameters
        ----------
        omega
            Angular frequencies, rad/s, shape (line,).

        Returns
        -------
        ndarray
            N/m, shape (line, row).
        """
        iw = 1j * omega[:, None]
        found = self.stiffness + iw * self.damping
        of_memories = self.sliding * self.memory_gain * iw / (iw + self.cutoff)
        for memory, row in enumerate(self.memory_rows.tolist()):
            found[:, row] += of_memories[:, memory]
        return np.asarray(found)

    def memory_correlation(self, omega: Real, rate_spectra: Real) -> Real:
        """Return E[v m] of each memory, m/s, shape (memory,).

        Parameters
        ----------
        omega
            rad/s, shape (line,).
        rate_spectra
            What each line adds to the mean square of the rate of each row, m²/s², shape (line, row).
        """
        ratio = self.cutoff / (self.cutoff**2 + omega[:, None] ** 2)
        return np.asarray(self.memory_gain * (ratio * rate_spectra[:, self.memory_rows]).sum(axis=0))


def _elements(forces: NonlinearForces, values: Real) -> Iterator[tuple[ForceLaw, NDArray[np.int64], slice, Real]]:
    """Yield each law with the rows of its elements, their memories and its parameters."""
    for law, at, own, positions in forces.laws:
        yield law, np.arange(forces.number)[at], own, values[positions]


def _friction(law: ForceLaw, parameters: Real) -> tuple[Real, Real]:
    """Return the sliding force of friction, N, and the travel over which it builds up, m."""
    force, stiffness = parameters[-2:]
    length = np.maximum(np.abs(force) / stiffness, _SHORTEST)
    still = np.zeros_like(force)
    return law.evaluate(parameters, ElementInput(still, still, still, still + 1)).force, length


def linearise_random(forces: NonlinearForces, values: Real, travel: RandomTravel) -> EquivalentElements:
    """Return the linear elements that replace nonlinear ones in a random motion.

    Parameters
    ----------
    forces
        The nonlinear elements.
    values
        Parameters, SI, shape (parameter,).
    travel
        Statistics of their travels.

    Returns
    -------
    EquivalentElements
    """
    mean, stiffness, damping = np.zeros((3, forces.number))
    sliding, gain, cutoff = np.zeros((3, forces.memories))
    for law, rows, own, parameters in _elements(forces, values):
        if law.has_memory:
            sliding[own], length = _friction(law, parameters)
            gain[own] = np.maximum(1 - _MEAN_ABSOLUTE * travel.memory[own], 0.0) / length
            cutoff[own] = _MEAN_ABSOLUTE * travel.rate_std[rows] / length
            continue
        still = np.zeros((1, len(rows)))
        offset = _NODES[:, None] * travel.std[rows]
        of_travel = law.evaluate(parameters, _input(travel.mean[rows] + offset, 0 * offset)).force
        rate = _NODES[:, None] * travel.rate_std[rows]
        of_rate = law.evaluate(parameters, _input(0 * rate + travel.mean[rows], rate)).force
        at_mean = law.evaluate(parameters, _input(still + travel.mean[rows], still)).force[0]
        np.add.at(mean, rows, _WEIGHTS @ of_travel + _WEIGHTS @ of_rate - at_mean)
        np.add.at(stiffness, rows, (_WEIGHTS * _NODES) @ of_travel / travel.std[rows])
        np.add.at(damping, rows, (_WEIGHTS * _NODES) @ of_rate / travel.rate_std[rows])
    return EquivalentElements(mean, stiffness, damping, sliding, gain, cutoff, forces.memory_rows)


def _input(travel: Real, rate: Real) -> ElementInput:
    zero = np.zeros_like(travel)
    return ElementInput(travel, rate, zero, zero)


def linearise_harmonic(
    forces: NonlinearForces, values: Real, mean: Real, amplitude: Real, omega: Real
) -> tuple[Real, Complex]:
    """Return mean forces and dynamic stiffnesses of nonlinear elements in a sinusoidal motion.

    Parameters
    ----------
    forces
        The nonlinear elements.
    values
        Parameters, SI, shape (parameter,).
    mean, amplitude
        Of the travel of each row, m, shape (line, row).
    omega
        Angular frequencies, rad/s, shape (line,).

    Returns
    -------
    mean_force
        N, shape (line, row).
    stiffness
        First harmonic of the force over that of the travel, N/m, shape (line, row).
    """
    mean_force = np.zeros(mean.shape)
    stiffness = np.zeros(mean.shape, dtype=np.complex128)
    cosine, sine = np.cos(_PHASES)[:, None, None], np.sin(_PHASES)[:, None, None]
    for law, rows, _, parameters in _elements(forces, values):
        size = np.maximum(amplitude[:, rows], _SHORTEST)
        if law.has_memory:
            sliding, length = _friction(law, parameters)
            # The travel a cos θ runs up while its sine is negative: the other half of the loop is the same, turned over.
            up = np.where(sine < 0, 1.0, -1.0)
            closed = 1 + np.tanh(size / length)
            force = sliding * up * (1 - closed * np.exp(-(up * cosine * size + size) / length))
        else:
            travel = mean[:, rows] + size * cosine
            force = law.evaluate(parameters, _input(travel, -omega[:, None] * size * sine)).force
        for position, row in enumerate(rows.tolist()):
            own = force[:, :, position]
            mean_force[:, row] += own.mean(axis=0)
            first = 2 * (own * np.exp(-1j * _PHASES)[:, None]).mean(axis=0)
            stiffness[:, row] += first / size[:, position]
    return mean_force, stiffness

"""A linear vehicle on pads that move: its exact motion, integrated from sample to sample by Gauss-Legendre quadrature."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sprung.errors import Problems
from sprung.vehicle import Load, Motion, PadInputs, Sensor, Vehicle, Wheel, highest_derivatives

Array = NDArray[np.float64]
Displacement: TypeAlias = Callable[[Array], Array]

_NODES = 5
"""Of the quadrature over a sampling interval: exact for polynomials of degree 9."""

_REST, _RAMP, _AFTER = 0.5, 1.0, 2.0
"""s of rest, s in which a motion begins and ends smoothly, and s of rest after it."""

_LINES = 100
"""Sines in a random motion."""

_KNEE = 2.0
"""Hz above which amplitudes fall with frequency: then no velocity is larger than at the knee."""

_RISE = 0.04
"""s in which a step rises."""

_NUDGE = 2e-5
"""s over which displacements are differentiated: of 25 Hz, the error is 1e-11."""


@dataclass(frozen=True)
class PadMotion:
    """How pads move in a simulated test.

    Attributes
    ----------
    kind
        ``random``: all pads at once, sines with random phases; ``sweep``: one pad after the other, through all frequencies;
        ``step``: one pad after the other, up and down again.
    amplitude
        Of a sweep below 2 Hz, height of a step, or three standard deviations of a random motion; m.
    lowest, highest
        Frequencies, Hz.
    duration
        Of the whole recording, s; the vehicle rests for half a second before the motion and for two after it.
    seed
        Of the phases. They have nothing to do with the noise.
    """

    kind: Literal["random", "sweep", "step"] = "random"
    amplitude: float = 0.006
    lowest: float = 0.5
    highest: float = 25.0
    duration: float = 30.0
    seed: int = field(default=0, kw_only=True)

    def check(self, problems: Problems) -> None:
        """Add a problem for everything that no pad can do."""
        if self.kind not in ("random", "sweep", "step"):
            problems.add("simulate: pads.kind", repr(self.kind), "random, sweep or step", "Correct it.")
        if not (math.isfinite(self.amplitude) and self.amplitude > 0):
            problems.add("simulate: pads.amplitude", repr(self.amplitude), "more than 0 m", "Correct it.")
        if not (math.isfinite(self.highest) and 0 < self.lowest < self.highest):
            found = f"{self.lowest:g} to {self.highest:g} Hz"
            problems.add("simulate: pads", found, "a highest frequency above the lowest", "Correct them.")
        least = _REST + 2 * _RAMP + _AFTER
        if not (math.isfinite(self.duration) and self.duration > least):
            problems.add("simulate: pads.duration", repr(self.duration), f"more than {least:g} s", "Record for longer.")

    def samples(self, rate: float) -> int:
        """Return the number of samples of a recording.

        Parameters
        ----------
        rate
            Samples per second.
        """
        return round(self.duration * rate)

    def displacements(self, wheels: Sequence[Wheel], drop: int) -> tuple[Displacement, ...]:
        """Return the displacement of each pad as a function of time, m of s.

        Parameters
        ----------
        wheels
            The wheel stations over them.
        drop
            Position of the drop in the campaign: no two have the same motion.
        """
        random = np.random.default_rng([self.seed, drop])
        begin, end = _REST, self.duration - _AFTER
        part = (end - begin) / len(wheels)
        if self.kind == "random":
            return tuple(self._random(random, begin, end) for _ in wheels)
        made = self._sweep if self.kind == "sweep" else self._step
        return tuple(made(begin + i * part, begin + (i + 1) * part) for i in range(len(wheels)))

    def _random(self, random: np.random.Generator, begin: float, end: float) -> Displacement:
        frequencies = np.linspace(self.lowest, self.highest, _LINES)
        phases = random.uniform(0, 2 * np.pi, _LINES)
        sizes = 1 / np.maximum(frequencies / _KNEE, 1.0)
        sizes *= self.amplitude / 3 / np.sqrt(np.sum(sizes**2) / 2)

        def displacement(time: Array) -> Array:
            waves = sizes @ np.sin(2 * np.pi * frequencies[:, None] * time + phases[:, None])
            return np.asarray(_window(time, begin, end) * waves)

        return displacement

    def _sweep(self, begin: float, end: float) -> Displacement:
        pace = math.log(self.highest / self.lowest) / (end - begin)

        def displacement(time: Array) -> Array:
            since = np.clip(time - begin, 0.0, end - begin)
            frequency = self.lowest * np.exp(pace * since)
            phase = 2 * np.pi * (frequency - self.lowest) / pace
            size = self.amplitude / np.sqrt(1 + (frequency / _KNEE) ** 2)
            return np.asarray(_window(time, begin, end) * size * np.sin(phase))

        return displacement

    def _step(self, begin: float, end: float) -> Displacement:
        middle = (begin + end) / 2

        def displacement(time: Array) -> Array:
            return np.asarray(self.amplitude * (_rise((time - begin) / _RISE) - _rise((time - middle) / _RISE)))

        return displacement


class DrivenMotion(NamedTuple):
    """The motion of a vehicle on pads.

    Attributes
    ----------
    motion
        Of its coordinates, from static equilibrium, SI, shape (coordinate, time) each.
    wheels
        The wheel stations over the pads that move.
    displacement, velocity
        Of the pads, m and m/s, shape (wheel, time).
    """

    motion: Motion
    wheels: tuple[Wheel, ...]
    displacement: Array
    velocity: Array

    def readings(self, vehicle: Vehicle, sensors: Sequence[Sensor]) -> Array:
        """Return what the pads add to the readings of sensors, SI, shape (channel, time)."""
        names, values = tuple(vehicle.parameters), list(vehicle.parameters.values())
        by_displacement, by_velocity = PadInputs.of(self.wheels, sensors, names).readings(values)
        return np.asarray(by_displacement @ self.displacement + by_velocity @ self.velocity)


def drive_on_pads(
    vehicle: Vehicle,
    load: Load,
    wheels: Sequence[Wheel],
    displacements: Sequence[Displacement],
    rate: float,
    samples: int,
) -> DrivenMotion:
    """Return the exact motion of a linear vehicle on pads, from rest at time 0 on.

    Parameters
    ----------
    vehicle
        The vehicle.
    load
        On it.
    wheels
        The wheel stations over the pads that move; the others stand on the ground.
    displacements
        Of each of these pads, m as functions of the time in s.
    rate
        Samples per second.
    samples
        How many.

    Returns
    -------
    DrivenMotion
    """
    matrices, step = vehicle.matrices(load), 1 / rate
    A, n, massive = matrices.state, matrices.M.shape[-1], matrices.massive
    values = list(vehicle.parameters.values())
    forces = PadInputs.of(wheels, (), tuple(vehicle.parameters)).forces(values)
    highest = np.linalg.inv(matrices.leading) @ np.concatenate(list(forces), axis=1)
    B = np.zeros((len(A), highest.shape[1]))
    B[highest_derivatives(n, massive)] = highest

    time: Array = step * np.arange(samples, dtype=np.float64)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    if not forces[1].any():  # velocities of pads have no effect, and take long to find
        B = B[:, : len(wheels)]
    driven = np.zeros((len(A), samples))
    for node, weight in zip((step * (1 + nodes) / 2).tolist(), (step * weights / 2).tolist(), strict=True):
        pads = _pads(displacements, time + node, B.shape[1] > len(wheels))
        driven += weight * (expm(A * (step - node)) @ B @ pads)
    transition, state = expm(A * step), np.zeros((len(A), samples))
    for i in range(samples - 1):
        state[:, i + 1] = transition @ state[:, i] + driven[:, i]

    pads = _pads(displacements, time)
    rates = A @ state + B @ pads[: B.shape[1]]
    acceleration = np.zeros((n, samples))
    acceleration[:massive] = rates[n:]
    return DrivenMotion(Motion(state[:n], rates[:n], acceleration), tuple(wheels), *np.split(pads, 2))


def _pads(displacements: Sequence[Displacement], time: Array, with_velocities: bool = True) -> Array:
    """Return displacements of pads, and their velocities if wanted, m and m/s, shape (wheel or 2 wheel, time)."""
    h = _NUDGE
    found = [one(time) for one in displacements]
    if not with_velocities:
        return np.array(found)
    rates = [
        (8 * (one(time + h) - one(time - h)) - (one(time + 2 * h) - one(time - 2 * h))) / (12 * h)
        for one in displacements
    ]
    return np.array([*found, *rates])


def _rise(part: Array) -> Array:
    """Return a smooth rise from 0 to 1 where its argument does so."""
    clipped = np.clip(part, 0.0, 1.0)
    return np.asarray(clipped**4 * (35 - 84 * clipped + 70 * clipped**2 - 20 * clipped**3))


def _window(time: Array, begin: float, end: float) -> Array:
    """Return 1 between two times, with a smooth beginning and end; 0 outside."""
    return np.asarray(_rise((time - begin) / _RAMP) * _rise((end - time) / _RAMP))

"""Pushes and bumps: what acts on the body or lifts the wheels, as pieces of sines whose motion is solved exactly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Bump, Push

Array = NDArray[np.float64]


class Arc(NamedTuple):
    """A piece of a sine: offset + amplitude sin(frequency τ + phase), τ counting from its start.

    Attributes
    ----------
    start
        When it begins, s; it lasts until the next one.
    offset, amplitude
        m or N.
    frequency
        rad/s.
    phase
        rad.
    """

    start: float
    offset: float = 0.0
    amplitude: float = 0.0
    frequency: float = 0.0
    phase: float = 0.0

    @property
    def state(self) -> Array:
        """Offset, sine and cosine at its start: with ṡ = frequency c and ċ = -frequency s it is offset + s."""
        sine, cosine = self.amplitude * math.sin(self.phase), self.amplitude * math.cos(self.phase)
        return np.array([self.offset, sine, cosine])


Arcs = Sequence[Arc]
"""Arcs one after the other; zero before the first one."""


def bump_arcs(bump: Bump, speed: float, start: float = 0.0) -> tuple[Arc, ...]:
    """Return the height of the ground under a wheel that runs over a bump.

    Parameters
    ----------
    bump
        What it runs over.
    speed
        m/s.
    start
        When the wheel reaches the bump, s.
    """
    half, edge = bump.height / 2, bump.edge / speed
    if bump.shape == "half-sine":
        passage = bump.length / speed
        return Arc(start, 0.0, bump.height, math.pi / passage), Arc(start + passage)
    up = Arc(start, half, half, math.pi / edge, -math.pi / 2), Arc(start + edge, bump.height)
    if bump.shape == "kerb":
        return up
    end = start + edge + bump.length / speed
    return (*up, Arc(end, half, half, math.pi / edge, math.pi / 2), Arc(end + edge))


def push_arcs(push: Push, force: float, frequency: float) -> tuple[Arc, ...]:
    """Return the upward force on the body that is pushed, from the beginning of the motion on.

    Parameters
    ----------
    push
        How it is pushed.
    force
        N.
    frequency
        Pushes per second, each a half sine in half the time.
    """
    if push.shape != "hand":
        return (Arc(0.0),)
    pushes = []
    for number in range(push.count):
        begin = number / frequency
        pushes += [Arc(begin, 0.0, -force, 2 * math.pi * frequency), Arc(begin + 0.5 / frequency)]
    return tuple(pushes)


class Drive(NamedTuple):
    """Signals that act on a vehicle: forces on its coordinates, or the height of the ground under its wheels.

    Attributes
    ----------
    signals
        Each from the beginning of the motion on, N or m.
    forces
        Force on each coordinate by each signal, shape (coordinate, signal).
    heights
        Height of the ground under each wheel by each signal, shape (wheel, signal).
    """

    signals: tuple[Arcs, ...]
    forces: Array
    heights: Array

    @classmethod
    def nothing(cls, coordinates: int, wheels: int) -> Drive:
        """Return a drive without signals."""
        return cls((), np.zeros((coordinates, 0)), np.zeros((wheels, 0)))

    @property
    def changes(self) -> tuple[float, ...]:
        """When any signal begins another arc, s, ascending."""
        return tuple(sorted({arc.start for arcs in self.signals for arc in arcs}))

    def at(self, time: float) -> tuple[Arc, ...]:
        """Return the arc of each signal that begins at a time or holds then."""
        return tuple(
            next((arc for arc in reversed(arcs) if arc.start <= time), Arc(-math.inf)) for arcs in self.signals
        )

    def values(self, times: Array) -> tuple[Array, Array]:
        """Return the signals and their rates at times, s, shape (signal, time)."""
        found = np.zeros((2, len(self.signals), len(times)))
        for (value, rate), arcs in zip(np.swapaxes(found, 0, 1), self.signals, strict=True):
            for arc in arcs:
                later = times >= arc.start
                angle = arc.frequency * (times[later] - arc.start) + arc.phase
                value[later] = arc.offset + arc.amplitude * np.sin(angle)
                rate[later] = arc.frequency * arc.amplitude * np.cos(angle)
        return found[0], found[1]

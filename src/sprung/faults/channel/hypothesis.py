"""The record of a hypothesis about one channel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.faults.correction import Correction
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

Numbers = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class ChannelHypothesis:
    """What a channel may measure instead of what is stated, the same in all drops.

    Attributes
    ----------
    code
        Of the fault.
    fault
        Returns the fault, given the numbers and their standard uncertainties, without what is done about it.
    estimate
        Estimates the numbers from the recordings, a gain, s, m or Hz, and returns them with the residual of the channel, sum of
        squares of each decay, (m/s²)², shape (decay,).
    correction
        Returns what corrects the channel, given the numbers; None where nothing would, and the channel is left out.
    stated
        What the campaign file states of the numbers, where it states anything.
    reading
        What the channel reads over what it should, given the numbers.
    free
        How many numbers are estimated, where they are not listed.
    allows
        Whether the numbers are of a usual size, and gravity at rest does not contradict them.
    law
        Of several laws that have the same code, which one it is: the order of a low-pass.
    first_order
        Code of the fault that it is to the first order of its size, whose score test is its own; empty for none.
    improve
        Returns the numbers after steps of that fault's numbers; None where they are the same numbers.
    change
        Returns the correction that leads from corrected numbers to others; None for the correction by their difference.
    recorded
        Returns the sum of squares, (m/s²)², that a residual of the corrected samples had in the recording, given it, samples
        per second and the numbers; None where it follows from the reading.
    """

    code: str
    fault: Callable[[Numbers, Numbers], Fault]
    estimate: Callable[[], tuple[Numbers, Real]]
    correction: Callable[[Numbers], Correction] | None = None
    stated: Numbers = ()
    reading: Callable[[Numbers], float] = lambda _: 1.0
    free: int = 0
    allows: Callable[[Numbers], bool] = lambda _: True
    law: int = 0
    first_order: str = ""
    improve: Callable[[Numbers, Numbers], Numbers] | None = None
    change: Callable[[Numbers, Numbers], Correction] | None = None
    recorded: Callable[[Real, float, Numbers], float] | None = None

    @cached_property
    def _estimated(self) -> tuple[Numbers, Real]:
        return self.estimate()

    @property
    def numbers(self) -> Numbers:
        """What is estimated from the recordings: a gain, s, m or Hz."""
        return self._estimated[0]

    @property
    def residual(self) -> Real:
        """Residual of the channel, sum of squares of each decay, (m/s²)², shape (decay,)."""
        return self._estimated[1]

    @property
    def scored_as(self) -> str:
        """Code of the fault whose score test tells its numbers."""
        return self.first_order or self.code


def figures(number: float) -> str:
    """Return a number with two significant digits."""
    return f"{float(f'{number:.2g}'):g}"


def stated_place(sensor: Sensor) -> str:
    """Return where the campaign file puts a sensor, in words."""
    if sensor.position is None:
        return sensor.on or "a wheel"
    x, y, _ = sensor.position
    return f"x = {x:.2f} m, y = {y:.2f} m"

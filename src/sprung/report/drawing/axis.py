"""Axes: where values stand on them, round ticks, and room for everything."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]


@dataclass(frozen=True)
class Axis:
    """An axis.

    Attributes
    ----------
    label
        What it shows, with the unit.
    low, high
        Its ends.
    log
        Whether it is logarithmic.
    falling
        Whether it runs from high to low.
    ticks
        Values and how they are written; empty for round ones.
    """

    label: str
    low: float
    high: float
    log: bool = False
    falling: bool = False
    ticks: tuple[tuple[float, str], ...] = ()

    def at(self, values: Real) -> Real:
        """Place values along the axis, 0 at its beginning and 1 at its end."""
        low, high = np.log([self.low, self.high]) if self.log else (self.low, self.high)
        with np.errstate(divide="ignore", invalid="ignore"):
            part = ((np.log(values) if self.log else np.asarray(values, dtype=float)) - low) / (high - low)
        return 1 - part if self.falling else part

    @property
    def marked(self) -> tuple[tuple[float, str], ...]:
        """Its ticks, round ones where none were given."""
        return self.ticks or tuple(round_ticks(self.low, self.high, self.log))


def round_ticks(low: float, high: float, log: bool = False, most: int = 6) -> Iterator[tuple[float, str]]:
    """Give round values between two, and how they are written.

    Parameters
    ----------
    low, high
        The values.
    log
        Whether the axis is logarithmic.
    most
        How many at the most.

    Examples
    --------
    >>> [text for _, text in round_ticks(-0.7, 1.2)]
    ['−0.5', '0', '0.5', '1']
    """
    if log:
        decades = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
        for digits in ((1, 2, 5), (1, 3), (1,)):
            found = [digit * 10.0**decade for decade in decades for digit in digits]
            found = [value for value in found if low * (1 - 1e-9) <= value <= high * (1 + 1e-9)]
            if len(found) <= most + 1:
                break
    else:
        power = 10.0 ** np.floor(np.log10((high - low) / most))
        step = next(size * power for size in (1, 2, 5, 10) if (high - low) / (size * power) <= most)
        found = (step * np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) + 0.0).tolist()
    yield from ((value, f"{value:.6g}".replace("-", "\N{MINUS SIGN}")) for value in found)


def room(*values: Real, least: float = 0.0, margin: float = 0.06) -> tuple[float, float]:
    """Give ends of an axis on which values fit.

    Parameters
    ----------
    values
        Any shape; NaN counts nothing.
    least
        Length of the axis at the least.
    margin
        Part of their span beyond them on either side.
    """
    finite = np.concatenate([np.ravel(one)[np.isfinite(np.ravel(one))] for one in values])
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (-1.0, 1.0)
    span = max(high - low, least, 1e-12 * max(abs(low), abs(high)), np.finfo(float).tiny ** 0.5)
    middle = (low + high) / 2
    return middle - span * (0.5 + margin), middle + span * (0.5 + margin)

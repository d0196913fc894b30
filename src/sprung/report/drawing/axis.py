"""Axes: position of values, round ticks, and limits that enclose the data."""

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
        Quantity and unit.
    low, high
        Its ends.
    log
        Whether it is logarithmic.
    descending
        Whether it runs from high to low.
    ticks
        Values and their labels; empty for round ones.
    """

    label: str
    low: float
    high: float
    log: bool = False
    descending: bool = False
    ticks: tuple[tuple[float, str], ...] = ()

    def at(self, values: Real) -> Real:
        """Return the position of values along the axis, 0 at its beginning and 1 at its end."""
        low, high = np.log([self.low, self.high]) if self.log else (self.low, self.high)
        with np.errstate(divide="ignore", invalid="ignore"):
            position = ((np.log(values) if self.log else np.asarray(values, dtype=float)) - low) / (high - low)
        return 1 - position if self.descending else position

    @property
    def all_ticks(self) -> tuple[tuple[float, str], ...]:
        """Its ticks; round ones where none were given."""
        return self.ticks or tuple(round_ticks(self.low, self.high, self.log))


def round_ticks(low: float, high: float, log: bool = False, most: int = 6) -> Iterator[tuple[float, str]]:
    """Return round values between two limits, with their labels.

    Parameters
    ----------
    low, high
        The limits, in the unit of the axis.
    log
        Whether the axis is logarithmic.
    most
        Largest number of ticks.

    Examples
    --------
    >>> [text for _, text in round_ticks(-0.7, 1.2)]
    ['−0.5', '0', '0.5', '1']
    """
    if log:
        decades = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
        for digits in ((1, 2, 5), (1, 3), (1,)):
            ticks = [digit * 10.0**decade for decade in decades for digit in digits]
            ticks = [value for value in ticks if low * (1 - 1e-9) <= value <= high * (1 + 1e-9)]
            if len(ticks) <= most + 1:
                break
    else:
        power = 10.0 ** np.floor(np.log10((high - low) / most))
        step = next(size * power for size in (1, 2, 5, 10) if (high - low) / (size * power) <= most)
        ticks = (step * np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) + 0.0).tolist()
    yield from ((value, f"{value:.6g}".replace("-", "\N{MINUS SIGN}")) for value in ticks)


def axis_limits(*values: Real, least: float = 0.0, margin: float = 0.06) -> tuple[float, float]:
    """Return limits of an axis that enclose the values.

    Parameters
    ----------
    values
        Any shape; NaN is ignored.
    least
        Smallest length of the axis, in its unit.
    margin
        Margin on either side, as a part of the span.
    """
    finite = np.concatenate([np.ravel(array)[np.isfinite(np.ravel(array))] for array in values])
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (-1.0, 1.0)
    if low == high == 0:  # a quantity that is zero throughout has no scale of its own
        low, high = -1.0, 1.0
    span = max(high - low, least, 1e-12 * max(abs(low), abs(high)), np.finfo(float).tiny ** 0.5)
    middle = (low + high) / 2
    return middle - span * (0.5 + margin), middle + span * (0.5 + margin)

"""An estimated quantity: value, uncertainty, unit and origin."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from sprung.display import shown
from sprung.uncertainty.rounding import round_by_uncertainty

Status = Literal["estimated", "known", "unidentifiable"]
"""Origin of a value: see `Estimate`."""

IntervalFrom = Literal["curvature", "profile"]
"""Origin of an interval: see `Estimate`."""

NORMAL_95 = 1.959963984540054
"""Half-width of the central 95 % of a normal distribution, in standard deviations."""


@shown
@dataclass(frozen=True, slots=True)
class Estimate:
    """A quantity with its uncertainty.

    Attributes
    ----------
    value
        SI; None where the data do not determine it.
    std
        Standard uncertainty, SI; 0 where it was known exactly, None where undetermined.
    interval95
        Limits of the 95 % interval, SI; None where undetermined. One limit is None where the interval is open to that side.
    unit
        SI, such as ``N/m``.
    status
        ``known`` beforehand and exactly, ``estimated`` from the recordings and what was known, or ``unidentifiable``.
    interval_from
        Whether the interval follows from the ``curvature`` of the likelihood at its maximum, as the standard uncertainty does,
        or from its whole ``profile``; None where nothing was estimated.
    """

    value: float | None
    std: float | None
    interval95: tuple[float | None, float | None] | None
    unit: str
    status: Status
    interval_from: IntervalFrom | None = None

    @property
    def percent(self) -> float | None:
        """Standard uncertainty in percent of the value; None where there is none."""
        if self.value is None or self.std is None or self.value == 0:
            return None
        return 100 * self.std / abs(self.value)

    def __str__(self) -> str:
        if self.value is None or self.std is None:
            return "not determined"
        value, std = round_by_uncertainty(self.value, self.std)
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{value}{f' ± {std}' if std else ''}{unit}"

    def __format__(self, spec: str) -> str:
        """Return the value by a number's format, ``f"{estimate:.3g}"``; without one value, uncertainty and unit."""
        if not spec:
            return str(self)
        return format(math.nan if self.value is None else self.value, spec)


@shown
@dataclass(frozen=True, slots=True)
class Ratio:
    """A quantity per total mass, which is determined even where the absolute scale is not.

    Attributes
    ----------
    value, std
        In the unit; the latter its standard uncertainty.
    unit
        SI, such as ``1/s^2``.
    """

    value: float
    std: float
    unit: str

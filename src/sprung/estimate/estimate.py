"""One estimated quantity: value, uncertainty, unit, and where it comes from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Status = Literal["estimated", "known", "unidentifiable"]

NORMAL_95 = 1.959963984540054
"""Half-width of the central 95 % of a normal distribution, in standard deviations."""


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
        Limits of the 95 % interval, SI; None where undetermined.
    unit
        SI, such as ``N/m``.
    status
        ``known`` beforehand and exactly, ``estimated`` from the recordings and what was known, or ``unidentifiable``.
    """

    value: float | None
    std: float | None
    interval95: tuple[float, float] | None
    unit: str
    status: Status

    @property
    def percent(self) -> float | None:
        """Standard uncertainty in percent of the value; None where there is none."""
        if self.value is None or self.std is None or self.value == 0:
            return None
        return 100 * self.std / abs(self.value)


@dataclass(frozen=True, slots=True)
class Ratio:
    """A quantity per total mass: what is left to say when the absolute scale is not determined."""

    value: float
    std: float
    unit: str

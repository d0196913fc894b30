"""Estimates beside true values, where the vehicle is a simulated one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sprung.display import shown
from sprung.results import Result
from sprung.uncertainty import Estimate
from sprung.vehicle import Vehicle


@shown
@dataclass(frozen=True, slots=True)
class TrueValue:
    """A parameter whose true value is known because it was simulated.

    Attributes
    ----------
    true
        SI.
    estimate
        What was identified; it has a value and a standard uncertainty above 0.
    """

    true: float
    estimate: Estimate

    @property
    def percent(self) -> float:
        """Estimate less true value, % of the true value."""
        return 100 * self._difference / self.true

    @property
    def standard_errors(self) -> float:
        """Estimate less true value, in standard uncertainties of the estimate."""
        assert self.estimate.std is not None  # noqa: S101 (for the type checker: see `true_values`)
        return self._difference / self.estimate.std

    @property
    def _difference(self) -> float:
        assert self.estimate.value is not None  # noqa: S101 (for the type checker: see `true_values`)
        return self.estimate.value - self.true


def true_values(result: Result, vehicle: Vehicle) -> Mapping[str, TrueValue]:
    """Set the estimates of a result beside the vehicle that was simulated.

    Parameters
    ----------
    result
        The result.
    vehicle
        The vehicle that was simulated.

    Returns
    -------
    mapping
        By parameter: those that were estimated and that the vehicle has, other than zero. Known ones have no error to show.
    """
    return {
        name: TrueValue(vehicle.parameters[name], found)
        for name, found in result.parameters.items()
        if found.status == "estimated" and found.value is not None and found.std and vehicle.parameters.get(name)
    }

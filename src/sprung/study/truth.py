"""Estimates and true values of a simulated vehicle."""

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
    """A parameter of a simulated vehicle and its estimate.

    Attributes
    ----------
    true
        SI.
    estimate
        Estimate, with a value and a standard uncertainty above 0.
    """

    true: float
    estimate: Estimate

    @property
    def percent(self) -> float:
        """Estimate minus true value, % of the true value."""
        return 100 * self._difference / self.true

    @property
    def standard_errors(self) -> float:
        """Estimate minus true value, in standard uncertainties of the estimate."""
        assert self.estimate.std is not None  # noqa: S101 (for the type checker: see `true_values`)
        return self._difference / self.estimate.std

    @property
    def _difference(self) -> float:
        assert self.estimate.value is not None  # noqa: S101 (for the type checker: see `true_values`)
        return self.estimate.value - self.true


def true_values(result: Result, vehicle: Vehicle) -> Mapping[str, TrueValue]:
    """Return the estimates of a result with the true values.

    Parameters
    ----------
    result
        Of an identification.
    vehicle
        The simulated vehicle.

    Returns
    -------
    mapping
        By parameter: those that were estimated and are not zero in the simulated vehicle.
    """
    return {
        name: TrueValue(vehicle.parameters[name], estimate)
        for name, estimate in result.parameters.items()
        if estimate.status == "estimated"
        and estimate.value is not None
        and estimate.std
        and vehicle.parameters.get(name)
    }

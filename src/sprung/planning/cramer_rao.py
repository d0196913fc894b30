"""Cramér-Rao bound: the smallest standard uncertainty of each parameter, and what a test does not determine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.estimation import (
    NO_INFORMATION,
    RANK,
    FitStatistics,
    Unidentifiable,
    canonical_basis,
    to_estimates,
    unidentifiable_combinations,
)
from sprung.planning.setup import MeasurementSetup
from sprung.vehicle import is_nuisance

Real = NDArray[np.float64]

_LEAST = 0.01
"""Information assumed in a direction without any, as in the fit: an uncertainty of ten powers of e."""

_EXACT = 1e-12
"""Relative uncertainty below which exact knowledge has fixed a parameter, such as b under an exact a and wheelbase."""


@shown
@dataclass(frozen=True, eq=False)
class CramerRaoBound:
    """:term:`Cramér-Rao bound` of one test.

    Attributes
    ----------
    setup
        What is tested.
    information
        Of drops and known quantities, in the free directions of the setup, dimensionless, shape (direction, direction).
    percents
        Smallest standard uncertainty in percent of each parameter that is not known exactly beforehand, those of extras in
        percent of the front spring or damper rate; None where there is no bound below the value itself.
    """

    setup: MeasurementSetup
    information: Real = field(repr=False)

    @cached_property
    def _directions(self) -> tuple[Real, Real]:
        eigenvalues, vectors = np.linalg.eigh(self.information)
        rounding = RANK * eigenvalues.max(initial=0.0)
        return np.where(eigenvalues < rounding, 0.0, eigenvalues), self.setup.free @ vectors

    @cached_property
    def covariance(self) -> Real:
        """Of the fit's coordinates, shape (parameter, parameter); very large where there is no information."""
        eigenvalues, directions = self._directions
        covariance: Real = directions @ (directions / np.maximum(eigenvalues, _LEAST)).T
        return covariance

    @cached_property
    def percents(self) -> Mapping[str, float | None]:
        """Smallest standard uncertainty of each parameter, %; None without a bound below its value."""
        spread = np.sqrt(np.diag(self.covariance)).tolist()
        return {
            name: 100 * one if one <= 1 else None
            for name, one in zip(self.setup.names, spread, strict=True)
            if one > _EXACT and not is_nuisance(name)
        }

    @property
    def undetermined(self) -> tuple[str, ...]:
        """Parameters without a bound."""
        return tuple(name for name, percent in self.percents.items() if percent is None)

    @property
    def worst(self) -> str | None:
        """Parameter with the largest uncertainty; None where all are known exactly."""
        return max(self.percents, key=lambda name: _size(self.percents[name]), default=None)

    def count_above(self, wanted: float) -> int:
        """Count the parameters that stay above a wanted percent."""
        return sum(_size(percent) > wanted for percent in self.percents.values())

    @property
    def sort_key(self) -> tuple[int, float]:
        """Sort key: number of parameters without a bound, then the largest uncertainty of the others."""
        sizes = [percent for percent in self.percents.values() if percent is not None]
        return len(self.undetermined), max(sizes, default=0.0)

    @cached_property
    def unidentifiable(self) -> tuple[Unidentifiable, ...]:
        """Combinations of parameters that the test does not determine, with the reason."""
        undetermined = self.undetermined
        if not undetermined:
            return ()
        eigenvalues, directions = self._directions
        without = canonical_basis(directions[:, eigenvalues < NO_INFORMATION])
        expected = self._expected_fit(without).of_vehicle
        combinations = unidentifiable_combinations(expected, to_estimates(expected, self.setup.known))
        combinations = tuple(own for own in combinations if set(own.parameters) & set(undetermined))
        others = tuple(name for name in undetermined if not any(name in own.parameters for own in combinations))
        if others:
            combinations += (Unidentifiable(others, "its standard uncertainty from these drops exceeds its value"),)
        return combinations

    def _expected_fit(self, undetermined: Real) -> FitStatistics:
        """Return the statistics of the fit to be expected of the test."""
        setup = self.setup
        return FitStatistics(
            names=setup.names,
            values=setup.values,
            slopes=setup.slopes,
            relative_covariance=self.covariance,
            covariance=self.covariance * np.outer(setup.slopes, setup.slopes),
            undetermined=undetermined,
            noise=setup.noise,
            residual=np.zeros((0, len(setup.noise))),
            inflation=setup.inflation,
            residuals=(),
            contradictions={},
            loglikelihood=0.0,
            iterations=0,
            converged=True,
            starts_agreeing=0,
            starts=0,
        )


def _size(percent: float | None) -> float:
    return np.inf if percent is None else percent


def two_figures(percent: float | None) -> str:
    """Format a percentage to two significant figures, or a dash for none.

    Parameters
    ----------
    percent
        %.

    Returns
    -------
    str

    Examples
    --------
    >>> two_figures(3.1415), two_figures(0.0031), two_figures(None)
    ('3.1', '0.0031', '-')
    """
    return "-" if percent is None else f"{float(f'{percent:.2g}'):g}"

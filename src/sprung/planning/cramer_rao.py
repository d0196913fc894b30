"""The Cramér-Rao bound: how well any unbiased estimate can know each parameter, and what it cannot know at all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.estimation import NO_INFORMATION, RANK, FitStatistics, Unidentifiable, canonical_basis, to_estimates
from sprung.planning.setup import MeasurementSetup
from sprung.vehicle import LOAD_MASS

Real = NDArray[np.float64]

_LEAST = 0.01
"""Information given to a direction without any, as the fit does it: ten powers of e of uncertainty."""

_EXACT = 1e-12
"""Relative uncertainty below which exact knowledge has fixed a parameter, such as b under an exact a and wheelbase."""


@shown
@dataclass(frozen=True, eq=False)
class Bound:
    """The bound of one test.

    Attributes
    ----------
    subject
        What is tested.
    information
        Of drops and knowledge together, in the subject's free directions, dimensionless, shape (direction, direction).
    percents
        Smallest standard uncertainty in percent of each parameter that is not known exactly beforehand, those of extras in
        percent of the front spring or damper rate; None where there is no bound below the value itself.
    """

    subject: MeasurementSetup
    information: Real = field(repr=False)

    @cached_property
    def _directions(self) -> tuple[Real, Real]:
        eigenvalues, vectors = np.linalg.eigh(self.information)
        rounding = RANK * eigenvalues.max(initial=0.0)
        return np.where(eigenvalues < rounding, 0.0, eigenvalues), self.subject.free @ vectors

    @cached_property
    def covariance(self) -> Real:
        """Of the fit's coordinates, shape (parameter, parameter); very large where there is no information."""
        eigenvalues, directions = self._directions
        covariance: Real = directions @ (directions / np.maximum(eigenvalues, _LEAST)).T
        return covariance

    @cached_property
    def percents(self) -> Mapping[str, float | None]:
        """By name, as the class says."""
        spread = np.sqrt(np.diag(self.covariance)).tolist()
        return {
            name: 100 * one if one <= 1 else None
            for name, one in zip(self.subject.names, spread, strict=True)
            if one > _EXACT and not name.startswith(LOAD_MASS)
        }

    @property
    def undetermined(self) -> tuple[str, ...]:
        """The parameters without a bound."""
        return tuple(name for name, percent in self.percents.items() if percent is None)

    @property
    def worst(self) -> str | None:
        """The parameter that is known least; None where all are known exactly."""
        return max(self.percents, key=lambda name: _size(self.percents[name]), default=None)

    def above(self, wanted: float) -> int:
        """Count the parameters that stay above a wanted percent."""
        return sum(_size(percent) > wanted for percent in self.percents.values())

    @property
    def rank(self) -> tuple[int, float]:
        """Sorts bounds: fewest parameters without one first, then by the worst of the others."""
        sizes = [percent for percent in self.percents.values() if percent is not None]
        return len(self.undetermined), max(sizes, default=0.0)

    @cached_property
    def why(self) -> tuple[Unidentifiable, ...]:
        """Which parameters the test does not determine, and why, in the words of an identification of it."""
        silent = self.undetermined
        if not silent:
            return ()
        eigenvalues, directions = self._directions
        silenced = canonical_basis(directions[:, eigenvalues < NO_INFORMATION])
        named = to_estimates(self._expected(silenced), self.subject.known).unidentifiable
        found = tuple(one for one in named if set(one.parameters) & set(silent))
        left = tuple(name for name in silent if not any(name in one.parameters for one in found))
        if left:
            found += (Unidentifiable(left, "these drops leave as much doubt of it as its own size"),)
        return found

    def _expected(self, undetermined: Real) -> FitStatistics:
        """Give the fit that is to be expected of the test."""
        subject = self.subject
        return FitStatistics(
            names=subject.names,
            values=subject.values,
            slopes=subject.slopes,
            relative_covariance=self.covariance,
            covariance=self.covariance * np.outer(subject.slopes, subject.slopes),
            undetermined=undetermined,
            noise=subject.noise,
            residual=np.zeros((0, len(subject.noise))),
            inflation=subject.inflation,
            fitted=(),
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
    """Write a percentage to two figures, or a dash for none.

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

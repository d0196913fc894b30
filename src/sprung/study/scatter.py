"""Scatter of several vehicles of one kind beyond their uncertainties, and outliers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, t

from sprung.display import shown
from sprung.study.significance import holm

Real = NDArray[np.float64]

FEWEST = 3
"""Smallest number of values for an estimate of their scatter."""

_OUTLIER = 0.05
"""Probability, corrected for the number of comparisons, below which a result is an outlier."""


@shown
@dataclass(frozen=True, slots=True)
class ScatterEstimate:
    """Scatter of one quantity over several results.

    Attributes
    ----------
    names
        Labels of the results that have it.
    mean, mean_std
        Mean, weighted by uncertainty and scatter, and its standard uncertainty; in the quantity's unit.
    spread
        Standard deviation between vehicles, beyond the stated uncertainties; 0 where these explain the scatter; in the
        quantity's unit.
    p
        Probability of at least this scatter if all vehicles were equal; dimensionless.
    furthest
        Label of the result that is furthest from the others, relative to its uncertainty and their scatter.
    distance
        Its distance: Student's t with n - 2 degrees of freedom for n results; dimensionless.
    p_holm
        Probability of such a distance, corrected for the number of results and of quantities; dimensionless.
    """

    names: tuple[str, ...]
    mean: float
    mean_std: float
    spread: float
    p: float
    furthest: str
    distance: float
    p_holm: float

    @property
    def stands_out(self) -> bool:
        """Whether the furthest result is an outlier at the 5 % level."""
        return self.p_holm <= _OUTLIER


def estimate_scatter(quantities: Mapping[str, Sequence[tuple[str, float, float]]]) -> dict[str, ScatterEstimate]:
    """Return the scatter of several quantities.

    Parameters
    ----------
    quantities
        By name of the quantity: label, value and standard uncertainty of each result that has it, in the quantity's unit.

    Returns
    -------
    dict
        By name, of those that three results or more have.

    Notes
    -----
    The spread between vehicles is the method of moments' (R. DerSimonian, N. Laird, Controlled Clin. Trials 7 (1986) 177): no
    iteration, never negative. The distance of a result is computed from mean and spread of the others.
    """
    estimates = {name: _estimate(rows) for name, rows in quantities.items() if len(rows) >= FEWEST}
    corrected = holm([min(1.0, scatter.p_holm * len(scatter.names)) for scatter in estimates.values()])
    return {name: replace(scatter, p_holm=p) for (name, scatter), p in zip(estimates.items(), corrected, strict=True)}


def _estimate(rows: Sequence[tuple[str, float, float]]) -> ScatterEstimate:
    values, stds = np.array([row[1] for row in rows]), np.array([row[2] for row in rows])
    mean, mean_std, spread, chi_square = _pooled(values, stds)
    distances = []
    for i in range(len(rows)):
        others = np.arange(len(rows)) != i
        others_mean, others_std, others_spread, _ = _pooled(values[others], stds[others])
        distances.append((values[i] - others_mean) / np.sqrt(stds[i] ** 2 + others_std**2 + others_spread**2))
    furthest = int(np.argmax(np.abs(distances)))
    uncorrected = float(2 * t.sf(abs(distances[furthest]), len(rows) - 2))
    return ScatterEstimate(
        names=tuple(row[0] for row in rows),
        mean=mean,
        mean_std=mean_std,
        spread=spread,
        p=float(chi2.sf(chi_square, len(rows) - 1)),
        furthest=rows[furthest][0],
        distance=float(distances[furthest]),
        p_holm=uncorrected,
    )


def _pooled(values: Real, stds: Real) -> tuple[float, float, float, float]:
    """Return mean, its standard uncertainty, spread beyond the uncertainties, and chi-square for equal values."""
    weights = 1 / stds**2
    chi_square = float(np.sum(weights * (values - np.average(values, weights=weights)) ** 2))
    scale = weights.sum() - np.sum(weights**2) / weights.sum()
    variance = max(0.0, (chi_square - (len(values) - 1)) / scale)
    total = 1 / (stds**2 + variance)
    return float(np.average(values, weights=total)), float(total.sum() ** -0.5), float(np.sqrt(variance)), chi_square


def complete_rows(rows: Iterable[tuple[str, float | None, float | None]]) -> list[tuple[str, float, float]]:
    """Return the rows with a value and an uncertainty.

    Parameters
    ----------
    rows
        Label, value and standard uncertainty of each result, in one unit.
    """
    return [(label, value, std) for label, value, std in rows if value is not None and std]

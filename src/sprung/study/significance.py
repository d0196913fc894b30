"""Significance of differences: of one quantity, corrected for many, and joint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm

from sprung.display import shown
from sprung.results import Result

Real = NDArray[np.float64]

_RANK = 1e-6
"""Eigenvalue of a correlation matrix below which a direction is fixed by prior knowledge."""


@shown
@dataclass(frozen=True, slots=True)
class JointTest:
    """Joint test of all quantities that two results have estimated.

    Attributes
    ----------
    names
        Of the quantities.
    chi_square
        Squared Mahalanobis distance of the differences; dimensionless.
    freedom
        Degrees of freedom: fewer than names where prior knowledge, such as an exact wheelbase, constrains several.
    p
        Probability of a larger distance between two results of the same vehicle.
    """

    names: tuple[str, ...]
    chi_square: float
    freedom: int
    p: float


def two_sided(z: float) -> float:
    """Return the two-sided probability of a standard normal variable.

    Parameters
    ----------
    z
        In standard uncertainties.
    """
    return float(2 * norm.sf(abs(z)))


def holm(probabilities: Sequence[float]) -> list[float]:
    """Return the probabilities of many comparisons, corrected so that at most 5 % of tables have any wrong one below 0.05.

    Parameters
    ----------
    probabilities
        Each between 0 and 1.

    Returns
    -------
    list of float
        In the same order, none smaller than before, none above 1.

    Notes
    -----
    S. Holm, A simple sequentially rejective multiple test procedure, Scand. J. Statist. 6 (1979) 65. It makes no
    assumption about the dependence of the comparisons.

    Examples
    --------
    >>> holm([0.01, 0.04, 0.03])
    [0.03, 0.06, 0.06]
    """
    order = np.argsort(probabilities, kind="stable")
    steps = np.asarray(probabilities, dtype=float)[order] * (len(probabilities) - np.arange(len(probabilities)))
    corrected = np.empty(len(probabilities))
    corrected[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return corrected.tolist()


def joint_test(first: Result, second: Result, among: Sequence[str]) -> JointTest | None:
    """Test all parameters that two results have estimated, with their correlations.

    Parameters
    ----------
    first, second
        Results with independent errors.
    among
        Names of the comparable parameters.

    Returns
    -------
    Joint or None
        None where they have no estimated parameter in common.
    """
    common = set(first.correlation.names) & set(second.correlation.names)
    names = tuple(name for name in among if name in common)
    if not names:
        return None
    covariance = _covariance(first, names) + _covariance(second, names)
    std = np.sqrt(np.diag(covariance))
    z = np.array([_value(second, name) - _value(first, name) for name in names]) / std
    sizes, directions = np.linalg.eigh(covariance / np.outer(std, std))
    free = sizes > _RANK
    chi_square = float(np.sum((directions[:, free].T @ z) ** 2 / sizes[free]))
    freedom = int(free.sum())
    return JointTest(names, chi_square, freedom, float(chi2.sf(chi_square, freedom)))


def _value(result: Result, name: str) -> float:
    return result.parameters[name].value or 0.0


def _covariance(result: Result, names: Sequence[str]) -> Real:
    indices = [result.correlation.names.index(name) for name in names]
    matrix = np.array(result.correlation.matrix)[np.ix_(indices, indices)]
    std = np.array([result.parameters[name].std or 0.0 for name in names])
    return np.asarray(matrix * np.outer(std, std))

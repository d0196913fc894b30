"""How sure a difference is: of one quantity, of many at once, and of all together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm

from sprung.display import shown
from sprung.results import Result

Real = NDArray[np.float64]

_RANK = 1e-6
"""Eigenvalue of a correlation matrix below which what was known beforehand fixes a direction, not the recordings."""


@shown
@dataclass(frozen=True, slots=True)
class JointTest:
    """All quantities that two results have estimated, compared at once.

    Attributes
    ----------
    names
        Which.
    chi_square
        Squared length of the differences in standard uncertainties, correlations counted; dimensionless.
    freedom
        Independent directions among them: fewer than names where something known beforehand, such as an exact wheelbase, ties
        several together.
    p
        Chance of a larger one between two results of the same vehicle.
    """

    names: tuple[str, ...]
    chi_square: float
    freedom: int
    p: float


def two_sided(z: float) -> float:
    """Give the chance that a standard normal number is further from 0.

    Parameters
    ----------
    z
        The number, in standard uncertainties.
    """
    return float(2 * norm.sf(abs(z)))


def holm(chances: Sequence[float]) -> list[float]:
    """Correct the chances of many comparisons, so that any one below 0.05 is wrong in at most 5 % of tables.

    Parameters
    ----------
    chances
        Each between 0 and 1.

    Returns
    -------
    list of float
        In the same order, none smaller than before, none above 1.

    Notes
    -----
    S. Holm, A simple sequentially rejective multiple test procedure, Scand. J. Statist. 6 (1979) 65. It asks nothing about how
    the comparisons depend on each other.

    Examples
    --------
    >>> holm([0.01, 0.04, 0.03])
    [0.03, 0.06, 0.06]
    """
    order = np.argsort(chances, kind="stable")
    steps = np.asarray(chances, dtype=float)[order] * (len(chances) - np.arange(len(chances)))
    corrected = np.empty(len(chances))
    corrected[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return [float(one) for one in corrected]


def joint_test(first: Result, second: Result, among: Sequence[str]) -> JointTest | None:
    """Compare what two results both estimated, with the correlations that they tell.

    Parameters
    ----------
    first, second
        The results, whose errors are taken to be independent.
    among
        Names of the parameters that can be compared.

    Returns
    -------
    Joint or None
        None where they have nothing in common.
    """
    told = [set(result.correlation.names) for result in (first, second)]
    names = tuple(name for name in among if name in told[0] & told[1])
    if not names:
        return None
    covariance = _covariance(first, names) + _covariance(second, names)
    spread = np.sqrt(np.diag(covariance))
    apart = np.array([_value(second, name) - _value(first, name) for name in names]) / spread
    sizes, directions = np.linalg.eigh(covariance / np.outer(spread, spread))
    free = sizes > _RANK
    size = float(np.sum((directions[:, free].T @ apart) ** 2 / sizes[free]))
    freedom = int(free.sum())
    return JointTest(names, size, freedom, float(chi2.sf(size, freedom)))


def _value(result: Result, name: str) -> float:
    return result.parameters[name].value or 0.0


def _covariance(result: Result, names: Sequence[str]) -> Real:
    places: Mapping[str, int] = {name: i for i, name in enumerate(result.correlation.names)}
    chosen = [places[name] for name in names]
    matrix = np.array(result.correlation.matrix)[np.ix_(chosen, chosen)]
    spread = np.array([result.parameters[name].std or 0.0 for name in names])
    return np.asarray(matrix * np.outer(spread, spread))

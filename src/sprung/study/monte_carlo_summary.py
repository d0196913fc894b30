"""Bias, scatter and coverage of estimates, each with its own statistical uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t

from sprung.batch import Row
from sprung.display import shown
from sprung.study.significance import two_sided
from sprung.uncertainty import NORMAL_95
from sprung.vehicle import PARAMETERS

_SIGNIFICANT = two_sided(3.0)
"""Two-sided probability below which a bias is significant: 0.27 %, that of three standard deviations."""


@shown
@dataclass(frozen=True, slots=True)
class Share:
    """A part of all campaigns.

    Attributes
    ----------
    count, of
        Number of campaigns, and of all.
    part
        Their ratio, dimensionless; 0 of none.
    low, high
        Wilson's 95 % interval of the probability, dimensionless.
    """

    count: int
    of: int
    part: float
    low: float
    high: float


@shown
@dataclass(frozen=True, slots=True)
class ParameterAccuracy:
    """Accuracy of the estimates of one parameter; None where fewer than two campaigns estimate it.

    Attributes
    ----------
    true
        Value of the simulated vehicle, SI.
    unit
        SI.
    estimated, undetermined
        Number of campaigns that estimate it, and that find it not determined.
    bias, bias_std
        Mean error and its standard error, % of the true value.
    scatter, scatter_std
        Standard deviation of the estimates and its standard error, % of the true value.
    stated
        Root-mean-square of the stated standard uncertainties, % of the true value.
    coverage
        Part of the 95 % intervals that contain the true value.
    """

    true: float
    unit: str
    estimated: int
    undetermined: int
    bias: float | None
    bias_std: float | None
    scatter: float | None
    scatter_std: float | None
    stated: float | None
    coverage: Share

    @property
    def is_biased(self) -> bool:
        """Whether the bias is significant: Student's t with the two-sided probability of three standard deviations."""
        if self.bias is None or self.bias_std is None:
            return False
        return bool(abs(self.bias) > t.isf(_SIGNIFICANT / 2, self.estimated - 1) * self.bias_std)


def share(count: int, of: int) -> Share:
    """Return a part of all campaigns, with Wilson's interval of its probability.

    Parameters
    ----------
    count, of
        Number of campaigns, and of all.

    Returns
    -------
    Share

    Notes
    -----
    E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209.

    Examples
    --------
    >>> found = share(190, 200)
    >>> found.part, round(found.low, 3), round(found.high, 3)
    (0.95, 0.91, 0.973)
    """
    if not of:
        return Share(0, 0, 0.0, 0.0, 1.0)
    part, square = count / of, NORMAL_95**2
    middle = (part + square / (2 * of)) / (1 + square / of)
    half = NORMAL_95 * np.sqrt(part * (1 - part) / of + square / (4 * of**2)) / (1 + square / of)
    return Share(count, of, part, max(float(middle - half), 0.0), min(float(middle + half), 1.0))


def accuracy_of(name: str, true: float, rows: Sequence[Row]) -> ParameterAccuracy:
    """Return the accuracy of the estimates of one parameter.

    Parameters
    ----------
    name
        Of the parameter.
    true
        Its true value, SI.
    rows
        Of the campaigns with a result.

    Returns
    -------
    ParameterAccuracy
    """
    known = [row for row in rows if row["verdict"] != "reject"]
    found = [(row[name], row[f"{name}_std"]) for row in known if row[name] is not None and row[f"{name}_std"]]
    undetermined = sum(row[name] is None for row in known)
    parameter = PARAMETERS[name]
    pairs: NDArray[np.float64] = np.array(found, dtype=float).reshape(-1, 2)
    values, stds = pairs[:, 0], pairs[:, 1]
    # Intervals are those of `sprung.uncertainty.Estimate`: even in the logarithm of a positive parameter.
    with np.errstate(divide="ignore", invalid="ignore"):
        distances = np.log(values / true) * values / stds if parameter.positive else (values - true) / stds
    coverage = share(int((np.abs(distances) <= NORMAL_95).sum()), len(found))
    if len(found) < 2:
        nothing = (None, None, None, None, None)
        return ParameterAccuracy(true, parameter.unit, len(found), undetermined, *nothing, coverage)
    size = abs(true) or 1.0
    errors = 100 * (values - true) / size
    scatter = float(errors.std(ddof=1))
    return ParameterAccuracy(
        true,
        parameter.unit,
        len(found),
        undetermined,
        float(errors.mean()),
        float(scatter / np.sqrt(len(found))),
        scatter,
        float(scatter / np.sqrt(2 * (len(found) - 1))),
        float(np.sqrt(np.mean((100 * stds / size) ** 2))),
        coverage,
    )

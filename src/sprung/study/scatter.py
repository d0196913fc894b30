"""How far several vehicles of one kind scatter beyond what their uncertainties explain, and which one stands out."""

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
"""Values below which nothing is said of their scatter."""

_STANDS_OUT = 0.05


@shown
@dataclass(frozen=True, slots=True)
class ScatterEstimate:
    """One quantity over several results.

    Attributes
    ----------
    names
        Labels of the results that tell it.
    mean, mean_std
        Mean, each value weighted by how sure it is and how far all scatter, and its standard uncertainty; in the quantity's
        unit.
    spread
        Standard deviation from vehicle to vehicle, beyond the stated uncertainties; 0 where these explain all. In the
        quantity's unit.
    p
        Chance of as much scatter if all were the same; dimensionless.
    furthest
        The label of the result furthest from the others, in terms of its own uncertainty and of how far they scatter.
    distance
        How far that is: Student's t with two degrees of freedom less than there are results; dimensionless.
    p_holm
        Chance of one so far among so many, corrected for their number and that of the quantities; dimensionless.
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
        """Whether the furthest is further than the scatter of the others lets one expect, at 5 %."""
        return self.p_holm <= _STANDS_OUT


def estimate_scatter(quantities: Mapping[str, Sequence[tuple[str, float, float]]]) -> dict[str, ScatterEstimate]:
    """Describe the scatter of several quantities.

    Parameters
    ----------
    quantities
        By name of the quantity: label, value and standard uncertainty of each result that tells it, in the quantity's unit.

    Returns
    -------
    dict
        By name, of those that three results or more tell.

    Notes
    -----
    The spread between vehicles is the method of moments' (R. DerSimonian, N. Laird, Controlled Clin. Trials 7 (1986) 177): no
    iteration, never negative. How far one is from the others is told from a mean and spread that it did not touch.
    """
    described = {name: _described(rows) for name, rows in quantities.items() if len(rows) >= FEWEST}
    corrected = holm([min(1.0, one.p_holm * len(one.names)) for one in described.values()])
    return {name: replace(one, p_holm=chance) for (name, one), chance in zip(described.items(), corrected, strict=True)}


def _described(rows: Sequence[tuple[str, float, float]]) -> ScatterEstimate:
    values, stds = np.array([row[1] for row in rows]), np.array([row[2] for row in rows])
    mean, mean_std, spread, size = _pooled(values, stds)
    apart = []
    for i in range(len(rows)):
        others = np.arange(len(rows)) != i
        middle, of_middle, among, _ = _pooled(values[others], stds[others])
        apart.append((values[i] - middle) / np.sqrt(stds[i] ** 2 + of_middle**2 + among**2))
    furthest = int(np.argmax(np.abs(apart)))
    alone = float(2 * t.sf(abs(apart[furthest]), len(rows) - 2))
    return ScatterEstimate(
        names=tuple(row[0] for row in rows),
        mean=mean,
        mean_std=mean_std,
        spread=spread,
        p=float(chi2.sf(size, len(rows) - 1)),
        furthest=rows[furthest][0],
        distance=float(apart[furthest]),
        p_holm=alone,
    )


def _pooled(values: Real, stds: Real) -> tuple[float, float, float, float]:
    """Give mean, its standard uncertainty, the spread beyond what is stated, and the chi-square of all being the same."""
    weights = 1 / stds**2
    size = float(np.sum(weights * (values - np.average(values, weights=weights)) ** 2))
    beyond = weights.sum() - np.sum(weights**2) / weights.sum()
    between = max(0.0, (size - (len(values) - 1)) / beyond)
    wide = 1 / (stds**2 + between)
    return float(np.average(values, weights=wide)), float(wide.sum() ** -0.5), float(np.sqrt(between)), size


def complete_rows(rows: Iterable[tuple[str, float | None, float | None]]) -> list[tuple[str, float, float]]:
    """Keep what has a value and an uncertainty of its own.

    Parameters
    ----------
    rows
        Label, value and standard uncertainty of each result, in one unit.
    """
    return [(label, value, std) for label, value, std in rows if value is not None and std]

"""Drops of several vehicles: one explains some of the drops, another one the rest, and none explains all of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import FitResult
from sprung.selection.search import ModelSearch

Groups: TypeAlias = tuple[tuple[str, ...], tuple[str, ...]]
"""The names of the recordings of two vehicles; the first one has the first of all."""

_FEWEST = 3
"""Drops of each vehicle at the least: fewer are single mishaps, which are looked for drop by drop."""

_WITHIN = 0.5
"""Share of the misfit that may be within drops: what is left of it with a vehicle for each."""

_BETWEEN, _PARTLY = 0.1, 0.75
"""Share of the misfit between drops that two linear vehicles may leave, and two nonlinear ones by their linear parts."""

_ROUNDS = 4


def divide_drops(search: ModelSearch, *, partly: bool = False) -> Groups | None:
    """Divide the drops between two vehicles, if that explains what one leaves.

    What a model lacks shows within each drop above all, while other vehicles show between them. A nonlinear vehicle may seem
    another one with each load, so that some load has to have drops of both.

    Parameters
    ----------
    search
        A linear model and its fit, which does not explain the recordings.
    partly
        Whether the vehicles may have more than the model: what it leaves within drops counts for nothing, and whether two
        explain the recordings is to be confirmed.

    Returns
    -------
    tuple or None
        None where two vehicles explain much less than a vehicle for each drop does; partly, hardly more than one.
    """
    return _divided(search, np.inf, _PARTLY) if partly else _divided(search, _WITHIN, _BETWEEN)


def of_group(search: ModelSearch, files: Collection[str]) -> ModelSearch:
    """Fit the same linear model to some drops alone.

    Parameters
    ----------
    search
        Of all drops.
    files
        The names of their recordings.

    Returns
    -------
    ModelSearch
    """
    decays = [decay for decay in search.decays if decay.file in files]
    return replace(search, decays=decays).refit(search.structure)


def _divided(search: ModelSearch, most_within: float, most_between: float) -> Groups | None:
    """Divide the drops, given the most that may be left within them and between those of a vehicle, as parts."""
    files = [decay.file for decay in search.decays]
    if len(files) < 2 * _FEWEST or not (search.sensor_noise > 0).any():
        return None
    misfit = _misfit(search, search.fit)
    within = _left_by_each(search, files, most_within * misfit)
    between = misfit - sum(within.values())
    if between < max(1 - most_within, 0.0) * misfit:
        return None
    first = _alike_the_first(search, within)
    for _ in range(_ROUNDS):
        second = [file for file in files if file not in first]
        if min(len(first), len(second)) < _FEWEST:
            return None
        vehicles = [of_group(search, group) for group in (first, second)]
        nearer = [file for file, is_second in zip(files, _nearest(search, vehicles), strict=True) if not is_second]
        if nearer == first:
            left = sum(_misfit(search, one.fit) for one in vehicles) - sum(within.values())
            loads = [{decay.load for decay in one.decays} for one in vehicles]
            is_divided = left <= most_between * between and set.intersection(*loads)
            return (tuple(first), tuple(second)) if is_divided else None
        first = nearer
    return None


def _misfit(search: ModelSearch, fit: FitResult) -> float:
    """Return what a fit of some drops leaves beyond the noise of the sensors, in twice the log-likelihood."""
    known = search.sensor_noise > 0
    counts = fit.problem.objective.observations[:, known]
    variances = fit.residual_sums[:, known] / np.maximum(counts, 1.0)
    return float(np.sum(counts * np.log(np.maximum(variances / search.sensor_noise[known], 1.0))))


def _left_by_each(search: ModelSearch, files: Sequence[str], most: float) -> dict[str, float]:
    """Return by drop the misfit that a vehicle of its own leaves; not of all drops where that is too much."""
    left: dict[str, float] = {}
    for file in files:
        left[file] = _left_in(search, [file])
        if sum(left.values()) > most:
            break
    return left


def _left_in(search: ModelSearch, files: Collection[str]) -> float:
    """Return the misfit that a vehicle of their own leaves in some drops."""
    return _misfit(search, of_group(search, files).fit)


def _alike_the_first(search: ModelSearch, within: Mapping[str, float]) -> list[str]:
    """Return the half of the drops that share a vehicle best with the first one, by what it leaves more than one for each."""
    first, *others = within
    more = {file: _left_in(search, [first, file]) - within[first] - within[file] for file in others}
    alike = sorted(others, key=lambda file: more[file])[: len(within) // 2 - 1]
    return [file for file in within if file == first or file in alike]


def _nearest(search: ModelSearch, vehicles: Sequence[ModelSearch]) -> NDArray[np.intp]:
    """Return by drop which of some vehicles explains it best, shape (drop,)."""
    weights = np.divide(1.0, search.sensor_noise, out=np.zeros_like(search.sensor_noise), where=search.sensor_noise > 0)
    costs = np.array([vehicle.fit.residual_sums_of(search.decays) @ weights for vehicle in vehicles])
    nearest: NDArray[np.intp] = np.argmin(costs, axis=0)
    return nearest

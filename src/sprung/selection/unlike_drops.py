"""Drops that are unlike all others beside nonlinear terms: another load than stated, a passenger, a brake, another vehicle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from sprung.selection.search import ModelSearch

Real = NDArray[np.float64]

_WORSE = 3.0
"""What a drop leaves over what the median one does, from which it is unlike the others: geometric mean of its squares and of
their part of those of its motion."""

_MOST = 0.25
"""Part of all drops that are unlike the others at the most: where more of them are, it is the model."""

_LEFT = 0.5
"""Part of their model error that the other drops may leave once these are left out, or have another load."""

_ITERATIONS = 22
"""Of the fits that confirm it, at the most."""


class UnlikeDrops(NamedTuple):
    """Drops that are unlike all others.

    Attributes
    ----------
    recordings
        The names of their recordings.
    loads
        By recording the load with which they are like the others; empty where none makes them so.
    others
        The recordings of all others, where another vehicle explains these; else empty.
    """

    recordings: tuple[str, ...]
    loads: Mapping[str, str]
    others: tuple[str, ...] = ()


def find_unlike_drops(search: ModelSearch) -> UnlikeDrops | None:
    """Find the few drops that a nonlinear model explains far worse than all others.

    Parameters
    ----------
    search
        A nonlinear model and its fit, of the decays or of their beginnings.

    Returns
    -------
    UnlikeDrops or None
        None where no drop stands out, and where the other drops are explained no better without those that do.
    """
    decays = search.decays
    unlike = outstanding_drops(search)
    if not 0 < len(unlike) <= _MOST * len(decays):
        return None
    names = tuple(decays[drop].file for drop in unlike)
    loads = sorted({decay.load for decay in decays})
    kept = [drop for drop in range(len(decays)) if drop not in unlike]
    if len(loads) == 2:
        other = dict(zip(loads, loads[::-1], strict=True))
        changed = {decays[drop].file: other[decays[drop].load] for drop in unlike}
        relabelled = [replace(decay, load=changed.get(decay.file, decay.load)) for decay in decays]
        exchanged = replace(search, decays=relabelled).refit(search.structure, _ITERATIONS, beginning_only=True)
        if not outstanding_drops(exchanged) and _part_left(search, exchanged, kept, kept) < _LEFT:
            return UnlikeDrops(names, changed)
    without = replace(search, decays=[decays[drop] for drop in kept]).refit(
        search.structure, _ITERATIONS, beginning_only=True, states=search.fit.states[kept]
    )
    is_confirmed = _part_left(search, without, kept, range(len(kept))) < _LEFT
    return UnlikeDrops(names, {}) if is_confirmed else None


def outstanding_drops(search: ModelSearch) -> list[int]:
    """Return the drops, by their positions, that leave much more than the median one, by itself and over their motion.

    Parameters
    ----------
    search
        A model and its fit.
    """
    left = np.array([_squares(residual, search.fit.weights) for residual in search.fit.residuals])
    moved = np.array([_squares(fitted, search.fit.weights) for fitted in search.fit.fitted])
    own, over_motion = (part / np.median(part) for part in (left, left / moved))
    return [int(drop) for drop in np.flatnonzero(np.sqrt(own * over_motion) > _WORSE)]


def _part_left(before: ModelSearch, after: ModelSearch, own: Sequence[int], others: Sequence[int]) -> float:
    """Return the part of the model error of some drops that another fit leaves, in which they have other positions."""
    noise = before.sensor_noise
    known = noise > 0
    errors = []
    for search, drops in ((before, own), (after, others)):
        residuals = np.concatenate([search.fit.residuals[drop] for drop in drops], axis=1)[known]
        errors.append(float(np.maximum(np.nanmean(residuals**2, axis=1) / noise[known] - 1, 0.0).sum()))
    return errors[1] / max(errors[0], np.finfo(float).tiny)


def _squares(records: Real, weights: Real) -> float:
    """Return the mean of the squares of records, shape (channel, time), over the variances of their noise."""
    return float(np.nan_to_num(np.mean(records**2, axis=1)) @ weights)

"""Two channels exchanged: where the records make no sense as they are, and do with two of them changed about."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.identification import Summit
from sprung.prepare import Decay

Real = NDArray[np.float64]

_SENSELESS = 1.5
"""Residuals over the noise at rest from which the records may make no sense as they are."""

_EXPLAINED = 1.3
"""Residuals over the noise at rest below which they do."""


def undo_exchange(
    decays: Sequence[Decay], channels: Sequence[str], found: Summit, fit: Callable[[Sequence[Decay]], Summit]
) -> tuple[tuple[Decay, ...], Summit]:
    """Change two channels about where this, and nothing else of the kind, explains the records.

    Parameters
    ----------
    decays
        As they were recorded.
    channels
        The channels' names.
    found
        Where the fit of them ended.
    fit
        Fits decays from scratch.

    Returns
    -------
    decays
        With a fault in the first one if two channels were changed about.
    summit
        Where the fit of these ends.
    """
    rests = [decay.rest.noise for decay in decays if decay.rest.noise.shape[1] > 1]
    if not rests:
        return tuple(decays), found
    pooled = np.concatenate(rests, axis=1)
    at_rest = np.sqrt(np.nanmean(pooled**2, axis=1))
    if not np.all(at_rest > 0) or not np.nanmax(found.noise / at_rest) > _SENSELESS:
        return tuple(decays), found
    explained = []
    for pair in combinations(range(len(channels)), 2):
        order = np.arange(len(channels))
        order[list(pair)] = pair[::-1]
        changed = tuple(_changed(decay, order) for decay in decays)
        summit = fit(changed)
        if np.nanmax(summit.noise / at_rest[order]) < _EXPLAINED:
            explained.append((pair, changed, summit))
    if len(explained) != 1:
        return tuple(decays), found
    (first, second), changed, summit = explained[0]
    fault = Fault(
        "exchanged",
        f"{channels[first]}, {channels[second]}",
        "changed about, they fit the vehicle and the other channels, which as recorded they do not; that was done",
        "Exchange the two in the campaign file, or their cables.",
    )
    return (replace(changed[0], faults=(*changed[0].faults, fault)), *changed[1:]), summit


def _changed(decay: Decay, order: NDArray[np.int64]) -> Decay:
    rest = decay.rest._replace(level=decay.rest.level[order], noise=decay.rest.noise[order])
    return replace(decay, values=decay.values[order], earlier=decay.earlier[order], rest=rest)

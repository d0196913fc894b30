"""Gravity at rest: a sensor that reads it upside down, or in another unit than its neighbours, is put right."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.prepare.release import Release, Rest
from sprung.recording import Recording
from sprung.units import STANDARD_GRAVITY

Real = NDArray[np.float64]

_NEAR = 0.1
"""Part of gravity by which tilt and offset may change what a sensor reads at rest."""

_READINGS = (
    (-1.0, "sign", "reads gravity downward", "was turned over", 'Set direction = "down" for it in the campaign file.'),
    (
        STANDARD_GRAVITY,
        "unit",
        "reads gravity as 1",
        "was taken to be in g",
        'Set unit = "g" for it in the campaign file.',
    ),
    (
        1e-3,
        "unit",
        "reads gravity as 9800",
        "was taken to be in mm/s²",
        'Set unit = "mm/s^2" for it in the campaign file.',
    ),
)
"""Factor that puts a channel right, the fault's code, what is seen, what was done, and what the user can do."""


def put_right(
    recordings: Sequence[Recording], releases: Sequence[Release | None]
) -> tuple[list[Recording], list[Release | None]]:
    """Put right the channels whose rest shows beyond doubt that their sign or unit is another one.

    Parameters
    ----------
    recordings
        As they were read.
    releases
        The release in each, with what the sensors read before it.

    Returns
    -------
    recordings
        With a fault for each channel that was changed.
    releases
        With what those channels read before it, changed likewise.

    Notes
    -----
    Only sensors that feel gravity tell; a channel is changed where most of the others read gravity as it is, and where it
    reads the same wrong thing in every drop that has a rest.
    """
    levels = np.array([release.rest.level for release in releases if release is not None])
    if not levels.size:
        return list(recordings), list(releases)
    usual = np.abs(levels / STANDARD_GRAVITY - 1) < _NEAR
    most = np.sum(usual.all(axis=0)) > levels.shape[1] / 2
    factors, faults = np.ones(levels.shape[1]), []
    for factor, code, seen, done, do in _READINGS:
        like_it = (np.abs(levels * factor / STANDARD_GRAVITY - 1) < _NEAR) | np.isnan(levels)
        for channel in np.flatnonzero(like_it.all(axis=0) & ~np.isnan(levels).all(axis=0)) if most else ():
            factors[channel] = factor
            name = recordings[0].channels[channel]
            faults.append(
                Fault(code, name, f"at rest it {seen}, where the other channels read 9.8 m/s²; it {done}", do)
            )
    if not faults:
        return list(recordings), list(releases)
    changed = [replace(one, values=one.values * factors[:, None]) for one in recordings]
    changed[0] = replace(changed[0], faults=(*changed[0].faults, *faults))
    return changed, [None if one is None else _changed(one, factors) for one in releases]


def _changed(release: Release, factors: Real) -> Release:
    return Release(release.sample, Rest(release.rest.level * factors, release.rest.noise * factors[:, None]))

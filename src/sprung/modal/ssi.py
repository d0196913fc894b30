"""Stochastic subspace identification, with covariances and with data, for free decays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from sprung.modal.identified import ModeSet
from sprung.modal.selection import Task
from sprung.modal.subspace import realised
from sprung.modal.thinning import triangle

_ROWS = 300
"""Rows of past and future together at the most."""


def subspace_by_covariances(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify the modes common to several free decays from the covariances of later samples with earlier ones.

    All covariances are summed over the same samples, whatever their lag. The factor 1/(N - k) that makes those of stationary
    noise unbiased would reshape a decay, which is not stationary: with it the poles are wrong even without noise.

    Parameters
    ----------
    records, rate, order
        As for `eigensystem_realisation`.

    Returns
    -------
    Modes
        Exact without noise, repeated and real poles too.

    Raises
    ------
    InputError
        As `eigensystem_realisation`.

    References
    ----------
    B. Peeters and G. De Roeck, Mech. Syst. Signal Process. 13 (1999) 855, section 3.2.
    """
    task = Task.of(records, rate, order, "ssi-cov")
    hankel, rows = _past_and_future(task)
    covariances = hankel[rows:] @ hankel[:rows].T
    left = np.linalg.svd(covariances, full_matrices=False)[0]
    return task.modes(realised(left[:, : task.order], task.thinned))


def subspace_by_data(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify the modes common to several free decays from the projection of later samples on earlier ones.

    Parameters
    ----------
    records, rate, order
        As for `eigensystem_realisation`.

    Returns
    -------
    Modes
        Exact without noise, repeated and real poles too.

    Raises
    ------
    InputError
        As `eigensystem_realisation`.

    References
    ----------
    P. Van Overschee and B. De Moor, Automatica 29 (1993) 649; unweighted principal components.
    """
    task = Task.of(records, rate, order, "ssi-data")
    hankel, rows = _past_and_future(task)
    lower = triangle(hankel.T).T
    left = np.linalg.svd(lower[rows:, :rows], full_matrices=False)[0]
    return task.modes(realised(left[:, : task.order], task.thinned))


def _past_and_future(task: Task) -> tuple[np.ndarray[tuple[int, int], np.dtype[np.float64]], int]:
    """Stack past over future of all records, and count the rows of the past."""
    thinned = task.thinned
    rows = (thinned.shifted(_ROWS) + 1) // 2 * thinned.channels
    task.allow(rows - thinned.channels)
    return np.hstack(thinned.hankel(2 * (rows // thinned.channels) - 1)), rows

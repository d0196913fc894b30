"""Stochastic subspace identification, with covariances and with data, for free decays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from sprung.modal.decimation import triangular_factor
from sprung.modal.identification_task import IdentificationTask
from sprung.modal.mode_set import ModeSet
from sprung.modal.subspace import realise_poles

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
    ModeSet
        Exact without noise, repeated and real poles too.

    Raises
    ------
    InputError
        As `eigensystem_realisation`.

    References
    ----------
    B. Peeters and G. De Roeck, Mech. Syst. Signal Process. 13 (1999) 855, section 3.2.
    """
    task = IdentificationTask.of(records, rate, order, "ssi-cov")
    hankel, rows = _past_and_future(task)
    covariances = hankel[rows:] @ hankel[:rows].T
    left = np.linalg.svd(covariances, full_matrices=False)[0]
    return task.modes(realise_poles(left[:, : task.order], task.decimated))


def subspace_by_data(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify the modes common to several free decays from the projection of later samples on earlier ones.

    Parameters
    ----------
    records, rate, order
        As for `eigensystem_realisation`.

    Returns
    -------
    ModeSet
        Exact without noise, repeated and real poles too.

    Raises
    ------
    InputError
        As `eigensystem_realisation`.

    References
    ----------
    P. Van Overschee and B. De Moor, Automatica 29 (1993) 649; unweighted principal components.
    """
    task = IdentificationTask.of(records, rate, order, "ssi-data")
    hankel, rows = _past_and_future(task)
    lower = triangular_factor(hankel.T).T
    left = np.linalg.svd(lower[rows:, :rows], full_matrices=False)[0]
    return task.modes(realise_poles(left[:, : task.order], task.decimated))


def _past_and_future(task: IdentificationTask) -> tuple[np.ndarray[tuple[int, int], np.dtype[np.float64]], int]:
    """Stack past over future of all records, and count the rows of the past."""
    decimated = task.decimated
    rows = (decimated.shifts_within(_ROWS) + 1) // 2 * decimated.channels
    task.allow(rows - decimated.channels)
    return np.hstack(decimated.hankel(2 * (rows // decimated.channels) - 1)), rows

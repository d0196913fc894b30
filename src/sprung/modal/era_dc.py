"""Eigensystem realisation from correlations of the free decays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from sprung.modal.identification_task import IdentificationTask
from sprung.modal.mode_set import ModeSet
from sprung.modal.subspace import realise_poles

_ROWS = 300
"""Rows of the block Hankel matrix at the most, correlated ones among them."""

_OWN = 2
"""Block rows that are correlated with each other: the rest of the delays go into the correlations."""


def realisation_by_correlations(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify the modes common to several free decays from the correlations of their block Hankel matrices.

    R(j) = H(j) H(0)ᵀ, with H(j) some block rows of all records delayed by j lags, is a decay itself, of the same poles. The
    R(j) are stacked into a block Hankel matrix in turn. White noise is only in those whose rows overlap; they are left out.

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
    J.-N. Juang, J. E. Cooper and J. R. Wright, Control Theory Adv. Technol. 4 (1988) 5.
    """
    task = IdentificationTask.of(records, rate, order, "era-dc")
    decimated, channels = task.decimated, task.decays.channels
    own = min(_OWN, max(decimated.shifts_within(_ROWS) // 3, 1))
    rows = own * channels
    shifts = decimated.shifts_within(_ROWS)
    delays = shifts + 1 - own  # of H(j), j = 0 ... delays
    first = own if delays - own >= 3 else 0
    half = (delays - first) // 2
    task.allow(half * rows)
    hankel = np.hstack(decimated.hankel(shifts))
    correlations = hankel @ hankel[:rows].T
    blocks = [correlations[j * channels : j * channels + rows] for j in range(first, delays + 1)]
    stacked = np.vstack([np.hstack(blocks[i : i + len(blocks) - half]) for i in range(half + 1)])
    left = np.linalg.svd(stacked, full_matrices=False)[0]
    return task.modes(realise_poles(left[:, : task.order], decimated, rows))

"""Recursions of delayed samples: the State Variable Method with several block rows, and Ibrahim's time domain method."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.modal.identification_task import IdentificationTask
from sprung.modal.mode_set import ModeSet
from sprung.modal.subspace import poles_of_transition

Real = NDArray[np.float64]

_ROWS = 150
"""Rows of delayed samples at the most."""


class _States(NamedTuple):
    """States before and after a lag, and what the channels see of them; shapes (order, time), (channel, order)."""

    before: Real
    after: Real
    seen: Real


def state_variables_in_rows(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify modes by the paper's recursion, eqs. (5) to (11), with a longer lag and as many block rows as the records allow.

    The state {X(k), X(k + 1)} of eq. (6) gets further delayed samples, half a period of the slowest motion in all, and its
    principal components take its place, as many as there are poles: noise that fills the others is left out of the regressor
    of eq. (10), and biases it less.

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
    """
    task = IdentificationTask.of(records, rate, order, "svm-rows")
    states = _states(task)
    transition = np.linalg.lstsq(states.before.T, states.after.T, rcond=None)[0].T
    return task.modes(poles_of_transition(np.asarray(transition, dtype=float), states.seen, task.decimated))


def ibrahim_time_domain(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify modes by Ibrahim's time domain method with double least squares.

    The transition matrix is the mean of the two least squares solutions Φ̄Φᵀ(ΦΦᵀ)⁻¹ and Φ̄Φ̄ᵀ(ΦΦ̄ᵀ)⁻¹: white noise makes the
    damping of one too large and that of the other too small.

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
    S. R. Ibrahim and E. C. Mikulcik, Shock Vib. Bull. 47 (1977) 183; double least squares after S. R. Ibrahim, AIAA J. 24
    (1986) 1028.
    """
    task = IdentificationTask.of(records, rate, order, "itd")
    before, after, seen = _states(task)
    biased_up = np.linalg.solve((before @ before.T).T, (after @ before.T).T).T
    biased_down = np.linalg.solve((before @ after.T).T, (after @ after.T).T).T
    return task.modes(poles_of_transition((biased_up + biased_down) / 2, seen, task.decimated))


def _states(task: IdentificationTask) -> _States:
    """Return principal components of delayed samples, each of variance 1 over all records."""
    decimated, channels = task.decimated, task.decays.channels
    shifts = decimated.shifts_within(_ROWS)
    task.allow(shifts * channels)
    hankel = np.hstack(decimated.hankel(shifts))
    left, singular, right = np.linalg.svd(hankel[:-channels], full_matrices=False)
    basis, sizes = left[:, : task.order], singular[: task.order]
    after = (basis / sizes).T @ hankel[channels:]
    return _States(
        right[: task.order], np.asarray(after, dtype=float), np.asarray(basis[:channels] * sizes, dtype=float)
    )

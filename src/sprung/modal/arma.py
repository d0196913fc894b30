"""Autoregression with a moving average: noise in the regressor is got rid of by instruments older than it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from sprung.modal.identification_task import IdentificationTask
from sprung.modal.mode_set import ModeSet
from sprung.modal.subspace import poles_of_transition

_RANK_TOLERANCE = 1e-15
"""Singular value, as a part of the largest, that is rounding."""

_OVERSIZE = 2
"""Times the lags that the order asks for: the ones too many take up noise."""


def autoregression(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify modes as poles of a vector autoregressive moving-average process.

    A sum of decays satisfies X(k) = Σ Aᵢ X(k - i); white noise on it makes the right side a moving average of the same length.
    Samples older than that are not correlated with it: as instruments (the modified Yule-Walker equations) they leave the
    autoregressive part without the bias of least squares.

    Parameters
    ----------
    records, rate, order
        As for `eigensystem_realisation`. The model has more poles; those that explain most of the records are kept.

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
    P. Stoica, T. Söderström and B. Friedlander, IEEE Trans. Autom. Control 30 (1985) 1066.
    """
    task = IdentificationTask.of(records, rate, order, "arma")
    decimated, channels = task.decimated, task.decays.channels
    longest = max((decimated.shortest // decimated.step - 2) // 3, 1)
    task.allow(longest * channels)
    lags = min(_OVERSIZE * -(-task.order // channels), longest)
    hankel = np.hstack(decimated.hankel(2 * lags))
    instruments, regressors, target = np.split(hankel, [lags * channels, 2 * lags * channels])
    left, singular, right = np.linalg.svd(regressors @ instruments.T)
    kept = min(task.order, int(np.sum(singular > _RANK_TOLERANCE * singular[0])))
    inverse = (right[:kept].T / singular[:kept]) @ left[:, :kept].T
    coefficients = target @ instruments.T @ inverse
    companion = np.eye(lags * channels, k=channels)
    companion[-channels:] = coefficients
    return task.modes(poles_of_transition(companion, np.eye(channels, lags * channels), decimated))

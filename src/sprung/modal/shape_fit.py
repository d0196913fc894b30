"""Mode shapes for given poles: the contribution of each pole to every channel of every record, and its rank."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.modal.decimation import DecimatedRecords
from sprung.modal.likelihood import Poles
from sprung.vibration import exponentials

Complex = NDArray[np.complex128]

_ANOTHER = 6.0
"""Standard errors by which a second shape of one pole must exceed noise."""

_LEAST = 1e-3
"""Part of the first that a second shape must be: close poles leave rounding that looks like one."""


def fit_shapes(decimated: DecimatedRecords, exponent: Complex) -> Poles:
    """Fit shapes to given poles: every channel's contribution by least squares, then the shapes common to all records.

    The contributions of a pole, a matrix of channels by records, are the product of its shape and its amplitudes. A repeated
    pole has as many shapes as that matrix has ranks, and comes back as often.

    Parameters
    ----------
    decimated
        The records.
    exponent
        λ per sample of the records as they were, of one of each conjugate pair, none twice; shape (pole,).
    """
    every = np.concatenate([exponent, exponent[exponent.imag != 0].conj()]) * decimated.every
    contributions, errors, squares, freedom = [], [], 0.0, 0
    for record in decimated.records:
        motion = exponentials(every, record.shape[1])
        motion = motion - motion.mean(axis=0)
        sizes = np.linalg.norm(motion, axis=0)
        inverse = np.linalg.pinv(motion / sizes, rcond=1e-14) / sizes[:, None]
        values = (record - record.mean(axis=1, keepdims=True)).T
        found = inverse @ values
        contributions.append(found)
        errors.append(np.linalg.norm(inverse, axis=1))
        squares += float((np.abs(values - motion @ found) ** 2).sum())
        freedom += values.size
    noise = np.sqrt(max(squares / freedom, 1e-300))
    poles, shapes = [], []
    for j, pole in enumerate(exponent):
        # Channels have noise of one size here, and each contribution its own standard error.
        matrix = np.array([found[j] / error[j] for found, error in zip(contributions, errors, strict=True)]).T / noise
        left, strengths, _ = np.linalg.svd(matrix, full_matrices=False)
        limit = max(_ANOTHER * (np.sqrt(matrix.shape[0]) + np.sqrt(matrix.shape[1])), _LEAST * strengths[0])
        for k in range(max(int((strengths > limit).sum()), 1)):
            poles.append(pole)
            shapes.append(decimated.scale * left[:, k])
    return Poles.of(np.array(poles, dtype=np.complex128), np.stack(shapes, axis=1).astype(np.complex128))

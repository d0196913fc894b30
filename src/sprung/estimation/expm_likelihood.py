"""The likelihood the long way: by matrix exponentials, sample by sample, without modes.

At critical damping two modes meet in one shape and modal coordinates cease to exist, though nothing happens to the motion.
There, and only there, the fit takes this way: a hundred times slower, and indifferent to the eigenvalues.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sprung.vehicle import LinearModel, Rows, affine_response

Real = NDArray[np.float64]


def reach(state: int) -> Real:
    """Give how far from rest a decay may begin, in standard deviations: a metre or radian, and ten of them in a second.

    Parameters
    ----------
    state
        How many numbers a state {X, Ẋ} has.

    Returns
    -------
    ndarray
        Shape (state,).
    """
    return np.repeat([1.0, 10.0], state // 2)


class ExpmLikelihood(NamedTuple):
    """One drop, evaluated the long way.

    Attributes
    ----------
    residual, leverage
        Residual sum of squares, and how many of the initial states each channel pays for; shape (channel,).
    gradient
        Σ derivative · residual / σ²; shape (parameter,).
    information
        Initial states and offsets eliminated; shape (parameter, parameter).
    fitted
        What the model makes of the centred record; shape (channel, time).
    state
        {X, Ẋ} at the first sample, SI, shape (2n,) with n coordinates.
    """

    residual: Real
    leverage: Real
    gradient: Real
    information: Real
    fitted: Real
    state: Real


def evaluate_drop(
    model: LinearModel, sensors: Rows, values: Real, record: Real, rate: float, weights: Real
) -> ExpmLikelihood:
    """Evaluate the likelihood of one drop and its derivatives.

    Parameters
    ----------
    model
        Equations of motion with the load.
    sensors
        The sensors' rows.
    values
        Parameters, SI.
    record
        Centred record, shape (channel, time), m/s².
    rate
        Samples per second.
    weights
        1/σ² of each channel, zero for one that is left out; shape (channel,).

    Returns
    -------
    Longhand
    """
    channels, samples = record.shape
    lower, slopes = model.accelerations(values)
    n, size = lower.shape
    A = np.vstack([np.eye(n, size, n), lower])
    S = sensors.at(values)
    root = np.sqrt(weights)[:, None]

    def weighted(readings: Real) -> Real:
        """Centre and weigh readings of shape (..., channel, time), and string the channels together."""
        centred = readings - readings.mean(axis=-1, keepdims=True)
        flat: Real = (root * centred).reshape(*readings.shape[:-2], -1)
        return flat

    # What each initial state would look like at the sensors, orthonormalised.
    readings = (S @ lower)[None]
    propagator = expm(A / rate)
    while len(readings) < samples:
        readings = np.concatenate([readings, readings @ propagator])
        propagator = propagator @ propagator
    basis = weighted(readings[:samples].transpose(2, 1, 0)).T
    within_reach = np.vstack([basis, np.diag(1 / reach(size))])
    sizes = np.linalg.norm(within_reach, axis=0)
    orthonormal, triangle = np.linalg.qr(within_reach / sizes)
    target = np.append(weighted(record), np.zeros(size))
    state = np.linalg.solve(triangle, orthonormal.T @ target) / sizes
    left = target - orthonormal @ (orthonormal.T @ target)

    # How the readings from that state change with each parameter: Ẏ' = A Y' + dA Y, both propagated together.
    changes = []
    for dS, dlower in zip(np.swapaxes(sensors.slopes, 0, 1), slopes, strict=True):
        dA = np.vstack([np.zeros((n, size)), dlower])
        both = np.block([[A, np.zeros_like(A)], [dA, A]])
        motion = affine_response(both, np.zeros(2 * size), np.append(state, np.zeros(size)), 1 / rate, samples)
        changes.append((dS @ lower + S @ dlower) @ motion[:size] + S @ lower @ motion[size:])
    jacobian = np.vstack([weighted(np.array(changes)).T, np.zeros((size, len(changes)))])
    jacobian = jacobian - orthonormal @ (orthonormal.T @ jacobian)

    fitted = np.swapaxes(readings[:samples] @ state, 0, 1)
    fitted = (fitted - fitted.mean(axis=1, keepdims=True)) * (weights > 0)[:, None]
    return ExpmLikelihood(
        residual=np.sum((record - fitted) ** 2, axis=1),
        leverage=np.sum(orthonormal[:-size].reshape(channels, samples, -1) ** 2, axis=(1, 2)),
        gradient=jacobian.T @ left,
        information=jacobian.T @ jacobian,
        fitted=fitted,
        state=state,
    )

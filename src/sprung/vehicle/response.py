"""Exact response of the linear vehicle: the state at any time is a matrix exponential of the state at the start.

No time-stepping scheme and no eigenvectors stand between the equations of motion and these numbers, so repeated, real
and coinciding eigenvalues need no care, and they can serve as truth for everything that is fast.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import expm

from sprung.vehicle.kinematics import WHEELS, Wheel
from sprung.vehicle.model import Matrices

Array = NDArray[np.float64]


class Motion(NamedTuple):
    """Displacements, velocities and accelerations of the coordinates.

    Attributes
    ----------
    displacement, velocity, acceleration
        SI, shape (coordinate, time).
    """

    displacement: Array
    velocity: Array
    acceleration: Array


def affine_response(A: ArrayLike, constant: ArrayLike, state: ArrayLike, step: float, samples: int) -> Array:
    """Solve Ẏ = A Y + constant at equal steps, exactly.

    Parameters
    ----------
    A
        State matrix, shape (n, n), 1/s.
    constant
        Constant part, shape (n,).
    state
        Y at the first sample, shape (n,).
    step
        Sampling interval, s.
    samples
        How many samples, the first included.

    Returns
    -------
    ndarray
        Y, shape (n, samples).
    """
    A, state = np.asarray(A, dtype=float), np.asarray(state, dtype=float)
    size = state.size
    generator = np.zeros((size + 1, size + 1))
    generator[:size, :size] = A
    generator[:size, size] = constant
    propagator = expm(generator * step)
    states = np.append(state, 1.0)[:, None]
    # Doubling: the states known so far, all propagated at once, give as many again.
    while states.shape[1] < samples:
        states = np.hstack([states, propagator @ states])
        propagator = propagator @ propagator
    return states[:size, :samples]


def free_decay(matrices: Matrices, state: ArrayLike, step: float, samples: int) -> Motion:
    """Free vibration from any state, eq. (3) of the paper, sampled without error.

    Parameters
    ----------
    matrices
        M, C and K.
    state
        {X, Ẋ} at the first sample, shape (2n,) with n coordinates, m, rad, m/s, rad/s.
    step
        Sampling interval, s.
    samples
        How many samples.

    Returns
    -------
    Motion

    Examples
    --------
    >>> import numpy as np
    >>> unit = Matrices(np.eye(7), np.zeros((7, 7)), (2 * np.pi) ** 2 * np.eye(7))
    >>> bool(np.isclose(free_decay(unit, np.eye(14)[0], 0.25, 5).displacement[0, 4], 1.0))
    True
    """
    A, n = matrices.state, len(matrices.M)
    states = affine_response(A, np.zeros(2 * n), state, step, samples)
    return Motion(states[:n], states[n:], (A @ states)[n:])


def drive_over_half_sine_bump(
    matrices: Matrices,
    tyre_rates: dict[Wheel, tuple[float, float]],
    wheels: tuple[Wheel, ...],
    height: float,
    duration: float,
    step: float,
    samples: int,
) -> tuple[Motion, Array]:
    """Drive some wheels over a half-sine bump from rest, in closed form, and let the vehicle vibrate freely after it.

    Eq. (19) of the paper means z_g = 0.09 sin 5π(t - 0.1); as printed, sin 5πt, it would jump to 0.09 m at the start
    and end at -0.09 m.

    Parameters
    ----------
    matrices
        M, C and K.
    tyre_rates
        Tyre stiffness and damping under each wheel, N/m and N s/m.
    wheels
        The wheels that run over the bump, all at the same time.
    height
        Of the bump, m.
    duration
        Of the passage, s.
    step
        Sampling interval, s.
    samples
        How many samples, the first at the start of the bump.

    Returns
    -------
    Motion
        From the start of the bump on.
    ndarray
        State {X, Ẋ} at the end of the bump, shape (2n,): where the free decay starts.
    """
    omega, n = np.pi / duration, len(matrices.M)
    force = np.zeros(n, dtype=complex)
    for station in wheels:
        stiffness, damping = tyre_rates[station]
        force[3 + WHEELS.index(station)] = height * (stiffness + 1j * omega * damping)
    dynamic = matrices.K - omega**2 * matrices.M + 1j * omega * matrices.C
    steady = np.linalg.solve(dynamic, force)  # X = Im(steady exp(iωt)) answers the sine
    orbit = np.concatenate([steady, 1j * omega * steady])
    A = matrices.state

    during = min(samples, int(np.ceil(duration / step - 1e-9)))
    transient = -orbit.imag
    times = step * np.arange(during)
    forced = (orbit[:, None] * np.exp(1j * omega * times)).imag + affine_response(
        A, np.zeros(2 * n), transient, step, during
    )
    at_end = (orbit * np.exp(1j * omega * duration)).imag + expm(A * duration) @ transient
    after = expm(A * (during * step - duration)) @ at_end
    states = np.hstack([forced, affine_response(A, np.zeros(2 * n), after, step, max(samples - during, 1))])[
        :, :samples
    ]

    acceleration = (A @ states)[n:]
    ground = (force[:, None] * np.exp(1j * omega * times)).imag
    acceleration[:, :during] += np.linalg.solve(matrices.M, ground)
    return Motion(states[:n], states[n:], acceleration), at_end

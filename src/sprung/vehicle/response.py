"""Exact response of the linear vehicle: the state at any time is a matrix exponential of the state at the start.

Neither a time-stepping scheme nor eigenvectors are used, so repeated and real eigenvalues need no special care, and these
responses are the reference for everything faster.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import expm

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

    @classmethod
    def of_states(cls, A: Array, states: Array, coordinates: int) -> Motion:
        """Return the motion of states {X, Ẋ} of n coordinates, shape (state, time), whose rate is A times them."""
        rates = A @ states
        return cls(states[:coordinates], rates[:coordinates], (A @ rates)[:coordinates])


def after_rest(motion: Motion, samples: int) -> Motion:
    """Return a motion after a rest at the displacements with which it begins.

    Parameters
    ----------
    motion
        SI, shape (coordinate, time) each.
    samples
        Of the rest.

    Returns
    -------
    Motion
    """
    before = ((0, 0), (samples, 0))
    still = (np.pad(part, before) for part in motion[1:])
    return Motion(np.pad(motion.displacement, before, "edge"), *still)


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
    # Doubling: one product propagates all states known so far, which doubles their number.
    # A vehicle that a search passes through may be unstable: its motion has no bounds.
    with np.errstate(over="ignore", invalid="ignore"):
        while states.shape[1] < samples:
            states = np.hstack([states, propagator @ states])
            propagator = propagator @ propagator
    return states[:size, :samples]


def free_decay(matrices: Matrices, state: ArrayLike, step: float, samples: int) -> Motion:
    """Return the free vibration from any state, eq. (3) of the paper, exact at every sample.

    Parameters
    ----------
    matrices
        M, C and K.
    state
        {X, Ẋ} at the first sample, shape (n + m,): velocities of the m coordinates with mass; m, rad, m/s, rad/s.
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
    A = matrices.state
    return Motion.of_states(A, affine_response(A, np.zeros(len(A)), state, step, samples), len(matrices.M))

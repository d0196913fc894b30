"""The response to a half-sine bump under some wheels, in closed form."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sprung.vehicle import LAYOUTS, Matrices, Motion, Wheel, affine_response

Array = NDArray[np.float64]


def drive_over_half_sine_bump(
    matrices: Matrices,
    tyre_rates: dict[Wheel, tuple[float, float]],
    wheels: tuple[Wheel, ...],
    height: float,
    duration: float,
    step: float,
    samples: int,
) -> tuple[Motion, Array]:
    """Return the motion of a vehicle driven over a half-sine bump from rest, and its free vibration after it, in closed form.

    Eq. (19) of the paper means z_g = 0.09 sin 5π(t - 0.1); as printed, sin 5πt, it would jump to 0.09 m at the start
    and end at -0.09 m.

    Parameters
    ----------
    matrices
        M, C and K.
    tyre_rates
        Tyre stiffness and damping under each wheel of the vehicle, in order, N/m and N s/m.
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
        State {X, Ẋ} at the end of the bump, shape (n + m,): where the free decay starts.
    """
    omega, n = np.pi / duration, len(matrices.M)
    force = np.zeros(n, dtype=complex)
    layout = next(one for one in LAYOUTS.values() if one.wheels == tuple(tyre_rates))
    for station in wheels:
        stiffness, damping = tyre_rates[station]
        force[layout.wheels_at.start + layout.wheels.index(station)] = height * (stiffness + 1j * omega * damping)
    dynamic = matrices.K - omega**2 * matrices.M + 1j * omega * matrices.C
    amplitude = np.linalg.solve(dynamic, force)  # X = Im(amplitude exp(iωt)), the steady-state response to the sine
    m = matrices.massive
    orbit = np.concatenate([amplitude, 1j * omega * amplitude[:m]])
    A, at_rest = matrices.state, np.zeros(n + m)

    during = min(samples, int(np.ceil(duration / step - 1e-9)))
    transient = -orbit.imag
    times = step * np.arange(during)
    forced = (orbit[:, None] * np.exp(1j * omega * times)).imag + affine_response(A, at_rest, transient, step, during)
    at_end = (orbit * np.exp(1j * omega * duration)).imag + expm(A * duration) @ transient
    after = expm(A * (during * step - duration)) @ at_end
    states = np.hstack([forced, affine_response(A, at_rest, after, step, max(samples - during, 1))])[:, :samples]

    # The ground acts on the wheels, which have mass: only accelerations follow it at once.
    motion = Motion.of_states(A, states, n)
    ground = (force[:, None] * np.exp(1j * omega * times)).imag
    motion.acceleration[:, :during] += np.linalg.solve(matrices.leading, ground)
    return motion, at_end

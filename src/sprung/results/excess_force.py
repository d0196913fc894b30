"""Forces of the dampers beyond the model, from what it leaves of the measured accelerations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sprung.errors import InputError, Problem
from sprung.results.motion import ReadDrop
from sprung.vehicle import Rows, state_matrix, travels

Real = NDArray[np.float64]

_WEAK = 3.0
"""Standard deviation that a force may have beforehand, over the largest that the residuals make of any at first sight."""

_CORNER = 20.0
"""Frequency up to which a force has the same spectrum beforehand, Hz: above the natural frequencies of wheels."""

_STRAY = 0.01
"""Standard deviation of the displacement from the fitted motion with which a drop begins, m; the velocity is that of 1 Hz."""

_RANK = 1e-6
"""Smallest singular value of the readings per damper force, over the largest, with which every force is determined."""


class ExcessForces(NamedTuple):
    """Forces of the dampers beyond the model, and the motion that they cause.

    Attributes
    ----------
    force
        N, positive in rebound, shape (wheel, time).
    noise
        Standard deviation of each in the middle of the drop, N, shape (wheel,).
    displacement, velocity
        Of the coordinates beyond the fitted motion, m and rad, m/s and rad/s, shape (coordinate, time).
    """

    force: Real
    noise: Real
    displacement: Real
    velocity: Real


def excess_forces(read: ReadDrop, residuals: Real, time: Real) -> ExcessForces:
    """Return the forces of the dampers that explain what the model leaves of the accelerations.

    Parameters
    ----------
    read
        The drop.
    residuals
        Measured minus fitted readings, SI, shape (channel, time).
    time
        s, shape (time,).

    Returns
    -------
    ExcessForces

    Raises
    ------
    InputError
        If the accelerometers do not tell the forces of the dampers apart.

    Notes
    -----
    The deviation from the fitted motion, x, follows the equations of the linear vehicle with forces f along the travels G of
    the dampers' mountings: M ẍ + C ẋ + K x = -Gᵀ f. The residuals are the readings of ẍ and noise. Beforehand each force is
    random with a flat spectrum up to 20 Hz, so large that it does not matter where the accelerometers determine the force.
    They do not determine slow forces, least of all those of one diagonal of the body against the other: these accelerate
    hardly anything, and are estimated near zero. The estimate is that of a fixed-interval smoother
    (Rauch, Tung and Striebel 1965).
    """
    which = read.readout.reads_accelerations & read.usable
    rows = read.readout.of_accelerations(read.readout.at(read.readings))[which]
    highest, _ = read.model.accelerations(read.values)
    massive, n = read.model.massive, len(highest)
    M = read.model.matrices(read.values).M[:massive, :massive]
    effect = -np.linalg.solve(M, damper_travel_rows(read)[:, :massive].T)
    forces = effect.shape[1]
    noise = read.noise[which]
    weighted = rows[:, :massive] @ effect / noise[:, None]
    strengths = np.linalg.svd(weighted, compute_uv=False)
    if len(strengths) < forces or strengths[-1] < _RANK * strengths[0]:
        found = f"{len(noise)} accelerometers that do not tell the forces of {forces} dampers apart"
        do = "An accelerometer on every wheel would show them."
        raise InputError([Problem(f"drop {read.name}", found, "accelerometers that determine each", do)])
    A = state_matrix(highest, massive)
    size = len(A)
    push = np.zeros((size, forces))
    push[n:] = effect
    step = float(np.mean(np.diff(time)))
    flow, first, second = _linear_input(A, push, step)
    kept = np.exp(-2 * np.pi * _CORNER * step)
    left = residuals[which] - residuals[which].mean(axis=1, keepdims=True)
    at_once = np.linalg.pinv(weighted) @ (left / noise[:, None])
    spread = np.full(forces, _WEAK * np.sqrt(np.mean(at_once**2, axis=1).max()))
    # The state without what the force at the same sample adds to it depends on earlier forces alone.
    whole = np.block([[flow, flow @ second + first], [np.zeros((forces, size)), kept * np.eye(forces)]])
    by_state = rows[:, :massive] @ highest[:massive]
    reading = np.hstack([by_state, by_state @ second + rows[:, :massive] @ effect]) / noise[:, None]
    start = np.concatenate([np.full(n, _STRAY), np.full(size - n, _STRAY * 2 * np.pi), spread])
    driven = np.concatenate([np.zeros(size), spread * np.sqrt(1 - kept**2)])
    smoothed, variances = smooth(whole, reading, left / noise[:, None], start, driven)
    states = smoothed[:size] + second @ smoothed[size:]
    return ExcessForces(smoothed[size:], np.sqrt(variances[size:]), states[:n], A[:n] @ states)


def _linear_input(A: Real, push: Real, step: float) -> tuple[Real, Real, Real]:
    """Return what leads to the next state: from the state, from the input there, and from that at the end of the step.

    The input runs linearly between samples: x₁ = Φ x₀ + Γ₀ u₀ + Γ₁ u₁ for ẋ = A x + B u.
    """
    size, inputs = push.shape
    generator = np.zeros((size + 2 * inputs, size + 2 * inputs))
    generator[:size, :size], generator[:size, size : size + inputs] = A * step, push * step
    generator[size : size + inputs, size + inputs :] = np.eye(inputs)
    moved = expm(generator)[:size]
    second = moved[:, size + inputs :]
    return moved[:, :size], moved[:, size : size + inputs] - second, second


def smooth(flow: Real, reading: Real, measured: Real, start: Real, driven: Real) -> tuple[Real, Real]:
    """Return the states of a linear system with random inputs, by its readings before and after each sample.

    Parameters
    ----------
    flow
        From the state at a sample to that at the next, shape (state, state).
    reading
        Readings per state, over the noise of each, shape (channel, state).
    measured
        Readings over their noise, shape (channel, time).
    start, driven
        Standard deviation of each state at the first sample, and of what is added to it at each further one, in its unit;
        shape (state,).

    Returns
    -------
    states
        In their units, shape (state, time).
    variances
        Of the states in the middle, shape (state,).
    """
    samples, size = measured.shape[1], len(flow)
    means, covariances = np.empty((samples, size)), np.empty((samples, size, size))
    before, before_covariances = np.empty((samples, size)), np.empty((samples, size, size))
    mean, covariance = np.zeros(size), np.diag(start**2)
    for k in range(samples):
        before[k], before_covariances[k] = mean, covariance
        by_reading = covariance @ reading.T
        gain = np.linalg.solve(reading @ by_reading + np.eye(len(reading)), by_reading.T).T
        mean = mean + gain @ (measured[:, k] - reading @ mean)
        covariance = covariance - gain @ by_reading.T
        covariance = (covariance + covariance.T) / 2
        means[k], covariances[k] = mean, covariance
        mean, covariance = flow @ mean, flow @ covariance @ flow.T + np.diag(driven**2)
    states, variance = means.copy(), covariances[-1]
    middle = np.diag(variance)
    for k in range(samples - 2, -1, -1):
        back = np.linalg.lstsq(before_covariances[k + 1], flow @ covariances[k], rcond=1e-14)[0].T
        states[k] += back @ (states[k + 1] - before[k + 1])
        variance = covariances[k] + back @ (variance - before_covariances[k + 1]) @ back.T
        if k == samples // 2:
            middle = np.diag(variance)
    return states.T, np.maximum(middle, 0.0)


def damper_travel_rows(read: ReadDrop) -> Real:
    """Return the travels of the dampers with their mounts by the coordinates.

    Parameters
    ----------
    read
        A drop.

    Returns
    -------
    ndarray
        1 and m, shape (wheel, coordinate).
    """
    vehicle = read.vehicle
    travel = travels(vehicle.tracks, vehicle.extras, vehicle.wheelbase)
    rows = [travel(wheel, "damper") for wheel in vehicle.layout.wheels]
    return np.asarray(Rows.of(rows, tuple(vehicle.parameters)).at(list(vehicle.parameters.values())))

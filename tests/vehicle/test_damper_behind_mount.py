"""Damper curves behind rubber mounts: the rate of a coordinate without mass depends on the force of its own element."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from sprung.vehicle import (
    TABLE_1_CAR,
    NonlinearModel,
    Stepper,
    Vehicle,
    differentiate_motion,
    linear_elements,
    nonlinear_elements,
    parameter_names,
)

Array = NDArray[np.float64]

EXTRAS = ("damper-mount", "rebound", "damper-curve")
CAR = Vehicle.from_parameters(
    TABLE_1_CAR.parameters
    | {"k_df": 2.0e5, "k_dr": 2.4e5, "r_f": 2.0, "r_r": 1.7, "v_kf": 0.1, "v_kr": 0.13, "q_f": 0.3, "q_r": 0.4}
)
NAMES = parameter_names("shared", EXTRAS)
VALUES = np.array([getattr(CAR, name) for name in NAMES])
MODEL = NonlinearModel.of(
    linear_elements("shared", EXTRAS), nonlinear_elements("shared", EXTRAS), NAMES
)  # fmt: skip


def stepper(step: float, values: Array) -> Stepper:
    return Stepper.of([MODEL], [step], np.array([0]), values)


def rate_of_damper(force: float, axle: str) -> float:
    """Return the rate, m/s, at which a damper has a force: the inverse of its curve."""
    c, r, knee, q = (getattr(CAR, f"{name}{axle}") for name in ("c_s", "r_", "v_k", "q_"))
    c = c * (r if force > 0 else 1.0)
    size = abs(force) / c
    return float(np.sign(force) * (size if size < knee else knee + (size - knee) / q))


def rates_of_change(state: Array) -> Array:
    """Newton's equations, wheel by wheel; the state is {X, travels of the dampers, Ẋ}."""
    z, theta, phi, *wheels = state[:7]
    accelerations, relaxations = np.zeros(7), np.zeros(4)
    masses = (CAR.m_s, CAR.I_yy, CAR.I_xx, CAR.m_uf, CAR.m_uf, CAR.m_ur, CAR.m_ur)
    for i, (axle, side) in enumerate((("f", 1), ("f", -1), ("r", 1), ("r", -1))):
        k_s, k_t, k_d, half = (getattr(CAR, f"{name}{axle}") for name in ("k_s", "k_t", "k_d", "t_"))
        lever = -CAR.a if axle == "f" else CAR.b
        travel = z + lever * theta + side * half * phi - wheels[i]
        mount = k_d * (travel - state[7 + i])
        relaxations[i] = rate_of_damper(mount, axle)
        force = k_s * travel + mount
        accelerations[:3] -= force * np.array([1.0, lever, side * half])
        accelerations[3 + i] += force - k_t * wheels[i]
    return np.concatenate([state[11:], relaxations, accelerations / masses])


STATE = np.random.default_rng(2).standard_normal(18) * np.repeat([0.02, 0.0, 0.3], [7, 4, 7])


@pytest.mark.slow
def test_a_damper_curve_behind_a_mount_follows_newtons_equations() -> None:
    """A quarter of the step leaves a sixteenth of the error, of which 3e-4 of the motion are left at 0.5 ms."""
    times = np.arange(41) * 0.01
    there = solve_ivp(
        lambda _, y: rates_of_change(y), (0, 0.4), STATE, "Radau", times, rtol=1e-8, atol=1e-10, max_step=0.002
    ).y.T
    scale = np.abs(there).max(axis=0)
    errors = []
    for every in (5, 20):
        motion = stepper(0.01 / every, VALUES).integrate(STATE[None], np.zeros((1, 0)), 40 * every)
        errors.append(float(np.max(np.abs(motion.states[::every, 0] - there) / scale)))
    assert errors[1] < 1.5e-3
    assert errors[1] < errors[0] / 8


def test_its_derivatives_are_those_of_the_steps() -> None:
    """Forces are solved to 1e-6 of the largest, also where Newton's method goes back and forth between two kinks."""
    before = stepper(0.001, VALUES)
    motion = before.integrate(STATE[None], np.zeros((1, 0)), 60)
    outputs = np.eye(18, 18 + before.forces.number)
    found = differentiate_motion(before, motion, 0, outputs, 1)
    for name in ("k_df", "c_sr", "r_f", "v_kf", "v_kr", "q_f", "q_r", "a", "m_uf"):
        position = NAMES.index(name)
        ends = []
        for side in (1, -1):
            values = VALUES.copy()
            values[position] *= 1 + side * 1e-4
            ends.append(stepper(0.001, values).integrate(STATE[None], np.zeros((1, 0)), 60).states[:, 0])
        slope = (ends[0] - ends[1]) / (2e-4 * VALUES[position])
        np.testing.assert_allclose(found[:, position].T, slope, atol=1e-5 * np.abs(slope).max())

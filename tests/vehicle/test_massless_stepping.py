"""Time steps of vehicles with coordinates without mass: the rate of a damper behind its mount depends on its own force."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from sprung.vehicle import (
    TABLE_1_CAR,
    NonlinearModel,
    Stepper,
    Vehicle,
    differentiate_motion,
    free_decay,
    linear_elements,
    nonlinear_elements,
)

Array = NDArray[np.float64]

RUBBER = {
    "k_df": 2.0e5,
    "k_dr": 2.4e5,
    "c_df": 140.0,
    "c_dr": 90.0,
    "k_zf": 3000.0,
    "k_zr": 4500.0,
    "c_zf": 150.0,
    "c_zr": 290.0,
}
CAR = Vehicle.from_parameters(TABLE_1_CAR.parameters | RUBBER)
WITH_REBOUND = Vehicle.from_parameters(CAR.parameters | {"r_f": 1.8, "r_r": 2.4})
WITH_FRICTION = Vehicle.from_parameters(
    WITH_REBOUND.parameters | {"F_f": 90.0, "F_r": 120.0, "s_f": 2e5, "s_r": 3e5, "p_f": 2.0, "p_r": 1.0}
)
START: Array = np.random.default_rng(4).standard_normal(22) * np.repeat([0.02, 0.01, 0.3], [7, 8, 7])


def stepper(car: Vehicle, step: float, values: Array | None = None) -> Stepper:
    elements = linear_elements(car.tracks, car.extras)
    nonlinear = nonlinear_elements(car.tracks, (*car.extras, "rebound"))
    names = tuple(dict.fromkeys((*car.parameters, "r_f", "r_r")))
    model = NonlinearModel.of(elements, nonlinear, names)
    own = np.array([getattr(car, name) for name in names])
    return Stepper.of([model], [step], np.zeros(1, dtype=np.int64), own if values is None else values)


def test_dampers_behind_mounts_follow_fastest_where_they_are_softest() -> None:
    """k_d/(c_s + c_d) in compression, where rebound is harder; rubber beside the springs is linear, and is stepped exactly."""
    nonlinear = nonlinear_elements(WITH_REBOUND.tracks, WITH_REBOUND.extras)
    names = tuple(WITH_REBOUND.parameters)
    model = NonlinearModel.of(linear_elements(WITH_REBOUND.tracks, WITH_REBOUND.extras), nonlinear, names)
    expected = max(
        WITH_REBOUND.k_df / (WITH_REBOUND.c_sf + WITH_REBOUND.c_df),
        WITH_REBOUND.k_dr / (WITH_REBOUND.c_sr + WITH_REBOUND.c_dr),
    )
    found = model.fastest_decay(np.array(list(WITH_REBOUND.parameters.values())))
    assert found == pytest.approx(expected, rel=1e-9)
    without = NonlinearModel.of(
        linear_elements(CAR.tracks, CAR.extras), nonlinear_elements(CAR.tracks, CAR.extras), names
    )
    assert without.fastest_decay(np.array(list(WITH_REBOUND.parameters.values()))) == 0.0


def rates_of_change(car: Vehicle, state: Array) -> Array:
    """Newton's equations, element by element; a damper with its rebound ratio extends as its mount pulls."""
    z, theta, phi, *wheels = state[:7]
    dampers, branches, velocities = state[7:11], state[11:15], state[15:]
    accelerations, relaxations = np.zeros(7), np.zeros(8)
    masses = (car.m_s, car.I_yy, car.I_xx, car.m_uf, car.m_uf, car.m_ur, car.m_ur)
    for i, (axle, side) in enumerate((("f", 1), ("f", -1), ("r", 1), ("r", -1))):
        k_s, k_t, c_s, k_d, c_d, k_z, c_z, r, half = (
            getattr(car, f"{name}{axle}") for name in ("k_s", "k_t", "c_s", "k_d", "c_d", "k_z", "c_z", "r_", "t_")
        )
        lever = -car.a if axle == "f" else car.b
        travel = z + lever * theta + side * half * phi - wheels[i]
        speed = velocities[0] + lever * velocities[1] + side * half * velocities[2] - velocities[3 + i]
        mount, branch = k_d * (travel - dampers[i]) + c_d * speed, k_z * (travel - branches[i])
        damping = c_s * (r if mount > 0 else 1.0)
        relaxations[i], relaxations[4 + i] = mount / (damping + c_d), branch / c_z
        force = k_s * travel + damping * relaxations[i] + branch
        accelerations[:3] -= force * np.array([1.0, lever, side * half])
        accelerations[3 + i] += force - k_t * wheels[i]
    return np.concatenate([velocities, relaxations, accelerations / masses])


def test_without_any_force_the_steps_are_exact() -> None:
    trajectory = stepper(CAR, 0.01).integrate(START[None], np.zeros((1, 0)), 60)
    exact = free_decay(CAR.matrices(), START, 0.01, 61)
    assert_allclose(trajectory.states[:, 0, :15].T, exact.displacement, atol=1e-12)
    assert_allclose(trajectory.states[:, 0, 15:].T, exact.velocity[:7], atol=1e-11)


def test_rebound_behind_a_mount_is_that_of_newtons_equations() -> None:
    step, steps = 0.0005, 400
    trajectory = stepper(WITH_REBOUND, step).integrate(START[None], np.zeros((1, 0)), steps)
    there = solve_ivp(
        lambda _, y: rates_of_change(WITH_REBOUND, y), (0, step * steps), START, "Radau", rtol=1e-9, atol=1e-11,
        t_eval=step * np.arange(0, steps + 1, 40), max_step=0.001,
    )  # fmt: skip
    found = trajectory.states[::40, 0]
    # Forces run straight over a step, but for the one in which a damper reverses.
    assert np.all(np.abs(found - there.y.T) < 5e-4 * np.abs(found).max(axis=0))


@pytest.mark.slow
def test_derivatives_are_those_of_the_steps_themselves(monkeypatch: pytest.MonkeyPatch) -> None:
    """Forces are solved for to 1e-6 of the largest, which differences of them would show: here almost to rounding."""
    monkeypatch.setattr("sprung.vehicle.stepping._SOLVED", 1e-10)
    car, steps, states, memories = WITH_FRICTION, 60, START[None], np.full((1, 4), 0.3)
    before = stepper(car, 0.001)
    values = before.values
    trajectory = before.integrate(states, memories, steps)
    outputs = 22 + before.forces.number
    found = differentiate_motion(before, trajectory, 0, np.eye(outputs), 1).transpose(2, 0, 1)[
        :, None
    ]  # step, drop, output, unknown
    for unknown, value in enumerate(values):
        ends = []
        for side in (1, -1):
            moved = values.copy()
            moved[unknown] += side * 1e-6 * abs(value)
            there = stepper(car, 0.001, moved).integrate(states, memories, steps)
            ends.append(np.concatenate([there.states, there.forces], axis=2))
        slope = (ends[0] - ends[1]) / (2e-6 * abs(value))
        scale = np.abs(slope).max(axis=(0, 1)) + 1e-9 * np.abs(slope).max()
        assert np.all(np.abs(found[..., unknown] - slope) < 3e-4 * scale)

"""What finite rotation and a load add, against another program's simulation and energies written out with finite rotations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.optimize import approx_fprime, root

from sprung.vehicle import (
    EMPTY,
    LEVEL,
    LinearModel,
    Load,
    affine_response,
    body_sinking,
    finite_rotation_readings,
    linear_elements,
    parameter_names,
)
from sprung.vehicle.finite_rotation import turned_body
from tall_car import BALLAST, HEIGHTS, RATE, SENSORS, TALL_CAR, second_order

Array = NDArray[np.float64]

G = 9.80665
NAMES = tuple(TALL_CAR.parameters)
VALUES = np.array(list(TALL_CAR.parameters.values()))
EMPTY_MODEL = TALL_CAR.linear_model()
ARM = HEIGHTS.wheel_arms[1]

DEFLECTIONS = {"roll": [0, 0, 0.02, 0, 0, 0, 0], "both": [0.01, 0.01, 0.02, 0.002, 0, 0, 0]}


def model_of(load: Load) -> tuple[LinearModel, float]:
    """Return the equations of motion where the body rests under a load, and how much lower that is."""
    sunk = body_sinking(EMPTY_MODEL, TALL_CAR.linear_model(load), "shared", VALUES)
    heights = HEIGHTS._replace(sunk=sunk)
    elements = linear_elements("shared", TALL_CAR.extras, heights) + load.elements(heights)
    return LinearModel.of(elements, NAMES), sunk


@pytest.mark.parametrize("key", list(second_order()))
def test_even_parts_of_readings_are_those_of_a_rigid_body_engine(key: str) -> None:
    """Half the sum of two opposite motions holds no first order; the mean sinking under the load counts for both axles."""
    measured = second_order()[key]
    deflected, name = key.split()
    load = BALLAST if name == "ballast" else EMPTY
    model, sunk = model_of(load)
    A = model.matrices(VALUES).state
    state = np.concatenate([DEFLECTIONS[deflected], np.zeros(7)])
    motion = affine_response(A, np.zeros(14), state, 1 / RATE, measured.shape[1])
    there, back = finite_rotation_readings(
        model, "shared", HEIGHTS._replace(sunk=sunk), load, SENSORS, VALUES, [motion, -motion], 1 / RATE
    )
    left = 0.03 if load is BALLAST else 0.01
    assert np.linalg.norm(measured - 0.5 * (there + back)) < left * np.linalg.norm(measured)


def potential(X: Array, load: Load) -> float:
    """Energy of the tall car from rest without load: wheels slide along the body's own vertical axis, tyres are vertical."""
    z, theta, phi, *wheels = X
    p = TALL_CAR
    upright = np.cos(theta) * np.cos(phi)
    total = p.m_s * G * z
    for item in load.items:
        assert item.position is not None
        x, y, height = item.position[0] + p.a, item.position[1], item.position[2] - (HEIGHTS.cg_height or 0.0)
        total += item.mass * G * (z - x * np.sin(theta) + y * np.cos(theta) * np.sin(phi) + height * upright)
    slid = []
    for at, wheel in enumerate(wheels):
        front, side = at < 2, 1 - 2 * (at % 2)
        k, k_t, m_u, t = (p.k_sf, p.k_tf, p.m_uf, p.t_f) if front else (p.k_sr, p.k_tr, p.m_ur, p.t_r)
        x, carried = (p.a, p.b) if front else (-p.b, p.a)
        carried *= p.m_s * G / (2 * p.wheelbase)
        along = (wheel + ARM - z + x * np.sin(theta) - side * (t or 0.0) * np.sin(phi) * np.cos(theta)) / upright
        slid.append(along - ARM)
        total += carried * slid[-1] + 0.5 * k * slid[-1] ** 2 - carried * wheel + 0.5 * k_t * wheel**2
        total += m_u * G * wheel - m_u * G * wheel
    bars = 0.5 * p.k_af * (slid[0] - slid[1]) ** 2 + 0.5 * p.k_ar * (slid[2] - slid[3]) ** 2
    return float(total + bars)


@pytest.mark.parametrize("turned", [[0.01, 0.03, 0.05, 0.002, -0.004, 0.0, 0.01], [0.0, -0.1, 0.2, 0.0, 0.0, 0.0, 0.0]])
def test_forces_of_a_turned_body_are_the_slope_of_its_energy(turned: list[float]) -> None:
    """Nothing is expanded in the angles: also at 0.2 rad. Static forces are from the linear model, whose body pitches as it
    settles on its springs, so that gravity turns it a little further: 2e-4 of the forces."""
    rest, X = np.zeros(7), np.array(turned)
    motion = np.zeros((3, 7, 1))
    motion[0, :, 0] = X
    slope = approx_fprime(X, potential, 1e-6, EMPTY) - approx_fprime(rest, potential, 1e-6, EMPTY)
    tyres = np.array([0, 0, 0, TALL_CAR.k_tf, TALL_CAR.k_tf, TALL_CAR.k_tr, TALL_CAR.k_tr]) * X
    body = turned_body(EMPTY_MODEL, "shared", HEIGHTS, EMPTY, VALUES)
    assert_allclose(body.forces(motion)[:, 0], slope - tyres, atol=3e-4 * np.abs(slope).max())
    assert np.abs(slope).max() > 500.0


def test_a_load_lets_the_body_rest_lower_and_stiffens_roll() -> None:
    """The roll stiffness is the curvature of the energy at rest under the load, found by Newton's method.

    The mean sinking counts for both axles, and the static pitch of 0.01 rad is left out: 0.01 of the change.
    """

    def gradient(X: Array) -> Array:
        return np.asarray(approx_fprime(X, potential, 1e-6, BALLAST)) / 1e3

    rest = root(gradient, np.zeros(7)).x
    along = 2e-3 * np.eye(7)[2]
    curvature = (
        potential(rest + along, BALLAST) - 2 * potential(rest, BALLAST) + potential(rest - along, BALLAST)
    ) / 4e-6
    model, sunk = model_of(BALLAST)
    unsunk = TALL_CAR.linear_model(BALLAST).matrices(VALUES).K[2, 2]
    change = curvature - unsunk
    weight = G * (TALL_CAR.m_s + BALLAST.total_mass())
    assert sunk == pytest.approx(-rest[0] + np.mean(rest[3:]), rel=0.1)
    assert change == pytest.approx(weight * sunk, rel=0.02)
    assert model.matrices(VALUES).K[2, 2] - unsunk == pytest.approx(change, rel=0.02)


def test_a_vehicle_that_nothing_holds_turns_with_the_least_kinetic_energy() -> None:
    """Momentum that stays zero leaves the least kinetic energy over all horizontal velocities (Thomson's theorem)."""
    p = TALL_CAR
    points = [(p.m_s, 0.0, 0.0, 0.0)]
    # The half-distance of the wheels is left out of the yaw inertia, of which that of the body is a guess anyway.
    points += [(2 * p.m_uf, p.a, 0.0, ARM), (2 * p.m_ur, -p.b, 0.0, ARM)]
    for item in BALLAST.items:
        assert item.position is not None
        x, y, z = item.position
        points.append((item.mass, x + p.a, y, z - (HEIGHTS.cg_height or 0.0)))
    for angle, own in ((2, p.I_xx + 16.0), (1, p.I_yy + 66.0)):
        rows, right = [[0.0, 0.0, np.sqrt(p.I_yy)]], [0.0]
        for mass, x, y, h in points:
            rows += [[np.sqrt(mass), 0.0, -np.sqrt(mass) * y], [0.0, np.sqrt(mass), np.sqrt(mass) * x]]
            right += [-np.sqrt(mass) * h * (angle == 1), np.sqrt(mass) * h * (angle == 2)]
        _, (left,), *_ = np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)
        vertical = sum(m * (x**2 if angle == 1 else y**2) for m, x, y, _ in points[3:])
        assert TALL_CAR.linear_model(BALLAST).matrices(VALUES).M[angle, angle] == pytest.approx(
            own + vertical + left, rel=1e-12
        )


def test_derivatives_of_the_reduced_mass_matrix() -> None:
    """Central differences; their error is that of rounding, 1e-16 of the inertias over a step of 1e-6 of each parameter."""
    model = TALL_CAR.linear_model(BALLAST)
    assert model.is_reduced
    exact = model.slopes(VALUES).M
    for i, value in enumerate(VALUES):
        step = 1e-6 * value * np.eye(len(VALUES))[i]
        difference = (model.matrices(VALUES + step).M - model.matrices(VALUES - step).M) / (2e-6 * value)
        assert_allclose(exact[i], difference, rtol=1e-6, atol=1e-5 * max(1.0, 3000 / value))


def test_without_heights_nothing_moves_sideways() -> None:
    names = parameter_names("shared", TALL_CAR.extras)
    model = LinearModel.of(linear_elements("shared", TALL_CAR.extras, LEVEL), names)
    assert not model.is_reduced
    assert not model.unconstrained_motion(VALUES).any()
    assert replace(TALL_CAR, cg_height=None, wheel_height=None).linear_model(BALLAST).matrices(VALUES).M[2, 2] == 736.0

"""What gravity and sideways motion do to roll and pitch, against energies written out with finite rotations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import sprung
from sprung.vehicle import LEVEL, TABLE_1_CAR, Heights, Load, Vehicle, parse_record

Array = NDArray[np.float64]

G = 9.80665
CG, WHEEL = 0.55, 0.29
CAR = Vehicle.from_parameters(TABLE_1_CAR.parameters, cg_height=CG, wheel_height=WHEEL)
BALLAST = parse_record(
    Load, {"name": "ballast", "items": [{"mass": 150.0, "position": (-1.0, 0.0, 0.9), "inertia": (5.0, 8.0)}]}
)
CORNERS = [(x, side, wheel) for wheel, (x, side) in enumerate(product((CAR.a, -CAR.b), (1.0, -1.0)))]


def hessian(energy: Callable[[Array], float], step: float) -> Array:
    """Second derivatives at zero by central differences."""
    found = np.empty((7, 7))
    for i, j in product(range(7), range(7)):
        one, other = step * np.eye(7)[i], step * np.eye(7)[j]
        found[i, j] = energy(one + other) - energy(one - other) - energy(other - one) + energy(-one - other)
    return found / (4 * step**2)


def potential(X: Array, load: float) -> float:
    """Energy of the vehicle whose wheels slide along the body's own vertical axis, tyres vertical; from rest.

    Heights are relative to the centre of gravity, about which the body turns: pitch first, then roll.
    """
    z, theta, phi, *wheels = X
    K = TABLE_1_CAR
    upright = np.cos(theta) * np.cos(phi)
    total = K.m_s * G * z + load * G * (z + (0.9 - CG) * upright)
    for x, side, at in CORNERS:
        front = at < 2
        k, k_t, m_u, t = (K.k_sf, K.k_tf, K.m_uf, K.t_f or 0.0) if front else (K.k_sr, K.k_tr, K.m_ur, K.t_r or 0.0)
        carried = (K.m_s + load) * G * (K.b if front else K.a) / (2 * (K.a + K.b))
        # How far the wheel stands along the body's axis, from where it does at rest: up is compression.
        along = (wheels[at] + (WHEEL - CG) - z + x * np.sin(theta) - side * t * np.sin(phi) * np.cos(theta)) / upright
        slid = along - (WHEEL - CG)
        total += carried * slid + 0.5 * k * slid**2
        total += m_u * G * wheels[at] - (carried + m_u * G) * wheels[at] + 0.5 * k_t * wheels[at] ** 2
    return float(total)


@pytest.mark.parametrize("load", [0.0, 150.0])
def test_gravity_tips_what_stands_above_its_wheels(load: float) -> None:
    """The stiffness of the vehicle, loaded above its centre of gravity or not, is the curvature of its energy at rest."""
    # A load over the centre of gravity, whose moments are left out: only what its height does is looked at.
    above = parse_record(Load, {"name": "above", "items": [{"mass": 150.0, "position": (-CAR.a, 0.0, 0.9)}]})
    K = CAR.matrices(above if load else sprung.vehicle.EMPTY).K
    assert_allclose(K, hessian(lambda X: potential(X, load), 1e-4), rtol=1e-5, atol=2e-3 * G)
    assert K[2, 2] < TABLE_1_CAR.matrices().K[2, 2] - 0.9 * (CAR.m_s + load) * G * (CG - WHEEL)


def test_what_is_carried_sideways_counts_as_inertia() -> None:
    """Kinetic energy of a body that rolls about an axis below it: Steiner for the body, the load and the wheels."""
    axis = 0.1
    car = replace(CAR, roll_axis_height=axis)
    M, plain = car.matrices(BALLAST).M, TABLE_1_CAR.matrices(BALLAST).M
    wheels = 2 * (CAR.m_uf + CAR.m_ur)
    roll = CAR.m_s * (CG - axis) ** 2 + 150.0 * (0.9 - axis) ** 2 + wheels * (WHEEL - axis) ** 2
    pitch = 150.0 * (0.9 - CG) ** 2 + wheels * (WHEEL - CG) ** 2
    added = np.zeros((7, 7))
    added[1, 1], added[2, 2] = pitch, roll
    assert_allclose(M - plain, added, atol=1e-9)


def test_heights_that_do_not_tell_enough_change_nothing() -> None:
    for heights in (LEVEL, Heights(wheel_height=0.3), Heights(cg_height=0.5), Heights(roll_axis_height=0.1)):
        assert not heights.has_effect
        car = Vehicle.from_parameters(TABLE_1_CAR.parameters, name="told little", **heights.by_key)
        for one, other in zip(car.matrices(), TABLE_1_CAR.matrices(), strict=True):
            assert_allclose(one, other)


def test_where_the_body_is_carried_decides_how_gravity_tips_it() -> None:
    both = Heights(CG, WHEEL, 0.1)
    assert both.is_ambiguous
    assert both.gravity_stiffness() == pytest.approx(G * (CG - WHEEL))
    assert both._replace(carried_at="roll axis").gravity_stiffness() == pytest.approx(G * (CG - 0.1))
    assert Heights(CG, None, 0.1).gravity_stiffness() == pytest.approx(G * (CG - 0.1))
    assert not Heights(CG, WHEEL).is_ambiguous

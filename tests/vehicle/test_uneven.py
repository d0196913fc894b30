"""Left/right differences and rigid axles: matrices against energies written out, and identified from drops."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sprung
from sprung.vehicle import TABLE_1_CAR, Vehicle, separate_track_names

UNEVEN = {"y_s": 0.03, "d_ksf": 800.0, "d_csr": 400.0, "d_ktr": -5000.0}
RIGID = {"n_r": 0.7, "m_xr": -12.0}
LOAD = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.3, 0.5)}]}


def test_left_and_right_differ_by_what_is_told() -> None:
    """Every wheel with its own rates, and the body's mass where it is: energies written out."""
    p = TABLE_1_CAR
    car = Vehicle.from_parameters(p.parameters | UNEVEN)
    M, C, K = car.matrices()
    X, V = np.random.default_rng(1).standard_normal((2, 7))
    stations = [(p.a, 1.0, "f"), (p.a, -1.0, "f"), (-p.b, 1.0, "r"), (-p.b, -1.0, "r")]
    kinetic = 0.5 * p.m_s * (V[0] + 0.03 * V[2]) ** 2 + 0.5 * p.I_yy * V[1] ** 2 + 0.5 * p.I_xx * V[2] ** 2
    lost = stored = 0.0
    for at, (x, side, axle) in enumerate(stations):
        k, c, k_t, m = (getattr(p, f"{name}{axle}") for name in ("k_s", "c_s", "k_t", "m_u"))
        k += side * UNEVEN.get(f"d_ks{axle}", 0.0)
        c += side * UNEVEN.get(f"d_cs{axle}", 0.0)
        k_t += side * UNEVEN.get(f"d_kt{axle}", 0.0)
        travel, rate = (one[0] - x * one[1] + side * 0.74 * one[2] - one[3 + at] for one in (X, V))
        kinetic += 0.5 * m * V[3 + at] ** 2
        stored += 0.5 * k * travel**2 + 0.5 * k_t * X[3 + at] ** 2
        lost += c * rate**2
    assert_allclose(0.5 * V @ M @ V, kinetic, rtol=1e-12)
    assert_allclose(0.5 * X @ K @ X, stored, rtol=1e-12)
    assert_allclose(V @ C @ V, lost, rtol=1e-12)


def test_a_rigid_axle_is_one_body_on_two_tyres() -> None:
    """Its middle and its roll angle, springs and dampers inboard: energies written out, T the wheels' half-distance."""
    p = TABLE_1_CAR
    T, t = 0.74 / 0.7, 0.74
    car = Vehicle.from_parameters(p.parameters | RIGID)
    X, V = np.random.default_rng(2).standard_normal((2, 7))
    own, plain = (one.matrices() for one in (car, TABLE_1_CAR))
    (z, v), (angle, turn) = ((one[5] + one[6]) / 2 for one in (X, V)), ((one[5] - one[6]) / (2 * T) for one in (X, V))
    inertia = 2 * T**2 * (p.m_ur + RIGID["m_xr"])
    moving = 0.5 * 2 * p.m_ur * v**2 + 0.5 * inertia * turn**2
    independent = 0.5 * p.m_ur * (V[5] ** 2 + V[6] ** 2)
    assert_allclose(0.5 * V @ (own.M - plain.M) @ V, moving - independent, rtol=1e-10)
    for matrix, before, rate, Y in ((own.K, plain.K, p.k_sr, X), (own.C, plain.C, p.c_sr, V)):
        middle, tilt = (z, angle) if Y is X else (v, turn)
        felt = [Y[0] + p.b * Y[1] + side * t * Y[2] - (middle + side * t * tilt) for side in (1.0, -1.0)]
        alone = [Y[0] + p.b * Y[1] + side * t * Y[2] - Y[5 + at] for at, side in enumerate((1.0, -1.0))]
        assert_allclose(Y @ (matrix - before) @ Y, rate * (sum(np.square(felt)) - sum(np.square(alone))), rtol=1e-9)


def test_on_a_rigid_axle_springs_and_dampers_may_stand_apart() -> None:
    assert separate_track_names("n_r") == ("n_r1", "n_r2")
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"n_r1": 0.6, "n_r2": 0.8})
    assert (car.tracks, car.extras, car.n_f1, car.n_r) == ("separate", ("rigid-axle",), 1.0, None)
    assert {"t_f1", "n_r1", "n_r2", "m_xr"} <= car.parameters.keys()
    with pytest.raises(sprung.errors.InputError, match="either n_r, or n_r1"):
        Vehicle.from_parameters(TABLE_1_CAR.parameters | {"n_r": 0.7, "n_r1": 0.6})


def test_the_vehicle_nearest_to_what_a_fit_found() -> None:
    """Friction a little below nothing is none; left springs softer than right ones are what they are."""
    found = TABLE_1_CAR.parameters | {"F_f": -2.0, "F_r": 30.0, "d_ksf": -800.0, "y_s": -0.02}
    car = Vehicle.nearest(found, cg_height=0.5)
    assert (car.F_f, car.F_r, car.d_ksf, car.y_s, car.cg_height) == (0.0, 30.0, -800.0, -0.02, 0.5)

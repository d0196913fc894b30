"""Drop tests of vehicles with dry friction and uneven damping, by equations and a solver that are not the package's own.

Friction follows Dahl's law or that of Bouc and Wen; the tyres push and never pull; all drops are followed at once by the
classical method of Runge and Kutta, from rest on the blocks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import sprung
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import WHEELS, Vehicle, sensor_rows

Real = NDArray[np.float64]
Law = Literal["dahl", "bouc-wen"]

STEP = 2e-4
"""s of a step, at most: friction of 1000 N and 2 MN/m builds up within half a millimetre."""

BEFORE = 0.4
"""s of rest on the blocks before the release."""

_SHAPES = {"dahl": (1.0, 0.0, 1.0), "bouc-wen": (0.5, 0.5, 2.0)}
"""β, γ and n of z' = (v - β |v| z |z|^(n-1) - γ v |z|^n) / x."""


def measured(
    vehicle: Vehicle,
    *,
    law: Law = "dahl",
    seed: int = 0,
    noise: float = 0.02,
    rate: float = 500.0,
    duration: float = 3.2,
    **given: Any,
) -> sprung.Campaign:
    """Drop a vehicle with friction and uneven damping, and record it.

    Parameters
    ----------
    vehicle
        With F, s and r.
    law
        Of the friction.
    seed
        Of the noise.
    noise
        m/s² root-mean-square.
    rate, duration
        Samples per second, and s from the release on.
    given
        Further arguments of `sprung.simulate`: drops, loads, known, model.
    """
    plain = Vehicle.from_parameters(
        {name: value for name, value in vehicle.parameters.items() if name[0] not in "Fr" and name[:2] != "s_"},
        cg_height=vehicle.cg_height,
        name=vehicle.name,
    )
    shape = sprung.simulate(plain, rate=rate, noise=0.0, seed=0, **given)
    accelerations = _followed(vehicle, shape, law, rate, duration)
    names = tuple(plain.parameters)
    S = sensor_rows(shape.sensors, names).at(list(plain.parameters.values()))
    random, rest = np.random.default_rng(seed), int(BEFORE * rate)
    recordings = []
    for recording, acceleration in zip(shape.recordings, accelerations, strict=True):
        quiet = np.hstack([np.zeros((len(S), rest)), S @ acceleration]) + STANDARD_GRAVITY
        values = quiet + noise * random.standard_normal(quiet.shape)
        recordings.append(replace(recording, values=values, start=0.0))
    return shape.with_recordings(recordings)


def _followed(vehicle: Vehicle, campaign: sprung.Campaign, law: Law, rate: float, duration: float) -> Real:
    """Return accelerations of the seven coordinates from the release on, (drop, 7, time)."""
    drops, (beta, gamma, n) = campaign.drops, _SHAPES[law]
    p = _by_wheel(vehicle)
    a, b = vehicle.a, vehicle.b
    x, side = np.array([a, a, -b, -b]), np.array([1.0, -1.0, 1.0, -1.0])
    # Travel of a suspension: the body above the wheel, less the wheel; the body's nose goes down with positive pitch.
    at_spring = np.hstack([np.column_stack([np.ones(4), -x, side * p["t_2"]]), -np.eye(4)])
    at_damper = np.hstack([np.column_stack([np.ones(4), -x, side * p["t_1"]]), -np.eye(4)])
    masses = np.array([plain.M for plain in (vehicle.matrices(campaign.load(drop.load)) for drop in drops)])
    inverse = np.linalg.inv(masses)
    down = STANDARD_GRAVITY * masses @ np.array([1.0, 0, 0, 1, 1, 1, 1])
    lifted = np.array([[(drop.height or 0.05) * (wheel in drop.wheels) for wheel in WHEELS] for drop in drops])

    def forces(X: Real, V: Real, z: Real, ground: Real) -> tuple[Real, Real]:
        rate_of = V @ at_damper.T
        damper = p["c_s"] * np.where(rate_of > 0, p["r"], 1.0) * rate_of
        spring = p["k_s"] * (X @ at_spring.T) + p["F"] * z
        tyre = np.maximum(p["k_t"] * (ground - X[:, 3:]), 0.0)
        total = -spring @ at_spring - damper @ at_damper - down
        total[:, 3:] += tyre
        return np.einsum("dij,dj->di", inverse, total), V @ at_spring.T

    # Springs are measured from where they carry nothing, so rest on the blocks is an equilibrium like any other.
    X = _at_rest(p, at_spring, down, lifted)
    V, z = np.zeros_like(X), np.zeros((len(drops), 4))
    every = int(np.ceil(1 / (rate * STEP)))
    h = 1 / (rate * every)
    flat = np.zeros((len(drops), 4))
    reach = p["F"] / p["s"]

    def slope(X: Real, V: Real, z: Real) -> tuple[Real, Real, Real]:
        A, v = forces(X, V, z, flat)
        size = np.abs(z)
        grown = v - beta * np.abs(v) * z * size ** (n - 1) - gamma * v * size**n
        return V, A, np.where(p["F"] > 0, grown / np.maximum(reach, 1e-12), 0.0)

    samples = int(duration * rate)
    out = np.empty((len(drops), 7, samples))
    for k in range(samples):
        out[:, :, k] = forces(X, V, z, flat)[0]
        for _ in range(every):
            one = slope(X, V, z)
            two = slope(*(y + h / 2 * dy for y, dy in zip((X, V, z), one, strict=True)))
            three = slope(*(y + h / 2 * dy for y, dy in zip((X, V, z), two, strict=True)))
            four = slope(*(y + h * dy for y, dy in zip((X, V, z), three, strict=True)))
            X, V, z = (
                y + h / 6 * (d1 + 2 * d2 + 2 * d3 + d4)
                for y, d1, d2, d3, d4 in zip((X, V, z), one, two, three, four, strict=True)
            )
    return out


def _by_wheel(vehicle: Vehicle) -> Mapping[str, Real]:
    """Return every corner parameter for the four wheels, by its name without the axle."""
    names = ("k_s", "c_s", "k_t", "F_", "s_", "r_")
    found = {
        name.rstrip("_"): np.array([getattr(vehicle, f"{name}{wheel[0]}") for wheel in WHEELS], dtype=float)
        for name in names
    }
    return found | {
        f"t_{which}": np.array([getattr(vehicle, f"t_{wheel[0]}{which}") for wheel in WHEELS]) for which in "12"
    }


def _at_rest(p: Mapping[str, Real], at_spring: Real, down: Real, lifted: Real) -> Real:
    """Return the static position on the blocks, without wheels that would hang, (drop, 7)."""
    found = []
    for weight, heights in zip(down, lifted, strict=True):
        on = np.ones(4, dtype=bool)
        for _ in range(4):
            tyres = np.append(np.zeros(3), p["k_t"] * on)
            K = (at_spring.T * p["k_s"]) @ at_spring + np.diag(tyres)
            X = np.linalg.solve(K, tyres * np.append(np.zeros(3), heights) - weight)
            pulled = on & (heights - X[3:] < 0)
            if not pulled.any():
                break
            on &= ~pulled
        found.append(X)
    return np.array(found)


def loads_of(vehicle: Vehicle, part: float = 0.1) -> Sequence[Mapping[str, Any]]:
    """Return a load of a fraction of the sprung mass, off centre."""
    mass = part * vehicle.m_s
    places = [(-0.3 * vehicle.wheelbase, 0.3, 0.6), (-0.75 * vehicle.wheelbase, -0.25, 0.6)]
    return [{"name": "ballast", "items": [{"mass": mass / 2, "position": place} for place in places]}]

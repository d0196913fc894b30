"""Rigs and vehicles of which no score shows much: several effects at once, or a linear fit that nobody would recognise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pytest

import sprung
from sprung.simulation import Push, simulate
from sprung.vehicle import Sensor, Vehicle

MM = 1e-3

RIG = Vehicle(model="quarter", m_s=340.0, m_u=42.0, k_s=21e3, k_t=195e3, c_s=1450.0)
HEAVY_RIG = Vehicle(model="quarter", m_s=370.0, m_u=55.0, k_s=38e3, k_t=340e3, c_s=2230.0)
HALF_CAR = Vehicle.from_parameters(
    {"m_s": 650.0, "I_yy": 980.0, "m_uf": 40.0, "m_ur": 36.0, "k_sf": 19e3, "k_sr": 23e3, "k_tf": 190e3, "k_tr": 185e3}
    | {"c_sf": 1400.0, "c_sr": 1650.0, "a": 1.15, "b": 1.45}
)
PICKUP = Vehicle.from_parameters(
    {
        "m_s": 1720.0,
        "I_yy": 4100.0,
        "I_xx": 690.0,
        "m_uf": 58.0,
        "m_ur": 88.0,
        "k_sf": 36e3,
        "k_sr": 33e3,
        "k_tf": 262e3,
    }
    | {"k_tr": 258e3, "c_sf": 2700.0, "c_sr": 2100.0, "a": 1.35, "b": 1.85, "t_f": 0.66, "t_r": 0.53}
    | {"n_f": 1.0, "n_r": 0.7, "m_xf": -0.5, "m_xr": -29.0, "F_f": 20.0, "F_r": 260.0, "s_f": 2e5, "s_r": 3.5e5}
    | {"p_f": 0.3, "p_r": 5.0}
)
"""A rear axle that is rigid and light at its ends, on leaf springs that rub and grow stiffer."""

HATCHBACK = Vehicle.from_parameters(
    {"m_s": 985.0, "I_yy": 1320.0, "I_xx": 330.0, "m_uf": 36.0, "m_ur": 33.0, "k_sf": 21e3, "k_sr": 19.5e3}
    | {"k_tf": 188e3, "k_tr": 185e3, "c_sf": 1500.0, "c_sr": 1350.0, "a": 0.98, "b": 1.55, "t_f": 0.70, "t_r": 0.69}
    | {"F_f": 25.0, "F_r": 20.0, "s_f": 2e5, "s_r": 2e5}
)


def with_terms(vehicle: Vehicle, **terms: float) -> Vehicle:
    """Return a vehicle with parameters of further terms."""
    return Vehicle.from_parameters({**vehicle.parameters, **terms})


def displacements(vehicle: Vehicle, on_body: bool) -> list[Sensor]:
    """Return displacement sensors on every wheel, and on the body above them, absolute or of the travel."""
    wheels = vehicle.layout.wheels
    body = [
        Sensor(channel=f"body_{one}", on="body", quantity="displacement", position=(0.0, 0.0, 0.5))
        if on_body
        else Sensor(channel=f"travel_{one}", on="body", quantity="displacement", relative_to=one)
        for one in wheels
    ]
    return [*body, *(Sensor(channel=f"wheel_{one}", on=one, quantity="displacement") for one in wheels)]


def heights(vehicle: Vehicle, *blocks: float) -> list[dict[str, Any]]:
    """Return drops of all wheels from blocks of some heights, m."""
    return [{"wheels": vehicle.layout.wheels, "height": height} for height in blocks]


def identified(vehicle: Vehicle, sensors: Sequence[Sensor], drops: Sequence[Mapping[str, Any]]) -> sprung.Result:
    """Identify a rig of which the total mass is known, its displacement sensors with noise of 0.05 mm and usual errors."""
    noise = {sensor.channel: 0.05 * MM for sensor in sensors}
    known = {"total_mass": vehicle.total_mass}
    return sprung.identify(
        simulate(vehicle, sensors=sensors, drops=drops, noise=noise, seed=7, known=known, sensor_errors=True)
    )


def is_right(result: sprung.Result, truth: Vehicle, *terms: str) -> None:
    """Check the terms, if some are given, that no sensor is blamed, and every parameter that has a value."""
    assert not terms or {*result.fit.model} == {*terms}
    assert not result.faults
    for name, found in result.parameters.items():
        true = truth.parameters[name]
        if found.value is not None and found.std:
            assert abs(found.value - true) < 4 * found.std, name


@pytest.mark.slow
def test_a_rig_whose_damper_has_a_knee_and_is_harder_in_rebound() -> None:
    """Gains of its two sensors of 15 and 20 % made up for both, so that the misfit seemed small: it was rejected."""
    rig = with_terms(RIG, v_k=0.15, q=0.35, r=1.6)
    result = identified(rig, displacements(rig, on_body=False), heights(rig, 0.03, 0.05, 0.07, 0.03, 0.05))
    is_right(result, rig, "rebound", "damper-curve")
    assert result.verdict.state == "accept"


@pytest.mark.slow
def test_a_rig_with_rubber_in_two_places_and_a_tyre_that_damps() -> None:
    """One after the other each left what was no more like noise, and a gain of 1.4 was taken for the rest, accepted."""
    rig = with_terms(HEAVY_RIG, c_t=205.0, k_d=432e3, k_z=6240.0, c_z=182.0)
    result = identified(rig, displacements(rig, on_body=True), heights(rig, 0.03, 0.05, 0.04, 0.06))
    is_right(result, rig)  # all of the damping of the tyre may be the spring's in this draw


@pytest.mark.slow
def test_a_half_car_with_springs_and_tyres_that_grow_stiffer() -> None:
    """Its decays began a third of a second late, where springs of air explained them: tyre rates were off by 18 %, accepted."""
    car = with_terms(HALF_CAR, p_f=5.0, p_r=6.0, h_tf=6.0, h_tr=5.0)
    ends = [{"wheels": (one,), "height": 0.05} for one in car.layout.wheels]
    result = identified(car, displacements(car, on_body=False), [*heights(car, 0.03, 0.05, 0.06), *ends])
    is_right(result, car, "progressive", "tyre-curve")
    assert result.verdict.state == "accept"


@pytest.mark.long
def test_a_pickup_with_a_rigid_axle_on_leaf_springs() -> None:
    """A rigid axle alone did not explain everything, as it has to; nothing was tried beside it: it was rejected."""
    load = [{"name": "sacks", "items": [{"mass": 350.0, "position": [-2.8, 0.1, 0.9]}]}]
    known = {"total_mass": PICKUP.total_mass}
    result = sprung.identify(simulate(PICKUP, loads=load, rate=400, noise=0.05, seed=2, known=known))
    is_right(result, PICKUP, "rigid-axle", "friction", "progressive")


@pytest.mark.long
def test_a_hatchback_with_friction_that_is_pushed_by_hand() -> None:
    """Tyre damping, mounts and rebound took a part of what friction does: rates were off by up to 23 %, 10 standard errors."""
    wheels = [("fl", "fr", "rl", "rr"), ("fl", "fr"), ("rl", "rr"), ("fl", "rl"), ("fr", "rr")]
    drops = [{"wheels": pushed, "excitation": "push"} for pushed in wheels]
    known = {"total_mass": HATCHBACK.total_mass}
    push = Push(shape="hand", force=450.0)
    result = sprung.identify(
        simulate(HATCHBACK, drops=drops, push=push, rate=200, noise=0.01, seed=9, known=known, duration=5.0)
    )
    is_right(result, HATCHBACK, "friction")
    assert result.verdict.state == "accept"

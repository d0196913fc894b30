"""Vehicles with several effects at once, to which neither the linear fit nor a vehicle with every usual term leads."""

from __future__ import annotations

import pytest

from sprung import identify
from sprung.campaign import Campaign
from sprung.results import Result
from sprung.simulation import Push, simulate
from sprung.vehicle import Vehicle

LORRY = Vehicle.from_parameters(
    {"m_s": 5768.7, "I_yy": 35934.0, "I_xx": 6282.8, "m_uf": 170.85, "m_ur": 345.2}
    | {"k_sf": 103340.0, "k_sr": 166020.0, "k_tf": 711410.0, "k_tr": 1548500.0, "c_sf": 7750.0, "c_sr": 16007.0}
    | {"a": 2.1891, "b": 2.0488, "t_f": 0.79393, "t_r": 0.80662, "k_af": 80313.0, "k_ar": 121600.0}
    | {"r_f": 2.0582, "r_r": 2.0667, "h_tf": 8.8565, "h_tr": 5.8557},
    name="lorry",
)
"""Anti-roll bars, dampers that are twice as hard in rebound, and tyres that stiffen."""

VAN = Vehicle.from_parameters(
    {"m_s": 1847.8, "I_yy": 4585.2, "I_xx": 1081.9, "m_uf": 50.854, "m_ur": 61.792}
    | {"k_sf": 38873.0, "k_sr": 50358.0, "k_tf": 306860.0, "k_tr": 339890.0, "c_sf": 3192.5, "c_sr": 3073.0}
    | {"a": 1.4439, "b": 1.64, "t_f": 0.77648, "t_r": 0.72386, "k_af": 24769.0, "k_ar": 16835.0}
    | {"F_f": 60.56, "F_r": 104.67, "s_f": 71714.0, "s_r": 110310.0}
    | {"v_kf": 0.10071, "v_kr": 0.11399, "q_f": 0.30904, "q_r": 0.36286},
    name="van",
)
"""Anti-roll bars, friction, and dampers that are softer beyond a knee."""


ESTATE_CAR = Vehicle.from_parameters(
    {"m_s": 2260.7, "I_yy": 3502.7, "I_xx": 948.8, "m_uf": 55.252, "m_ur": 49.081}
    | {"k_sf": 31699.0, "k_sr": 39294.0, "k_tf": 235530.0, "k_tr": 247360.0, "c_sf": 2363.7, "c_sr": 3229.0}
    | {"a": 1.3418, "b": 1.6453, "t_f": 0.70853, "t_r": 0.89374, "c_tf": 159.73, "c_tr": 295.33}
    | {"k_zf": 2011.0, "k_zr": 2915.1, "c_zf": 186.65, "c_zr": 91.145}
    | {"v_kf": 0.12899, "v_kr": 0.10245, "q_f": 0.41367, "q_r": 0.2921},
    name="estate car",
)
"""Knees of the dampers, rubber beside the springs that relaxes, and tyres that damp."""


def worst(result: Result, truth: Vehicle) -> float:
    """Return the largest error of a parameter in its standard errors."""
    estimates = {name: result.parameters[name] for name in truth.parameters}
    return max(
        abs(float(one.value or 0.0) - truth.parameters[name]) / float(one.std or 0.0) for name, one in estimates.items()
    )


def passes() -> Campaign:
    """Return three passes over a bump."""
    speeds = {("fl", "fr", "rl", "rr"): 3.34, ("fl", "rl"): 3.15, ("fr", "rr"): 4.49}
    drops = [{"wheels": wheels, "excitation": "pass", "speed": speed} for wheels, speed in speeds.items()]
    return simulate(LORRY, drops=drops, noise=0.0115, seed=65, known={"total_mass": LORRY.total_mass})


def pushes(vehicle: Vehicle, force: float, noise: float, seed: int) -> Campaign:
    """Return five pushes by a rope with a force, N, that is cut; noise in m/s²."""
    wheels = [("fl", "fr", "rl", "rr"), ("fl", "fr"), ("rl", "rr"), ("fl", "rl"), ("fr", "rr")]
    drops = [{"wheels": pushed, "excitation": "push"} for pushed in wheels]
    push, known = Push(shape="rope", force=force), {"total_mass": vehicle.total_mass}
    return simulate(vehicle, drops=drops, push=push, noise=noise, seed=seed, known=known)


@pytest.mark.slow
def test_a_lorry_whose_likeliest_terms_begin_from_an_ordinary_vehicle() -> None:
    """The linear vehicle is one from which no step with rebound leads back: the campaign was rejected."""
    found = identify(passes())
    assert (found.verdict.state, {*found.fit.model}) == ("accept", {"anti-roll", "rebound", "tyre-curve"})
    assert worst(found, LORRY) < 4


@pytest.mark.slow
def test_a_van_whose_dampers_and_friction_show_beside_its_anti_roll_bars() -> None:
    """An ordinary vehicle with rubber and without anti-roll bars explained no more: the campaign was rejected."""
    found = identify(pushes(VAN, 2490.0, 0.043, 78))
    assert (found.verdict.state, {*found.fit.model}) == ("accept", {"anti-roll", "friction", "damper-curve"})
    assert worst(found, VAN) < 4


@pytest.mark.slow
def test_an_estate_car_whose_rubber_shows_in_no_score() -> None:
    """Knees that lie elsewhere in rebound took its place, accepted: the front dampers were off by 16 standard errors."""
    found = identify(pushes(ESTATE_CAR, 3857.0, 0.0233, 26))
    assert {*found.fit.model} == {"tyre-damping", "zener", "damper-curve"}
    damper = found.parameters["c_sf"]
    assert damper.value == pytest.approx(ESTATE_CAR.c_sf, abs=4 * float(damper.std or 0.0))

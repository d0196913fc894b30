"""Terms that hide each other: none shows, or explains much, while another one is missing."""

from __future__ import annotations

from dataclasses import replace

import pytest

import sprung
from selection.test_refined_terms import BALLAST
from sprung.selection.nonlinear_terms import KNEE_RATIOS
from sprung.selection.ordinary_vehicle import ordinary_vehicle
from sprung.selection.structure import choose_structure
from sprung.selection.terms import TERMS
from sprung.vehicle import TABLE_1_CAR, Vehicle

TWIST = {"I_w": 60.0, "k_w": 60.0 * (2 * 3.1416 * 17.0) ** 2, "c_w": 250.0, "a_w": 0.1, "u_w": 0.0, "e_w": 0.0}
"""A body that twists at 17 Hz."""

AIR = {"e_f": 4.4, "e_r": 4.6}
"""Air springs, by the height of their columns."""

PEOPLE = {"m_o": 140.0, "k_o": 140.0 * (2 * 3.1416 * 4.4) ** 2, "c_o": 2200.0, "x_o": -1.4, "y_o": 0.0, "t_o": 0.4}
"""Two people on their seats."""

CURVE = {"r_f": 1.8, "r_r": 1.8, "v_kf": 0.08, "v_kr": 0.08, "q_f": 0.5, "q_r": 0.5}
"""Dampers with a knee, harder in rebound."""

ORIFICE = {"r_f": 1.7, "r_r": 1.6, "v_kf": 0.1, "v_kr": 0.1, "q_f": 2.3, "q_r": 2.3, "c_sf": 700.0, "c_sr": 650.0}
"""Dampers that an orifice makes the harder the faster they move."""

BENDING = {"m_v": 80.0, "k_v": 80.0 * (2 * 3.1416 * 11.0) ** 2, "c_v": 400.0, "b_v": 0.6, "p_v": 0.1}
"""A body that bends at 11 Hz."""

SOFT_MOUNTS = {"k_df": 1.6e5, "k_dr": 2.2e5, "c_df": 350.0, "c_dr": 300.0}
"""Rubber mounts of dampers."""

ON_THE_FLOOR = {
    "name": "ballast",
    "items": [
        {"mass": 92.9, "position": (-1.1, 0.3, 0.5)},
        {"mass": 61.9, "position": (-2.07, -0.3, 0.5)},
    ],
}
"""A tenth of the car's mass."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("first", "second"),
    [(TWIST, AIR), (PEOPLE, CURVE), (TWIST, SOFT_MOUNTS), (PEOPLE, BENDING)],
    ids=[
        "twist behind air springs",
        "people behind damper curves",
        "twist behind soft mounts",
        "people behind bending",
    ],
)
def test_both_of_two_effects_are_found(first: dict[str, float], second: dict[str, float]) -> None:
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | first | second)
    known = {"total_mass": car.total_mass}
    result = sprung.identify(sprung.simulate(car, loads=[BALLAST], rate=500.0, noise=0.02, seed=2, known=known))
    assert result.verdict.state == "accept"
    assert not result.faults
    assert {*car.extras} <= {*result.fit.model}
    for name in TABLE_1_CAR.parameters:
        found = result.parameters[name]
        assert found.std is not None
        assert found.value == pytest.approx(car.parameters[name], abs=4 * found.std), name


@pytest.mark.slow
def test_dampers_that_steepen_are_found() -> None:
    """Whether the curve flattens or steepens beyond its knee shows in its score, from which an ordinary vehicle follows."""
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | ORIFICE)
    known = {"total_mass": car.total_mass}
    result = sprung.identify(sprung.simulate(car, loads=[BALLAST], rate=500.0, noise=0.02, seed=2, known=known))
    assert result.verdict.state == "accept"
    assert {"rebound", "damper-curve"} <= {*result.fit.model}
    for name in car.parameters:
        found = result.parameters[name]
        assert found.std is not None
        assert found.value == pytest.approx(car.parameters[name], abs=4 * found.std), name


def test_an_ordinary_damper_that_steepens_has_its_usual_force_in_a_drop() -> None:
    """Half the slope beyond 0.12 m/s, or twice: at 0.3 m/s both exert the same force."""
    structure = choose_structure(sprung.simulate(TABLE_1_CAR, duration=1.0), "shared", ("damper-curve",))
    forces = []
    for steepen, ratio in enumerate(KNEE_RATIOS):
        values, _ = ordinary_vehicle(replace(structure, dampers_steepen=bool(steepen)))
        assert values["q_f"] == ratio
        forces.append(values["c_sf"] * (values["v_kf"] + ratio * (0.3 - values["v_kf"])))
    assert forces[0] == pytest.approx(forces[1], rel=1e-12)


def test_a_knee_at_no_velocity_is_a_friction() -> None:
    """Dampers of buses have their knees at 0.05 m/s and more; a force that reverses within millimetres a second rubs."""
    curve = TERMS["damper-curve"]
    values = dict(TABLE_1_CAR.parameters) | {"q_f": 0.5, "q_r": 0.5, "v_kf": 0.05}
    assert not curve.is_something_else(values | {"v_kr": 0.05})
    assert curve.is_something_else(values | {"v_kr": 0.001})
    assert curve.counterpart == "friction"


@pytest.mark.slow
def test_an_engine_behind_friction_is_no_body_that_bends() -> None:
    """Bending around points twenty metres outside explains the recordings as well: a part that means nothing is not the end."""
    engine = {"m_e": 187.0, "k_e": 187.0 * (2 * 3.1416 * 8.44) ** 2, "c_e": 693.0, "x_e": -0.26}
    car = TABLE_1_CAR.with_values(**engine, F_f=60.0, F_r=60.0, s_f=3e5, s_r=3e5)
    result = sprung.identify(sprung.simulate(car, loads=[ON_THE_FLOOR], rate=500.0, duration=3.2, noise=0.02, seed=0))
    assert result.fit.model == ("engine", "friction")
    assert result.verdict.state == "accept"
    assert not result.faults
    found = result.parameters["m_e"]
    assert found.std is not None
    assert found.value == pytest.approx(engine["m_e"], abs=4 * found.std)

"""A body that is not one rigid mass: twist, bending, and people on soft seats."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import sprung
from sprung.simulation import drop_from_blocks, static_wheel_loads
from sprung.vehicle import TABLE_1_CAR, Item, Load, Readout, Sensor, Vehicle, coordinates, sensor_rows
from sprung.vibration import compute_modes

Array = NDArray[np.float64]


def oscillator(names: tuple[str, str, str], mass: float, frequency: float, damping: float) -> dict[str, float]:
    omega = 2 * np.pi * frequency
    return dict(zip(names, (mass, mass * omega**2, 2 * damping * mass * omega), strict=True))


def car_with(more: dict[str, float]) -> Vehicle:
    return Vehicle.from_parameters(TABLE_1_CAR.parameters | more)


TWISTS = car_with(oscillator(("I_w", "k_w", "c_w"), 40.0, 12.0, 0.02) | {"a_w": 0.1, "u_w": 0.03, "e_w": -0.02})
BENDS = car_with(oscillator(("m_v", "k_v", "c_v"), 900.0, 14.0, 0.02) | {"b_v": 0.25, "p_v": 0.05})
SEATED = car_with(oscillator(("m_o", "k_o", "c_o"), 150.0, 4.5, 0.3) | {"x_o": -1.2, "y_o": 0.2})
DIFFER = SEATED.with_values(y_o=0.0, t_o=0.33, d_mo=12.0, d_ko=15e3, d_co=-200.0)
CARS = pytest.mark.parametrize(
    "car", [TWISTS, BENDS, SEATED, DIFFER], ids=["twist", "bending", "occupants", "uneven-occupants"]
)

BAGS = Load(
    name="bags",
    items=(
        Item(mass=140.0, position=(-2.2, 0.1, 0.6), inertia=(5.0, 8.0)),
        Item(mass=80.0, position=(-0.9, -0.4, 0.6)),
    ),
)


@pytest.mark.parametrize("x", [0.2, -1.4, -3.0])
def test_a_sensor_beside_its_stated_place_reads_what_one_there_does(x: float) -> None:
    """Where a body bends and twists, it leans otherwise at every place; twist is even here."""
    car = Vehicle.from_parameters(TWISTS.with_values(u_w=0.0, e_w=0.0).parameters | BENDS.parameters)
    names, values = tuple(car.parameters), np.array(list(car.parameters.values()))
    stated = Sensor(channel="stated", on="body", position=(x, 0.6, 0.5), gain_std=0.0, tilt_std=0.0, position_std=0.01)
    readout = Readout.with_unknowns([stated], names, car.wheelbase)
    there = replace(stated, position=(x + 0.01, 0.6 - 0.02, 0.5))
    found = readout.at(np.append(values, [0.01, -0.02]))
    expected = Readout.of([there], names, car.wheelbase).at(values)
    # Of the second order: 0.01² / 2 of curvature, 0.01 · 0.02 of twist.
    assert_allclose(found, expected, rtol=0, atol=2.1e-4)
    assert np.abs(found - readout.at(np.append(values, [0.0, 0.0]))).max() > 8e-3


def test_the_shapes_are_those_of_a_body_that_turns_and_bends_along_its_length() -> None:
    """The angle of twist is a cubic along the body, linear from axle to axle; bending is a parabola through both."""
    car = Vehicle.from_parameters(TWISTS.parameters | BENDS.parameters)
    names, L = tuple(car.parameters), car.wheelbase
    places = [(0.3, 0.5), (0.0, 0.7), (-L / 2, 0.6), (-L, -0.4), (-3.1, 0.2)]
    sensors = [Sensor(channel=str(i), on="body", position=(x, y, 0.5)) for i, (x, y) in enumerate(places)]
    rows = sensor_rows(sensors, names, L).at(list(car.parameters.values()))
    order = coordinates(names)
    x, y = np.array(places).T
    along = 1 + 2 * x / L
    angle = along / 2 + (1 - along**2) * (0.03 + 0.02 * along)  # over that between the axles: 1/2 and -1/2 at them
    assert_allclose(rows[:, order.index("q_w")], y * L * angle, atol=1e-12)
    assert_allclose(rows[:, order.index("q_v")], (L / 2) ** 2 / 2 - (x + L / 2) ** 2 / 2, atol=1e-12)
    # A pure twist strains springs by what the corners rise; the middle's rise by bending strains none.
    K = car.matrices().K - np.diag([car.k_w * L**2 if name == "q_w" else 0.0 for name in order])
    corners = [(car.k_sf, car.t_f), (car.k_sr, car.t_r)]
    own = sum(2 * rate * (half or 0.0) ** 2 * (L / 2) ** 2 for rate, half in corners)
    assert K[order.index("q_w"), order.index("q_w")] == pytest.approx(own)
    assert K[order.index("q_v"), order.index("q_v")] == pytest.approx(car.k_v * (L**2 / 8) ** 2)


def test_a_floating_body_swings_at_its_own_frequency() -> None:
    soft = {"k_sf": 1e-3, "k_sr": 1e-3, "c_sf": 1e-3, "c_sr": 1e-3}
    for car, name, frequency in ((TWISTS, "body twist", 12.0), (BENDS, "body bending", 14.0)):
        floating = Vehicle.from_parameters(car.parameters | soft)
        modes = {mode.name: mode for mode in compute_modes(floating.matrices(), coordinates(car.parameters))}
        assert modes[name].frequency == pytest.approx(frequency, rel=1e-5)
        assert modes[name].damping_ratio == pytest.approx(0.02, rel=1e-4)


@CARS
def test_at_rest_it_weighs_what_a_rigid_one_weighs(car: Vehicle) -> None:
    stiff = {name: 1e9 for name in ("k_w", "k_v", "k_o") if name in car.parameters}
    rigid = Vehicle.from_parameters(car.parameters | stiff)
    assert_allclose(static_wheel_loads(rigid, BAGS), static_wheel_loads(TABLE_1_CAR, BAGS), rtol=1e-3)
    assert static_wheel_loads(car, BAGS).sum() == pytest.approx(static_wheel_loads(TABLE_1_CAR, BAGS).sum())


@CARS
def test_a_rigid_one_is_the_paper_s(car: Vehicle) -> None:
    stiff = {name: 1e10 for name in ("k_w", "k_v", "k_o") if name in car.parameters}
    rigid = Vehicle.from_parameters(car.parameters | stiff | ({"c_o": 1e6} if "c_o" in car.parameters else {}))
    ours, plain = (drop_from_blocks(one, wheels=("fl", "rr")).motion(0.002, 300) for one in (rigid, TABLE_1_CAR))
    wheels = slice(3, 7)
    assert_allclose(ours.displacement[wheels], plain.displacement[wheels], atol=2e-5)


@CARS
def test_without_noise_identification_returns_what_was_simulated(car: Vehicle) -> None:
    result = sprung.identify(sprung.simulate(car, loads=[BAGS], noise=0.0), extras=car.extras)
    for name, value in car.parameters.items():
        assert result.parameters[name].value == pytest.approx(value, rel=1e-4, abs=1e-4)


@CARS
@pytest.mark.slow
def test_it_is_estimated_within_its_errors(car: Vehicle) -> None:
    result = sprung.identify(sprung.simulate(car, loads=[BAGS], noise=0.02, seed=1), extras=car.extras)
    assert result.verdict.state == "accept"
    for name, value in car.parameters.items():
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - value) < 4 * found.std


@pytest.mark.slow
@pytest.mark.parametrize("car", [SEATED, DIFFER], ids=["alike", "uneven"])
def test_people_on_seats_are_selected(car: Vehicle) -> None:
    campaign = sprung.simulate(car, loads=[BAGS], noise=0.02, seed=1)
    assert sprung.identify(campaign).fit.model == car.extras


def test_two_people_who_differ_are_two_masses_each_on_a_seat_of_its_own() -> None:
    """Matrices of two people assembled by hand, each a mass, a spring and a damper at a place of its own."""
    order = coordinates(tuple(DIFFER.parameters))
    assert (DIFFER.m_o, DIFFER.t_o) == (pytest.approx(150.0), pytest.approx(0.33))
    expected = {law: np.zeros((len(order), len(order))) for law in "MCK"}
    for side, mass, rate, damping in (
        (1, 75.0 + 12.0, DIFFER.k_o / 2 + 15e3, DIFFER.c_o / 2 - 200.0),
        (-1, 75.0 - 12.0, DIFFER.k_o / 2 - 15e3, DIFFER.c_o / 2 + 200.0),
    ):
        below, own = np.zeros(len(order)), np.zeros(len(order))
        below[:3] = 1.0, 1.2 - DIFFER.a, side * 0.33
        own[[order.index("z_o"), order.index("dz_o")]] = 1.0, side
        expected["M"] += mass * (np.outer(own, own) - np.outer(below, below))
        expected["K"] += rate * np.outer(below - own, below - own)
        expected["C"] += damping * np.outer(below - own, below - own)
    plain = TABLE_1_CAR.matrices()
    for law, added in expected.items():
        whole = np.array(getattr(DIFFER.matrices(), law))
        whole[:7, :7] -= getattr(plain, law)
        assert_allclose(whole, added, atol=1e-9 * np.abs(added).max())


@pytest.mark.slow
def test_how_far_people_sit_apart_does_not_decide_about_the_roll_inertia() -> None:
    """Held at 0.37 m, people 0.33 m from their middle gave a roll inertia 5 to 12 % off."""
    car = SEATED.with_values(y_o=0.0, t_o=0.32)
    result = sprung.identify(sprung.simulate(car, loads=[BAGS], noise=0.01, seed=3), extras=("occupants",))
    for name in ("I_xx", "t_f", "t_r", "t_o"):
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - car.parameters[name]) < 4 * found.std
    assert result.parameters["I_xx"].value == pytest.approx(car.I_xx, rel=0.02)


def test_an_infinite_modal_mass_is_none() -> None:
    assert TABLE_1_CAR.extras == ()
    assert TABLE_1_CAR.with_values(I_w=40.0).extras == ("twist",)


def test_people_who_move_with_the_body_are_a_part_of_it() -> None:
    """In any motion of the rigid body the kinetic energy is that of the vehicle without seats: I_xx includes people."""
    place = {"m_o": 150.0, "x_o": -1.2, "y_o": 0.1, "t_o": 0.41}
    seated = Vehicle.from_parameters(TABLE_1_CAR.parameters | place)
    heave, pitch, roll = 0.7, 0.3, -0.4
    body = np.array([heave, pitch, roll, 0.1, 0.2, 0.3, 0.4])
    # z_o is the mean of both seats, dz_o half their difference: t_o left and right of their middle.
    people = [heave - pitch * (seated.a + place["x_o"]) + roll * place["y_o"], place["t_o"] * roll]
    whole = np.array([*body, *people])
    assert whole @ seated.matrices().M @ whole == pytest.approx(body @ TABLE_1_CAR.matrices().M @ body, rel=1e-12)
    np.testing.assert_allclose(
        seated.matrices().K @ [*body[:3], *(0, 0, 0, 0), *people],
        [*TABLE_1_CAR.matrices().K @ [*body[:3], 0, 0, 0, 0], 0, 0],
        atol=1e-9 * seated.k_o,
    )

"""An engine on its mounts: one more coordinate, a part of the body, and found without being asked for."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sprung
from sprung.errors import InputError
from sprung.simulation import drop_from_blocks, static_wheel_loads
from sprung.vehicle import TABLE_1_CAR, Load, coordinates, parse_record
from sprung.vibration import compute_modes

HANGING = 2 * np.pi * 9.5  # 1/s of the engine on its mounts, the body held

WITH_ENGINE = TABLE_1_CAR.with_values(
    m_e=160.0, k_e=160.0 * HANGING**2, c_e=0.14 * 160.0 * HANGING, x_e=0.1, name="car with an engine"
)

BALLAST = parse_record(Load, {"name": "ballast", "items": [{"mass": 150.0, "position": [-1.1, 0.3, 0.5]}]})


def test_the_matrices_are_those_of_a_body_and_an_engine_of_their_own() -> None:
    # Written out: the body that is left has its own centre of gravity, towards the rear, and its own pitch inertia about it.
    car = WITH_ENGINE
    ahead = car.a + car.x_e  # of the centre of gravity of both
    rest = car.m_s - car.m_e
    behind = car.m_e * ahead / rest
    inertia = car.I_yy - car.m_e * ahead**2 - rest * behind**2
    M, _, K = car.matrices()
    z, theta, e = np.eye(8)[[0, 1, 7]]
    own = z + behind * theta  # what is behind the centre of gravity rises with the nose going down
    expected = rest * np.outer(own, own) + inertia * np.outer(theta, theta) + car.m_e * np.outer(e, e)
    chosen = np.ix_([0, 1, 7], [0, 1, 7])
    assert_allclose(M[chosen], expected[chosen], rtol=1e-12, atol=1e-9)
    mount = z - ahead * theta - e
    assert_allclose(K - TABLE_1_CAR_K_BESIDE, car.k_e * np.outer(mount, mount), rtol=1e-9, atol=1e-6)


TABLE_1_CAR_K_BESIDE = np.pad(TABLE_1_CAR.matrices().K, (0, 1))


def test_an_engine_that_is_bolted_down_is_none() -> None:
    bolted = WITH_ENGINE.with_values(k_e=1e10, c_e=1e6)
    ours, plain = (drop_from_blocks(car, wheels=("fl", "rr")).motion(0.002, 400) for car in (bolted, TABLE_1_CAR))
    assert_allclose(ours.displacement[:7], plain.displacement, atol=1e-6 * np.abs(plain.displacement).max())


def test_it_weighs_what_it_weighed_before() -> None:
    assert_allclose(static_wheel_loads(WITH_ENGINE, BALLAST), static_wheel_loads(TABLE_1_CAR, BALLAST), rtol=1e-12)


def test_in_the_air_only_gravity_moves_the_whole_vehicle() -> None:
    fall = drop_from_blocks(WITH_ENGINE, height=0.08)
    flight = fall.motion(1e-4, int(fall.events[4].time / 1e-4))
    M = WITH_ENGINE.matrices().M
    weight = WITH_ENGINE.total_mass * 9.80665
    assert_allclose(np.ones(8) * (np.arange(8) % 7 != 1) * (np.arange(8) != 2) @ M @ flight.acceleration, -weight)


def test_its_mode_has_its_name() -> None:
    named = {mode.name: mode for mode in compute_modes(WITH_ENGINE.matrices(), coordinates(WITH_ENGINE.parameters))}
    assert len(coordinates(WITH_ENGINE.parameters)) == 8
    # On a body that gives way it swings faster than on one that is held.
    assert named["engine bounce"].frequency == pytest.approx(10.87, abs=0.01)
    assert named["body bounce"].frequency < 1.5


def test_an_engine_that_leaves_nothing_of_the_body_is_refused() -> None:
    with pytest.raises(InputError, match="leaves the body some mass and pitch inertia"):
        WITH_ENGINE.with_values(m_e=800.0)


def test_frequencies_are_told_where_no_mass_is() -> None:
    # Without a load only ratios are determined, and every frequency follows from ratios.
    result = sprung.identify(sprung.simulate(WITH_ENGINE, noise=0.02, seed=1), extras=["engine"])
    assert result.parameters["m_e"].value is None
    (engine,) = [mode for mode in result.modes["empty"] if mode.name == "engine bounce"]
    assert engine.frequency_std is not None
    assert engine.frequency_std < 0.002

"""Pure free decays."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sprung.errors import InputError
from sprung.simulation import free_decays
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import SCHOOL_BUS, WHEELS, Added, Load, Sensor, free_decay

PAPER_LOAD = Load(name="loaded", added=Added(mass=470, I_yy=1057.5, I_xx=339.6))
ON_WHEELS = [Sensor(channel=station, on=station) for station in WHEELS]


def test_recordings_are_the_free_decays_of_the_given_states() -> None:
    states = 0.01 * np.random.default_rng(4).standard_normal((3, 14))
    campaign = free_decays(SCHOOL_BUS, states=states, loads=[PAPER_LOAD], sensors=ON_WHEELS, rate=200, duration=1.5)
    assert [(drop.file, drop.load, drop.start) for drop in campaign.drops] == [
        (f"{load}_decay{number}.csv", load, 0.0) for load in ("empty", "loaded") for number in ("", "_2", "_3")
    ]
    for i, recording in enumerate(campaign.recordings):
        load = campaign.load(campaign.drops[i].load)
        expected = free_decay(SCHOOL_BUS.matrices(load), states[i % 3], 1 / 200, 300).acceleration[3:]
        assert_allclose(recording.values, STANDARD_GRAVITY + expected, rtol=1e-12)
        assert (recording.start, recording.rate) == (0.0, 200)


def test_states_by_load() -> None:
    first, second = np.eye(14)[:2] * 0.01
    campaign = free_decays(SCHOOL_BUS, states={"empty": first, "loaded": [first, second]}, loads=[PAPER_LOAD])
    assert [drop.load for drop in campaign.drops] == ["empty", "loaded", "loaded"]


def test_random_states_excite_all_fourteen_and_repeat_with_the_seed() -> None:
    one, again = (free_decays(SCHOOL_BUS, states=14, seed=9, gravity=0.0) for _ in range(2))
    first = np.array([recording.values for recording in one.recordings])
    assert np.array_equal(first, [recording.values for recording in again.recordings])
    # Fourteen decays together span fourteen different ones.
    assert np.linalg.matrix_rank(first.reshape(14, -1), tol=1e-6) == 14
    assert 1.0 < np.abs(first).max() < 1000.0  # m/s², as in a drop test


def test_states_of_the_wrong_shape_are_named_with_everything_else() -> None:
    with pytest.raises(InputError) as caught:
        free_decays(SCHOOL_BUS, states=np.zeros((2, 7)), loads=[PAPER_LOAD], duration=-1)
    assert [problem.found for problem in caught.value.problems] == [
        "-1",
        "shape (2, 7) for load 'empty'",
        "shape (2, 7) for load 'loaded'",
    ]

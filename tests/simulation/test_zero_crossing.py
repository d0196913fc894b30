"""The first fall of a function of the response, on oscillators whose answers are known."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sprung.simulation.zero_crossing import find_first_zero

TURN = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
"""Y = {sin(t + φ), cos(t + φ), 1}."""


def start(phase: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.array([np.sin(phase), np.cos(phase), 1.0])


@pytest.mark.parametrize("step", [0.3, 0.1, 0.01])
def test_the_first_of_several_whatever_the_grid(step: float) -> None:
    # sin t + 0.5 falls to zero at 7π/6, cos t at π/2, and sin t at π.
    watch = np.array([[1.0, 0, 0.5], [0, 1, 0], [1, 0, 0]])
    found = find_first_zero(watch, TURN, start(0.1), step, int(5 / step))
    assert isinstance(found, tuple)
    assert found[1] == 1
    assert found[0] == pytest.approx(np.pi / 2 - 0.1, abs=1e-14)


def test_a_rise_is_no_fall() -> None:
    # sin t comes up to its peak and 1.1 - cos t rises; neither is at zero up to 2.9.
    watch = np.array([[1.0, 0, 0], [0, -1, 1.1]])
    assert_allclose(find_first_zero(watch, TURN, start(0.1), 0.1, 28), start(2.9), atol=1e-13)


def test_zero_at_the_start_counts_only_on_the_way_down() -> None:
    rising = find_first_zero(np.array([[1.0, 0, 0]]), TURN, start(0.0), 0.1, 50)
    assert isinstance(rising, tuple)
    assert rising[0] == pytest.approx(np.pi, abs=1e-14)
    falling = find_first_zero(np.array([[-1.0, 0, 0]]), TURN, start(0.0), 0.1, 50)
    assert falling == (0.0, 0)


@pytest.mark.parametrize("blur", [-1e-16, 1e-16])
def test_up_and_down_again_before_the_first_grid_point(blur: float) -> None:
    # sin t - sin 1.5 is zero at t = 1.5 and at π - 1.5, 0.14 later, and rounding may blur the first zero.
    watch = np.array([[1.0, 0, -np.sin(1.5) + blur]])
    found = find_first_zero(watch, TURN, start(1.5), 0.2, 3)
    assert isinstance(found, tuple)
    assert found[0] == pytest.approx(np.pi - 3.0, abs=1e-13)


def test_a_dip_between_two_grid_points_is_seen() -> None:
    # 0.99999 + sin t is negative within 0.0045 of 3π/2 = 4.7124, between the grid points 4.7 and 4.8.
    watch = np.array([[1.0, 0, 0.99999]])
    found = find_first_zero(watch, TURN, start(0.0), 0.1, 60)
    assert isinstance(found, tuple)
    assert found[0] == pytest.approx(1.5 * np.pi - np.arccos(0.99999), abs=1e-11)


def test_coming_near_is_not_falling() -> None:
    watch = np.array([[1.0, 0, 1.0001]])
    assert_allclose(find_first_zero(watch, TURN, start(0.0), 0.1, 60), start(6.0), atol=1e-12)


def test_down_from_zero_and_up_again_before_the_first_grid_point() -> None:
    # sin 1.5 - sin t leaves zero downwards at t = 1.5 and is back 0.14 later.
    found = find_first_zero(np.array([[-1.0, 0, np.sin(1.5) - 1e-17]]), TURN, start(1.5), 0.2, 3)
    assert found == (0.0, 0)

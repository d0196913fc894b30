"""The optimiser on functions whose maximum is known, real and complex, and where it must stop."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from sprung.optimisation import Maximum, NormalEquations, maximise

Real = NDArray[np.float64]
Array = NDArray[Any]


class Residuals(NamedTuple):
    """Twice the log-likelihood -|r(x)|² of residuals with their Jacobian; points are x itself."""

    name: str
    scale: complex = 1.0

    def residuals(self, x: Array) -> tuple[Array, Array]:
        if self.name == "rosenbrock":  # H. H. Rosenbrock, Computer J. 3 (1960) 175: a curved valley, its end at (1, 1)
            return np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]), np.array([[-20 * x[0], 10.0], [-1.0, 0.0]])
        if self.name == "powell":  # M. J. D. Powell, Computer J. 5 (1962) 147: singular at its end (0, 0, 0, 0)
            a, b, c, d = x
            values = np.array([a + 10 * b, 5**0.5 * (c - d), (b - 2 * c) ** 2, 10**0.5 * (a - d) ** 2])
            rows = [[1, 10, 0, 0], [0, 0, 5**0.5, -(5**0.5)], [0, 2 * (b - 2 * c), -4 * (b - 2 * c), 0]]
            return values, np.array([*rows, [2 * 10**0.5 * (a - d), 0, 0, -2 * 10**0.5 * (a - d)]], dtype=float)
        # A complex linear problem: x = (2 + i, -1).
        matrix = np.array([[1.0, 2j], [0.5, 1.0], [1j, 3.0]]) * self.scale
        return matrix @ (x - np.array([2 + 1j, -1.0])), matrix

    def normal_equations(self, point: Array, _damping: float) -> NormalEquations:
        values, jacobian = self.residuals(point)
        information = jacobian.conj().T @ jacobian
        scaling = np.diag(np.maximum(np.diag(information).real, 1e-12))
        gradient = -jacobian.conj().T @ values
        return NormalEquations(information + 1e-14 * scaling, gradient, scaling, np.eye(len(point)))

    def trial(self, point: Array, step: Array, _damping: float) -> tuple[Array, float]:
        before, after = (self.residuals(x)[0] for x in (point, point + step))
        return point + step, float(np.sum(np.abs(before) ** 2) - np.sum(np.abs(after) ** 2))


class Wall(NamedTuple):
    """A slope that ends at a wall: beyond x = 1 nothing exists."""

    def normal_equations(self, point: Real, _damping: float) -> NormalEquations:
        del point
        return NormalEquations(np.eye(1), np.ones(1), np.eye(1), np.eye(1))

    def trial(self, point: Real, step: Real, _damping: float) -> tuple[Real, float]:
        return point + step, -np.inf if point[0] + step[0] > 1.0 else float(step[0])


class Distant(NamedTuple):
    """A steep bowl, and a coordinate whose maximum is fifty of the longest steps away."""

    def normal_equations(self, point: Real, _damping: float) -> NormalEquations:
        curvature = np.diag([1e6, 100.0])
        return NormalEquations(curvature, curvature @ (np.array([0.0, 50.0]) - point), curvature, np.eye(2))

    def trial(self, point: Real, step: Real, _damping: float) -> tuple[Real, float]:
        before, after = (np.array([1e6, 100.0]) @ (x - np.array([0.0, 50.0])) ** 2 for x in (point, point + step))
        return point + step, float(before - after)


class Cliff(NamedTuple):
    """Nothing exists but the start."""

    def normal_equations(self, point: Real, _damping: float) -> NormalEquations:
        del point
        return NormalEquations(np.eye(1), np.full(1, 1e6), np.eye(1), np.eye(1))

    def trial(self, point: Real, step: Real, _damping: float) -> tuple[Real, float]:
        return point + step, -np.inf


class Promising(NamedTuple):
    """A kink of which one side alone is seen: a gain of one is expected, and each step brings a thousandth of what it says."""

    brings: float

    def normal_equations(self, point: Real, _damping: float) -> NormalEquations:
        del point
        return NormalEquations(np.eye(1), np.ones(1), np.eye(1), np.eye(1))

    def trial(self, point: Real, step: Real, _damping: float) -> tuple[Real, float]:
        return point + step, self.brings


class Lagging(NamedTuple):
    """Twice the log-likelihood -x² - f(y)², where y is eliminated, f(y) = arctan y: undamped steps beyond 1.39 diverge."""

    def normal_equations(self, point: Real, damping: float) -> NormalEquations:
        gain = float(np.arctan(point[1]) ** 2 / (1 + damping))
        return NormalEquations(np.eye(1), -point[:1], np.eye(1), np.eye(1), gain)

    def trial(self, point: Real, step: Real, damping: float) -> tuple[Real, float]:
        own = -np.arctan(point[1]) * (1 + point[1] ** 2) / (1 + damping)
        tried = point + np.array([step[0], own])
        value, other = (x**2 + np.arctan(y) ** 2 for x, y in (point, tried))
        return tried, float(value - other)


class Flatter(NamedTuple):
    """Twice the log-likelihood -x², of which the information says that it bends so many times as much."""

    times: float

    def normal_equations(self, point: Real, _damping: float) -> NormalEquations:
        return NormalEquations(self.times * np.eye(1), -point, np.eye(1), np.eye(1))

    def trial(self, point: Real, step: Real, _damping: float) -> tuple[Real, float]:
        return point + step, float(point[0] ** 2 - (point + step)[0] ** 2)


@pytest.mark.parametrize("times", [2.0, 4.0, 7.0])
def test_a_step_goes_on_where_less_bends_than_the_information_says(times: float) -> None:
    """A step is too short by that factor, and gains 2 - 1/factor of what is expected: the vertex of the parabola is the end."""
    found = maximise(Flatter(times), np.ones(1), tolerance=1e-9, damping=1e-12, most_steps=3)
    assert found.converged
    assert found.steps == 1
    np.testing.assert_allclose(found.point, 0.0, atol=1e-9)


class Hesitant(NamedTuple):
    """An eliminated unknown that promises more than it gains, but for a damping of more than a thousandth."""

    dampings: list[float]

    def normal_equations(self, point: Real, damping: float) -> NormalEquations:
        self.dampings.append(damping)
        return NormalEquations(np.eye(1), -point, np.eye(1), np.eye(1), 2.0 if damping < 1e-3 else 1e-4)

    def trial(self, point: Real, step: Real, _damping: float) -> tuple[Real, float]:
        return point + step, float(point[0] ** 2 - (point + step)[0] ** 2) + 0.01


def test_eliminated_unknowns_are_damped_more_while_steps_gain_little() -> None:
    dampings: list[float] = []
    found = maximise(Hesitant(dampings), np.full(1, 0.01), tolerance=1e-3, damping=1e-12, most_steps=20)
    assert found.converged
    assert dampings == sorted(dampings)
    assert dampings[0] == pytest.approx(1e-5)
    assert 1e-3 < dampings[-1] <= 1e-2
    assert found.steps < 5


@pytest.mark.parametrize("lag", [0.5, 3.0])
def test_it_has_not_converged_before_eliminated_unknowns_have(lag: float) -> None:
    """Nothing is left to gain by x itself; undamped steps of what is eliminated lose where they begin far away.

    They end within the root of 250 times the tolerance, as what they leave is of second order in the others.
    """
    found = maximise(Lagging(), np.array([0.0, lag]), tolerance=1e-11, damping=1e-9, most_steps=50)
    assert found.converged
    np.testing.assert_allclose(found.point, [0.0, 0.0], atol=1e-4)


def test_the_end_of_a_curved_valley_is_found() -> None:
    found = maximise(Residuals("rosenbrock"), np.array([-1.2, 1.0]), tolerance=1e-12, damping=1e-3, most_steps=100)
    assert found.converged
    np.testing.assert_allclose(found.point, [1.0, 1.0], atol=1e-5)


def test_a_singular_end_is_approached() -> None:
    start = np.array([3.0, -1.0, 0.0, 1.0])
    found = maximise(Residuals("powell"), start, tolerance=1e-16, damping=1e-3, most_steps=100)
    assert found.converged
    np.testing.assert_allclose(found.point, 0.0, atol=1e-3)  # the fourth power of which is the tolerance


@pytest.mark.parametrize("scale", [1.0, 1j, 1e4])
def test_a_linear_problem_takes_one_step_complex_as_well(scale: complex) -> None:
    start = np.zeros(2, dtype=complex)
    found = maximise(Residuals("linear", scale), start, tolerance=1e-9, damping=1e-12, most_steps=10)
    assert found.converged
    assert found.steps == 1
    np.testing.assert_allclose(found.point, [2 + 1j, -1.0], atol=1e-9)


def test_at_the_maximum_no_step_is_taken() -> None:
    found = maximise(Residuals("rosenbrock"), np.array([1.0, 1.0]), tolerance=1e-9, damping=1e-3, most_steps=10)
    assert (found.steps, found.converged) == (0, True)


def test_no_step_is_longer_than_allowed() -> None:
    start = np.zeros(2, dtype=complex)
    found = maximise(Residuals("linear"), start, tolerance=1e-9, damping=1e-12, most_steps=1, longest_step=0.1)
    assert np.abs(found.point).max() == pytest.approx(0.1)
    assert not found.converged


def test_steps_are_counted_and_limited() -> None:
    """From the second point on, four are left to gain; from the third one, three thousandths."""
    start = np.array([-1.2, 1.0])
    found = [
        maximise(Residuals("rosenbrock"), start, tolerance=1e-12, damping=1e-3, most_steps=most) for most in (2, 3)
    ]
    assert [(one.steps, one.converged) for one in found] == [(2, False), (3, True)]


def test_who_is_told_to_stop_has_not_converged() -> None:
    found = maximise(
        Residuals("rosenbrock"), np.array([-1.2, 1.0]), tolerance=1e-12, damping=1e-3, most_steps=50,
        stop=lambda point, _: bool(point[0] > 0),
    )  # fmt: skip
    assert found.point[0] > 0
    assert not found.converged
    assert 0 < found.steps < 50


def test_before_a_wall_it_ends() -> None:
    found = maximise(Wall(), np.array([0.0]), tolerance=1e-9, damping=1e-3, most_steps=1000)
    assert found.steps < 1000
    assert 0.9 < found.point[0] <= 1.0


def test_where_even_the_shortest_step_should_gain_but_does_not_it_has_not_converged() -> None:
    """A gradient of 1e6 that leads nowhere: a wrong derivative, or a cliff."""
    found = maximise(Cliff(), np.array([0.0]), tolerance=1e-9, damping=1e-3, most_steps=10)
    assert (found.steps, found.converged) == (0, False)


def test_without_any_direction_there_is_nothing_to_gain() -> None:
    equations = NormalEquations(np.zeros((0, 0)), np.zeros(0), np.zeros((0, 0)), np.zeros((3, 0)))
    step, gain = equations.step(0.1)
    np.testing.assert_array_equal(step, np.zeros(3))
    assert gain == 0.0


class Scripted:
    """A log-likelihood whose steps gain other than expected, as where noise levels follow the residuals."""

    def __init__(self, expected: list[float], gained: list[float]) -> None:
        self.expected, self.gained = expected, gained

    def normal_equations(self, point: int, _damping: float) -> NormalEquations:
        one = np.ones((1, 1))
        return NormalEquations(one, np.array([self.expected[point] ** 0.5]), one, one)

    def trial(self, point: int, step: Array, _damping: float) -> tuple[int, float]:
        del step
        return point + 1, self.gained[point]


def test_a_step_that_gains_far_more_than_expected_is_not_the_last() -> None:
    """Twice the log-likelihood of a friction, from the first seconds of a fit: 17 are enough, 250 were expected, 4000 came."""
    found = maximise(
        Scripted([5000.0, 250.0, 8000.0, 300.0, 5.0], [5000.0, 4000.0, 9000.0, 300.0, 5.0]),
        0,
        tolerance=17.0,
        damping=1e-9,
        most_steps=20,
    )
    assert found.converged
    assert found.point >= 3
    # A step that gains what was expected, a twentieth of the one before, is the last one.
    found = maximise(
        Scripted([5000.0, 250.0, 0.1], [5000.0, 250.0, 0.1]), 0, tolerance=17.0, damping=1e-9, most_steps=20
    )
    assert found == Maximum(2, 2, converged=True)


class Bend(NamedTuple):
    """Twice the log-likelihood -x² up to x = 1 and -x⁴ behind it: its quadratic model there promises what is not to be had."""

    tried: list[float]

    def normal_equations(self, point: Real, _damping: float) -> NormalEquations:
        x = point[0]
        gradient = -x if abs(x) < 1 else -2 * x**3
        return NormalEquations(np.full((1, 1), 1e-3 if abs(x) > 1 else 1.0), np.full(1, gradient), np.eye(1), np.eye(1))

    def trial(self, point: Real, step: Real, _damping: float) -> tuple[Real, float]:
        before, after = (float(x**2 if abs(x) < 1 else x**4) for x in (point[0], point[0] + step[0]))
        self.tried.append(point[0] + step[0])
        return point + step, before - after


def test_few_steps_are_tried_where_little_damping_changes_nothing() -> None:
    """From a damping of 1e-9 about 40 is needed: ten rises by a factor of 8 would need as many trials."""
    bend = Bend([])
    found = maximise(bend, np.array([3.0]), tolerance=1e-9, damping=1e-9, most_steps=1, cautious=True)
    assert abs(found.point[0]) < 3.0
    assert len(bend.tried) <= 8


def test_at_a_kink_steps_that_bring_nothing_end() -> None:
    """A gain is expected for ever: after three steps in turn that bring less than the tolerance there is no fourth."""
    idle = maximise(Promising(1e-3), np.zeros(1), tolerance=0.01, damping=0.0, most_steps=50)
    assert (idle.steps, idle.converged) == (3, True)
    busy = maximise(Promising(0.02), np.zeros(1), tolerance=0.01, damping=0.0, most_steps=50)
    assert (busy.steps, busy.converged) == (50, False)


@pytest.mark.parametrize(("gain", "converged"), [(1e-6, True), (0.005, True), (0.02, False)])
def test_steps_end_at_an_optimum_where_the_last_one_gained_next_to_nothing(gain: float, converged: bool) -> None:
    """A direction that records hardly show: a hundred steps of 1e-6 each, where 1e-8 was asked, are no failure."""
    found = maximise(Scripted([gain] * 9, [0.5 * gain] * 9), 0, tolerance=1e-8, damping=0.0, most_steps=5)
    assert (found.steps, found.converged) == (5, converged)
    held = maximise(
        Scripted([gain] * 9, [0.5 * gain] * 9), 0, tolerance=1e-8, damping=0.0, most_steps=5, longest_step=1e-5
    )
    assert (held.steps, held.converged) == (5, False)


@pytest.mark.parametrize(("gain", "steps", "converged"), [(0.08, 9, True), (0.12, 30, False)])
def test_steps_that_are_never_expected_to_gain_less_end(gain: float, steps: int, converged: bool) -> None:
    """Where friction turns round the likelihood has a kink at every step: a third of a standard error is as near as it gets."""
    found = maximise(Scripted([gain] * 40, [0.5 * gain] * 40), 0, tolerance=0.004, damping=0.0, most_steps=30)
    assert (found.steps, found.converged) == (steps, converged)


class Bent(NamedTuple):
    """Twice the log-likelihood -(x - 3)² - 100 (y - x²)², where y is eliminated, and follows x along a straight line.

    Points are x, y, and how often y has stepped alone.
    """

    def normal_equations(self, point: Real, _damping: float) -> NormalEquations:
        x, y, _ = point
        return NormalEquations(np.eye(1), np.array([3 - x]), np.eye(1), np.eye(1), float(100 * (x**2 - y) ** 2))

    def trial(self, point: Real, step: Real, _damping: float) -> tuple[Real, float]:
        x, _, alone = point
        tried = np.array([x + step[0], x**2 + 2 * x * step[0], alone + (step[0] == 0)])
        value, other = ((x - 3) ** 2 + 100 * (y - x**2) ** 2 for x, y, _ in (point, tried))
        return tried, float(value - other)


def test_eliminated_unknowns_step_alone_where_they_did_not_follow() -> None:
    """One step leads x there; y, which followed along a straight line, loses a hundred times the fourth power of it."""
    found = maximise(Bent(), np.array([2.0, 4.0, 0.0]), tolerance=1e-9, damping=1e-12, most_steps=10)
    assert found.converged
    assert found.steps == 1
    np.testing.assert_allclose(found.point, [3.0, 9.0, 1.0], atol=1e-6)


def test_a_step_that_was_held_back_does_not_say_that_little_is_left() -> None:
    """The first step gains a hundred times what the next one does, of which fifty are to come."""
    found = maximise(Distant(), np.array([1.0, 0.0]), tolerance=450.0, damping=1e-9, most_steps=100, longest_step=1.0)
    assert found.converged
    np.testing.assert_allclose(found.point, [0.0, 50.0], atol=2.5)

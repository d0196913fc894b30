"""The method of Levenberg and Marquardt: Gauss-Newton steps on a log-likelihood, damped until they gain.

Every maximum likelihood fit of the program takes its steps here: parameters of a vehicle, profiles of single quantities, poles
and shapes of modes. What is maximised says at each point how it rises (`NormalEquations`) and what a step gains.

References
----------
D. W. Marquardt, J. SIAM 11 (1963) 431; the watchdog after R. M. Chamberlain and others, Math. Prog. Study 16 (1982) 1.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

_LEAST_DAMPING, _MOST_DAMPING = 1e-12, 1e8
_SLOWEST = 0.9  # ratio of successive gains that is assumed where only one is known, and at the most
_STALLED = 0.01
"""Expected gain, a tenth of a standard error, above which a point from which no step gains, or only the last one that may be
taken, is not an optimum."""

_HELD_BACK = 3
"""Times that coordinates are held back, of which others may go too far then, before the whole step is shortened."""

_FASTER = 4.0
"""What the factor by which the damping rises grows by, each time that a step loses: little damping changes nothing."""

_POOR, _GOOD = 0.25, (0.75, 1.3)
"""Gain of a step, as a part of what was expected, up to which the damping rises, and within which it falls fast."""

_FURTHEST = 8.0
"""How many times as far as a step that gained more than expected a longer one goes at the most: to the vertex of the parabola
through both gains, where along its way the likelihood bends less than the information says."""

_LOWERED, _USUAL, _EASED, _RAISED = 100.0, 10.0, 3.0, 8.0
"""Factors by which the damping falls after a step that gained what was expected, after others that gained, and after these
where the start is far away; and by which it rises after one that gained little."""

_IDLE = 3
"""Steps in turn, each of which gains hardly anything, after which none is expected to: at a kink of the likelihood a gain is
expected that no step brings."""

_CRAWL, _NEAR = 0.05, 1.0
"""Part of the expected gain that is hardly anything where no more than so much is expected: one standard error."""

_SMALL, _STAGNANT, _LONG = 0.1, 0.5, 8
"""Expected gain of a third of a standard error, and the part of the one before that is expected again: steps to a smooth
maximum leave less each time. After so many others in turn none is expected to."""

_OF_SECOND_ORDER = 250.0
"""How many times the tolerance eliminated unknowns may still gain, up to one standard error: where they are going is part of
the gradient of the others, and what they leave is of second order. Some of them go on for long that records hardly show."""

_MOSTLY = 0.5  # part of a gain from which it is mostly that of eliminated unknowns

_FIRM = 1.0  # damping above which a small gain says nothing of what is left to gain

_OF_ELIMINATED = 1e-5
"""Damping of eliminated unknowns at the least, as a part of each one's own information: along combinations of them of which
less is known, they would go farther than derivatives tell.
"""

_MOST_OF_ELIMINATED = 1e-2
"""The same at the most: it rises while steps gain little of what is expected, until only those combinations count that go where
derivatives tell."""

Point = TypeVar("Point")


class NormalEquations(NamedTuple):
    """Quadratic model of twice the log-likelihood around a point, in directions that may be taken.

    Attributes
    ----------
    information
        Fisher information, real symmetric or complex Hermitian, positive definite; shape (direction, direction).
    gradient
        Of the log-likelihood, shape (direction,).
    scaling
        What damping multiplies: Marquardt's scaling, shape (direction, direction).
    directions
        In the coordinates, as columns, shape (coordinate, direction).
    eliminated
        Gain of unknowns that are eliminated and that every step moves towards their maximum, too.
    """

    information: Array
    gradient: Array
    scaling: Array
    directions: Array
    eliminated: float = 0.0

    def step(self, damping: float = 0.0, longest: float = np.inf) -> tuple[Array, float]:
        """Return a damped step in the coordinates, the Newton step without damping, and its expected gain.

        The gain is that of twice the log-likelihood. A coordinate that would go further than the `longest` is held back as by
        information of its own, so that one of which hardly anything is known does not shorten the step of all others.
        """
        if not self.gradient.size:
            return np.zeros(len(self.directions)), self.eliminated
        matrix = self.information + damping * self.scaling
        along = np.linalg.solve(matrix, self.gradient)
        for _ in range(_HELD_BACK):
            far = np.abs(self.directions @ along)
            if not (far > longest).any():
                break
            # With the information μ beside the 1/v that there is, a step shrinks by 1 + μ v.
            own = self.directions[far > longest]
            v = np.einsum("ij,ji->i", own, np.linalg.solve(matrix, own.T)).real
            matrix = matrix + own.T @ ((far[far > longest] / longest - 1) / v * own.T).T
            along = np.linalg.solve(matrix, self.gradient)
        gain = float((along.conj() @ self.gradient).real) + self.eliminated
        return _limited(self.directions @ along, longest), gain

    def is_held_back(self, longest: float) -> bool:
        """Whether the Newton step would take a coordinate further than the `longest`, so that its gain is still to come."""
        return bool(np.abs(self.step()[0]).max(initial=0.0) > longest)


def _has_converged(equations: NormalEquations, damping: float, tolerance: float) -> bool:
    """Whether less is left to gain than a tolerance, or little more by eliminated unknowns alone."""
    if equations.eliminated >= _enough_of_eliminated(tolerance):
        return False
    # A damped step gains less than the Newton step: where it gains enough, there is no need of that one.
    return all(equations.step(of_step)[1] - equations.eliminated < tolerance for of_step in (damping, 0.0))


def _enough_of_eliminated(tolerance: float) -> float:
    """Return the gain that eliminated unknowns may leave, where all others leave no more than a tolerance."""
    return max(tolerance, min(_OF_SECOND_ORDER * tolerance, _NEAR))


class Maximisable(Protocol[Point]):
    """A log-likelihood that can be maximised."""

    def normal_equations(self, point: Point, damping: float, /) -> NormalEquations:
        """Return how twice the log-likelihood rises from a point, with so much damping of eliminated unknowns."""

    def trial(self, point: Point, step: Array, damping: float, /) -> tuple[Point, float]:
        """Return the point a step (shape (coordinate,)) away, and the gain in twice the log-likelihood: -inf if it has none.

        The damping is that of eliminated unknowns, which follow and step towards their maximum.
        """


class Maximum(NamedTuple, Generic[Point]):
    """Where a maximisation ended.

    Attributes
    ----------
    point
        The last point.
    steps
        How many were taken.
    converged
        Whether no further gain is expected.
    """

    point: Point
    steps: int
    converged: bool


def maximise(
    problem: Maximisable[Point],
    start: Point,
    *,
    tolerance: float,
    damping: float,
    most_steps: int,
    longest_step: float = np.inf,
    stop: Callable[[Point, NormalEquations], bool] | None = None,
    cautious: bool = False,
) -> Maximum[Point]:
    """Maximise a log-likelihood from a start.

    Parameters
    ----------
    problem
        What is maximised.
    start
        The first point.
    tolerance
        Expected gain in twice the log-likelihood at which to stop.
    damping
        Of the first step, as a part of each coordinate's own information.
    most_steps
        Steps at the most.
    longest_step
        Largest change of a coordinate in one step.
    stop
        Asked at every point; where it holds, the maximisation ends there, without having converged.
    cautious
        Whether the damping falls fast only where a gain was expected, and rises ever faster: from a start that is far away.

    Returns
    -------
    Maximum
    """
    point, before, of_eliminated = start, np.inf, _OF_ELIMINATED
    idle = stagnant = 0
    for steps in range(most_steps):
        equations = problem.normal_equations(point, of_eliminated)
        if stop is not None and stop(point, equations):
            return Maximum(point, steps, converged=False)
        if _has_converged(equations, damping, tolerance):
            return Maximum(point, steps, converged=True)
        found = _gaining_step(problem, point, equations, damping, of_eliminated, longest_step, tolerance, cautious)
        if found is None:
            # Not even the shortest step gains: without noise rounding leaves no more.
            damped = problem.normal_equations(point, _MOST_DAMPING)
            return Maximum(point, steps, converged=damped.step(_MOST_DAMPING)[1] < _STALLED)
        point, damping, gain, realised = found
        if 0 < equations.eliminated < _enough_of_eliminated(tolerance):
            of_eliminated = _MOST_OF_ELIMINATED
        elif realised < _POOR * gain:
            of_eliminated = min(_RAISED * of_eliminated, _MOST_OF_ELIMINATED)
        crawls = gain < _NEAR and realised < _CRAWL * gain
        idle = idle + 1 if realised < tolerance or crawls else 0
        stagnant = stagnant + 1 if _STAGNANT * before < gain < _SMALL else 0
        # What the steps to come will gain, if they go on shrinking as the last two did.
        ratio = min(gain / before, _SLOWEST) if before < np.inf else _SLOWEST
        before = gain
        shrinks = gain * min(ratio / (1 - ratio), 1.0) < tolerance and damping < _FIRM
        if idle == _IDLE or stagnant == _LONG or (shrinks and not equations.is_held_back(longest_step)):
            return Maximum(point, steps + 1, converged=True)
    # Along what hardly shows steps may zigzag for long, each of which gains next to nothing.
    is_near = most_steps > 0 and equations.step()[1] < _STALLED and not equations.is_held_back(longest_step)
    return Maximum(point, most_steps, converged=is_near)


def _gaining_step(
    problem: Maximisable[Point],
    point: Point,
    equations: NormalEquations,
    damping: float,
    least_of_eliminated: float,
    longest: float,
    tolerance: float,
    cautious: bool,
) -> tuple[Point, float, float, float] | None:
    """Return the point a step further that does not lose, the next damping, and the gain to go by and that which was realised.

    None if there is none. The gain to go by is what was expected, or what came of it where that is more: as noise levels follow
    the residuals, a step may gain many times what was expected at the old ones, and the steps to come likewise.

    In a curved valley the straight way leads up its wall, and only the next step down again, further along: where the first
    step loses, or gains little while eliminated unknowns have to follow it, one more is tried from there (the watchdog). No
    step is tried that would gain too little. Where a step gains more than expected, a longer one is tried as well.
    """
    first, raised = True, _EASED if cautious else _RAISED
    while damping < _MOST_DAMPING:
        # They follow the others, and are nearly linear: their whole step is shortened only where it loses.
        of_eliminated = least_of_eliminated if first else max(least_of_eliminated, damping)
        if not first:
            equations = problem.normal_equations(point, of_eliminated)
        step, expected = equations.step(damping, longest)
        if not first and expected < tolerance:
            return None
        tried, gain = problem.trial(point, step, of_eliminated)
        least = _POOR * expected if equations.eliminated > 0 else 0.0
        if first and np.isfinite(gain) and gain < least:
            second, further = _second_step(problem, tried, damping, of_eliminated, longest)
            if gain + further > max(gain, 0.0):
                tried, gain = second, gain + further
        if gain >= 0:
            # More than a million times what was expected is as good as any.
            ratio = gain / max(expected, 1e-6 * gain, np.finfo(float).tiny)
            # The damping that this step needed is about what the next one will need.
            following = _next_damping(damping, ratio, cautious) if first or not cautious else damping / _EASED
            by: float = max(expected, gain)
            ends = [(tried, gain)]
            if _GOOD[1] < ratio < 2 and not cautious:
                longer = _limited(step / max(2 - ratio, 1 / _FURTHEST), longest)
                ends.append(problem.trial(point, longer, of_eliminated))
            tried, gain = max(ends, key=lambda end: end[1])
            return tried, following, by, gain
        first = False
        damping, raised = max(damping, 1e-8) * raised, raised * (_FASTER if cautious else 1.0)
    return None


def _second_step(
    problem: Maximisable[Point], tried: Point, damping: float, of_eliminated: float, longest: float
) -> tuple[Point, float]:
    """Return where one more step leads from where a first one has gained too little, and what it gains.

    Eliminated unknowns have followed the first step along a straight line: where most is left to gain by them, they step alone.
    """
    there = problem.normal_equations(tried, of_eliminated)
    step, expected = there.step(damping, longest)
    alone = there.eliminated > _MOSTLY * expected
    return problem.trial(tried, np.zeros_like(step) if alone else step, of_eliminated)


def _next_damping(damping: float, ratio: float, cautious: bool) -> float:
    """Return the damping after a step that gained so much of what was expected.

    Far away a gain that is many times as large says as little of the next step as one that is small.
    """
    if ratio <= _POOR:
        return _RAISED * damping
    is_right = _GOOD[0] < ratio < (_GOOD[1] if cautious else np.inf)
    return max(damping / (_LOWERED if is_right else _EASED if cautious else _USUAL), _LEAST_DAMPING)


def _limited(step: Array, longest: float) -> Array:
    shortened: Array = step * min(1.0, longest / np.abs(step).max(initial=1e-300))
    return shortened

"""Steps of one motion, one after the other: the loop that is compiled (Numba).

The forces of nonlinear elements at the end of a step depend on the travels there, and these on the forces: Newton's method
solves for them, beginning with forces that go on as straight as before.

All arrays are contiguous. Those that go together are one array, as every array that is passed on costs time.
"""

from __future__ import annotations

from math import exp, fabs, isfinite, log, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.compilation import compiled
from sprung.vehicle.force_laws import LEAST_COLUMN, POLYTROPIC_EXPONENT, SMALL_STRAIN
from sprung.vehicle.kink_means import STILL

if TYPE_CHECKING:
    from sprung.vehicle.law_table import LawTable
    from sprung.vehicle.stepping import MotionBuffer, StepMatrices

Array = NDArray[np.float64]

_MOST_EVALUATIONS = 12
"""Evaluations of the forces at the end of each step, at the most: mostly one or two are enough."""

_OWN_EFFECT = 0.1
"""Effect of a surplus on forces and on itself, as a part of it, at the most: c h/m of a damper and the mass behind it."""

_TRAVEL, _RATE, _FORCE, _BY_TRAVEL, _BY_RATE = range(5)
"""What is known of each row at the end of a step: forces, and slopes of those without memory; shape (5, row)."""

_FOUND, _MISSING, _CORRECTION, _SLOPE, _EARLIER_ERROR, _EARLIER_FORCE = range(6)
"""What a solution works with, for each row: forces and missing surplus as evaluated, the correction of the forces, their whole
slope by the travel, and the error and force of the evaluation before; shape (6, row)."""


@compiled
def follow_motion(
    step: StepMatrices, laws: LawTable, increments: Array, inputs: Array, solved: float, motion: MotionBuffer
) -> int:
    """Follow a motion from its first state and memories, which stand in it.

    Parameters
    ----------
    step
        What steps.
    laws
        Of the nonlinear elements.
    increments
        What moves the vehicle from outside adds to the state at the end of each step, SI, shape (step, state); of no step
        for nothing.
    inputs
        What it adds to travels and rates at each step, SI, shape (step + 1, 2 row); likewise.
    solved
        Difference of forces from those that they were evaluated with, as a part of the largest, that is none.
    motion
        Where it is written.

    Returns
    -------
    int
        Of how many steps, the start included, the states are finite.
    """
    rows, state = len(step.at_end), len(step.by_state)
    start, end, work = np.zeros((5, rows)), np.zeros((5, rows)), np.zeros((6, rows))
    predicted, of_rows, pushing, moved = np.zeros(state), np.zeros(2 * rows), np.zeros(rows), np.zeros(2 * rows)
    whole, memories, is_driven = motion.whole, motion.memories, len(increments) > 0
    for k in range(len(whole)):
        start, end, last = end, start, max(k - 1, 0)
        if k == 0:
            _copy(whole[0, :state], predicted)
        else:
            predicted[:] = 0.0
            _add_product(whole[last], step.transition, predicted)
            if is_driven:
                for i in range(state):
                    predicted[i] += increments[last, i]
            for i in range(rows):
                # Forces are expected to go on as straight as they do.
                end[_FORCE, i] = 2.0 * start[_FORCE, i] - whole[max(k - 2, 0), state + i]
        _copy(step.at_start, of_rows)
        _add_product(predicted, step.by_state, of_rows)
        if is_driven:
            for i in range(2 * rows):
                of_rows[i] += inputs[k, i]
        _copy(memories[last], memories[k])
        _solve(step, laws, k > 0, of_rows, start, end, memories[k], motion.surplus[k], work, pushing, moved, solved)
        for i in range(rows):
            whole[k, state + i] = end[_FORCE, i]
            pushing[i] = end[_FORCE, i] + motion.surplus[k, i]
        if k > 0:
            _add_product(pushing, step.by_force, predicted)
        total = 0.0
        for i in range(state):
            whole[k, i] = predicted[i]
            total += predicted[i]
        if not isfinite(total):
            return k
    return len(whole)


@compiled
def _copy(vector: Array, to: Array) -> None:
    for i in range(len(vector)):
        to[i] = vector[i]


@compiled
def _add_product(vector: Array, matrix: Array, total: Array) -> None:
    """Add the product of a vector and a matrix to a total, four rows at once: so the total is read less often."""
    number = len(vector) // 4 * 4
    for j in range(0, number, 4):
        a, b, c, d = vector[j], vector[j + 1], vector[j + 2], vector[j + 3]
        for i in range(len(total)):
            total[i] += a * matrix[j, i] + b * matrix[j + 1, i] + c * matrix[j + 2, i] + d * matrix[j + 3, i]
    for j in range(number, len(vector)):
        for i in range(len(total)):
            total[i] += vector[j] * matrix[j, i]


@compiled
def _solve(
    step: StepMatrices,
    laws: LawTable,
    moves: bool,
    predicted: Array,
    start: Array,
    end: Array,
    memories: Array,
    surplus: Array,
    work: Array,
    pushing: Array,
    moved: Array,
    solved: float,
) -> None:
    """Find forces, memories and travels that depend on each other.

    Parameters
    ----------
    step, laws, solved
        As for `follow_motion`.
    moves
        Whether a step is taken; otherwise forces of the state at its start are asked for.
    predicted
        Travels and rates without the forces, shape (2 row,).
    start, end
        Ends of the step before and of this one; the forces to begin with stand in the latter.
    memories
        Of frictions at the start, which those at the end replace; shape (memory,).
    surplus
        Where it is written, shape (row,); zero to begin with.
    work, pushing, moved
        To work with: what is known of rows; forces and what they move, shapes (row,) and (2 row,).
    """
    rows, by_force = len(surplus), step.at_end if moves else step.at_rest
    for evaluation in range(_MOST_EVALUATIONS):
        for i in range(rows):
            pushing[i] = end[_FORCE, i] + surplus[i]
        _copy(predicted, moved)
        _add_product(pushing, by_force, moved)
        for i in range(rows):
            end[_TRAVEL, i], end[_RATE, i] = moved[i], moved[rows + i]
        _evaluate(laws, moves, start, end, memories, work)
        if moves and step.has_surplus:
            _find_surplus(laws, step.length, start, end, work)
        size, largest = 0.0, 0.0
        for i in range(rows):
            work[_MISSING, i] -= surplus[i]
            error = max(fabs(work[_FOUND, i] - end[_FORCE, i]), _OWN_EFFECT * fabs(work[_MISSING, i]))
            size = max(size, step.weights[i] * error)
            largest = max(largest, step.weights[i] * fabs(work[_FOUND, i]))
        if evaluation == _MOST_EVALUATIONS - 1 or not size > solved * largest:
            for i in range(rows):
                end[_FORCE, i] = work[_FOUND, i]
                surplus[i] += work[_MISSING, i]
            break
        _correct(by_force, evaluation > 0, end, work, pushing, moved)
        for i in range(rows):
            work[_EARLIER_ERROR, i], work[_EARLIER_FORCE, i] = work[_FOUND, i] - end[_FORCE, i], end[_FORCE, i]
            end[_FORCE, i] += work[_CORRECTION, i]
            surplus[i] += work[_MISSING, i]
    for m in range(len(memories)):
        row = int(laws.frictions[0, m])
        memories[m] = _memory(
            memories[m], end[_TRAVEL, row] - start[_TRAVEL, row] if moves else 0.0, laws.frictions[2, m]
        )


@compiled
def _correct(by_force: Array, is_again: bool, end: Array, work: Array, pushing: Array, moved: Array) -> None:
    """Find Newton's correction of forces: for its effect on their own travel and rate, then for that of all on all others."""
    rows = len(pushing)
    for i in range(rows):
        own = 1.0 - work[_SLOPE, i] * by_force[i, i] - end[_BY_RATE, i] * by_force[i, rows + i]
        work[_CORRECTION, i] = (work[_FOUND, i] - end[_FORCE, i]) / own
        pushing[i] = work[_CORRECTION, i] + work[_MISSING, i]
    moved[:] = 0.0
    _add_product(pushing, by_force, moved)
    for i in range(rows):
        error = work[_FOUND, i] - end[_FORCE, i]
        own = 1.0 - work[_SLOPE, i] * by_force[i, i] - end[_BY_RATE, i] * by_force[i, rows + i]
        answer = error + work[_SLOPE, i] * moved[i] + end[_BY_RATE, i] * moved[rows + i]
        work[_CORRECTION, i] += (answer - work[_CORRECTION, i]) / own
        earlier = work[_EARLIER_ERROR, i]
        if is_again and error * earlier < 0:
            # Where a kink lies between, Newton's method may go back and forth: the secant does not.
            work[_CORRECTION, i] = error * (end[_FORCE, i] - work[_EARLIER_FORCE, i]) / (earlier - error)


@compiled
def _evaluate(laws: LawTable, moves: bool, start: Array, end: Array, memories: Array, work: Array) -> None:
    """Evaluate forces and their slopes at travels and rates, and from travels at the start of the step if one is taken."""
    for i in range(end.shape[1]):
        work[_FOUND, i] = work[_MISSING, i] = work[_SLOPE, i] = end[_BY_TRAVEL, i] = end[_BY_RATE, i] = 0.0
    for kink in range(laws.kinks.shape[1]):
        row, by_travel, by_rate = int(laws.kinks[0, kink]), laws.kinks[1, kink], laws.kinks[2, kink]
        position, jump, width = laws.kinks[3, kink], laws.kinks[4, kink], laws.kinks[5, kink]
        if laws.kinks[6, kink] != 0 and not end[_TRAVEL, row] > 0:
            continue
        u = by_travel * end[_TRAVEL, row] + by_rate * end[_RATE, row] - position
        value, slope, _, _ = hinge(u, position, width)
        work[_FOUND, row] += jump * value
        end[_BY_TRAVEL, row] += jump * slope * by_travel
        end[_BY_RATE, row] += jump * slope * by_rate
    for curve in range(laws.curves.shape[1]):
        row, growth, highest = int(laws.curves[0, curve]), laws.curves[1, curve], laws.curves[2, curve]
        rate, inverse_height = laws.curves[3, curve], laws.curves[4, curve]
        x = min(end[_TRAVEL, row], highest)
        work[_FOUND, row] -= 0.5 * growth * x * x
        end[_BY_TRAVEL, row] -= growth * x
        if inverse_height != 0:
            mean, slope = air_ratio(inverse_height * x)
            work[_FOUND, row] += rate * x * mean
            end[_BY_TRAVEL, row] += rate * (mean + inverse_height * x * slope)
    for i in range(end.shape[1]):
        work[_SLOPE, i] = end[_BY_TRAVEL, i]
    for m in range(len(memories)):
        row, force, length = int(laws.frictions[0, m]), laws.frictions[1, m], laws.frictions[2, m]
        memory = _memory(memories[m], end[_TRAVEL, row] - start[_TRAVEL, row] if moves else 0.0, length)
        sign = 1.0 if end[_TRAVEL, row] > start[_TRAVEL, row] else -1.0
        work[_FOUND, row] += force * memory
        work[_SLOPE, row] += force * (1.0 - memory * sign) / length if moves else 0.0


@compiled
def _memory(before: float, increment: float, length: float) -> float:
    """Return the memory of a friction after an increment of the travel; see `FRICTION`."""
    sign = 1.0 if increment > 0 else -1.0
    return sign + (before - sign) * exp(-fabs(increment) / length)


@compiled
def air_ratio(strain: float) -> tuple[float, float]:
    """Return what the mean rate of an air spring is above that at rest, as a part of it, and its derivative by the strain."""
    n = POLYTROPIC_EXPONENT
    if fabs(strain) < SMALL_STRAIN:
        mean = (n + 1) * strain * (-1 / 2 + (n + 2) * strain * (1 / 6 - (n + 3) * strain / 24))
        return mean, (n + 1) * (-1 / 2 + (n + 2) * strain * (1 / 3 - (n + 3) * strain / 8))
    column = max(1.0 + strain, LEAST_COLUMN)
    pressure = column**-n
    mean = (1.0 - pressure) / (n * strain) - 1.0
    return mean, ((pressure / column if column > LEAST_COLUMN else 0.0) - 1.0 - mean) / strain


@compiled
def _find_surplus(laws: LawTable, length: float, start: Array, end: Array, work: Array) -> None:
    """Find twice what the mean forces over a step are above the mean of those at both ends."""
    for i in range(end.shape[1]):
        # The mean rate is the increment of the travel, and the ends of the rate tell how the travel is curved.
        curved = (end[_TRAVEL, i] - start[_TRAVEL, i]) / length - 0.5 * (start[_RATE, i] + end[_RATE, i])
        change = (end[_RATE, i] - start[_RATE, i]) * length / 12.0
        by_travel, by_rate = start[_BY_TRAVEL, i] + end[_BY_TRAVEL, i], start[_BY_RATE, i] + end[_BY_RATE, i]
        work[_MISSING, i] = by_rate * curved - by_travel * change
    for kink in range(laws.kinks.shape[1]):
        row, by_travel, by_rate = int(laws.kinks[0, kink]), laws.kinks[1, kink], laws.kinks[2, kink]
        position, jump, width = laws.kinks[3, kink], laws.kinks[4, kink], laws.kinks[5, kink]
        u = by_travel * start[_TRAVEL, row] + by_rate * start[_RATE, row] - position
        v = by_travel * end[_TRAVEL, row] + by_rate * end[_RATE, row] - position
        if laws.kinks[6, kink] != 0:
            work[_MISSING, row] += jump * excess_in_the_air(u, v, start[_TRAVEL, row], end[_TRAVEL, row])[0]
        elif width > 0:
            work[_MISSING, row] += jump * rounded_excess(u, v, width)[0]
        elif u * v < 0:
            work[_MISSING, row] += jump * u * v / fabs(v - u)


@compiled
def hinge(u: float, position: float, width: float) -> tuple[float, float, float, float]:
    """Return what `kinks.hinge` does, of one kink."""
    if not u > (-position if width > 0 else 0.0):
        return 0.0, 0.0, 0.0, 0.0
    if not width > 0:
        return u, 1.0, 0.0, 0.0
    root, at_zero = sqrt(u * u + width * width), sqrt(position * position + width * width)
    return (
        0.5 * (u + root - at_zero + position),
        0.5 * (1.0 + u / root),
        0.5 * (1.0 - position / at_zero),
        0.5 * width * (1.0 / root - 1.0 / at_zero),
    )


@compiled
def rounded_excess(u: float, v: float, width: float) -> tuple[float, float, float, float]:
    """Return what `kink_means.rounded_excess` does, of one step, and its derivatives by both ends and by the width."""
    first, last, change = sqrt(u * u + width * width), sqrt(v * v + width * width), v - u
    if not fabs(change) > STILL * min(first, last):
        return 0.0, 0.0, 0.0, 0.0
    # The difference of two inverse hyperbolic sines, without sums of nearly opposite numbers.
    turned = log((v + last) / (u + first)) if u + v > 0 else log((first - u) / (last - v))
    mean = 0.25 * (v * (v + last) - u * (u + first) + width * width * turned) / change
    at_start, at_end = 0.5 * (u + first), 0.5 * (v + last)
    return (
        2.0 * mean - at_start - at_end,
        2.0 * (mean - at_start) / change - 0.5 * (1.0 + u / first),
        2.0 * (at_end - mean) / change - 0.5 * (1.0 + v / last),
        width * turned / change - 0.5 * width * (1.0 / first + 1.0 / last),
    )


@compiled
def excess_in_the_air(u: float, v: float, x: float, y: float) -> tuple[float, float, float, float, float]:
    """Return what `kink_means.excess_in_the_air` does, of one step, and its derivatives by all arguments."""
    first, last, passes = 0.0, 1.0, 0.0
    for one, other in ((u, v), (x, y)):
        if one <= 0 and other <= 0:
            last = 0.0
        elif one <= 0:
            passes = one / (one - other)
            first = max(first, passes)
        elif other <= 0:
            passes = one / (one - other)
            last = min(last, passes)
    duration, acts_first, acts_last = max(last - first, 0.0), u > 0 and x > 0, v > 0 and y > 0
    by_end = duration * 0.5 * (first + last)
    excess = 2.0 * (u * duration + (v - u) * by_end) - (u if acts_first else 0.0) - (v if acts_last else 0.0)
    by_x, by_y = 0.0, 0.0
    if (x > 0) != (y > 0):
        # The travel says how long the force acts, if the argument is above zero where it passes zero.
        lost = 2.0 * max(u + (v - u) * passes, 0.0) / (x - y) ** 2
        by_x, by_y = lost * fabs(y), lost * fabs(x)
    by_u = 2.0 * (duration - by_end) - (1.0 if acts_first else 0.0)
    return excess, by_u, 2.0 * by_end - (1.0 if acts_last else 0.0), by_x, by_y

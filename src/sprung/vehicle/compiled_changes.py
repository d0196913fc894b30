"""Changes of one motion by all unknowns, step by step: the loop that is compiled (Numba).

All arrays are contiguous, of single precision; unknowns are along the last axis.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.compilation import compiled

if TYPE_CHECKING:
    from sprung.vehicle.sensitivities import ChangeMatrices, DirectChanges, ForceSlopes, LawSlopes

Single = NDArray[np.float32]

_LEAST_PIVOT = 0.1
"""Part of one below which a pivot is too small to go on without exchange of rows."""


@compiled
def follow_changes(
    matrices: ChangeMatrices,
    slopes: ForceSlopes,
    ends: DirectChanges,
    inputs: DirectChanges,
    parameters: int,
    every: int,
    readings: Single,
) -> None:
    """Follow the changes of a motion by its parameters, its initial state and its initial memories.

    Parameters
    ----------
    matrices, slopes
        How changes go through steps.
    ends, inputs
        What parameters change directly in the state at the end of each step, and in travels and rates at each.
    parameters
        How many there are.
    every
        Steps from one reading to the next.
    readings
        Where the changes of what is read are written, shape (reading, output, unknown).
    """
    (rows, state), memories = matrices.by_force.T.shape, len(slopes.memory_rows)
    unknowns, has_surplus = readings.shape[2], len(slopes.surplus_by_end) > 0
    # Changes of state and forces; of the state without the forces at the end of the step; of memories; of travels and rates.
    changes, after = _zeros(state + rows, unknowns), _zeros(state, unknowns)
    memory, before, now = _zeros(memories, unknowns), _zeros(2 * rows, unknowns), _zeros(2 * rows, unknowns)
    pushing, moved, effect = _zeros(rows, unknowns), _zeros(2 * rows, unknowns), _zeros(rows, rows)
    for i in range(state):
        after[i, parameters + i] = 1.0
    for m in range(memories):
        memory[m, parameters + state + m] = 1.0
    for k in range(len(slopes.by_travel)):
        before, now = now, before
        if k > 0:
            np.dot(matrices.transition, changes, after)
            _add_direct(ends, k - 1, after)
        np.dot(matrices.by_state, after, now)
        _add_direct(inputs, k, now)
        for m in range(memories):
            row, kept, by_increment = slopes.memory_rows[m], slopes.kept[k, m], slopes.by_increment[k, m]
            for u in range(unknowns):
                memory[m, u] = kept * memory[m, u] - by_increment * before[row, u]
        _add_by_parameters(slopes.of_memories, k, memory)
        for i in range(rows):
            by_travel, by_rate = slopes.by_travel[k, i], slopes.by_rate[k, i]
            for u in range(unknowns):
                pushing[i, u] = by_travel * now[i, u] + by_rate * now[rows + i, u]
        _add_by_parameters(slopes.of_forces, k, pushing)
        for m in range(memories):
            row, by_memory = slopes.memory_rows[m], slopes.by_memory[k, m]
            for u in range(unknowns):
                pushing[row, u] += by_memory * memory[m, u]
        forced = changes[state:]
        at_end = matrices.at_end if k > 0 else matrices.at_rest
        for i in range(rows):
            for j in range(rows):
                effect[i, j] = -slopes.by_travel[k, i] * at_end[i, j] - slopes.by_rate[k, i] * at_end[rows + i, j]
            effect[i, i] += np.float32(1.0)
        solve(effect, pushing)
        _copy(pushing, forced)
        np.dot(at_end, forced, moved)
        _add(moved, now)
        if has_surplus and k > 0:
            for i in range(rows):
                x, v = slopes.surplus_by_start[k - 1, i], slopes.surplus_by_start[k - 1, rows + i]
                y, w = slopes.surplus_by_end[k - 1, i], slopes.surplus_by_end[k - 1, rows + i]
                for u in range(unknowns):
                    start = x * before[i, u] + v * before[rows + i, u]
                    pushing[i, u] = start + y * now[i, u] + w * now[rows + i, u]
            _add_by_parameters(slopes.of_surplus, k - 1, pushing)
            # A surplus moves the end of its step a little. What else follows from that is of second order, and left out.
            np.dot(matrices.at_end, pushing, moved)
            _add(moved, now)
            for i in range(rows):
                by_rate = slopes.by_rate[k, i]
                for u in range(unknowns):
                    forced[i, u] += by_rate * moved[rows + i, u]
                    pushing[i, u] += forced[i, u]
        if k == 0:
            _copy(after, changes)
        else:
            np.dot(matrices.by_force, pushing if has_surplus else forced, changes[:state])
            _add(after, changes[:state])
        for m in range(memories):
            row, by_increment = slopes.memory_rows[m], slopes.by_increment[k, m]
            for u in range(unknowns):
                memory[m, u] += by_increment * now[row, u]
        if k % every == 0:
            np.dot(matrices.outputs, changes, readings[k // every])


@compiled
def _zeros(number: int, unknowns: int) -> Single:
    return np.zeros((number, unknowns), dtype=np.float32)


@compiled
def _copy(changes: Single, to: Single) -> None:
    for i in range(changes.shape[0]):
        for u in range(changes.shape[1]):
            to[i, u] = changes[i, u]


@compiled
def _add(changes: Single, total: Single) -> None:
    for i in range(changes.shape[0]):
        for u in range(changes.shape[1]):
            total[i, u] += changes[i, u]


@compiled
def solve(matrix: Single, right: Single) -> None:
    """Replace right sides (row, unknown) by the solutions, where the matrix, which is lost, is nearly a unit matrix.

    Rows are exchanged only where a pivot is small: forces of rows are of different units.
    """
    rows, unknowns = right.shape
    for p in range(rows):
        pivot = p
        if abs(matrix[p, p]) < _LEAST_PIVOT:
            for i in range(p + 1, rows):
                if abs(matrix[i, p]) > abs(matrix[pivot, p]):
                    pivot = i
        if pivot != p:
            for j in range(rows):
                matrix[p, j], matrix[pivot, j] = matrix[pivot, j], matrix[p, j]
            for u in range(unknowns):
                right[p, u], right[pivot, u] = right[pivot, u], right[p, u]
        for i in range(p + 1, rows):
            factor = matrix[i, p] / matrix[p, p]
            if factor != 0:
                for j in range(p + 1, rows):
                    matrix[i, j] -= factor * matrix[p, j]
                for u in range(unknowns):
                    right[i, u] -= factor * right[p, u]
    for p in range(rows - 1, -1, -1):
        for j in range(p + 1, rows):
            factor = matrix[p, j]
            for u in range(unknowns):
                right[p, u] -= factor * right[j, u]
        factor = np.float32(1.0) / matrix[p, p]
        for u in range(unknowns):
            right[p, u] *= factor


@compiled
def _add_direct(direct: DirectChanges, k: int, changes: Single) -> None:
    """Add what parameters change directly in a step."""
    for i in range(direct.changes.shape[1]):
        for p in range(direct.changes.shape[2]):
            changes[i, direct.first + p] += direct.changes[k, i, p]


@compiled
def _add_by_parameters(slopes: LawSlopes, k: int, changes: Single) -> None:
    """Add what the parameters of laws change in a step."""
    for which in range(len(slopes.rows)):
        changes[slopes.rows[which], slopes.unknowns[which]] += slopes.slopes[k, which]

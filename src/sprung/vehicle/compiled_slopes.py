"""Slopes of forces, memories and surplus along one motion: the loop that is compiled (Numba).

Every coefficient of the laws follows a few parameters, and so does a force by the coefficients that it depends on.
"""

from __future__ import annotations

from math import exp, fabs
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.compilation import compiled
from sprung.vehicle.compiled_steps import air_ratio, excess_in_the_air, hinge, rounded_excess

if TYPE_CHECKING:
    from sprung.vehicle.law_table import LawTable, TableSlopes
    from sprung.vehicle.sensitivities import ForceSlopes

Array = NDArray[np.float64]
Single = NDArray[np.float32]
Flags = NDArray[np.bool_]


@compiled
def differentiate_forces(
    laws: LawTable, table: TableSlopes, inputs: Array, memories: Array, length: float, slopes: ForceSlopes
) -> None:
    """Differentiate forces, memories and surplus at each step of a motion.

    Parameters
    ----------
    laws, table
        Coefficients of the laws, and their slopes.
    inputs
        Travels and rates of the rows, m and m/s, shape (step + 1, 2 row).
    memories
        Of frictions at the end of each step, shape (step + 1, memory).
    length
        Of a step, s.
    slopes
        Where they are written; zero before.
    """
    rows, has_surplus = inputs.shape[1] // 2, len(slopes.surplus_by_end) > 0
    curved, is_bent = np.zeros(2 * rows), np.zeros(rows, dtype=np.bool_)
    by_kink, by_curve = np.zeros((4, laws.kinks.shape[1])), np.zeros((3, laws.curves.shape[1]))
    unused = np.zeros((2, rows), dtype=np.float32)
    for k in range(len(inputs)):
        for i in range(rows):
            is_bent[i] = False
        by_travel, by_rate, by_parameter = slopes.by_travel[k], slopes.by_rate[k], slopes.of_forces.slopes[k]
        _differentiate_laws(laws, table, inputs[k], 1.0, is_bent, by_kink, by_curve, by_travel, by_rate, by_parameter)
        if not has_surplus or k == 0:
            continue
        _differentiate_means(slopes, inputs[k - 1], inputs[k], length, k, curved)
        _find_bent_rows(laws, inputs[k], curved, is_bent)
        by_parameter = slopes.of_surplus.slopes[k - 1]
        for factor, at in ((-2.0, inputs[k]), (2.0, curved)):
            _differentiate_laws(laws, table, at, factor, is_bent, by_kink, by_curve, unused[0], unused[1], by_parameter)
        differentiate_excess(
            laws,
            table,
            inputs[k - 1],
            inputs[k],
            slopes.surplus_by_start[k - 1],
            slopes.surplus_by_end[k - 1],
            by_parameter,
        )
    _differentiate_frictions(laws, table, inputs, memories, slopes)


@compiled
def _differentiate_laws(
    laws: LawTable,
    table: TableSlopes,
    at: Array,
    factor: float,
    is_left_out: Flags,
    by_kink: Array,
    by_curve: Array,
    by_travel: Single,
    by_rate: Single,
    by_parameter: Single,
) -> None:
    """Add derivatives of forces that follow from travels and rates, but for some rows, multiplied by a factor."""
    rows = len(is_left_out)
    for kink in range(laws.kinks.shape[1]):
        row, position, width = int(laws.kinks[0, kink]), laws.kinks[3, kink], laws.kinks[5, kink]
        u = laws.kinks[1, kink] * at[row] + laws.kinks[2, kink] * at[rows + row] - position
        value, slope, by_position, by_width = hinge(u, position, width)
        may_act = (laws.kinks[6, kink] == 0 or at[row] > 0) and not is_left_out[row]
        weight = factor if may_act else 0.0
        push = weight * laws.kinks[4, kink]
        by_kink[0, kink], by_kink[1, kink] = weight * value, push * slope
        by_kink[2, kink], by_kink[3, kink] = push * by_position, push * by_width
        by_travel[row] += push * slope * laws.kinks[1, kink]
        by_rate[row] += push * slope * laws.kinks[2, kink]
    for one in range(len(table.kinks.of)):
        kink = table.kinks.of[one]
        row = int(laws.kinks[0, kink])
        moved = (
            table.kinks.slopes[0, one] * at[row]
            + table.kinks.slopes[1, one] * at[rows + row]
            - table.kinks.slopes[2, one]
        )
        found = by_kink[1, kink] * moved + by_kink[2, kink] * table.kinks.slopes[2, one]
        found += by_kink[0, kink] * table.kinks.slopes[3, one] + by_kink[3, kink] * table.kinks.slopes[4, one]
        by_parameter[table.kinks.to[one]] += found
    for curve in range(laws.curves.shape[1]):
        row, growth = int(laws.curves[0, curve]), laws.curves[1, curve]
        rate, inverse = laws.curves[3, curve], laws.curves[4, curve]
        weight, x = 0.0 if is_left_out[row] else factor, min(at[row], laws.curves[2, curve])
        mean, slope = air_ratio(inverse * x)
        by_curve[0, curve] = -0.5 * weight * x * x
        by_curve[1, curve], by_curve[2, curve] = weight * x * mean, weight * rate * x * slope * x
        by_travel[row] += weight * (rate * (mean + inverse * x * slope) - growth * x)
    for one in range(len(table.curves.of)):
        curve, to = table.curves.of[one], table.curves.to[one]
        for field in range(3):
            by_parameter[to] += by_curve[field, curve] * table.curves.slopes[field, one]


@compiled
def _differentiate_frictions(
    laws: LawTable, table: TableSlopes, inputs: Array, memories: Array, slopes: ForceSlopes
) -> None:
    """Write slopes of memories, and add those of forces by them, and by the travel that moves them."""
    for k in range(len(inputs)):
        for m in range(memories.shape[1]):
            row, force, ramp = int(laws.frictions[0, m]), laws.frictions[1, m], laws.frictions[2, m]
            increment = inputs[k, row] - inputs[k - 1, row] if k > 0 else 0.0
            sign = 1.0 if increment > 0 else -1.0
            slopes.by_memory[k, m], slopes.kept[k, m] = force, exp(-fabs(increment) / ramp)
            if k > 0:
                slopes.by_increment[k, m] = (1.0 - sign * memories[k, m]) / ramp
                slopes.by_travel[k, row] += force * slopes.by_increment[k, m]
        for one in range(len(table.frictions.of)):
            m = table.frictions.of[one]
            slopes.of_forces.slopes[k, table.frictions.to[one]] += table.frictions.slopes[0, one] * memories[k, m]
        for one in range(len(table.memories.of)):
            m = table.memories.of[one]
            row, ramp = int(laws.frictions[0, m]), laws.frictions[2, m]
            increment = inputs[k, row] - inputs[k - 1, row] if k > 0 else 0.0
            by_length = -increment * slopes.by_increment[k, m] / ramp
            slopes.of_memories.slopes[k, table.memories.to[one]] += table.memories.slopes[0, one] * by_length


@compiled
def _differentiate_means(slopes: ForceSlopes, start: Array, end: Array, length: float, k: int, curved: Array) -> None:
    """Write how the surplus follows travels and rates, kinks apart, and what means of these are beyond those of both ends."""
    rows = len(start) // 2
    by_start, by_end = slopes.surplus_by_start[k - 1], slopes.surplus_by_end[k - 1]
    for i in range(rows):
        change = end[rows + i] - start[rows + i]
        curved[i] = end[i] - change * length / 12.0
        curved[rows + i] = end[rows + i] + (end[i] - start[i]) / length - start[rows + i] - 0.5 * change
        by_rate = slopes.by_rate[k - 1, i] + slopes.by_rate[k, i]
        by_travel = (slopes.by_travel[k - 1, i] + slopes.by_travel[k, i]) * length / 12.0
        by_start[i], by_start[rows + i] = -by_rate / length, by_travel - 0.5 * by_rate
        by_end[i], by_end[rows + i] = by_rate / length, -by_travel - 0.5 * by_rate


@compiled
def _find_bent_rows(laws: LawTable, end: Array, curved: Array, is_bent: Flags) -> None:
    """Find rows of which a kink lies between two inputs: the difference of their forces is not that of one slope."""
    rows = len(is_bent)
    for kink in range(laws.kinks.shape[1]):
        row, by_travel, by_rate, position = (
            int(laws.kinks[0, kink]), laws.kinks[1, kink], laws.kinks[2, kink], laws.kinks[3, kink]
        )  # fmt: skip
        u = by_travel * end[row] + by_rate * end[rows + row] - position
        v = by_travel * curved[row] + by_rate * curved[rows + row] - position
        if u * v < 0 or (laws.kinks[6, kink] != 0 and end[row] * curved[row] < 0):
            is_bent[row] = True


@compiled
def differentiate_excess(
    laws: LawTable,
    table: TableSlopes,
    start: Array,
    end: Array,
    by_start: Single,
    by_end: Single,
    by_parameter: Single,
) -> None:
    """Add derivatives of twice what mean forces of kinks over a step are above the mean of those at both ends.

    Parameters
    ----------
    laws, table
        As for `differentiate_forces`.
    start, end
        Travels and rates at both ends, m and m/s, shape (2 row,).
    by_start, by_end
        Derivatives by these, to which they are added, N/m and N s/m, shape (2 row,).
    by_parameter
        Likewise of each dependence on a parameter, shape (dependence,).
    """
    rows, entry = len(start) // 2, 0
    for kink in range(laws.kinks.shape[1]):
        row, by_travel, by_rate = int(laws.kinks[0, kink]), laws.kinks[1, kink], laws.kinks[2, kink]
        position, jump, width = laws.kinks[3, kink], laws.kinks[4, kink], laws.kinks[5, kink]
        x, y, first = start[row], end[row], entry
        while entry < len(table.kinks.of) and table.kinks.of[entry] == kink:
            entry += 1
        u = by_travel * x + by_rate * start[rows + row] - position
        v = by_travel * y + by_rate * end[rows + row] - position
        is_aloft, by_width, by_x, by_y = laws.kinks[6, kink] != 0, 0.0, 0.0, 0.0
        if is_aloft and (u * v < 0 or x * y < 0):
            excess, by_u, by_v, by_x, by_y = excess_in_the_air(u, v, x, y)
        elif width > 0:
            excess, by_u, by_v, by_width = rounded_excess(u, v, width)
        elif not is_aloft and u * v < 0:
            size = fabs(v - u)
            excess, by_u, by_v = u * v / size, v * v / (size * (v - u)), -u * u / (size * (v - u))
        else:
            continue
        by_start[row] += jump * (by_u * by_travel + by_x)
        by_start[rows + row] += jump * by_u * by_rate
        by_end[row] += jump * (by_v * by_travel + by_y)
        by_end[rows + row] += jump * by_v * by_rate
        for one in range(first, entry):
            before = (
                table.kinks.slopes[0, one] * x
                + table.kinks.slopes[1, one] * start[rows + row]
                - table.kinks.slopes[2, one]
            )
            after = (
                table.kinks.slopes[0, one] * y
                + table.kinks.slopes[1, one] * end[rows + row]
                - table.kinks.slopes[2, one]
            )
            found = jump * (by_u * before + by_v * after + by_width * table.kinks.slopes[4, one])
            by_parameter[table.kinks.to[one]] += found + excess * table.kinks.slopes[3, one]

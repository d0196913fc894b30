"""Sensitivities of time-stepped motions: derivatives of outputs by parameters, initial states and initial memories.

Once the motions are known, a small change follows linear steps. Nonlinear elements enter them by the slopes of their forces
alone, so the changes of all drops and unknowns go through the same product of matrices. They do not wait for each other either:
the recording is cut into segments, all of which are followed side by side from unit changes of their initial states, and
the changes of these states are put together afterwards (multiple shooting; H. G. Bock, Springer Series in Chemical Physics 18
(1981) 102).

Within a segment changes are followed in single precision: it is twice as fast, and its rounding is far below what the
derivatives leave out.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ElementForce, ElementInput
from sprung.vehicle.many_inverses import SIDE_BY_SIDE, invert_many
from sprung.vehicle.nonlinear import Dependences
from sprung.vehicle.segments import cut_into_segments, segments_of, steps_of_segments
from sprung.vehicle.stepping import Stepper, Trajectory, mean_rate_offset

Array = NDArray[np.float64]
Single = NDArray[np.float32]
Index = NDArray[np.int64]


def differentiate_motions(
    stepper: Stepper, trajectory: Trajectory, outputs: Array, every: int, of_sample: int = 1
) -> tuple[Callable[[int], Array], Array, Array]:
    """Differentiate motions and what is read of them by the parameters, the initial states and the initial memories.

    Parameters
    ----------
    stepper
        What stepped.
    trajectory
        The motions.
    outputs
        Linear functions of {x, u}, by kind of step, shape (kind, output, state + row). What parameters change in these
        functions themselves is left to the caller.
    every
        Steps from one sample to the next.
    of_sample
        Readings from one sample to the next, of which `every` is a multiple.

    Returns
    -------
    outputs
        Derivatives of the outputs of a drop, by its position, shape (output, unknown, reading), the unknowns in this order.
    starts
        Those of state and memories at the start of each segment, shape (drop, segment, start, unknown).
    transitions
        The end of each segment by its start, shape (drop, segment, start, start).

    Notes
    -----
    Not finite where the motion is not.
    """
    number, length = segments_of(len(trajectory.states) - 1, every)
    every //= of_sample
    with np.errstate(over="ignore", invalid="ignore"):
        motion, given, surplus = _cut(stepper, trajectory, number, length)

    def differentiate(kind: int) -> tuple[Single, Array]:
        own, here = stepper.of_kind(kind), slice(kind, kind + 1)
        inputs = ElementInput(*(part[:, here] for part in given))
        with np.errstate(over="ignore", invalid="ignore"):  # of this thread
            return _differentiate_segments(own, motion[:, here], inputs, surplus[:, here], outputs[here], every)

    # No kind waits for another: each may have a processor of its own.
    with ThreadPoolExecutor(len(outputs)) as pool:
        readings, by_kind = zip(*pool.map(differentiate, range(len(outputs))), strict=True)
    ends, (kind, slot) = np.concatenate(by_kind), stepper.places
    start, parameters, read = ends.shape[-2], len(stepper.values), (len(trajectory.states) - 1) // every + 1
    ends = ends.reshape(len(ends), -1, number, *ends.shape[2:])[kind, slot]
    starts = np.zeros_like(ends)
    starts[:, 0, :, parameters:] = np.eye(start)
    for segment in range(1, number):
        end = ends[:, segment - 1]
        starts[:, segment] = end[..., :start] @ starts[:, segment - 1]
        starts[:, segment, :, :parameters] += end[..., start:]

    def of_drop(drop: int) -> Array:
        first = slot[drop] * number
        own = readings[kind[drop]][:, 0, :, first : first + number]
        local = np.moveaxis(own, 2, 0).reshape(number, -1, own.shape[-1])
        whole = local[..., :start] @ starts[drop].astype(np.float32)
        whole[..., :parameters] += local[..., start:]
        by_output = whole.reshape(number, -1, outputs.shape[1], start + parameters).transpose(2, 3, 0, 1)
        found: Array = by_output.astype(np.float64, order="C").reshape(*by_output.shape[:2], -1)[..., :read]
        return found

    return of_drop, starts, ends[..., :start]


def _cut(stepper: Stepper, trajectory: Trajectory, number: int, length: int) -> tuple[Array, ElementInput, Array]:
    """Cut motions into a number of segments of so many steps, as `cut_into_segments` does.

    Returns
    -------
    motion
        {x, u, 1}, shape (step + 1, kind, place, state + row + 1).
    given
        Input of the forces at each step, as of the step that ends there; at the first one without any increment.
    surplus
        As in `Trajectory`, shape (step + 1, kind, place, row).
    """
    steps, slots = steps_of_segments(number, length), stepper.slots
    states, forces, surplus = (
        cut_into_segments(part, steps, slots) for part in (trajectory.states, trajectory.forces, trajectory.surplus)
    )
    motion = np.concatenate([states, forces, np.ones((*states.shape[:-1], 1))], axis=-1)
    travel, rate = np.split(motion @ np.swapaxes(stepper.inputs, 1, 2), 2, axis=-1)
    memories = cut_into_segments(trajectory.memories, np.maximum(steps - 1, steps[:1]), slots)
    return motion, ElementInput(travel, rate, np.diff(travel, axis=0, prepend=travel[:1]), memories), surplus


def _differentiate_segments(
    stepper: Stepper, motion: Array, given: ElementInput, surplus: Array, outputs: Array, every: int
) -> tuple[Single, Array]:
    """Differentiate by the state and the memories at the start of each segment, and by the parameters.

    Parameters
    ----------
    stepper
        What stepped.
    motion, given, surplus
        From `_cut`.
    outputs
        Linear functions of {x, u}, shape (kind, output, state + row).
    every
        Steps from one reading to the next.

    Returns
    -------
    readings
        Outputs at each reading, shape (reading, kind, output, place, start + parameter).
    ends
        State and memories at the end, shape (kind, place, start, start + parameter).
    """
    forces, slopes = stepper.forces, _force_slopes(stepper, given)
    steps, (kinds, places, size) = len(motion) - 1, motion.shape[1:]
    rows, own = forces.number, forces.memory_rows
    state, memories, start = size - 1 - rows, len(own), stepper.starts
    unknowns = start + len(stepper.values)
    geometry, driving = _driven(stepper.input_slopes, start), _driven(stepper.step_slopes, start)
    transition, by_state, by_force, input_by_force, input_by_surplus, directly_by_force, readable = (
        matrices.astype(np.float32)
        for matrices in (
            stepper.transition,
            stepper.by_state,
            stepper.by_force,
            stepper.input_by_force,
            stepper.input_by_surplus,
            stepper.directly_by_force,
            outputs,
        )
    )

    def multiply(matrices: Single, changes: Single) -> Single:
        product = matrices @ changes.reshape(kinds, changes.shape[1], places * unknowns)
        return product.reshape(kinds, -1, places, unknowns)

    def force_changes(k: int, inputs: Single, memory: Single, travel: Single, inverse: Single) -> tuple[Single, Single]:
        """Return changes of the forces, and of memories less those by the change of the travel over the step."""
        memory = slopes.kept[k] * memory - slopes.by_increment[k] * travel
        slopes.of_memories.add_to(memory, k)
        right = slopes.by_travel[k] * inputs[:, :rows]
        right += slopes.by_rate[k] * inputs[:, rows:]
        slopes.of_forces.add_to(right, k)
        right[:, own] += slopes.by_memory[k] * memory
        return np.swapaxes(inverse @ np.swapaxes(right, 1, 2), 1, 2), memory

    # Changes of state and forces, and of memories, by row, place and unknown.
    changes, memory = (np.zeros((kinds, n, places, unknowns), dtype=np.float32) for n in (size - 1, memories))
    for i in range(start):
        (changes[:, i] if i < state else memory[:, i - state])[..., i] = 1.0
    moving = motion.astype(np.float32)
    pushed = moving.copy()
    pushed[..., state:-1] += surplus
    inputs = multiply(by_state, changes[:, :state])
    _add_driven(inputs, *geometry, moving[0])
    inverse = _inverses(directly_by_force, slopes.by_travel[:1], slopes.by_rate[:1])[0]
    changes[:, state:], memory = force_changes(0, inputs, memory, inputs[:, own], inverse)
    inputs += multiply(directly_by_force, changes[:, state:])
    inverses = _inverses(input_by_force, slopes.by_travel, slopes.by_rate)
    readings = np.empty((steps // every, kinds, outputs.shape[1], places, unknowns), dtype=np.float32)
    for k in range(steps):
        if k % every == 0:
            readings[k // every] = multiply(readable, changes)
        ends = multiply(transition, changes)
        _add_driven(ends, *driving, np.concatenate([moving[k, ..., :-1], pushed[k + 1, ..., state:]], axis=-1))
        at_start, inputs = inputs, multiply(by_state, ends)
        _add_driven(inputs, *geometry, moving[k + 1])
        forced, memory = force_changes(k + 1, inputs, memory, at_start[:, own], inverses[k + 1])
        inputs += multiply(input_by_force, forced)
        pushing = forced
        if slopes.surplus is not None:
            further = slopes.surplus.changes(k, at_start, inputs)
            # A surplus moves the end of its step a little. What else follows from that is of second order, and left out.
            moved = multiply(input_by_surplus, further)
            forced += slopes.by_rate[k + 1] * moved[:, rows:]
            inputs += moved
            pushing = forced + further
        changes[:, :state] = ends + multiply(by_force, pushing)
        changes[:, state:] = forced
        memory += slopes.by_increment[k + 1] * inputs[:, own]
    return readings, np.swapaxes(np.concatenate([changes[:, :state], memory], axis=1), 1, 2).astype(np.float64)


class _SlopesByLaw(NamedTuple):
    """Slopes of forces or memories by the parameters of their laws, at each step.

    Attributes
    ----------
    rows, unknowns
        Which they are, and by which unknown; shape (dependence,).
    slopes
        Shape (step, dependence, kind, place).
    """

    rows: Index
    unknowns: Index
    slopes: Single

    @classmethod
    def of(cls, dependences: Dependences, slopes: Array, start: int) -> _SlopesByLaw:
        """Arrange slopes (dependence, step, kind, place) by parameters, before which so many other unknowns come."""
        by_step = np.ascontiguousarray(np.swapaxes(slopes, 0, 1), dtype=np.float32)
        return cls(dependences.which, start + dependences.parameters, by_step)

    def add_to(self, changes: Single, k: int) -> None:
        """Add those of a step to changes (kind, row, place, unknown)."""
        changes[:, self.rows, :, self.unknowns] += self.slopes[k]


class _SurplusSlopes(NamedTuple):
    """Derivatives of the surplus of each step.

    Attributes
    ----------
    by_start, by_end
        By travels and rates of all rows at both ends, ready to multiply changes, shape (step, kind, 2 row, place, 1).
    by_parameter
        By the parameters of the laws.
    """

    by_start: Single
    by_end: Single
    by_parameter: _SlopesByLaw

    def changes(self, k: int, at_start: Single, at_end: Single) -> Single:
        """Return changes of the surplus of a step by those of travels and rates at its ends, and by the parameters.

        Parameters
        ----------
        k
            The step.
        at_start, at_end
            Changes of travels and rates, shape (kind, 2 row, place, unknown).
        """
        both = self.by_start[k] * at_start + self.by_end[k] * at_end
        found: Single = np.add(*np.split(both, 2, axis=1))
        self.by_parameter.add_to(found, k)
        return found


class _ForceSlopes(NamedTuple):
    """Slopes of forces, memories and surplus at each step, ready to multiply changes (kind, row, place, unknown).

    Attributes
    ----------
    by_travel, by_rate, by_memory
        Of the forces; by the travel with the memory that follows it.
    by_increment, kept
        Of the memories, by the increment of the travel and by the memory at the start.
    of_forces, of_memories
        By the parameters of the laws.
    surplus
        None where forces have none.
    """

    by_travel: Single
    by_rate: Single
    by_memory: Single
    by_increment: Single
    kept: Single
    of_forces: _SlopesByLaw
    of_memories: _SlopesByLaw
    surplus: _SurplusSlopes | None


def _force_slopes(stepper: Stepper, given: ElementInput) -> _ForceSlopes:
    """Evaluate the slopes of the forces at inputs from `_cut`."""
    forces, found = stepper.forces, stepper.forces_at.evaluate(given)
    by_memory, by_increment, kept = map(_for_changes, (found.by_memory, found.memory_by_travel, found.memory_by_memory))
    by_increment[0] = 0.0
    by_travel = _for_changes(found.by_travel)
    by_travel[:, :, forces.memory_rows] += by_memory * by_increment
    of_forces, of_memories = forces.differentiate(stepper.values, given)
    surplus = _surplus_slopes(stepper, found, given, of_forces) if stepper.has_surplus else None
    start = stepper.starts
    parameters = (
        _SlopesByLaw.of(forces.dependences, of_forces, start),
        _SlopesByLaw.of(forces.memory_dependences, of_memories, start),
    )
    return _ForceSlopes(by_travel, _for_changes(found.by_rate), by_memory, by_increment, kept, *parameters, surplus)


def _surplus_slopes(stepper: Stepper, found: ElementForce, given: ElementInput, of_forces: Array) -> _SurplusSlopes:
    """Differentiate the surplus of each step.

    Parameters
    ----------
    stepper
        What stepped.
    found
        Forces at each step, with their slopes.
    given
        From `_cut`.
    of_forces
        Derivatives of the forces by the parameters of the laws, shape (dependence, step + 1, kind, place).

    Returns
    -------
    _SurplusSlopes
    """
    kinks, length = stepper.forces_at.kinks, stepper.lengths[:, None, None]
    inputs = np.concatenate([given.travel, given.rate], axis=-1)
    rows = given.travel.shape[-1]
    by_rate, by_travel = (part[1:] + part[:-1] for part in (found.by_rate, found.by_travel))
    by_travel = by_travel * (length / 12.0)
    by_start = np.concatenate([-by_rate / length, by_travel - 0.5 * by_rate], axis=-1)
    by_end = np.concatenate([by_rate / length, -by_travel - 0.5 * by_rate], axis=-1)
    # Of the slopes, their change by the parameters times what means of travels and rates are more than those of both ends.
    start, end = inputs[:-1], inputs[1:]
    change = end - start
    curved = end.copy()
    curved[..., :rows] -= (length / 12.0) * change[..., rows:]
    curved[..., rows:] += mean_rate_offset(start, change, length)
    of_means = ElementInput(curved[..., :rows], curved[..., rows:], given.increment[1:], given.memory[1:])
    by_parameter = 2.0 * (stepper.forces.differentiate(stepper.values, of_means)[0] - of_forces[:, 1:])
    # Where a kink lies between both, their difference is not that of one slope.
    passed = kinks.lie_between(end, curved)[..., stepper.forces.dependences.which]
    by_parameter = np.where(passed, 0.0, np.moveaxis(by_parameter, 0, -1))
    kinks.add_surplus_slopes(start, end, by_start, by_end, by_parameter)
    by_parameter = np.moveaxis(by_parameter, -1, 0)
    of_parameters = _SlopesByLaw.of(stepper.forces.dependences, by_parameter, stepper.starts)
    return _SurplusSlopes(_for_changes(by_start), _for_changes(by_end), of_parameters)


def _inverses(by_force: Single, by_travel: Single, by_rate: Single) -> Single:
    """Return what solves for forces that act on their own travels and rates.

    Parameters
    ----------
    by_force
        Travels and rates by the forces, shape (kind, 2 row, row).
    by_travel, by_rate
        Slopes of the forces, shape (step, kind, row, place, 1).

    Returns
    -------
    ndarray
        Shape (step, kind, place, row, row).
    """
    travel, rate = np.split(by_force[:, None], 2, axis=2)
    steps, kinds, rows, places = by_travel.shape[:4]
    inverses = np.empty((steps, kinds, places, rows, rows), dtype=np.float32)
    for some in np.array_split(np.arange(steps), max(steps * places // SIDE_BY_SIDE, 1)):
        here = slice(some[0], some[-1] + 1)
        effect = np.swapaxes(by_travel[here], 2, 3) * travel + np.swapaxes(by_rate[here], 2, 3) * rate
        inverses[here] = invert_many(np.eye(rows, dtype=np.float32) - effect)
    return inverses


def _driven(slopes: Array, start: int) -> tuple[Single, slice]:
    """Arrange what parameters change in linear functions that others' changes go through, for `_add_driven`.

    Parameters
    ----------
    slopes
        Derivatives by each parameter, shape (kind, parameter, result, argument).
    start
        How many unknowns come before the parameters.

    Returns
    -------
    slopes
        Those by the parameters that change the functions, shape (kind, argument, result · parameter).
    columns
        Which columns these are of all unknowns.
    """
    which = np.flatnonzero(slopes.any(axis=(0, 2, 3)))
    first, last = (which[0], which[-1] + 1) if which.size else (0, 0)
    arranged = np.ascontiguousarray(slopes[:, first:last].transpose(0, 3, 2, 1), dtype=np.float32)
    return arranged.reshape(*arranged.shape[:2], -1), slice(start + int(first), start + int(last))


def _add_driven(results: Single, slopes: Single, columns: slice, arguments: Single) -> None:
    """Add to changes (kind, result, place, unknown) what parameters change at arguments (kind, place, argument)."""
    change = (arguments @ slopes).reshape(*arguments.shape[:2], results.shape[1], -1)
    results[..., columns] += np.swapaxes(change, 1, 2)


def _for_changes(slopes: Array) -> Single:
    """Return slopes (step, kind, place, row) so that they multiply changes (kind, row, place, unknown)."""
    return np.ascontiguousarray(np.swapaxes(slopes, 2, 3), dtype=np.float32)[..., None]

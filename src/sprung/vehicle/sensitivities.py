"""Sensitivities of time-stepped motions: derivatives of outputs by parameters, initial states and initial memories.

Once a motion is known, a small change follows linear steps. Nonlinear elements enter them by the slopes of their forces alone.
So the changes of all unknowns of a drop are followed at once, in single precision: it is twice as fast, and its rounding is
far below what the derivatives leave out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ElementForce, ElementInput
from sprung.vehicle.nonlinear import Dependences
from sprung.vehicle.stepping import Stepper, Trajectory, mean_rate_offset

Array = NDArray[np.float64]
Single = NDArray[np.float32]
Index = NDArray[np.int64]

_SIDE_BY_SIDE = 8
"""Numbers of single precision that a processor works on at once: unknowns are filled up to a multiple of it."""


class ChangeMatrices(NamedTuple):
    """How changes go through a step.

    Attributes
    ----------
    transition
        State at the end of a step by {x, u} at its start, shape (state, state + row).
    by_state
        Travels and rates by the state, shape (2 row, state).
    by_force
        State at the end of a step by the forces there, shape (state, row).
    at_rest, at_end
        Travels and rates by the forces with the state held, and by those at the end of a step, shape (2 row, row).
    outputs
        What is read, by {x, u}, shape (output, state + row).
    """

    transition: Single
    by_state: Single
    by_force: Single
    at_rest: Single
    at_end: Single
    outputs: Single


class DirectChanges(NamedTuple):
    """What parameters change in a linear function at the arguments that a motion has.

    Attributes
    ----------
    first
        Which unknown the first of the parameters is.
    changes
        By adjacent parameters, shape (step, result, parameter).
    """

    first: int
    changes: Single


class LawSlopes(NamedTuple):
    """Slopes of forces, memories or surplus by the parameters of the laws, at each step.

    Attributes
    ----------
    rows, unknowns
        Which they are, and by which unknown; shape (dependence,).
    slopes
        Shape (step, dependence).
    """

    rows: Index
    unknowns: Index
    slopes: Single


class ForceSlopes(NamedTuple):
    """Slopes of forces, memories and surplus along a motion.

    Attributes
    ----------
    by_travel, by_rate
        Of the forces, by the travel with the memory that follows it, shape (step + 1, row).
    memory_rows
        Row of each memory, shape (memory,).
    by_memory, by_increment, kept
        Of the forces by memories, and of these by the increment of the travel and by themselves at the start of the step, shape
        (step + 1, memory).
    of_forces, of_memories
        By the parameters of the laws.
    surplus_by_start, surplus_by_end
        Of the surplus by travels and rates at both ends of each step, shape (step, 2 row); of no step where forces have none.
    of_surplus
        By the parameters of the laws.
    """

    by_travel: Single
    by_rate: Single
    memory_rows: Index
    by_memory: Single
    by_increment: Single
    kept: Single
    of_forces: LawSlopes
    of_memories: LawSlopes
    surplus_by_start: Single
    surplus_by_end: Single
    of_surplus: LawSlopes


def differentiate_motion(stepper: Stepper, trajectory: Trajectory, drop: int, outputs: Array, every: int) -> Array:
    """Differentiate what is read of a motion by the parameters, the initial state and the initial memories.

    Parameters
    ----------
    stepper
        What stepped.
    trajectory
        The motions.
    drop
        Which of them, by its position.
    outputs
        Linear functions of {x, u}, SI, shape (output, state + row). What parameters change in these functions themselves is left
        to the caller.
    every
        Steps from one reading to the next.

    Returns
    -------
    ndarray
        SI, shape (output, unknown, reading), the unknowns in this order; not finite where the motion is not.
    """
    # Loaded only where something is stepped: it takes half a second.
    from sprung.vehicle.compiled_changes import follow_changes  # noqa: PLC0415

    own = stepper.of_drop(drop)
    with np.errstate(over="ignore", invalid="ignore"):
        states, forces, memories, surplus = (part[:, drop] for part in trajectory)
        motion = np.concatenate([states, forces, np.ones((len(states), 1))], axis=1)
        travel, rate = np.split(motion @ own.inputs[0].T, 2, axis=1)
        # As of the step that ends at each.
        before = np.concatenate([memories[:1], memories[:-1]])
        given = ElementInput(travel, rate, np.diff(travel, axis=0, prepend=travel[:1]), before)
        slopes = _force_slopes(own, given)
        pushed = forces[1:] + surplus[1:]
        ends = _direct_changes(own.step_slopes[0], np.hstack([motion[:-1, :-1], pushed, motion[:-1, -1:]]))
        inputs = _direct_changes(own.input_slopes[0], motion)
    matrices = own.transition, own.by_state, own.by_force, own.directly_by_force, own.input_by_force, outputs[None]
    starts, parameters = own.starts, len(own.values)
    unknowns = parameters + starts
    filled_up = -(-unknowns // _SIDE_BY_SIDE) * _SIDE_BY_SIDE
    readings = np.empty(((len(states) - 1) // every + 1, len(outputs), filled_up), dtype=np.float32)
    follow_changes(
        ChangeMatrices(*(np.ascontiguousarray(part[0], dtype=np.float32) for part in matrices)),
        slopes,
        ends,
        inputs,
        parameters,
        every,
        readings,
    )
    return np.ascontiguousarray(readings[..., :unknowns].transpose(1, 2, 0), dtype=np.float64)


def _direct_changes(slopes: Array, arguments: Array) -> DirectChanges:
    """Compute what parameters change, from slopes (parameter, result, argument) and arguments (step, argument)."""
    which = np.flatnonzero(slopes.any(axis=(1, 2)))
    first, last = (which[0], which[-1] + 1) if which.size else (0, 0)
    own = slopes[first:last].astype(np.float32)
    by_argument = own.transpose(2, 1, 0).reshape(arguments.shape[1], -1)
    changes = arguments.astype(np.float32) @ by_argument
    return DirectChanges(int(first), changes.reshape(len(arguments), slopes.shape[1], -1))


def _law_slopes(dependences: Dependences, slopes: Array) -> LawSlopes:
    """Arrange slopes by parameters, shape (dependence, step)."""
    return LawSlopes(dependences.which, dependences.parameters, _single(slopes.T))


def _single(values: Array) -> Single:
    return np.ascontiguousarray(values, dtype=np.float32)


def _force_slopes(stepper: Stepper, given: ElementInput) -> ForceSlopes:
    """Evaluate the slopes of the forces along the motion of one drop."""
    forces, found = stepper.forces, stepper.forces_at.evaluate(given)
    by_increment = found.memory_by_travel.copy()
    by_increment[0] = 0.0
    by_travel = found.by_travel.copy()
    by_travel[:, forces.memory_rows] += found.by_memory * by_increment
    of_forces, of_memories = forces.differentiate(stepper.values, given)
    none = np.zeros((0, 2 * forces.number)), np.zeros((0, 2 * forces.number)), of_forces[:, :0]
    surplus = _surplus_slopes(stepper, found, given, of_forces) if stepper.has_surplus else none
    return ForceSlopes(
        _single(by_travel),
        _single(found.by_rate),
        forces.memory_rows,
        _single(np.broadcast_to(found.by_memory, by_increment.shape)),
        _single(by_increment),
        _single(found.memory_by_memory),
        _law_slopes(forces.dependences, of_forces),
        _law_slopes(forces.memory_dependences, of_memories),
        _single(surplus[0]),
        _single(surplus[1]),
        _law_slopes(forces.dependences, surplus[2]),
    )


def _surplus_slopes(
    stepper: Stepper, found: ElementForce, given: ElementInput, of_forces: Array
) -> tuple[Array, Array, Array]:
    """Differentiate the surplus of each step.

    Parameters
    ----------
    stepper
        What stepped.
    found
        Forces at each step, with their slopes.
    given
        Of these.
    of_forces
        Derivatives of the forces by the parameters of the laws, shape (dependence, step + 1).

    Returns
    -------
    by_start, by_end
        By travels and rates of all rows at both ends, shape (step, 2 row).
    by_parameter
        By the parameters of the laws, shape (dependence, step).
    """
    kinks, length = stepper.forces_at.kinks, stepper.lengths[0]
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
    return by_start, by_end, np.moveaxis(by_parameter, -1, 0)

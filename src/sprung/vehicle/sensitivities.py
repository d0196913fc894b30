"""Sensitivities of time-stepped motions: derivatives of outputs by parameters, initial states and initial memories.

Once a motion is known, a small change follows linear steps. Nonlinear elements enter them by the slopes of their forces alone.
So the changes of all unknowns of a drop are followed at once, in single precision: it is twice as fast, and its rounding is
far below what the derivatives leave out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.nonlinear_forces import Dependences
from sprung.vehicle.stepping import Stepper, Trajectory

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
        Linear functions of {x, u}, SI, shape (output, state + row). What parameters change in them is left to the caller.
    every
        Steps from one reading to the next.

    Returns
    -------
    ndarray
        SI, shape (output, unknown, reading), the unknowns in this order; not finite where the motion is not.
    """
    # Loaded only where something is stepped: it takes half a second.
    from sprung.vehicle.compiled_changes import follow_changes  # noqa: PLC0415

    kind = stepper.kind[drop]
    with np.errstate(over="ignore", invalid="ignore"):
        states, forces, memories, surplus = (part[:, drop] for part in trajectory)
        motion = np.concatenate([states, forces, np.ones((len(states), 1))], axis=1)
        slopes = _force_slopes(
            stepper, motion @ stepper.inputs[kind].T, np.ascontiguousarray(memories), stepper.lengths[kind]
        )
        pushed = forces[1:] + surplus[1:]
        ends = _direct_changes(stepper.step_slopes[kind], np.hstack([motion[:-1, :-1], pushed, motion[:-1, -1:]]))
        inputs = _direct_changes(stepper.input_slopes[kind], motion)
    by_force = stepper.by_force, stepper.directly_by_force, stepper.input_by_force
    matrices = (part[kind] for part in (stepper.transition, stepper.by_state, *by_force))
    starts, parameters = stepper.starts, len(stepper.values)
    unknowns = parameters + starts
    filled_up = -(-unknowns // _SIDE_BY_SIDE) * _SIDE_BY_SIDE
    readings = np.empty(((len(states) - 1) // every + 1, len(outputs), filled_up), dtype=np.float32)
    follow_changes(
        ChangeMatrices(*(np.ascontiguousarray(part, dtype=np.float32) for part in (*matrices, outputs))),
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


def _force_slopes(stepper: Stepper, inputs: Array, memories: Array, length: float) -> ForceSlopes:
    """Differentiate forces, memories and surplus along a motion.

    Parameters
    ----------
    stepper
        What stepped.
    inputs
        Travels and rates of all rows, SI, shape (step + 1, 2 row).
    memories
        At the end of each step, shape (step + 1, memory).
    length
        Of a step, s.
    """
    # Loaded only where something is stepped: it takes half a second.
    from sprung.vehicle.compiled_slopes import differentiate_forces  # noqa: PLC0415

    forces, steps = stepper.forces, len(inputs)
    rows, with_surplus = forces.number, (steps - 1) * stepper.has_surplus

    def zeros(number: int, columns: int) -> Single:
        return np.zeros((number, columns), dtype=np.float32)

    def by_parameters(dependences: Dependences, number: int) -> LawSlopes:
        which, parameters = dependences
        return LawSlopes(which, parameters, zeros(number, len(which)))

    slopes = ForceSlopes(
        zeros(steps, rows),
        zeros(steps, rows),
        forces.memory_rows,
        zeros(steps, forces.memories),
        zeros(steps, forces.memories),
        zeros(steps, forces.memories),
        by_parameters(stepper.dependences[0], steps),
        by_parameters(stepper.dependences[1], steps),
        zeros(with_surplus, 2 * rows),
        zeros(with_surplus, 2 * rows),
        by_parameters(stepper.dependences[0], with_surplus),
    )
    differentiate_forces(stepper.laws, stepper.law_slopes, inputs, memories, float(length), slopes)
    return slopes

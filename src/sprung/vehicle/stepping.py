"""Time stepping: many motions of a vehicle with nonlinear elements at once, and their sensitivities.

The motions themselves are followed step by step, all drops side by side. Once they are known, a step maps a small change of
its start to one of its end by a matrix for each step and drop. These matrices are computed for many steps at once, and
following the sensitivities takes one product of matrices per step.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ElementForce, ElementInput
from sprung.vehicle.nonlinear import NonlinearForces, NonlinearModel

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_CORRECTIONS = 3
"""Evaluations of the forces at the end of each step: they depend little on their own effect within the step."""

_CHUNK = 128
"""Steps whose matrices are computed at once: they fit into a processor's cache."""


class Trajectory(NamedTuple):
    """Motions, step by step; the first axis is time.

    Attributes
    ----------
    states
        {X, Ẋ}, SI, shape (step + 1, drop, 2n) with n coordinates.
    forces
        N, shape (step + 1, drop, element).
    memories
        Dimensionless, shape (step + 1, drop, element).
    """

    states: Array
    forces: Array
    memories: Array


@dataclass(frozen=True, eq=False)
class Stepper:
    """Time steps of several loads and lengths, for drops that use one of them each.

    Attributes
    ----------
    forces
        The nonlinear elements, the same for all.
    values
        Parameters, SI, shape (parameter,).
    offsets, offset_slopes
        Travel of each element where the empty vehicle rests, m, shape (element,), and its derivatives, (element, parameter).
    steps, slopes
        `NonlinearModel.step` of each load and length, SI, shape (kind, 2n, 2n + 2 element + 1) with n coordinates, and its
        derivatives by each parameter, shape (kind, parameter, 2n, 2n + 2 element + 1).
    kind
        Which of them each drop uses, shape (drop,).
    """

    forces: NonlinearForces
    values: Array
    offsets: Array
    offset_slopes: Array
    steps: Array
    slopes: Array
    kind: Index

    @classmethod
    def of(cls, models: Sequence[NonlinearModel], lengths: Sequence[float], kind: Index, values: Array) -> Stepper:
        """Compute the steps of models, each of a length in s."""
        computed = [model.step(values, length) for model, length in zip(models, lengths, strict=True)]
        steps, slopes = (np.stack(stacked) for stacked in zip(*computed, strict=True))
        return cls(models[0].forces, values, *models[0].travel_offsets(values), steps, slopes, kind)

    @cached_property
    def _rows(self) -> Array:
        """Rows of the travels, shape (element, coordinate)."""
        return self.forces.rows.at(self.values)

    @cached_property
    def _row_slopes(self) -> Array:
        """Derivatives of the rows by each parameter, shape (element, coordinate, parameter)."""
        return np.ascontiguousarray(np.moveaxis(self.forces.rows.slopes, 1, 2))

    @cached_property
    def _parts(self) -> tuple[Array, Array, Array, Array]:
        """Φ, B, B' and d of the step of each kind."""
        elements, n = self._rows.shape
        transition, before, after, constant = np.split(self.steps, np.cumsum([2 * n, elements, elements]), axis=2)
        return transition, before, after, constant

    def integrate(self, states: Array, memories: Array, steps: int) -> Trajectory:
        """Integrate motions from their initial states.

        Parameters
        ----------
        states
            {X, Ẋ} of each drop, SI, shape (drop, 2n).
        memories
            Of the elements that have one, dimensionless, shape (drop, memory).
        steps
            How many.

        Returns
        -------
        Trajectory
            Not finite from where a motion diverges.
        """
        rows, values = self._rows, self.values
        elements, n = rows.shape
        both = np.kron(np.eye(2), rows)
        kind = self.kind
        transition, before, after, constant = self._parts
        # One product gives the end of a step without the forces there, and travel and rate there.
        predictor = np.concatenate([transition, before, constant], axis=2)
        predictor = np.concatenate([predictor, both @ predictor], axis=1)[kind]
        predictor[:, 2 * n : 2 * n + elements, -1] += self.offsets
        by_force = after[kind]
        travel_by_force = (both @ after)[kind]
        trajectory = Trajectory(
            np.empty((steps + 1, len(kind), 2 * n)),
            np.empty((steps + 1, len(kind), elements)),
            np.zeros((steps + 1, len(kind), elements)),
        )
        trajectory.states[0] = states
        trajectory.memories[0][:, self.forces.with_memory] = memories
        travel = states[:, :n] @ rows.T + self.offsets
        at_start = ElementInput(travel, states[:, n:] @ rows.T, np.zeros_like(travel), trajectory.memories[0])
        trajectory.forces[0] = self.forces.evaluate(values, at_start).force
        start = np.ones((len(kind), 2 * n + elements + 1))
        # Newton's correction takes the effect of a force on its own travel and rate; on the others' it is less still.
        diagonal = np.arange(elements)
        own_travel, own_rate = travel_by_force[:, diagonal, diagonal], travel_by_force[:, elements + diagonal, diagonal]
        with np.errstate(over="ignore", invalid="ignore"):
            for k in range(steps):
                start[:, : 2 * n], start[:, 2 * n : -1] = trajectory.states[k], trajectory.forces[k]
                predicted = np.matmul(predictor, start[:, :, None])[:, :, 0]
                memory, force = trajectory.memories[k], trajectory.forces[k]
                for correction in range(_CORRECTIONS):
                    end = predicted[:, 2 * n :] + np.matmul(travel_by_force, force[:, :, None])[:, :, 0]
                    increment = end[:, :elements] - travel
                    given = ElementInput(end[:, :elements], end[:, elements:], increment, memory)
                    found = self.forces.evaluate(values, given)
                    if correction < _CORRECTIONS - 1:
                        by_travel = found.by_travel + found.by_memory * found.memory_by_travel
                        slope = 1.0 - by_travel * own_travel - found.by_rate * own_rate
                        force = force + (found.force - force) / slope
                trajectory.forces[k + 1], trajectory.memories[k + 1], travel = found.force, found.memory, given.travel
                end_state = predicted[:, : 2 * n] + np.matmul(by_force, found.force[:, :, None])[:, :, 0]
                trajectory.states[k + 1] = end_state
        return trajectory

    def sensitivities(self, trajectory: Trajectory) -> Iterator[tuple[int, Array, Array]]:
        """Yield the derivatives of motions by the parameters, the initial states and the initial memories, in this order.

        Parameters
        ----------
        trajectory
            The motions.

        Yields
        ------
        first
            The step at which a chunk of steps begins; chunks follow each other from the start on.
        states, forces
            Derivatives of {X, Ẋ} and of the forces, shapes (step, drop, 2n, unknown) and (step, drop, element, unknown).
        """
        parameters, memories = len(self.values), len(self.forces.with_memory)
        steps, drops, state = trajectory.states.shape
        current = np.zeros((drops, state + memories, parameters + state + memories))
        current[:, :, parameters:] = np.eye(state + memories)
        for first in range(0, steps, _CHUNK):
            last = min(first + _CHUNK, steps)
            chunk = np.empty((last - first, *current.shape))
            chunk[0] = current
            if last > first + 1 or last < steps:
                matrices, drive = self._linearise(trajectory, first, min(last, steps - 1))
                for k in range(last - first):
                    chunk[k] = current
                    if first + k < steps - 1:
                        current = matrices[k] @ current
                        current[..., :parameters] += drive[k]
            yield first, chunk[:, :, :state], self._force_sensitivities(trajectory, first, chunk)

    def _evaluate(self, trajectory: Trajectory, first: int, last: int) -> tuple[ElementForce, ElementInput]:
        """Return the forces of the steps that end at first ... last - 1, and their input."""
        X, V = np.split(trajectory.states, 2, axis=-1)
        travel, rate = X[first:last] @ self._rows.T + self.offsets, V[first:last] @ self._rows.T
        earlier = np.arange(first, last) - 1
        earlier[earlier < 0] = 0
        increment = travel - (X[earlier] @ self._rows.T + self.offsets)
        given = ElementInput(travel, rate, increment, trajectory.memories[earlier])
        return self.forces.evaluate(self.values, given), given

    def _force_sensitivities(self, trajectory: Trajectory, first: int, chunk: Array) -> Array:
        """Return the derivatives of the forces from those of states and memories."""
        last, parameters = first + len(chunk), len(self.values)
        found, given = self._evaluate(trajectory, first, last)
        rows, row_slopes = self._rows, self._row_slopes
        n = rows.shape[1]
        forces = found.by_travel[..., None] * (rows @ chunk[:, :, :n])
        forces += found.by_rate[..., None] * (rows @ chunk[:, :, n : 2 * n])
        memory = np.zeros_like(forces)
        memory[:, :, self.forces.with_memory] = chunk[:, :, 2 * n :]
        forces += found.by_memory[..., None] * memory
        forces[..., :parameters] += self.forces.differentiate(self.values, given)[0]
        X, V = np.split(trajectory.states[first:last], 2, axis=-1)
        forces[..., :parameters] += found.by_travel[..., None] * (_by_geometry(X, row_slopes) + self.offset_slopes)
        forces[..., :parameters] += found.by_rate[..., None] * _by_geometry(V, row_slopes)
        return forces

    def _linearise(self, trajectory: Trajectory, first: int, last: int) -> tuple[Array, Array]:
        """Linearise the steps from first to last - 1 about their motions.

        Returns
        -------
        matrices
            Derivatives of {x, memory} at the end by those at the start, shape (step, drop, 2n + memory, 2n + memory).
        drive
            Their derivatives by the parameters with the start held, shape (step, drop, 2n + memory, parameter).
        """
        rows, row_slopes, memories = self._rows, self._row_slopes, self.forces.with_memory
        now, now_input = self._evaluate(trajectory, first, last)
        then, then_input = self._evaluate(trajectory, first + 1, last + 1)
        now_force, _ = self.forces.differentiate(self.values, now_input)
        then_force, then_memory = self.forces.differentiate(self.values, then_input)
        n = rows.shape[1]
        x, y = trajectory.states[first:last], trajectory.states[first + 1 : last + 1]

        # The forces at the start: by the state there, and by the parameters with the state held.
        start_by_x = _by_state(now.by_travel, rows, now.by_rate)
        start_by_p = (
            now_force
            + now.by_travel[..., None] * (_by_geometry(x[..., :n], row_slopes) + self.offset_slopes)
            + now.by_rate[..., None] * _by_geometry(x[..., n:], row_slopes)
        )
        # The forces at the end: by the state there, by state and memory at the start, and by the parameters.
        by_increment = then.by_memory * then.memory_by_travel
        end_by_y = _by_state(then.by_travel + by_increment, rows, then.by_rate)
        end_by_x = -_by_state(by_increment, rows, np.zeros_like(by_increment))
        end_by_memory = then.by_memory * then.memory_by_memory
        increments = _by_geometry(y[..., :n] - x[..., :n], row_slopes)
        end_by_p = then_force + then.by_memory[..., None] * then_memory
        end_by_p += then.by_travel[..., None] * (_by_geometry(y[..., :n], row_slopes) + self.offset_slopes)
        end_by_p += by_increment[..., None] * increments
        end_by_p += then.by_rate[..., None] * _by_geometry(y[..., n:], row_slopes)

        transition, before, after = (part[self.kind] for part in self._parts[:3])
        # The state at the end moves the forces there, which move the state: y = r + B' E y has the solution
        # y = r + B' (I - E B')⁻¹ E r.
        inverse = np.linalg.inv(np.eye(self.forces.number) - end_by_y @ after)
        by_x = transition + before @ start_by_x + after @ end_by_x
        by_memory = before * now.by_memory[..., None, :] + after * end_by_memory[..., None, :]
        by_p = self._step_by_parameters(x, trajectory.forces[first:last], trajectory.forces[first + 1 : last + 1])
        by_p += before @ start_by_p + after @ end_by_p
        whole = np.concatenate([by_x, by_memory[..., memories], by_p], axis=-1)
        whole += (after @ inverse) @ (end_by_y @ whole)

        state, size, parameters = 2 * n, 2 * n + len(memories), len(self.values)
        matrices = np.zeros((*x.shape[:2], size, size))
        drive = np.zeros((*x.shape[:2], size, parameters))
        matrices[..., :state, :] = whole[..., :size]
        drive[..., :state, :] = whole[..., size:]
        if len(memories):
            slope = then.memory_by_travel[..., memories, None]
            increment = rows[memories] @ whole[..., :n, :]
            increment[..., :n] -= rows[memories]
            matrices[..., state:, :] = slope * increment[..., :size]
            diagonal = state + np.arange(len(memories))
            matrices[..., diagonal, diagonal] += then.memory_by_memory[..., memories]
            by_geometry = slope * (increment[..., size:] + increments[..., memories, :])
            drive[..., state:, :] = by_geometry + then_memory[..., memories, :]
        return matrices, drive

    def _step_by_parameters(self, x: Array, before: Array, after: Array) -> Array:
        """Return the derivatives of the step itself by the parameters, shape (step, drop, 2n, parameter)."""
        inputs = np.concatenate([x, before, after, np.ones((*x.shape[:2], 1))], axis=-1)
        parameters, state = self.slopes.shape[1:3]
        found = np.empty((*x.shape[:2], state, parameters))
        for kind, slopes in enumerate(self.slopes):
            drops = np.flatnonzero(self.kind == kind)
            if drops.size:
                change = inputs[:, drops] @ slopes.reshape(parameters * state, -1).T
                found[:, drops] = np.swapaxes(change.reshape(len(x), len(drops), parameters, state), 2, 3)
        return found


def _by_state(by_travel: Array, rows: Array, by_rate: Array) -> Array:
    """Return the derivatives of forces by the state {X, Ẋ}, shape (..., element, 2n)."""
    return np.concatenate([by_travel[..., None] * rows, by_rate[..., None] * rows], axis=-1)


def _by_geometry(X: Array, row_slopes: Array) -> Array:
    """Return the derivatives of travels by geometry at X of shape (..., n): shape (..., element, parameter)."""
    change: Array = np.einsum("...i,fip->...fp", X, row_slopes, optimize=True)
    return change

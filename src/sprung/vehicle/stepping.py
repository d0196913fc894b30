"""Time stepping: many motions of a vehicle with nonlinear elements at once.

The linear vehicle is stepped exactly, the forces of the nonlinear elements being its inputs, and these depend on few
displacements. So a step of all motions is one product of matrices, and an evaluation of the force laws at its end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ElementInput
from sprung.vehicle.nonlinear import NonlinearForces, NonlinearModel

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_MOST_EVALUATIONS = 12
"""Evaluations of the forces at the end of each step, at the most: mostly two are enough."""

_SOLVED = 1e-7
"""Difference of forces from those that they were evaluated with, as a part of the largest, that is none."""


class Trajectory(NamedTuple):
    """Motions, step by step; the first axis is time.

    Attributes
    ----------
    states
        {X, Ẋ}, SI, shape (step + 1, drop, state).
    forces
        Of the rows of the nonlinear elements, N, shape (step + 1, drop, row).
    memories
        Dimensionless, shape (step + 1, drop, memory).
    """

    states: Array
    forces: Array
    memories: Array


class StepDrive(NamedTuple):
    """What moves the vehicle from outside, step by step; the first axis is time.

    Attributes
    ----------
    increments
        What it adds to the state at the end of each step, SI, shape (step, drop, state).
    inputs
        What it adds to travels and rates of the rows of the nonlinear elements, m and m/s, shape (step + 1, drop, 2 row).
    """

    increments: Array
    inputs: Array


@dataclass(frozen=True, eq=False)
class Stepper:
    """Time steps of several loads and lengths, for drops that use one of them each.

    Attributes
    ----------
    forces
        The nonlinear elements, the same for all.
    values
        Parameters, SI, shape (parameter,).
    steps, step_slopes
        `NonlinearModel.step` of each load and length, SI, shape (kind, state, state + 2 row + 1), and its derivatives by each
        parameter, shape (kind, parameter, state, state + 2 row + 1).
    inputs, input_slopes
        `NonlinearModel.element_inputs` likewise, shapes (kind, 2 row, state + row + 1) and
        (kind, parameter, 2 row, state + row + 1).
    kind
        Which of them each drop uses, shape (drop,).
    """

    forces: NonlinearForces
    values: Array
    steps: Array
    step_slopes: Array
    inputs: Array
    input_slopes: Array
    kind: Index

    @classmethod
    def of(cls, models: Sequence[NonlinearModel], lengths: Sequence[float], kind: Index, values: Array) -> Stepper:
        """Compute the steps of models, each of a length in s."""
        computed = [
            (*model.step(values, length), *model.element_inputs(values))
            for model, length in zip(models, lengths, strict=True)
        ]
        steps, step_slopes, inputs, input_slopes = (np.stack(part) for part in zip(*computed, strict=True))
        return cls(models[0].forces, values, steps, step_slopes, inputs, input_slopes, kind)

    def of_kind(self, kind: int) -> Stepper:
        """Return the steps of one load and length alone."""
        own = slice(kind, kind + 1)
        return replace(
            self,
            steps=self.steps[own],
            step_slopes=self.step_slopes[own],
            inputs=self.inputs[own],
            input_slopes=self.input_slopes[own],
            kind=np.zeros(int(np.sum(self.kind == kind)), dtype=np.int64),
        )

    @cached_property
    def parameters(self) -> tuple[Array, ...]:
        """Parameters of the laws, each of shape (parameter, element)."""
        return self.forces.parameters(self.values)

    @cached_property
    def slots(self) -> Index:
        """Drops of each kind, shape (kind, slot): a kind with fewer drops than another one repeats some drop."""
        drops = [np.flatnonzero(self.kind == kind) for kind in range(len(self.steps))]
        most = max(map(len, drops))
        return np.array([np.resize(own if own.size else np.zeros(1, dtype=np.int64), most) for own in drops])

    @cached_property
    def places(self) -> tuple[Index, Index]:
        """Kind and slot of each drop, shapes (drop,)."""
        return self.kind, np.array([int(np.sum(self.kind[:drop] == kind)) for drop, kind in enumerate(self.kind)])

    @cached_property
    def transition(self) -> Array:
        """[Φ, B]: the end of a step without the forces there, from {x, u} at its start; shape (kind, state, state + row)."""
        return self.steps[..., : sum(self.by_force.shape[1:])]

    @cached_property
    def by_force(self) -> Array:
        """B': the end of a step by the forces there, shape (kind, state, row)."""
        state, rows = self.steps.shape[1], self.forces.number
        return self.steps[..., state + rows : state + 2 * rows]

    @cached_property
    def by_state(self) -> Array:
        """Travels and rates by the state, shape (kind, 2 row, state)."""
        return self.inputs[..., : self.steps.shape[1]]

    @cached_property
    def directly_by_force(self) -> Array:
        """Travels and rates by the forces with the state held, shape (kind, 2 row, row)."""
        return self.inputs[..., self.steps.shape[1] : -1]

    @cached_property
    def input_by_force(self) -> Array:
        """Travels and rates at the end of a step by the forces there, shape (kind, 2 row, row)."""
        found: Array = self.by_state @ self.by_force + self.directly_by_force
        return found

    def integrate(
        self, states: Array, memories: Array, steps: int, drive: StepDrive | None = None, similar: Array | None = None
    ) -> Trajectory:
        """Integrate motions from their initial states.

        Parameters
        ----------
        states
            {X, Ẋ} of each drop, SI, shape (drop, state).
        memories
            Of the elements that have one, dimensionless, shape (drop, memory).
        steps
            How many.
        drive
            What moves the vehicle from outside.
        similar
            Forces of similar motions, N, shape (step + 1, drop, row): they save evaluations.

        Returns
        -------
        Trajectory
            Not finite from where a motion diverges.
        """
        slots, (kind, slot) = self.slots, self.places
        driven = None if drive is None else StepDrive(*(part[:, slots] for part in drive))
        whole, kept = self.follow(
            states[slots], memories[slots], steps, driven, None if similar is None else similar[:, slots]
        )
        state = states.shape[1]
        return Trajectory(whole[:, kind, slot, :state], whole[:, kind, slot, state:-1], kept[:, kind, slot])

    def follow(
        self,
        states: Array,
        memories: Array,
        steps: int,
        drive: StepDrive | None = None,
        similar: Array | None = None,
        nearly: float = 0.0,
    ) -> tuple[Array, Array]:
        """Follow motions that are arranged by kind.

        Parameters
        ----------
        states, memories
            As for `integrate`, shapes (kind, motion, state) and (kind, motion, memory).
        steps
            How many.
        drive
            What moves the vehicle from outside, arranged likewise.
        similar
            Forces of similar motions, N, shape (step + 1, kind, motion, row).
        nearly
            Difference of forces from those that they were evaluated with, as a part of the largest, whose correction is not
            evaluated again: it leaves about the square of it, where no kink lies between.

        Returns
        -------
        motions
            {x, u, 1}, shape (step + 1, kind, motion, state + row + 1).
        memories
            Shape (step + 1, kind, motion, memory).
        """
        forces, shape = self.forces, states.shape[:2]
        state, rows = states.shape[2], self.forces.number
        # One product gives the end of a step without the forces there, and travels and rates there.
        ends = np.concatenate([self.transition, self.steps[..., -1:]], axis=2)
        inputs = self.by_state @ ends
        inputs[..., -1] += self.inputs[..., -1]
        predictor = _transposed(np.concatenate([ends, inputs], axis=1))
        by_force, feedback = _transposed(self.by_force), _feedback(self.input_by_force, forces)
        motions = np.ones((steps + 1, *shape, state + rows + 1))
        kept = np.empty((steps + 1, *shape, forces.memories))
        motions[0, ..., :state], kept[0] = states, memories
        # Forces are expected to go on as straight as they do, but for what those of the similar motions turn there.
        alike = np.zeros((steps + 1, *shape, rows)) if similar is None else similar
        turns = np.diff(alike, 2, axis=0, prepend=alike[:1])
        predicted = np.empty((*shape, state + 2 * rows))
        with np.errstate(over="ignore", invalid="ignore"):
            by_state = _transposed(self.by_state)
            at_start = states @ by_state + self.inputs[:, None, :, -1]
            if drive is not None:
                at_start += drive.inputs[0]
            held = _feedback(self.directly_by_force, forces)
            force, _, travel = self._solve(at_start, at_start[..., :rows], memories, alike[0], held, nearly)
            before = motions[0, ..., state:-1] = force
            for k in range(steps):
                np.matmul(motions[k], predictor, out=predicted)
                if drive is not None:
                    predicted[..., :state] += drive.increments[k]
                    predicted[..., state:] += drive.increments[k] @ by_state + drive.inputs[k + 1]
                expected = 2 * force - before + turns[k]
                before, end = force, motions[k + 1]
                force, kept[k + 1], travel = self._solve(
                    predicted[..., state:], travel, kept[k], expected, feedback, nearly
                )
                end[..., state:-1] = force
                np.add(predicted[..., :state], force @ by_force, out=end[..., :state])
        return motions, kept

    def _solve(
        self,
        predicted: Array,
        before: Array,
        memories: Array,
        force: Array,
        feedback: tuple[Array, Array, Array, Array],
        nearly: float,
    ) -> tuple[Array, Array, Array]:
        """Return forces, memories and travels that depend on each other.

        Parameters
        ----------
        predicted
            Travels and rates without the forces, shape (kind, slot, 2 row).
        before, memories
            Travels and memories at the start of the step, shapes (kind, slot, row) and (kind, slot, memory).
        force
            The forces to begin with, shape (kind, slot, row).
        feedback
            What the forces add to travels and rates, from `_feedback`.
        nearly
            As for `follow`.
        """
        rows, memory_rows = force.shape[-1], self.forces.memory_rows
        by_force, own_travel, own_rate, memory_travel = feedback
        earlier: tuple[Array, Array] | None = None
        for left in reversed(range(_MOST_EVALUATIONS)):
            end = predicted + force @ by_force
            travel = end[..., :rows]
            given = ElementInput(travel, end[..., rows:], travel - before, memories)
            found = self.forces.evaluate(self.parameters, given)
            error = found.force - force
            size, largest = np.abs(error).max(initial=0.0), np.abs(found.force).max(initial=0.0)
            if not left or not size > _SOLVED * largest:
                break
            # Newton's correction takes the effect of a force on its own travel and rate first, then that of all on all others.
            slope = found.by_travel * own_travel + found.by_rate * own_rate
            if len(memory_rows):
                slope[..., memory_rows] += found.by_memory * found.memory_by_travel * memory_travel
            correction = error / (1.0 - slope)
            moved = correction @ by_force
            answer = found.by_travel * moved[..., :rows] + found.by_rate * moved[..., rows:]
            if len(memory_rows):
                answer[..., memory_rows] += found.by_memory * found.memory_by_travel * moved[..., memory_rows]
            correction += (error + answer - correction) / (1.0 - slope)
            if earlier is not None:
                # Where a kink lies between, Newton's method may go back and forth: the secant does not.
                passed = error * earlier[1] < 0
                secant = error * (force - earlier[0]) / np.where(passed, earlier[1] - error, 1.0)
                correction = np.where(passed, secant, correction)
            earlier, force = (force, error), force + correction
            if size < nearly * largest:
                moved = correction @ by_force
                change = found.memory_by_travel * moved[..., memory_rows]
                return force, found.memory + change, travel + moved[..., :rows]
        return found.force, found.memory, travel


def _feedback(by_force: Array, forces: NonlinearForces) -> tuple[Array, Array, Array, Array]:
    """Return what forces add to travels and rates, from these by the forces, shape (kind, 2 row, row).

    Returns
    -------
    by_force
        Travels and rates by the forces, shape (kind, row, 2 row).
    own_travel, own_rate
        Those of each row by its own force, shape (kind, 1, row).
    memory_travel
        Travel of the row of each memory by its own force, shape (kind, 1, memory).
    """
    travel, rate = (np.diagonal(part, axis1=1, axis2=2)[:, None] for part in np.split(by_force, 2, axis=1))
    return _transposed(by_force), travel.copy(), rate.copy(), travel[..., forces.memory_rows]


def _transposed(matrices: Array) -> Array:
    """Return matrices for products from the right, contiguous."""
    return np.ascontiguousarray(np.swapaxes(matrices, -1, -2))

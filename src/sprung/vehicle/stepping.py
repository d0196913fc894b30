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

from sprung.vehicle.force_laws import ElementForce, ElementInput
from sprung.vehicle.nonlinear import ForcesAt, NonlinearForces, NonlinearModel

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_MOST_EVALUATIONS = 12
"""Evaluations of the forces at the end of each step, at the most: mostly two are enough."""

_SOLVED = 1e-7
"""Difference of forces from those that they were evaluated with, as a part of the largest, that is none."""

_OWN_EFFECT = 0.1
"""Effect of a surplus on forces and on itself, as a part of it, at the most: c h/m of a damper and the mass behind it."""


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
    surplus
        Twice what the mean force over each step is above that of a straight run between its ends, N, shape
        (step + 1, drop, row). It moves the vehicle like a larger force at the end of the step, but is not read.
    """

    states: Array
    forces: Array
    memories: Array
    surplus: Array


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
    lengths
        Of the steps, s, shape (kind,).
    kind
        Which of them each drop uses, shape (drop,).
    displacements
        How many of a state are displacements; velocities follow, of coordinates with mass only.
    """

    forces: NonlinearForces
    values: Array
    steps: Array
    step_slopes: Array
    inputs: Array
    input_slopes: Array
    lengths: Array
    kind: Index
    displacements: int

    @classmethod
    def of(cls, models: Sequence[NonlinearModel], lengths: Sequence[float], kind: Index, values: Array) -> Stepper:
        """Compute the steps of models, each of a length in s."""
        computed = [
            (*model.step(values, length), *model.element_inputs(values))
            for model, length in zip(models, lengths, strict=True)
        ]
        steps, step_slopes, inputs, input_slopes = (np.stack(part) for part in zip(*computed, strict=True))
        n = len(models[0].linear.heave)
        return cls(models[0].forces, values, steps, step_slopes, inputs, input_slopes, np.array(lengths), kind, n)

    def of_kind(self, kind: int) -> Stepper:
        """Return the steps of one load and length alone."""
        own = slice(kind, kind + 1)
        return replace(
            self,
            steps=self.steps[own],
            step_slopes=self.step_slopes[own],
            inputs=self.inputs[own],
            input_slopes=self.input_slopes[own],
            lengths=self.lengths[own],
            kind=np.zeros(int(np.sum(self.kind == kind)), dtype=np.int64),
        )

    @property
    def starts(self) -> int:
        """Numbers from which a motion starts: of its state, and of its memories."""
        return int(self.steps.shape[1]) + self.forces.memories

    @cached_property
    def forces_at(self) -> ForcesAt:
        """The nonlinear elements with their parameters."""
        return self.forces.at(self.values)

    @cached_property
    def has_surplus(self) -> bool:
        """Whether forces have a surplus: not if all are friction, nor where rates jump with forces, as behind mounts."""
        return not self.directly_by_force.any() and not all(law.has_memory for law, *_ in self.forces.laws)

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

    @cached_property
    def input_by_surplus(self) -> Array:
        """Travels and rates at the end of a step by the surplus there, shape (kind, 2 row, row)."""
        found: Array = self.by_state @ self.by_force
        return found

    def unresolved(self, trajectory: Trajectory) -> Array:
        """Return what the mean forces of kinks over steps are above what the ends of the steps say; see `KinkForces`.

        Parameters
        ----------
        trajectory
            Motions that were stepped.

        Returns
        -------
        ndarray
            N, of the steps that end there; none at the first; shape (step + 1, drop, row).
        """
        states, forces = trajectory.states, trajectory.forces
        motion = np.concatenate([states, forces, np.ones((*states.shape[:-1], 1))], axis=-1)
        kinks, of_drop = self.forces_at.kinks, np.swapaxes(self.inputs, 1, 2)[self.kind]
        arguments = kinks.arguments(np.swapaxes(np.swapaxes(motion, 0, 1) @ of_drop, 0, 1))
        found = np.zeros_like(forces)
        found[1:] = kinks.unresolved(arguments[:-1], arguments[1:])
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
            Forces and surplus of similar motions, N, shape (step + 1, drop, 2 row): they save evaluations.

        Returns
        -------
        Trajectory
            Not finite from where a motion diverges.
        """
        slots, (kind, slot) = self.slots, self.places
        driven = None if drive is None else StepDrive(*(part[:, slots] for part in drive))
        whole, kept, surplus = self.follow(
            states[slots], memories[slots], steps, driven, None if similar is None else similar[:, slots]
        )
        state = states.shape[1]
        return Trajectory(
            whole[:, kind, slot, :state], whole[:, kind, slot, state:-1], kept[:, kind, slot], surplus[:, kind, slot]
        )

    def follow(
        self,
        states: Array,
        memories: Array,
        steps: int,
        drive: StepDrive | None = None,
        similar: Array | None = None,
        nearly: float = 0.0,
    ) -> tuple[Array, Array, Array]:
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
            Forces and surplus of similar motions, N, shape (step + 1, kind, motion, 2 row).
        nearly
            Difference of forces from those that they were evaluated with, as a part of the largest, whose correction is not
            evaluated again: it leaves about the square of it, where no kink lies between.

        Returns
        -------
        motions
            {x, u, 1}, shape (step + 1, kind, motion, state + row + 1).
        memories
            Shape (step + 1, kind, motion, memory).
        surplus
            N, shape (step + 1, kind, motion, row).
        """
        forces, shape = self.forces, states.shape[:2]
        state, rows = states.shape[2], self.forces.number
        # One product gives the end of a step without the forces there, and travels and rates there.
        ends = np.concatenate([self.transition, self.steps[..., -1:]], axis=2)
        inputs = self.by_state @ ends
        inputs[..., -1] += self.inputs[..., -1]
        predictor = _transposed(np.concatenate([ends, inputs], axis=1))
        by_force = _transposed(self.by_force)
        feedback = _Feedback.of(self.input_by_force, self.input_by_surplus)
        motions = np.ones((steps + 1, *shape, state + rows + 1))
        kept, surplus = np.empty((steps + 1, *shape, forces.memories)), np.zeros((steps + 1, *shape, rows))
        motions[0, ..., :state], kept[0] = states, memories
        # Forces are expected to go on as straight as they do, but for what those of the similar motions turn there.
        alike, of_alike = np.zeros((2, *surplus.shape)) if similar is None else np.split(similar, 2, axis=-1)
        turns = np.diff(alike, 2, axis=0, prepend=alike[:1])
        predicted = np.empty((*shape, state + 2 * rows))
        with np.errstate(over="ignore", invalid="ignore"):
            by_state = _transposed(self.by_state)
            at_start = states @ by_state + self.inputs[:, None, :, -1]
            if drive is not None:
                at_start += drive.inputs[0]
            held = _Feedback.of(self.directly_by_force, self.input_by_surplus)
            end = self._solve(at_start, None, memories, alike[0], surplus[0], held, nearly)
            before = motions[0, ..., state:-1] = end.force
            for k in range(steps):
                np.matmul(motions[k], predictor, out=predicted)
                if drive is not None:
                    predicted[..., :state] += drive.increments[k]
                    predicted[..., state:] += drive.increments[k] @ by_state + drive.inputs[k + 1]
                expected, before = 2 * end.force - before + turns[k], end.force
                end = self._solve(predicted[..., state:], end, kept[k], expected, of_alike[k + 1], feedback, nearly)
                motions[k + 1, ..., state:-1], kept[k + 1], surplus[k + 1] = end.force, end.memory, end.surplus
                moving = (end.force + end.surplus if self.has_surplus else end.force) @ by_force
                np.add(predicted[..., :state], moving, out=motions[k + 1, ..., :state])
        return motions, kept, surplus

    def _solve(
        self,
        predicted: Array,
        start: _End | None,
        memories: Array,
        force: Array,
        surplus: Array,
        feedback: _Feedback,
        nearly: float,
    ) -> _End:
        """Return forces, memories and travels that depend on each other.

        Parameters
        ----------
        predicted
            Travels and rates without the forces, shape (kind, slot, 2 row).
        start
            The end of the step before; None where no step is taken.
        memories
            At the start of the step, shape (kind, slot, memory).
        force, surplus
            To begin with, shape (kind, slot, row).
        feedback
            What they add to travels and rates.
        nearly
            As for `follow`.
        """
        rows, memory_rows = force.shape[-1], self.forces.memory_rows
        earlier: tuple[Array, Array] | None = None
        missing = None
        for left in reversed(range(_MOST_EVALUATIONS)):
            inputs = predicted + force @ feedback.by_force
            if start is not None and self.has_surplus:
                inputs += surplus @ feedback.by_surplus
            travel, rate = inputs[..., :rows], inputs[..., rows:]
            increment = np.zeros_like(travel) if start is None else travel - start.inputs[..., :rows]
            arguments = self.forces_at.kinks.arguments(inputs)
            found = self.forces_at.evaluate(ElementInput(travel, rate, increment, memories), arguments)
            error = found.force - force
            size, largest = np.abs(error).max(initial=0.0), np.abs(found.force).max(initial=0.0)
            if self.has_surplus and start is not None:
                missing = self._surplus(start, inputs, arguments, found) - surplus
                size = max(size, _OWN_EFFECT * np.abs(missing).max(initial=0.0))
            if not left or not size > _SOLVED * largest:
                surplus = surplus if missing is None else surplus + missing
                return _End(found.force, found.memory, inputs, surplus, arguments, found)
            by_travel = found.by_travel
            if len(memory_rows):
                by_travel = by_travel.copy()
                by_travel[..., memory_rows] += found.by_memory * found.memory_by_travel
            correction = _corrected(error, missing, by_travel, found.by_rate, feedback)
            if earlier is not None:
                # Where a kink lies between, Newton's method may go back and forth: the secant does not.
                passed = error * earlier[1] < 0
                secant = error * (force - earlier[0]) / np.where(passed, earlier[1] - error, 1.0)
                correction = np.where(passed, secant, correction)
            earlier, force = (force, error), force + correction
            moved = correction @ feedback.by_force if size < nearly * largest else None
            if missing is not None:
                surplus = surplus + missing
                moved = None if moved is None else moved + missing @ feedback.by_surplus
            if moved is not None:
                memory = found.memory + found.memory_by_travel * moved[..., memory_rows]
                moved += inputs
                return _End(force, memory, moved, surplus, self.forces_at.kinks.arguments(moved), found)
        raise AssertionError("the last evaluation returns")

    def _surplus(self, start: _End, inputs: Array, arguments: Array, end: ElementForce) -> Array:
        """Return twice what the mean forces over a step are above the mean of those at both ends.

        Parameters
        ----------
        start
            Of the step.
        inputs
            Travels and rates at its end, shape (kind, slot, 2 row).
        arguments
            Of the kinks there, shape (kind, slot, kink).
        end
            Slopes of the forces there.

        Returns
        -------
        ndarray
            N, shape (kind, slot, row).
        """
        # The mean rate is the increment of the travel, and the ends of the rate tell how the travel is curved.
        length, rows = self.lengths[:, None, None], end.force.shape[-1]
        change = inputs - start.inputs
        curved = mean_rate_offset(start.inputs, change, length)
        surplus: Array = (start.slopes.by_rate + end.by_rate) * curved
        if end.by_travel.any():
            surplus -= (start.slopes.by_travel + end.by_travel) * (change[..., rows:] * (length / 12.0))
        surplus += self.forces_at.kinks.surplus(start.arguments, arguments)
        return surplus


class _End(NamedTuple):
    """The end of a step.

    Attributes
    ----------
    force, memory, surplus
        As in `Trajectory`, shape (kind, slot, row) or (kind, slot, memory).
    inputs
        Travels and rates, shape (kind, slot, 2 row).
    arguments
        Of the kinks, shape (kind, slot, kink).
    slopes
        Of the forces, where they were evaluated last.
    """

    force: Array
    memory: Array
    inputs: Array
    surplus: Array
    arguments: Array
    slopes: ElementForce


class _Feedback(NamedTuple):
    """What forces add to travels and rates.

    Attributes
    ----------
    by_force, by_surplus
        Travels and rates by the forces and by their surplus, shape (kind, row, 2 row).
    own_travel, own_rate
        Those of each row by its own force, shape (kind, 1, row).
    """

    by_force: Array
    by_surplus: Array
    own_travel: Array
    own_rate: Array

    @classmethod
    def of(cls, by_force: Array, by_surplus: Array) -> _Feedback:
        """Arrange travels and rates by the forces and by their surplus, shape (kind, 2 row, row)."""
        own = (np.diagonal(part, axis1=1, axis2=2)[:, None].copy() for part in np.split(by_force, 2, axis=1))
        return cls(_transposed(by_force), _transposed(by_surplus), *own)


def mean_rate_offset(start: Array, change: Array, length: Array) -> Array:
    """Return what mean rates over steps are above the mean of those at both ends, m/s, shape (..., row).

    Parameters
    ----------
    start, change
        Travels and rates at the start, and their changes over the step, shape (..., 2 row).
    length
        Of the steps, s.
    """
    rows = start.shape[-1] // 2
    offset: Array = change[..., :rows] / length
    offset -= start[..., rows:]
    offset -= 0.5 * change[..., rows:]
    return offset


def _corrected(error: Array, change: Array | None, by_travel: Array, by_rate: Array, feedback: _Feedback) -> Array:
    """Return Newton's correction of forces with an error whose surplus changes, N, shape (kind, slot, row)."""
    rows = error.shape[-1]

    def answer(moved: Array) -> Array:
        found: Array = by_travel * moved[..., :rows] + by_rate * moved[..., rows:]
        return found

    # The effect of a force on its own travel and rate comes first, then that of all on all others.
    own = 1.0 - (by_travel * feedback.own_travel + by_rate * feedback.own_rate)
    if change is not None:
        error = error + answer(change @ feedback.by_surplus)
    correction = error / own
    further: Array = (error + answer(correction @ feedback.by_force) - correction) / own
    return correction + further


def _transposed(matrices: Array) -> Array:
    """Return matrices for products from the right, contiguous."""
    return np.ascontiguousarray(np.swapaxes(matrices, -1, -2))

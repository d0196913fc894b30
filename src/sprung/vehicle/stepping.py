"""Time stepping: motions of a vehicle with nonlinear elements.

The linear vehicle is stepped exactly, the forces of the nonlinear elements being its inputs, and these depend on few
displacements. So a step is a product of matrices, and an evaluation of the force laws at its end (`compiled_steps`).
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.law_table import LawTable, TableSlopes
from sprung.vehicle.nonlinear import NonlinearModel
from sprung.vehicle.nonlinear_forces import Dependences, ForcesAt, NonlinearForces

Array = NDArray[np.float64]
Index = NDArray[np.int64]

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


class StepMatrices(NamedTuple):
    """One step of a load and a length; every matrix has its argument along the first axis.

    Attributes
    ----------
    transition
        State at the end of a step without the forces there, by {x, u, 1} at its start, shape (state + row + 1, state).
    by_state
        Travels and rates by the state, shape (state, 2 row).
    by_force
        State at the end of a step by the forces there, and by their surplus, shape (row, state).
    at_rest, at_end
        Travels and rates by the forces with the state held, and by those at the end of a step, shape (row, 2 row).
    at_start
        Travels and rates without state and forces, m and m/s, shape (2 row,).
    weights
        By which forces of the rows are multiplied, see `NonlinearForces`, shape (row,).
    length
        s.
    has_surplus
        Whether forces have a surplus.
    """

    transition: Array
    by_state: Array
    by_force: Array
    at_rest: Array
    at_end: Array
    at_start: Array
    weights: Array
    length: float
    has_surplus: bool


class MotionBuffer(NamedTuple):
    """Where a motion is written, step by step, as far as it is followed.

    Attributes
    ----------
    whole
        {x, u, 1}: state, and forces of the rows, shape (step + 1, state + row + 1).
    memories
        Shape (step + 1, memory).
    surplus
        As in `Trajectory`, shape (step + 1, row).
    """

    whole: Array
    memories: Array
    surplus: Array


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

    def of_drop(self, drop: int) -> Stepper:
        """Return the steps of one drop alone, by its position."""
        own = slice(self.kind[drop], self.kind[drop] + 1)
        return replace(
            self,
            steps=self.steps[own],
            step_slopes=self.step_slopes[own],
            inputs=self.inputs[own],
            input_slopes=self.input_slopes[own],
            lengths=self.lengths[own],
            kind=np.zeros(1, dtype=np.int64),
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
    def laws(self) -> LawTable:
        """Coefficients of the laws, for the loops over steps."""
        return self.forces_at.table

    @cached_property
    def law_slopes(self) -> TableSlopes:
        """Their slopes by the parameters."""
        return self.forces.table_slopes(self.values)

    @cached_property
    def dependences(self) -> tuple[Dependences, Dependences]:
        """Which forces, and which memories, follow which parameters by the laws."""
        return self.forces.dependences, self.forces.memory_dependences

    @cached_property
    def has_surplus(self) -> bool:
        """Whether forces have a surplus: not if all are friction, nor where rates jump with forces, as behind mounts."""
        return not self.directly_by_force.any() and not all(law.has_memory for law, *_ in self.forces.laws)

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
        with np.errstate(over="ignore", invalid="ignore"):  # of a vehicle that runs away within a step
            found: Array = self.by_state @ self.by_force + self.directly_by_force
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
        of_drop = np.swapaxes(self.inputs, 1, 2)[self.kind]
        inputs = np.swapaxes(np.swapaxes(motion, 0, 1) @ of_drop, 0, 1)
        found = np.zeros_like(forces)
        found[1:] = self.forces_at.kinks.unresolved(inputs[:-1], inputs[1:])
        return found

    @cached_property
    def _matrices(self) -> tuple[StepMatrices, ...]:
        """One step of each kind."""
        transition = np.concatenate([self.transition, self.steps[..., -1:]], axis=2)
        parts = transition, self.by_state, self.by_force, self.directly_by_force, self.input_by_force
        at_start = np.ascontiguousarray(self.inputs[..., -1])
        transposed = [np.ascontiguousarray(np.swapaxes(part, 1, 2)) for part in parts]

        return tuple(
            StepMatrices._make((*matrices, self.forces.weights, float(length), self.has_surplus))
            for *matrices, length in zip(*transposed, at_start, self.lengths, strict=True)
        )

    def integrate(self, states: Array, memories: Array, steps: int, drive: StepDrive | None = None) -> Trajectory:
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

        Returns
        -------
        Trajectory
            Not finite from where a motion diverges.
        """
        # Loaded only where something is stepped: it takes half a second.
        from sprung.vehicle.compiled_steps import follow_motion  # noqa: PLC0415

        (drops, state), rows, laws = states.shape, self.forces.number, self.laws
        motion = MotionBuffer(
            np.ones((drops, steps + 1, state + rows + 1)),
            np.empty((drops, steps + 1, self.forces.memories)),
            np.zeros((drops, steps + 1, rows)),
        )
        motion.whole[:, 0, :state], motion.memories[:, 0] = states, memories
        increments, inputs = np.zeros((drops, 0, state)), np.zeros((drops, 0, 2 * rows))
        if drive is not None:
            increments, inputs = (np.ascontiguousarray(np.swapaxes(part, 0, 1)) for part in drive)

        def follow(drop: int) -> None:
            own, step = MotionBuffer(*(part[drop] for part in motion)), self._matrices[self.kind[drop]]
            finite = follow_motion(step, laws, increments[drop], inputs[drop], _SOLVED, own)
            for part in own:
                part[finite:] = np.nan

        # Each drop may have a processor of its own.
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(follow, range(drops)))
        whole, kept, surplus = (np.swapaxes(part, 0, 1) for part in motion)
        return Trajectory(whole[..., :state], whole[..., state:-1], kept, surplus)

"""Stepping: many motions of a vehicle with nonlinear forces at once, and what every unknown does to them.

The motion itself has to be followed step by step, all drops side by side. Once it is known, what a step makes of a small
change is a matrix for each step and drop, all made at once, and following the changes is one product of matrices per step.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ElementForce, ElementInput
from sprung.vehicle.nonlinear import NonlinearForces, NonlinearModel, Step

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_CORRECTIONS = 3
"""Times that the forces at the end of each step are put right: within it they hardly change what they follow from."""

_CHUNK = 128
"""Steps whose matrices are made at once: what they take stays in a processor's cache."""


class Trajectory(NamedTuple):
    """Motions, step by step; the first axis is time.

    Attributes
    ----------
    states
        {X, Ẋ}, SI, shape (step + 1, drop, 2n) with n coordinates.
    forces
        N, shape (step + 1, drop, force).
    memories
        Shape (step + 1, drop, force).
    """

    states: Array
    forces: Array
    memories: Array


class Sensitivities(NamedTuple):
    """What unknowns do to motions over some steps; unknowns are the parameters, then states and memories at the start.

    Attributes
    ----------
    first
        The step at which they begin.
    states, forces
        Shapes (step, drop, 2n, unknown) and (step, drop, force, unknown).
    """

    first: int
    states: Array
    forces: Array


@dataclass(frozen=True, eq=False)
class Stepper:
    """Steps of several loads and lengths, for drops that belong to one of them each.

    Attributes
    ----------
    forces
        The forces, the same for all.
    values
        Parameters, SI, shape (parameter,).
    offsets, by_offset
        Travel of each force where the empty vehicle rests, m, shape (force,), and by each parameter, (force, parameter).
    steps, slopes
        One step of each kind, and its derivatives by each parameter, stacked along a leading axis.
    kind
        Which of them each drop takes, shape (drop,).
    """

    forces: NonlinearForces
    values: Array
    offsets: Array
    by_offset: Array
    steps: Step
    slopes: Step
    kind: Index

    @classmethod
    def of(cls, models: Sequence[NonlinearModel], times: Sequence[float], kind: Index, values: Array) -> Stepper:
        """Make the steps of models, each of a length of time in s."""
        made = [model.step(values, time) for model, time in zip(models, times, strict=True)]
        stacked = [Step(*(np.stack(each) for each in zip(*those, strict=True))) for those in zip(*made, strict=True)]
        return cls(models[0].forces, values, *models[0].offsets(values), stacked[0], stacked[1], kind)

    @cached_property
    def _travel(self) -> Array:
        """The rows of the forces, shape (force, coordinate)."""
        return self.forces.rows.at(self.values)

    def follow(self, states: Array, memories: Array, steps: int) -> Trajectory:
        """Follow motions from where they start.

        Parameters
        ----------
        states
            {X, Ẋ} of each, SI, shape (drop, 2n).
        memories
            Of the forces that remember, dimensionless, shape (drop, memory).
        steps
            How many.

        Returns
        -------
        Path
            Not finite from where a motion runs away.
        """
        rows, values = self._travel, self.values
        count, n = rows.shape
        feel = np.kron(np.eye(2), rows)
        at = self.kind
        # One product gives where a step ends without the force at its end, and travel and rate there.
        whole = np.concatenate([self.steps.transition, self.steps.before, self.steps.constant[:, :, None]], axis=2)
        whole = np.concatenate([whole, feel @ whole], axis=1)[at]
        whole[:, 2 * n : 2 * n + count, -1] += self.offsets
        after = self.steps.after[at]
        yields = (feel @ self.steps.after)[at]
        path = Trajectory(
            np.empty((steps + 1, len(at), 2 * n)),
            np.empty((steps + 1, len(at), count)),
            np.zeros((steps + 1, len(at), count)),
        )
        path.states[0] = states
        path.memories[0][:, self.forces.remembering] = memories
        travel = states[:, :n] @ rows.T + self.offsets
        at_rest = ElementInput(travel, states[:, n:] @ rows.T, np.zeros_like(travel), path.memories[0])
        path.forces[0] = self.forces.answer(values, at_rest).force
        now = np.ones((len(at), 2 * n + count + 1))
        # What a force does to its own travel and rate: what it does to the others' within a step is less still.
        spot = np.arange(count)
        own_travel, own_rate = yields[:, spot, spot], yields[:, count + spot, spot]
        with np.errstate(over="ignore", invalid="ignore"):
            for k in range(steps):
                now[:, : 2 * n], now[:, 2 * n : -1] = path.states[k], path.forces[k]
                ahead = np.matmul(whole, now[:, :, None])[:, :, 0]
                memory, force = path.memories[k], path.forces[k]
                for correction in range(_CORRECTIONS):
                    felt = ahead[:, 2 * n :] + np.matmul(yields, force[:, :, None])[:, :, 0]
                    there = felt[:, :count]
                    found = self.forces.answer(values, ElementInput(there, felt[:, count:], there - travel, memory))
                    if correction < _CORRECTIONS - 1:
                        along, over = _slopes(found)
                        force = force + (found.force - force) / (1.0 - along * own_travel - over * own_rate)
                path.forces[k + 1], path.memories[k + 1], travel = found.force, found.memory, there
                path.states[k + 1] = ahead[:, : 2 * n] + np.matmul(after, found.force[:, :, None])[:, :, 0]
        return path

    def changes(self, path: Trajectory) -> Iterator[Sensitivities]:
        """Say what every unknown does to motions.

        Parameters
        ----------
        path
            The motions.

        Yields
        ------
        Changes
            Of a chunk of steps, one after the other, from the start on.
        """
        parameters, remembering = len(self.values), self.forces.remembering
        steps, drops, state = path.states.shape
        own = np.zeros((drops, state + len(remembering), parameters + state + len(remembering)))
        own[:, :, parameters:] = np.eye(state + len(remembering))
        for first in range(0, steps, _CHUNK):
            last = min(first + _CHUNK, steps)
            followed = np.empty((last - first, *own.shape))
            followed[0] = own
            if last > first + 1 or last < steps:
                matrices, drive = self._linearised(path, first, min(last, steps - 1))
                for k in range(last - first):
                    followed[k] = own
                    if first + k < steps - 1:
                        own = matrices[k] @ own
                        own[..., :parameters] += drive[k]
            yield Sensitivities(first, followed[:, :, :state], self._of_forces(path, first, followed))

    def _answers(self, path: Trajectory, first: int, last: int) -> tuple[ElementForce, ElementInput]:
        """Give the answers of the steps that end at each of first..last, and what they answered."""
        X, V = np.split(path.states, 2, axis=-1)
        travel, rate = X[first:last] @ self._travel.T + self.offsets, V[first:last] @ self._travel.T
        earlier = np.arange(first, last) - 1
        earlier[earlier < 0] = 0
        way = travel - (X[earlier] @ self._travel.T + self.offsets)
        asked = ElementInput(travel, rate, way, path.memories[earlier])
        return self.forces.answer(self.values, asked), asked

    def _of_forces(self, path: Trajectory, first: int, followed: Array) -> Array:
        """Give what the unknowns do to the forces, from what they do to states and memories."""
        last, parameters = first + len(followed), len(self.values)
        answer, asked = self._answers(path, first, last)
        rows, by_row = self._travel, self._by_row
        n = rows.shape[1]
        along, over = followed[:, :, :n], followed[:, :, n : 2 * n]
        forces = answer.by_travel[..., None] * (rows @ along) + answer.by_rate[..., None] * (rows @ over)
        memory = np.zeros_like(forces)
        memory[:, :, self.forces.remembering] = followed[:, :, 2 * n :]
        forces += answer.by_memory[..., None] * memory
        forces[..., :parameters] += self.forces.sensitivity(self.values, asked).force
        X, V = np.split(path.states[first:last], 2, axis=-1)
        forces[..., :parameters] += answer.by_travel[..., None] * (_moved(X, by_row) + self.by_offset)
        forces[..., :parameters] += answer.by_rate[..., None] * _moved(V, by_row)
        return forces

    @cached_property
    def _by_row(self) -> Array:
        """Give what turns X into the change of the travels with the parameters: shape (force, n, parameter) as a stack."""
        return np.ascontiguousarray(np.moveaxis(self.forces.rows.slopes, 1, 2))

    def _linearised(self, path: Trajectory, first: int, last: int) -> tuple[Array, Array]:
        """Give what the steps from first to last - 1 make of small changes of {x, memory}, and what parameters add.

        Returns
        -------
        matrices
            Shape (step, drop, 2n + memory, 2n + memory).
        drive
            Shape (step, drop, 2n + memory, parameter).
        """
        rows, by_row, memories = self._travel, self._by_row, self.forces.remembering
        now, now_asked = self._answers(path, first, last)
        then, then_asked = self._answers(path, first + 1, last + 1)
        of_now = self.forces.sensitivity(self.values, now_asked).force
        of_then = self.forces.sensitivity(self.values, then_asked)
        n = rows.shape[1]
        x, y = path.states[first:last], path.states[first + 1 : last + 1]

        # The force at the start: by the state and by the memory there, each beside what geometry does.
        feel = _beside(now.by_travel, rows, now.by_rate)
        start = (
            of_now
            + now.by_travel[..., None] * (_moved(x[..., :n], by_row) + self.by_offset)
            + now.by_rate[..., None] * _moved(x[..., n:], by_row)
        )
        # The force at the end: by the state there, and by state and memory at the start.
        held = then.by_memory * then.memory_by_travel
        feels = _beside(then.by_travel + held, rows, then.by_rate)
        back = -_beside(held, rows, np.zeros_like(held))
        kept = then.by_memory * then.memory_by_memory
        ways = _moved(y[..., :n] - x[..., :n], by_row)
        end = of_then.force + then.by_memory[..., None] * of_then.memory
        end += then.by_travel[..., None] * (_moved(y[..., :n], by_row) + self.by_offset) + held[..., None] * ways
        end += then.by_rate[..., None] * _moved(y[..., n:], by_row)

        at = self.kind
        transition, before, after = (one[at] for one in self.steps[:3])
        count = self.forces.number
        inverse = np.linalg.inv(np.eye(count) - feels @ after)
        spread = after @ inverse
        # What arrives at the end moves the force there, which moves what arrives.
        from_x = transition + before @ feel + after @ back
        from_m = before * now.by_memory[..., None, :] + after * kept[..., None, :]
        drive = self._by_step(x, path.forces[first:last], path.forces[first + 1 : last + 1])
        drive += before @ start + after @ end
        all_in = np.concatenate([from_x, from_m[..., memories], drive], axis=-1)
        all_in += spread @ (feels @ all_in)

        state, size, parameters = 2 * n, 2 * n + len(memories), len(self.values)
        matrices = np.zeros((*x.shape[:2], size, size))
        drives = np.zeros((*x.shape[:2], size, parameters))
        matrices[..., :state, :] = all_in[..., :size]
        drives[..., :state, :] = all_in[..., size:]
        if len(memories):
            slope = then.memory_by_travel[..., memories, None]
            way = rows[memories] @ all_in[..., :n, :]
            way[..., :n] -= rows[memories]
            matrices[..., state:, :] = slope * way[..., :size]
            spot = np.arange(len(memories))
            matrices[..., state + spot, state + spot] += then.memory_by_memory[..., memories]
            drives[..., state:, :] = (
                slope * (way[..., size:] + ways[..., memories, :]) + of_then.memory[..., memories, :]
            )
        return matrices, drives

    def _by_step(self, x: Array, before: Array, after: Array) -> Array:
        """Give what parameters do to the step itself, (step, drop, 2n, parameter)."""
        slopes = np.concatenate(
            [self.slopes.transition, self.slopes.before, self.slopes.after, self.slopes.constant[..., None]], axis=-1
        )
        inputs = np.concatenate([x, before, after, np.ones((*x.shape[:2], 1))], axis=-1)
        parameters, state = slopes.shape[1:3]
        found = np.empty((*x.shape[:2], state, parameters))
        for kind, own in enumerate(slopes):
            mine = np.flatnonzero(self.kind == kind)
            if mine.size:
                moved = inputs[:, mine] @ own.reshape(parameters * state, -1).T
                found[:, mine] = np.swapaxes(moved.reshape(len(x), len(mine), parameters, state), 2, 3)
        return found


def _slopes(answer: ElementForce) -> tuple[Array, Array]:
    """Give the derivatives of forces by travel, their memory following, and by rate."""
    return answer.by_travel + answer.by_memory * answer.memory_by_travel, answer.by_rate


def _beside(by_travel: Array, rows: Array, by_rate: Array) -> Array:
    """Give forces by the state {X, Ẋ}, shape (..., force, 2n)."""
    return np.concatenate([by_travel[..., None] * rows, by_rate[..., None] * rows], axis=-1)


def _moved(X: Array, by_row: Array) -> Array:
    """Give what geometry does to travels at X of shape (..., n): shape (..., force, parameter)."""
    moved: Array = np.einsum("...i,fip->...fp", X, by_row, optimize=True)
    return moved

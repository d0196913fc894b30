"""The vehicle with forces that no matrix carries, and what one step of time makes of it.

The linear vehicle is stepped exactly; the few forces beside it enter as feedback that runs straight from one step to the
next (first-order hold). Displacements are from the empty vehicle at rest, so that a load pushes with its weight: where a
spring stiffens with travel, a loaded vehicle has another rate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle.elements import Element, NonlinearElement
from sprung.vehicle.force_laws import ElementForce, ElementInput, ForceLaw, Sensitivity
from sprung.vehicle.heights import LEVEL, Heights
from sprung.vehicle.kinematics import coordinates
from sprung.vehicle.load import EMPTY, Load
from sprung.vehicle.model import LinearModel, Matrices, Rows

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class NonlinearForces(NamedTuple):
    """Forces over one list of parameters, whose values are SI, shape (parameter,); those of one law beside each other.

    Attributes
    ----------
    rows
        The travels they feel, one for each force.
    laws
        Each law, which of the forces have it, and where its parameters are in the list, shape (parameter, force).
    remembering
        Which forces have a memory, in the order of the memories; positions, shape (memory,).
    weightless
        1 for those whose travel counts from where the empty vehicle would be without gravity, else 0; dimensionless,
        shape (force,).
    """

    rows: Rows
    laws: tuple[tuple[ForceLaw, slice, Index], ...]
    remembering: Index
    weightless: Array

    @classmethod
    def of(cls, forces: Sequence[NonlinearElement], names: Sequence[str]) -> NonlinearForces:
        """Compile forces over a list of parameter names."""
        kinds = list({force.law.name: force.law for force in forces}.values())
        ordered = [force for law in kinds for force in forces if force.law.name == law.name]
        laws = []
        for law in kinds:
            own = [i for i, force in enumerate(ordered) if force.law.name == law.name]
            positions = np.array([[names.index(name) for name in ordered[i].parameters] for i in own]).T
            laws.append((law, slice(own[0], own[-1] + 1), positions))
        remembering = np.array([i for i, force in enumerate(ordered) if force.law.remembers], dtype=np.int64)
        weightless = np.array([float(force.weightless) for force in ordered])
        return cls(Rows.of([force.row for force in ordered], names), tuple(laws), remembering, weightless)

    @property
    def number(self) -> int:
        """How many forces."""
        return len(self.rows.affine)

    def answer(self, values: Array, felt: ElementInput) -> ElementForce:
        """Give all forces at parameter values; the last axis of what is felt is that of the forces."""
        parts = [law.answer(values[at], _of(felt, own)) for law, own, at in self.laws]
        if len(parts) == 1:
            return parts[0]
        return ElementForce(*(np.concatenate(each, axis=-1) for each in zip(*parts, strict=True)))

    def sensitivity(self, values: Array, felt: ElementInput) -> Sensitivity:
        """Give the derivatives of forces and memories by the parameters, from what is felt; shape (..., force, parameter)."""
        force = np.zeros((*felt.travel.shape, len(values)))
        remembered = np.zeros_like(force)
        for law, own, at in self.laws:
            parts = law.sensitivity(values[at], _of(felt, own))
            for which, row in enumerate(at):
                for column, position in enumerate(row.tolist()):
                    force[..., own.start + column, position] += parts.force[which][..., column]
                    remembered[..., own.start + column, position] += parts.memory[which][..., column]
        return Sensitivity(force, remembered)


def _of(felt: ElementInput, own: slice) -> ElementInput:
    return ElementInput(*(each[..., own] for each in felt))


class Step(NamedTuple):
    """What one step of time makes of the state {X, Ẋ}: Φ x + before u + after u' + constant, u' at its end.

    Attributes
    ----------
    transition, before, after, constant
        Shapes (2n, 2n), (2n, force), (2n, force) and (2n,) with n coordinates.
    """

    transition: Array
    before: Array
    after: Array
    constant: Array


@dataclass(frozen=True, eq=False)
class NonlinearModel:
    """Equations of motion with forces beside them, of one load, over values of the parameters, SI, shape (parameter,).

    Attributes
    ----------
    linear
        The loaded vehicle without them.
    load
        What the load adds to the masses, over the same parameters.
    forces
        The forces.
    gravity
        m/s².
    """

    linear: LinearModel
    load: LinearModel
    forces: NonlinearForces
    gravity: float = STANDARD_GRAVITY

    @classmethod
    def of(
        cls,
        elements: Sequence[Element],
        forces: Sequence[NonlinearElement],
        names: Sequence[str],
        load: Load = EMPTY,
        heights: Heights = LEVEL,
        gravity: float = STANDARD_GRAVITY,
    ) -> NonlinearModel:
        """Compile a vehicle with its heights and a load, elements and forces beside them, over a list of parameter names."""
        added = load.elements(heights, names)
        linear = LinearModel.of([*elements, *added], names)
        return cls(linear, LinearModel.of(added, names), NonlinearForces.of(forces, names), gravity)

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters."""
        return self.linear.names

    @property
    def state(self) -> int:
        """How many numbers a state {X, Ẋ} has."""
        return 2 * len(coordinates(self.names))

    def sag(self, values: Array) -> Array:
        """Give where the load's weight brings the vehicle to rest without the forces, from the empty one; X, (coordinate,)."""
        weight = self.load.matrices(values).weight * self.gravity
        return -np.asarray(np.linalg.solve(self.linear.matrices(values).K, weight), dtype=np.float64)

    def offsets(self, values: Array) -> tuple[Array, Array]:
        """Give the travels of the forces where the empty vehicle rests, m, each from where it counts.

        Returns
        -------
        offsets
            Shape (force,).
        slopes
            By each parameter, shape (force, parameter).
        """
        both = (
            (self.linear.matrices(values), self.load.matrices(values)),
            (
                self.linear.slopes(values),
                self.load.slopes(values),
            ),
        )
        empty, moved = (Matrices(*(own - added for own, added in zip(*pair, strict=True))) for pair in both)
        sag = -np.linalg.solve(empty.K, empty.weight * self.gravity)
        by_sag = -np.linalg.solve(empty.K, (moved.weight * self.gravity + moved.K @ sag).T)
        G, by_row = self.forces.rows.at(values), self.forces.rows.slopes
        counted = self.forces.weightless
        return counted * (G @ sag), counted[:, None] * (by_row @ sag + G @ by_sag)

    def accelerations(self, values: Array) -> tuple[Array, Array]:
        """Give accelerations from {X, Ẋ, u, 1} and their derivatives.

        Returns
        -------
        rows
            Shape (n, 2n + 1 + force) with n coordinates.
        slopes
            By each parameter, shape (parameter, n, 2n + 1 + force).
        """
        M, C, K = self.linear.matrices(values)
        dM, dC, dK = self.linear.slopes(values)
        pull = self.load.matrices(values).weight * self.gravity
        by_pull = self.load.slopes(values).weight * self.gravity
        G = self.forces.rows.at(values)
        by_row = np.moveaxis(self.forces.rows.slopes, 1, 0)
        driving = np.hstack([K, C, G.T, pull[:, None]])
        rows: Array = -np.asarray(np.linalg.solve(M, driving), dtype=float)
        by = np.concatenate([dK, dC, np.swapaxes(by_row, 1, 2), by_pull[:, :, None]], axis=2)
        slopes: Array = -np.asarray(np.linalg.solve(M, dM @ rows + by), dtype=float)
        return rows, slopes

    def step(self, values: Array, time: float) -> tuple[Step, Step]:
        """Give what a step makes of the state, and its derivatives by each parameter.

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).
        time
            Length of the step, s.

        Returns
        -------
        step, slopes
            The second with a leading axis of the parameters.
        """
        rows, slopes = self.accelerations(values)
        n = len(rows)
        inputs = rows.shape[1] - 2 * n
        held, size = 2 * n + inputs, 2 * (n + inputs)
        # The inputs run straight over the step: their rises over it are states of their own.
        generator = np.zeros((size, size))
        generator[:n, n : 2 * n] = time * np.eye(n)
        generator[n : 2 * n, :held] = time * rows
        generator[2 * n : held, held:] = np.eye(inputs)
        moved = np.zeros((len(slopes), size, size))
        moved[:, n : 2 * n, :held] = time * slopes
        # The exponential of [[Z, dZ], [0, Z]] has that of Z, and its derivative beside it.
        both = np.zeros((len(slopes), 2 * size, 2 * size))
        both[:, :size, :size] = both[:, size:, size:] = generator
        both[:, :size, size:] = moved
        found = np.asarray(expm(both))
        return _taken_apart(found[0, : 2 * n, :size]), _taken_apart(found[:, : 2 * n, size:])


def _taken_apart(rows: Array) -> Step:
    state = rows.shape[-2]
    held, rising = np.split(rows[..., state:], 2, axis=-1)
    before, after = held - rising, rising
    return Step(rows[..., :state], before[..., :-1], after[..., :-1], held[..., -1])

"""The nonlinear vehicle: the linear equations of motion with forces as feedback, and one exact time step of them.

The linear vehicle is stepped exactly; the forces of the nonlinear elements are inputs that run linearly from one step to the
next (first-order hold). Displacements are from static equilibrium of the empty vehicle, so that a load acts by its weight:
where a spring is progressive, a loaded vehicle has another rate.
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
from sprung.vehicle.force_laws import ElementForce, ElementInput, ForceLaw
from sprung.vehicle.heights import LEVEL, Heights
from sprung.vehicle.kinematics import state_variables
from sprung.vehicle.load import EMPTY, Load
from sprung.vehicle.model import LinearModel, Matrices, Rows, highest_derivatives, state_matrix

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class NonlinearForces(NamedTuple):
    """Nonlinear elements over one list of parameters, whose values are SI, shape (parameter,); those of one law adjacent.

    Attributes
    ----------
    rows
        Row of the travel of each element.
    laws
        Each law, the slice of its elements, and the positions of their parameters in the list, shape (parameter, element).
    with_memory
        Positions of the elements that have a memory, in the order of the memories, shape (memory,).
    weightless
        1 for elements whose travel counts from the empty vehicle without gravity, else 0; dimensionless, shape (element,).
    """

    rows: Rows
    laws: tuple[tuple[ForceLaw, slice, Index], ...]
    with_memory: Index
    weightless: Array

    @classmethod
    def of(cls, elements: Sequence[NonlinearElement], names: Sequence[str]) -> NonlinearForces:
        """Compile nonlinear elements over a list of parameter names."""
        laws = list({element.law.name: element.law for element in elements}.values())
        ordered = [element for law in laws for element in elements if element.law.name == law.name]
        compiled = []
        for law in laws:
            chosen = [i for i, element in enumerate(ordered) if element.law.name == law.name]
            positions = np.array([[names.index(name) for name in ordered[i].parameters] for i in chosen]).T
            compiled.append((law, slice(chosen[0], chosen[-1] + 1), positions))
        with_memory = np.array([i for i, element in enumerate(ordered) if element.law.has_memory], dtype=np.int64)
        weightless = np.array([float(element.weightless) for element in ordered])
        return cls(Rows.of([element.row for element in ordered], names), tuple(compiled), with_memory, weightless)

    @property
    def number(self) -> int:
        """Number of elements."""
        return len(self.rows.affine)

    def evaluate(self, values: Array, given: ElementInput) -> ElementForce:
        """Return all forces.

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).
        given
            Input, of shape (..., element).
        """
        parts = [law.evaluate(values[positions], _part(given, chosen)) for law, chosen, positions in self.laws]
        if len(parts) == 1:
            return parts[0]
        return ElementForce(*(np.concatenate(part, axis=-1) for part in zip(*parts, strict=True)))

    def differentiate(self, values: Array, given: ElementInput) -> tuple[Array, Array]:
        """Return the derivatives of forces and of memories by the parameters, each of shape (..., element, parameter).

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).
        given
            Input, of shape (..., element).
        """
        force = np.zeros((*given.travel.shape, len(values)))
        memory = np.zeros_like(force)
        for law, chosen, positions in self.laws:
            of_force, of_memory = law.differentiate(values[positions], _part(given, chosen))
            for which, row in enumerate(positions):
                for column, position in enumerate(row.tolist()):
                    force[..., chosen.start + column, position] += of_force[which][..., column]
                    memory[..., chosen.start + column, position] += of_memory[which][..., column]
        return force, memory


def _part(given: ElementInput, chosen: slice) -> ElementInput:
    return ElementInput(*(values[..., chosen] for values in given))


@dataclass(frozen=True, eq=False)
class NonlinearModel:
    """Equations of motion with nonlinear elements, under one load, as functions of parameter values, SI, shape (parameter,).

    Attributes
    ----------
    linear
        The loaded vehicle without the nonlinear elements.
    load
        What the load adds to the masses, over the same parameters.
    forces
        The nonlinear elements.
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
        nonlinear: Sequence[NonlinearElement],
        names: Sequence[str],
        load: Load = EMPTY,
        heights: Heights = LEVEL,
        gravity: float = STANDARD_GRAVITY,
    ) -> NonlinearModel:
        """Compile the linear and nonlinear elements of a vehicle with its heights and load, over a list of parameter names."""
        added = load.elements(heights, names)
        linear = LinearModel.of([*elements, *added], names)
        return cls(linear, LinearModel.of(added, names), NonlinearForces.of(nonlinear, names), gravity)

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters."""
        return self.linear.names

    @property
    def state_size(self) -> int:
        """Length of the state {X, Ẋ}."""
        return len(state_variables(self.names))

    def sag(self, values: Array) -> Array:
        """Return the static deflection by the load's weight, without the nonlinear elements: X, shape (coordinate,)."""
        weight = self.load.matrices(values).M @ self.linear.heave * self.gravity
        return -self.linear.matrices(values).deflection(weight)

    def travel_offsets(self, values: Array) -> tuple[Array, Array]:
        """Return the travel of each element where the empty vehicle rests, m, and its derivatives.

        Returns
        -------
        offsets
            Zero but for elements whose travel counts from the vehicle without gravity; shape (element,).
        slopes
            By each parameter, shape (element, parameter).
        """
        M, C, K = (
            loaded - load for loaded, load in zip(self.linear.matrices(values), self.load.matrices(values), strict=True)
        )
        dM, _, dK = (
            loaded - load for loaded, load in zip(self.linear.slopes(values), self.load.slopes(values), strict=True)
        )
        empty, gravity = Matrices(M, C, K), self.linear.heave * self.gravity
        sag = -empty.deflection(M @ gravity)
        sag_slopes = -empty.deflection((dM @ gravity + dK @ sag).T)
        G, row_slopes, weightless = self.forces.rows.at(values), self.forces.rows.slopes, self.forces.weightless
        return weightless * (G @ sag), weightless[:, None] * (row_slopes @ sag + G @ sag_slopes)

    def accelerations(self, values: Array) -> tuple[Array, Array]:
        """Return the highest derivatives as a linear function of {X, Ẋ, u, 1}, u being the forces, and its derivatives.

        Returns
        -------
        rows
            Accelerations of the m coordinates with mass, then velocities of the others, shape (n, n + m + element + 1) with n
            coordinates.
        slopes
            By each parameter, shape (parameter, n, n + m + element + 1).
        """
        M, C, K = self.linear.matrices(values)
        dM, dC, dK = self.linear.slopes(values)
        m, gravity = self.linear.massive, self.linear.heave * self.gravity
        leading = np.hstack([M[:, :m], C[:, m:]])
        by_leading = np.concatenate([dM[..., :m], dC[..., m:]], axis=2)
        weight, weight_slopes = self.load.matrices(values).M @ gravity, self.load.slopes(values).M @ gravity
        G = self.forces.rows.at(values)
        G_slopes = np.moveaxis(self.forces.rows.slopes, 1, 0)
        inputs = np.hstack([K, C[:, :m], G.T, weight[:, None]])
        rows: Array = -np.asarray(np.linalg.solve(leading, inputs), dtype=float)
        right = np.concatenate([dK, dC[..., :m], np.swapaxes(G_slopes, 1, 2), weight_slopes[:, :, None]], axis=2)
        slopes: Array = -np.asarray(np.linalg.solve(leading, by_leading @ rows + right), dtype=float)
        return rows, slopes

    def step(self, values: Array, length: float) -> tuple[Array, Array]:
        """Return one exact time step as a linear function, and its derivatives.

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).
        length
            Of the step, s.

        Returns
        -------
        step
            [Φ, B, B', d]: the state at the end is Φ x + B u + B' u' + d, from the state x at the start and the forces u at the
            start and u' at the end; shape (state, state + 2 element + 1).
        slopes
            By each parameter, shape (parameter, state, state + 2 element + 1).
        """
        rows, slopes = self.accelerations(values)
        state = self.state_size
        inputs = rows.shape[1] - state
        held, size = state + inputs, state + 2 * inputs
        # The inputs run linearly over the step: their increments over it are states of their own.
        generator = np.zeros((size, size))
        generator[:state, :held] = length * state_matrix(rows, self.linear.massive)
        generator[state:held, held:] = np.eye(inputs)
        change = np.zeros((len(slopes), size, size))
        change[:, highest_derivatives(len(rows), self.linear.massive), :held] = length * slopes
        # The exponential of [[Z, dZ], [0, Z]] holds that of Z and its derivative (Van Loan, IEEE TAC 23, 1978).
        block = np.zeros((len(slopes), 2 * size, 2 * size))
        block[:, :size, :size] = block[:, size:, size:] = generator
        block[:, :size, size:] = change
        exponential = np.asarray(expm(block))
        return _as_step(exponential[0, :state, :size]), _as_step(exponential[:, :state, size:])


def _as_step(rows: Array) -> Array:
    """Turn functions of {x, u, 1, increments of u and 1} into functions of {x, u, u', 1}; the last input is the constant."""
    state = rows.shape[-2]
    held, increments = np.split(rows[..., state:], 2, axis=-1)
    before, after = (held - increments)[..., :-1], increments[..., :-1]
    return np.concatenate([rows[..., :state], before, after, held[..., -1:]], axis=-1)

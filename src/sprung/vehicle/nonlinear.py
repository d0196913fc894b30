"""The nonlinear vehicle: the linear equations of motion with forces as feedback, and one exact time step of them.

The linear vehicle is stepped exactly; the forces of the nonlinear elements are inputs that run linearly from one step to the
next (first-order hold). Displacements are from static equilibrium of the empty vehicle, so that a load acts by its weight:
where a spring is progressive, a loaded vehicle has another rate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle.elements import Element
from sprung.vehicle.force_laws import ElementInput
from sprung.vehicle.heights import LEVEL, Heights
from sprung.vehicle.kinematics import state_variables
from sprung.vehicle.load import EMPTY, Load
from sprung.vehicle.model import LinearModel, Matrices, highest_derivatives, state_matrix
from sprung.vehicle.nonlinear_elements import NonlinearElement
from sprung.vehicle.nonlinear_forces import NonlinearForces

Array = NDArray[np.float64]

_FAST = 2.0
"""Rate of dampers beyond all their knees, m/s."""

_NODES = 12
"""Of Gauss-Legendre quadrature over a step: exact to 1e-7 for decays of ten times the step's inverse, to rounding for usual."""


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
        wheelbase: float = 0.0,
    ) -> NonlinearModel:
        """Compile the linear and nonlinear elements of a vehicle with its heights and load, over a list of parameter names.

        Parameters
        ----------
        elements, nonlinear
            Of the empty vehicle.
        names
            The parameters.
        load
            What is on it.
        heights
            Of the empty vehicle, m, as far as they are known.
        gravity
            m/s².
        wheelbase
            Of a body that twists unevenly, m.

        Returns
        -------
        NonlinearModel
        """
        added = load.elements(heights, names, wheelbase)
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

    def empty_sag(self, values: Array) -> Array:
        """Return the static deflection of the empty vehicle by its weight, without the nonlinear elements: X, (coordinate,)."""
        loaded, load = self.linear.matrices(values), self.load.matrices(values)
        empty = Matrices(*(whole - part for whole, part in zip(loaded, load, strict=True)))
        return -empty.deflection(empty.M @ self.linear.heave * self.gravity)

    def travel_offsets(self, values: Array) -> tuple[Array, Array]:
        """Return the travel of each row where the empty vehicle rests, m, and its derivatives.

        Returns
        -------
        offsets
            Zero but for rows whose travel counts from elsewhere; shape (row,).
        slopes
            By each parameter, shape (row, parameter).
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
        G, row_slopes, forces = self.forces.rows.at(values), self.forces.rows.slopes, self.forces
        offsets = forces.weightless * (G @ sag)
        slopes = forces.weightless[:, None] * (row_slopes @ sag + G @ sag_slopes)
        if forces.levelled.any():
            rest, rest_slopes = self._rest(values)
            offsets -= forces.levelled * (G @ rest)
            slopes -= forces.levelled[:, None] * (row_slopes @ rest + G @ rest_slopes)
        return offsets, slopes

    def _rest(self, values: Array) -> tuple[Array, Array]:
        """Return `sag`, and its derivatives by each parameter, shape (coordinate, parameter)."""
        loaded, gravity, sag = self.linear.matrices(values), self.linear.heave * self.gravity, self.sag(values)
        change = self.load.slopes(values).M @ gravity + self.linear.slopes(values).K @ sag
        return sag, -loaded.deflection(change.T)

    def fastest_decay(self, values: Array) -> float:
        """Return how fast dampers behind mounts follow where they are softest, 1/s; 0 where forces on them are linear."""
        m, matrices = self.linear.massive, self.linear.matrices(values)
        G, directions = self.forces.rows.at(values)[:, m:], self.forces.directions(values)[:, m:]
        behind = G.any(axis=0)
        if not behind.any():
            return 0.0
        at, none, still = self.forces.at(values), np.zeros(self.forces.memories), np.zeros(self.forces.number)
        stiffness, linear = (part[m:, m:][behind][:, behind] for part in (matrices.K, matrices.C))
        decays = []
        for rate in (-_FAST, _FAST):
            slopes = at.evaluate(ElementInput(still, still + rate, still, none)).by_rate
            damping = linear + ((directions.T * slopes) @ G)[behind][:, behind]
            decays.append(float(np.abs(np.linalg.eigvals(np.linalg.pinv(damping) @ stiffness)).max()))
        return max(decays)

    def accelerations(self, values: Array) -> tuple[Array, Array]:
        """Return the highest derivatives as a linear function of {X, Ẋ, u, 1}, u being the forces, and its derivatives.

        Returns
        -------
        rows
            Accelerations of the m coordinates with mass, then velocities of the others, shape (n, n + m + row + 1) with n
            coordinates.
        slopes
            By each parameter, shape (parameter, n, n + m + row + 1).
        """
        M, C, K = self.linear.matrices(values)
        dM, dC, dK = self.linear.slopes(values)
        m, gravity = self.linear.massive, self.linear.heave * self.gravity
        leading = np.hstack([M[:, :m], C[:, m:]])
        by_leading = np.concatenate([dM[..., :m], dC[..., m:]], axis=2)
        weight, weight_slopes = self.load.matrices(values).M @ gravity, self.load.slopes(values).M @ gravity
        G, G_slopes = self.forces.directions(values), self.forces.direction_slopes
        inputs = np.hstack([K, C[:, :m], G.T, weight[:, None]])
        rows: Array = -np.asarray(np.linalg.solve(leading, inputs), dtype=float)
        right = np.concatenate([dK, dC[..., :m], np.swapaxes(G_slopes, 1, 2), weight_slopes[:, :, None]], axis=2)
        slopes: Array = -np.asarray(np.linalg.solve(leading, by_leading @ rows + right), dtype=float)
        return rows, slopes

    def element_inputs(self, values: Array) -> tuple[Array, Array]:
        """Return travels and rates of all rows as a linear function of {X, Ẋ, u, 1}, u being the forces, and its derivatives.

        Returns
        -------
        rows
            First the travels, then the rates; shape (2 row, state + row + 1).
        slopes
            By each parameter, shape (parameter, 2 row, state + row + 1).
        """
        G, G_slopes = self.forces.rows.at(values), np.moveaxis(self.forces.rows.slopes, 1, 0)
        offsets, offset_slopes = self.travel_offsets(values)
        (number, n), m = G.shape, self.linear.massive
        # The velocities of coordinates without mass follow from displacements and forces.
        highest, highest_slopes = self.accelerations(values)
        velocities, velocity_slopes = np.zeros_like(highest), np.zeros_like(highest_slopes)
        velocities[:m, n : n + m] = np.eye(m)
        velocities[m:], velocity_slopes[:, m:] = highest[m:], highest_slopes[:, m:]
        rows = np.zeros((2 * number, highest.shape[1]))
        slopes = np.zeros((len(values), *rows.shape))
        for whole, part, offset in ((rows, G, offsets), (slopes, G_slopes, offset_slopes.T)):
            whole[..., :number, :n] = part
            whole[..., :number, -1] = offset
        rows[number:], slopes[:, number:] = G @ velocities, G_slopes @ velocities + G @ velocity_slopes
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
            start and u' at the end; shape (state, state + 2 row + 1).
        slopes
            By each parameter, shape (parameter, state, state + 2 row + 1).
        """
        rows, slopes = self.accelerations(values)
        state = self.state_size
        inputs = rows.shape[1] - state
        held, size = state + inputs, state + 2 * inputs
        # The inputs run linearly over the step: their increments over it are states of their own.
        generator = np.zeros((size, size))
        generator[:state, :held] = length * state_matrix(rows, self.linear.massive)
        generator[state:held, held:] = np.eye(inputs)
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        way = np.asarray(expm(0.5 * (1.0 + nodes[:, None, None]) * generator))
        # The derivative of exp(Z) is the integral of exp((1-s) Z) dZ exp(s Z) over s from 0 to 1; 1-s of a node is one, too.
        at = highest_derivatives(len(rows), self.linear.massive)
        left = (0.5 * length * weights[:, None, None] * way[::-1, :state, at]).transpose(1, 2, 0).reshape(state, -1)
        right = np.einsum("pah,nhz->anpz", slopes, way[:, :held], optimize=True)
        by_parameter = (left @ right.reshape(left.shape[1], -1)).reshape(state, len(slopes), size)
        return _as_step(np.asarray(expm(generator))[:state]), _as_step(np.swapaxes(by_parameter, 0, 1))


def _as_step(rows: Array) -> Array:
    """Turn functions of {x, u, 1, increments of u and 1} into functions of {x, u, u', 1}; the last input is the constant."""
    state = rows.shape[-2]
    held, increments = np.split(rows[..., state:], 2, axis=-1)
    before, after = (held - increments)[..., :-1], increments[..., :-1]
    return np.concatenate([rows[..., :state], before, after, held[..., -1:]], axis=-1)

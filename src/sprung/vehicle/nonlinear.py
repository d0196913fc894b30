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
from sprung.vehicle.elements import Element
from sprung.vehicle.force_laws import ElementForce, ElementInput, ForceLaw
from sprung.vehicle.heights import LEVEL, Heights
from sprung.vehicle.kinematics import state_variables
from sprung.vehicle.kinks import KinkForces, differentiate_fields
from sprung.vehicle.load import EMPTY, Load
from sprung.vehicle.model import LinearModel, Matrices, Rows, highest_derivatives, state_matrix
from sprung.vehicle.nonlinear_elements import NonlinearElement

Array = NDArray[np.float64]
Index = NDArray[np.int64]


_FAST = 2.0
"""Rate of dampers beyond all their knees, m/s."""

_NODES = 12
"""Of Gauss-Legendre quadrature over a step: exact to 1e-7 for decays of ten times the step's inverse, to rounding for usual."""


class Dependences(NamedTuple):
    """Which of some forces or memories follow which parameters: each pair once.

    Attributes
    ----------
    which
        Positions of the forces or memories, shape (dependence,).
    parameters
        Positions of the parameters, shape (dependence,).
    """

    which: Index
    parameters: Index

    @classmethod
    def of(cls, elements: Sequence[tuple[Index, Index]]) -> Dependences:
        """Collect the pairs of elements: their rows, shape (element,), and parameters, shape (parameter, element)."""
        pairs = [np.stack(np.broadcast_arrays(which, positions), -1).reshape(-1, 2) for which, positions in elements]
        which, parameters = np.unique(np.concatenate([np.zeros((0, 2), dtype=np.int64), *pairs]), axis=0).T
        return cls(np.ascontiguousarray(which), np.ascontiguousarray(parameters))

    def find(self, which: Index, parameters: Index) -> Index:
        """Return the positions of pairs, which and parameters being of shapes that go together."""
        size = 1 + max(self.parameters.max(initial=0), int(np.max(parameters, initial=0)))
        found: Index = np.searchsorted(self.which * size + self.parameters, which * size + parameters)
        return found


class NonlinearForces(NamedTuple):
    """Nonlinear elements over one list of parameters, whose values are SI, shape (parameter,).

    Elements that act on the same row are evaluated together: their forces add up to one force of the row.

    Attributes
    ----------
    rows
        The different rows of the elements' travels.
    laws
        Each law with its elements: the rows on which they act, a slice where these are adjacent; their memories among those of
        all elements, empty where the law has none; and the positions of its parameters in the list, shape (parameter, element).
    memory_rows
        Row of each memory, shape (memory,).
    weights
        By which the force of each row is multiplied: N of the load that the wheel carries, or 1; shape (row,).
    weightless, levelled
        1 for rows whose travel counts from the empty vehicle without gravity, and from where the loaded one rests, else 0;
        dimensionless, shape (row,).
    """

    rows: Rows
    laws: tuple[tuple[ForceLaw, slice | Index, slice, Index], ...]
    memory_rows: Index
    weights: Array
    weightless: Array
    levelled: Array

    @classmethod
    def of(cls, elements: Sequence[NonlinearElement], names: Sequence[str]) -> NonlinearForces:
        """Compile nonlinear elements over a list of parameter names."""
        by_law: dict[str, list[NonlinearElement]] = {}
        for element in elements:
            by_law.setdefault(element.law.name, []).append(element)
        distinct: dict[tuple[bytes, str, bool], NonlinearElement] = {}
        laws, memory_rows = [], list[int]()
        for alike in by_law.values():
            at = []
            for element in alike:
                compiled = Rows.of([element.row], names)
                key = ((compiled.affine + 0.0).tobytes(), element.origin, element.weight is not None)
                distinct.setdefault(key, element)
                at.append(list(distinct).index(key))
            law, first = alike[0].law, len(memory_rows)
            memory_rows += at * law.has_memory
            positions = np.array([[names.index(name) for name in element.parameters] for element in alike]).T
            laws.append((law, _adjacent(at), slice(first, len(memory_rows)), positions))
        rows = Rows.of([element.row for element in distinct.values()], names)
        weightless, levelled = (
            np.array([float(element.origin == origin) for element in distinct.values()])
            for origin in ("weightless", "loaded")
        )
        weights = np.array([1.0 if element.weight is None else element.weight for element in distinct.values()])
        return cls(rows, tuple(laws), np.array(memory_rows, dtype=np.int64), weights, weightless, levelled)

    def directions(self, values: Array) -> Array:
        """Return what the force of each row is on the coordinates, shape (row, coordinate): the row, times its weight."""
        return self.weights[:, None] * self.rows.at(values)

    @property
    def direction_slopes(self) -> Array:
        """Derivatives of `directions` by the parameters, shape (parameter, row, coordinate)."""
        return self.weights[:, None] * np.moveaxis(self.rows.slopes, 1, 0)

    @property
    def number(self) -> int:
        """Number of rows."""
        return len(self.rows.affine)

    @property
    def memories(self) -> int:
        """Number of memories."""
        return len(self.memory_rows)

    @property
    def dependences(self) -> Dependences:
        """Which force follows which parameter by its laws: rows, and positions in the list."""
        return Dependences.of([(np.arange(self.number)[at], positions) for _, at, _, positions in self.laws])

    @property
    def memory_dependences(self) -> Dependences:
        """Which memory follows which parameter: memories, and positions in the list."""
        return Dependences.of(
            [(np.arange(self.memories)[own], positions) for law, _, own, positions in self.laws if law.has_memory]
        )

    def at(self, values: Array) -> ForcesAt:
        """Return the forces at all parameters, SI, shape (parameter,)."""
        every = np.arange(self.number)
        bent = [
            (law.kinks, every[at], values[positions]) for law, at, _, positions in self.laws if law.kinks is not None
        ]
        others = tuple((law, at, own, values[positions]) for law, at, own, positions in self.laws if law.kinks is None)
        return ForcesAt(self.number, others, KinkForces.of(bent, self.number))

    def table_slopes(self, values: Array) -> TableSlopes:
        """Differentiate the coefficients of `ForcesAt.table` by all parameters, SI, shape (parameter,)."""
        rows, memories = np.arange(self.number), np.arange(self.memories)
        of_forces, of_memories = self.dependences, self.memory_dependences
        kinks, curves, frictions, lengths = ([FieldSlopes.none(fields)] for fields in (5, 3, 1, 1))
        first_kink = first_curve = 0
        for law, at, own, positions in self.laws:
            to, parameters = of_forces.find(rows[at], positions), values[positions]
            if law.kinks is not None:
                slopes = differentiate_fields(law.kinks, parameters)[:5]
                kinks.append(FieldSlopes.of_law(slopes, first_kink, to[:, None]))
                first_kink += slopes[0, 0].size
            elif law.steps is not None and law.has_memory:
                force, length = differentiate_fields(law.steps, parameters)
                frictions.append(FieldSlopes.of_law(force[None], own.start, to))
                lengths.append(FieldSlopes.of_law(length[None], own.start, of_memories.find(memories[own], positions)))
            elif law.steps is not None:
                growth, _, rate, inverse_height = differentiate_fields(law.steps, parameters)
                curves.append(FieldSlopes.of_law(np.stack([growth, rate, inverse_height]), first_curve, to))
                first_curve += growth[0].size
        return TableSlopes(*map(FieldSlopes.joined, (kinks, curves, frictions, lengths)))


class LawTable(NamedTuple):
    """The laws of all nonlinear elements at parameter values, each with its row as a first field.

    Attributes
    ----------
    kinks
        With the fields of `Kinks`, shape (7, kink).
    curves
        With the fields of `TravelCurve`, shape (5, curve).
    frictions
        With the fields of `Friction`, shape (3, memory).
    """

    kinks: Array
    curves: Array
    frictions: Array


class FieldSlopes(NamedTuple):
    """Slopes of coefficients of laws by the parameters that they depend on, one column for each pair.

    Attributes
    ----------
    of
        Which kink, curve or friction, in ascending order, shape (pair,).
    to
        To which of the dependences of forces or memories on parameters it belongs, shape (pair,).
    slopes
        Of the coefficients, shape (field, pair).
    """

    of: Index
    to: Index
    slopes: Array

    @classmethod
    def none(cls, fields: int) -> FieldSlopes:
        """Return the slopes of no law with so many fields."""
        return cls(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros((fields, 0)))

    @classmethod
    def of_law(cls, slopes: Array, first: int, to: Index) -> FieldSlopes:
        """Arrange slopes of a law.

        Parameters
        ----------
        slopes
            Shape (field, parameter, ..., element).
        first
            Which kink, curve or friction of all laws its first one is.
        to
            Dependences, of a shape that goes together with (parameter, ..., element).
        """
        which = np.broadcast_to(first + np.arange(slopes[0, 0].size).reshape(slopes.shape[2:]), slopes.shape[1:])
        of, flat = which.ravel(), slopes.reshape(len(slopes), -1)
        own = np.flatnonzero(flat.any(axis=0))
        own = own[np.argsort(of[own], kind="stable")]
        return cls(of[own], np.broadcast_to(to, slopes.shape[1:]).ravel()[own], flat[:, own])

    @classmethod
    def joined(cls, laws: Sequence[FieldSlopes]) -> FieldSlopes:
        """Join those of several laws, in their order."""
        of, to, slopes = zip(*laws, strict=True)
        return cls(np.concatenate(of), np.concatenate(to), np.concatenate(slopes, axis=1))


class TableSlopes(NamedTuple):
    """Slopes of the coefficients of a `LawTable` by parameters.

    Attributes
    ----------
    kinks
        Of the fields of `Kinks` but the last.
    curves
        Of growth, rate and inverse height.
    frictions
        Of the force.
    memories
        Of the length of frictions, to the dependences of memories.
    """

    kinks: FieldSlopes
    curves: FieldSlopes
    frictions: FieldSlopes
    memories: FieldSlopes


class ForcesAt(NamedTuple):
    """Nonlinear elements at parameter values.

    Attributes
    ----------
    number
        Of rows.
    laws
        Those that are not sums of kinks, as in `NonlinearForces`, but each with its parameters, shape (parameter, element).
    kinks
        What the others are sums of.
    """

    number: int
    laws: tuple[tuple[ForceLaw, slice | Index, slice, Array], ...]
    kinks: KinkForces

    @property
    def table(self) -> LawTable:
        """The same laws for the loop over time steps."""
        every, curves, frictions = np.arange(self.number), [np.zeros((5, 0))], [np.zeros((3, 0))]
        for law, at, _, parameters in self.laws:
            if law.steps is not None:
                (frictions if law.has_memory else curves).append(np.stack([every[at], *law.steps(parameters)]))
        kinks = np.stack([self.kinks.row_of, *self.kinks.kinks])
        return LawTable(kinks, np.concatenate(curves, axis=1), np.concatenate(frictions, axis=1))

    def evaluate(self, given: ElementInput, arguments: Array | None = None) -> ElementForce:
        """Return the force of each row.

        Parameters
        ----------
        given
            Input by row, shape (..., row), and memories, shape (..., memory).
        arguments
            Of the kinks at the same travels and rates, where they are known.

        Returns
        -------
        ElementForce
            By row; what concerns a memory has the shape (..., memory), with the derivative of the row's force by it.
        """
        if arguments is None:
            arguments = self.kinks.arguments(np.concatenate([given.travel, given.rate], axis=-1))
        force, slopes = self.kinks.act(arguments)
        by_travel, by_rate = slopes[..., : self.number], slopes[..., self.number :]
        of_memories = [(given.memory[..., :0],) * 4]
        for law, at, own, parameters in self.laws:
            part = law.evaluate(parameters, _part(given, law, at, own))
            force[..., at] += part.force
            if law.has_memory:
                of_memories.append((part.memory, part.by_memory, part.memory_by_travel, part.memory_by_memory))
            else:
                by_travel[..., at] += part.by_travel
                by_rate[..., at] += part.by_rate
        # Memories stand in the order of the laws; mostly one law has them all.
        joined = (
            of_memories[-1]
            if len(of_memories) < 3
            else (np.concatenate(p, axis=-1) for p in zip(*of_memories, strict=True))
        )
        memory, by_memory, memory_by_travel, memory_by_memory = joined
        return ElementForce(force, memory, by_travel, by_rate, by_memory, memory_by_travel, memory_by_memory)


def _part(given: ElementInput, law: ForceLaw, at: slice | Index, own: slice) -> ElementInput:
    travel, rate, increment = given.travel[..., at], given.rate[..., at], given.increment[..., at]
    return ElementInput(travel, rate, increment, given.memory[..., own] if law.has_memory else _NO_MEMORY)


def _adjacent(positions: Sequence[int]) -> slice | Index:
    """Return positions as a slice where they are adjacent: a view costs less than a copy."""
    first, last = positions[0], positions[-1] + 1
    return slice(first, last) if list(positions) == list(range(first, last)) else np.array(positions)


_NO_MEMORY = np.zeros(1)


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

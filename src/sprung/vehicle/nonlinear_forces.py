"""The nonlinear elements of a vehicle over its parameters: on which rows they act, and what their forces depend on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ElementForce, ElementInput, ForceLaw
from sprung.vehicle.kinks import KinkForces, differentiate_fields
from sprung.vehicle.law_table import FieldSlopes, LawTable, TableSlopes
from sprung.vehicle.model import Rows
from sprung.vehicle.nonlinear_elements import NonlinearElement

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_NO_MEMORY = np.zeros(1)


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
        laws = tuple((law, at, own, values[positions]) for law, at, own, positions in self.laws)
        return ForcesAt(self.number, laws, KinkForces.of(bent, self.number))

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


class ForcesAt(NamedTuple):
    """Nonlinear elements at parameter values.

    Attributes
    ----------
    number
        Of rows.
    laws
        As in `NonlinearForces`, but each with its parameters, shape (parameter, element).
    kinks
        What some of them are sums of.
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

    def evaluate(self, given: ElementInput) -> ElementForce:
        """Return the force of each row.

        Parameters
        ----------
        given
            Input by row, shape (..., row), and memories, shape (..., memory).

        Returns
        -------
        ElementForce
            By row; what concerns a memory has the shape (..., memory), with the derivative of the row's force by it.
        """
        force, by_travel, by_rate = np.zeros((3, *given.travel.shape))
        memory, by_memory, memory_by_travel, memory_by_memory = np.zeros((4, *given.memory.shape))
        for law, at, own, parameters in self.laws:
            part = law.evaluate(parameters, _part(given, law, at, own))
            force[..., at] += part.force
            if law.has_memory:
                memory[..., own], by_memory[..., own] = part.memory, part.by_memory
                memory_by_travel[..., own], memory_by_memory[..., own] = part.memory_by_travel, part.memory_by_memory
            else:
                by_travel[..., at] += part.by_travel
                by_rate[..., at] += part.by_rate
        return ElementForce(force, memory, by_travel, by_rate, by_memory, memory_by_travel, memory_by_memory)


def _part(given: ElementInput, law: ForceLaw, at: slice | Index, own: slice) -> ElementInput:
    travel, rate, increment = given.travel[..., at], given.rate[..., at], given.increment[..., at]
    return ElementInput(travel, rate, increment, given.memory[..., own] if law.has_memory else _NO_MEMORY)


def _adjacent(positions: Sequence[int]) -> slice | Index:
    """Return positions as a slice where they are adjacent: a view costs less than a copy."""
    first, last = positions[0], positions[-1] + 1
    return slice(first, last) if list(positions) == list(range(first, last)) else np.array(positions)

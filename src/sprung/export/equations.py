"""Equations of motion as lists of elements and rows: what every simulation format is written from.

The vehicle room has them as elements: a row, on whose travel an element acts, and a law. The matrices follow from the lists,
and so does any text that states them. Nothing here is a second model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.simulation import BlockSupport, simulate_nonlinear_drops
from sprung.vehicle import (
    STATIONS,
    CurveParts,
    Element,
    Load,
    Motion,
    NonlinearElement,
    NonlinearModel,
    Row,
    Rows,
    Vehicle,
    Wheel,
    coordinates,
    heave,
    linear_elements,
    nonlinear_elements,
    stiffened_air_springs,
)

Array = NDArray[np.float64]

_SIDES = {"friction left": 1.0, "friction right": -1.0}
"""Sides of the force laws of a friction that differs between left and right, by their names."""

_TYRE_CURVE = "tyre-curve"
"""Name of the force law of a tyre whose rate grows with its deflection."""


class RowForce(NamedTuple):
    """A nonlinear force law on a row.

    Attributes
    ----------
    element
        The law, its parameters and weight.
    row
        Position of its row.
    offset
        Travel of the row from which that of the law counts, m.
    """

    element: NonlinearElement
    row: int
    offset: float

    @property
    def law(self) -> str:
        """Name of the force law."""
        return self.element.law.name

    @property
    def side(self) -> float:
        """Side of a friction that is one of two that differ, 1 on the left and -1 on the right; 0 for any other force."""
        return _SIDES.get(self.law, 0.0)

    @property
    def curve_parts(self) -> CurveParts:
        """What a damper's curve has besides its knots; nothing for any other force."""
        symbols = {name.partition("_")[0] for name in self.element.parameters if self.law == "damper-curve"}
        return CurveParts(*(symbol in symbols for symbol in "rbw"))


class RowElement(NamedTuple):
    """A linear element on a row.

    Attributes
    ----------
    element
        Its law, coefficient and factor.
    row
        Position of its row.
    offset
        Travel of a spring at which it has no force, m or rad: gravity acts on the heights of a load from where the empty
        vehicle rests, and its seats carry nothing there.
    """

    element: Element
    row: int
    offset: float = 0.0


class Tyre(NamedTuple):
    """A tyre: it pushes and never pulls.

    Attributes
    ----------
    wheel
        Its wheel station.
    coordinate
        That of the wheel.
    stiffness, damping
        Parameters that make up its rate, N/m, and its damping, N s/m, with their factors.
    growth
        Parameters h and k of the growth of the rate h k with the deflection; None for a constant rate.
    """

    wheel: Wheel
    coordinate: str
    stiffness: tuple[tuple[str, float], ...]
    damping: tuple[tuple[str, float], ...]
    growth: tuple[str, str] | None


@dataclass(frozen=True, eq=False)
class Equations:
    """The equations of motion of a vehicle with a load.

    With X the displacements of the coordinates, g a row and f the force of the elements on it, they are Σ g f = F with the tyre
    forces F; the travel of a row is g·X. Displacements count from where the vehicle would be without gravity, on flat ground.

    Attributes
    ----------
    vehicle, load
        The vehicle and what is on it.
    rows
        The different rows.
    linear
        Masses, dampers and springs.
    forces
        Nonlinear elements.
    tyres
        In the order of the wheel stations.
    """

    vehicle: Vehicle
    load: Load
    rows: tuple[Row, ...]
    linear: tuple[RowElement, ...]
    forces: tuple[RowForce, ...]
    tyres: tuple[Tyre, ...]

    @classmethod
    def of(cls, vehicle: Vehicle, load: Load) -> Equations:
        """Return the equations of motion of a vehicle with a load."""
        own = _own_elements(vehicle, load)
        names = tuple(vehicle.parameters)
        added = load.elements(vehicle.heights, names, vehicle.wheelbase)
        nonlinear = _nonlinear_elements(vehicle, load)
        tyres = tuple(_tyre(wheel, own, nonlinear) for wheel in vehicle.layout.wheels)
        of_tyres = {name for tyre in tyres for name, _ in (*tyre.stiffness, *tyre.damping)}
        known, rows = {*coordinates(names), *_horizontal(own)}, _DistinctRows()
        model = NonlinearModel.of(own, nonlinear, names, load, vehicle.heights, wheelbase=vehicle.wheelbase)
        values = np.array(list(vehicle.parameters.values()))
        empty = model.empty_sag(values)
        linear = [
            RowElement(element, rows.position(_within(element.row, known)))
            for element in own
            if element.coefficient not in of_tyres
        ] + [
            RowElement(
                element,
                rows.position(_within(element.row, known)),
                float(Rows.of([element.row], names).at(values)[0] @ empty) if element.law == "spring" else 0.0,
            )
            for element in added
        ]
        origins = {"empty": empty, "loaded": empty + model.sag(values)}
        forces = []
        for element in nonlinear:
            if element.law.name != _TYRE_CURVE and element.weight != 0.0:
                row = Rows.of([element.row], names).at(values)[0]
                offset = float(row @ origins[element.origin])
                forces.append(RowForce(element, rows.position(_within(element.row, known)), offset))
        kept = tuple(one for one in linear if _acts(one, rows.distinct))
        return cls(vehicle, load, rows.distinct, kept, tuple(forces), tyres)

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters."""
        return tuple(self.vehicle.parameters)

    @cached_property
    def values(self) -> Array:
        """Values of the parameters, SI, shape (parameter,)."""
        return np.array(list(self.vehicle.parameters.values()))

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """Those on which forces act, then those on which none does and which move a mass nevertheless."""
        return (*self.forced, *_horizontal([one.element for one in self.linear]))

    @property
    def forced(self) -> tuple[str, ...]:
        """Coordinates on which forces act."""
        return coordinates(self.names)

    @property
    def massive(self) -> int:
        """Number of the first of these that move a mass."""
        return self.vehicle.linear_model(self.load).massive

    @property
    def wheels(self) -> tuple[Wheel, ...]:
        """Wheel stations."""
        return self.vehicle.layout.wheels

    @property
    def heave(self) -> dict[str, float]:
        """Coordinates that rise as everything moves up alike."""
        return dict(zip(self.forced, heave(self.names), strict=True))

    @property
    def has_tyre_damping(self) -> bool:
        """Whether the velocity of the road adds to the tyre forces."""
        return "tyre-damping" in self.vehicle.extras

    def weight_factor(self, row: int) -> float:
        """Return by how much a row rises in a unit of heave."""
        rising = self.heave
        return sum(value * rising.get(coordinate, 0.0) for coordinate, value in self.rows[row].constant.items())

    @cached_property
    def nonlinear(self) -> NonlinearModel:
        """The same equations as the vehicle room evaluates them, displacements from where the empty vehicle rests."""
        nonlinear = _nonlinear_elements(self.vehicle, self.load)
        own, vehicle = _own_elements(self.vehicle, self.load), self.vehicle
        return NonlinearModel.of(own, nonlinear, self.names, self.load, vehicle.heights, wheelbase=vehicle.wheelbase)

    def rest(self, heights: Sequence[float] | None = None) -> Array:
        """Return the displacements at rest, X, from where the vehicle would be without gravity.

        Parameters
        ----------
        heights
            Of the ground under the wheels, m; flat unless given. Of blocks of one height under some of them.

        Returns
        -------
        ndarray
            m and rad, shape (coordinate,); those on which no force acts stay where they are.
        """
        raised = np.zeros(len(self.wheels)) if heights is None else np.asarray(heights, dtype=float)
        blocks = tuple(wheel for wheel, height in zip(self.wheels, raised, strict=True) if height > 0)
        support = BlockSupport(self.load, blocks, float(raised.max(initial=0.0)))
        motion: Motion = simulate_nonlinear_drops(self.vehicle, [support], 1e-4, 2)[0]
        return motion.displacement[:, 0] + self.nonlinear.sag(self.values) + self.empty_rest

    @property
    def empty_rest(self) -> Array:
        """Displacements of the empty vehicle at rest, as its linear elements have them, X, shape (coordinate,)."""
        return self.nonlinear.empty_sag(self.values)


class _DistinctRows:
    """Rows, each once."""

    def __init__(self) -> None:
        self._rows: dict[str, Row] = {}

    @property
    def distinct(self) -> tuple[Row, ...]:
        return tuple(self._rows.values())

    def position(self, row: Row) -> int:
        slopes = sorted((name, sorted(slope.items())) for name, slope in row.slopes.items())
        key = repr((sorted(row.constant.items()), slopes))
        self._rows.setdefault(key, row)
        return list(self._rows).index(key)


def _own_elements(vehicle: Vehicle, load: Load) -> tuple[Element, ...]:
    """Return the linear elements of a vehicle, as a load leaves them."""
    tracks, extras, wheelbase, layout = vehicle.tracks, vehicle.extras, vehicle.wheelbase, vehicle.layout
    at_wheels = load.mass_at_wheels(wheelbase, layout)
    own = linear_elements(tracks, extras, vehicle.heights, wheelbase, layout)
    return own + stiffened_air_springs(at_wheels, tracks, extras, wheelbase, layout)


def _nonlinear_elements(vehicle: Vehicle, load: Load) -> tuple[NonlinearElement, ...]:
    at_wheels = load.mass_at_wheels(vehicle.wheelbase, vehicle.layout)
    return nonlinear_elements(vehicle.tracks, vehicle.extras, vehicle.wheelbase, at_wheels, vehicle.layout)


def _tyre(wheel: Wheel, linear: Sequence[Element], nonlinear: Sequence[NonlinearElement]) -> Tyre:
    """Return the tyre at a wheel station."""
    coordinate, axle, *_ = STATIONS[wheel]
    rates: dict[str, list[tuple[str, float]]] = {"spring": [], "damper": []}
    for element in linear:
        if element.coefficient in (f"k_t{axle}", f"d_kt{axle}", f"c_t{axle}") and coordinate in element.row.constant:
            rates[element.law].append((str(element.coefficient), element.factor))
    growth = f"h_t{axle}", f"k_t{axle}"
    grows = any(element.law.name == _TYRE_CURVE and element.parameters == growth for element in nonlinear)
    return Tyre(wheel, coordinate, tuple(rates["spring"]), tuple(rates["damper"]), growth if grows else None)


def _horizontal(elements: Sequence[Element]) -> tuple[str, ...]:
    used = {coordinate for element in elements for coordinate in element.row.constant}
    return tuple(coordinate for coordinate in ("x", "y", "psi") if coordinate in used)


def _within(row: Row, known: set[str]) -> Row:
    """Return a row without the coordinates that a vehicle has not, and without zeros."""
    constant, *slopes = (
        {coordinate: value for coordinate, value in shape.items() if value and coordinate in known}
        for shape in (row.constant, *row.slopes.values())
    )
    return Row(constant, {name: slope for name, slope in zip(row.slopes, slopes, strict=True) if slope})


def _acts(one: RowElement, rows: Sequence[Row]) -> bool:
    """Return whether an element adds anything."""
    row = rows[one.row]
    return bool(row.constant or row.slopes) and bool(one.element.factor) and one.element.coefficient != 0

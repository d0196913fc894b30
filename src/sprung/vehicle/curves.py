"""Force curves: the force of everything on the row of a damper, a spring or a tyre, as a function of its rate or travel.

A curve is the mean of both wheels of an axle, relative to rest; that of a tyre to where it first touches the ground. Hysteresis
(:term:`dry friction <Dahl model>`) has no curve: its half-width is stated beside that of the damper.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.elements import Element
from sprung.vehicle.force_laws import ElementInput
from sprung.vehicle.kinematics import Row
from sprung.vehicle.layout import LinearLaw
from sprung.vehicle.nonlinear_elements import NonlinearElement

Array = NDArray[np.float64]


_RATES: Mapping[str, tuple[str, LinearLaw]] = {
    "damper": ("c_s", "damper"),
    "spring": ("k_s", "spring"),
    "tyre": ("k_t", "spring"),
}

FORCE_CURVES: Mapping[str, tuple[str, LinearLaw]] = {
    f"{part}{end}": (f"{rate}{axle}", law)
    for part, (rate, law) in _RATES.items()
    for end, axle in (("_front", "f"), ("_rear", "r"), ("", ""))
}
"""Every force curve by its name in a result: the linear rate on whose row it is, and the law of the linear elements."""


class CurveElements(NamedTuple):
    """The elements on one kind of row, at both wheels of an axle.

    Attributes
    ----------
    law
        Of the linear elements: the force of a ``damper`` is a function of the rate, that of a ``spring`` of the travel.
    rows
        The row at each wheel.
    linear, nonlinear
        Elements on these rows whose force is a function of the argument, or may be.
    hysteretic
        Elements of these wheels whose force depends on a memory.
    """

    law: LinearLaw
    rows: tuple[Row, ...]
    linear: tuple[Element, ...]
    nonlinear: tuple[NonlinearElement, ...]
    hysteretic: tuple[NonlinearElement, ...]

    @classmethod
    def of(cls, name: str, linear: Sequence[Element], nonlinear: Sequence[NonlinearElement]) -> CurveElements:
        """Return the elements of one force curve, of those of a vehicle.

        Parameters
        ----------
        name
            One of `FORCE_CURVES`.
        linear, nonlinear
            Elements of the vehicle.
        """
        parameter, law = FORCE_CURVES[name]
        rows = _rows_of(parameter, linear, nonlinear)
        # Friction acts at the spring, and is stated with the damper.
        rubbing = [*rows, *_rows_of(parameter.replace("c_s", "k_s"), linear, nonlinear)]
        return cls(
            law,
            tuple(rows),
            tuple(element for element in linear if element.law == law and _is_on(element.row, rows)),
            tuple(element for element in nonlinear if not element.law.has_memory and _is_on(element.row, rows)),
            tuple(
                element
                for element in nonlinear
                if law == "damper" and element.law.has_memory and _is_on(element.row, rubbing)
            ),
        )

    def force(self, names: Sequence[str], values: Array, x: Array) -> tuple[Array, Array]:
        """Return the force and its derivatives, of each wheel on average.

        Parameters
        ----------
        names, values
            Parameters of the vehicle, SI; values of shape (parameter,).
        x
            Rate of a damper, m/s, travel of a spring from rest, or height of a tyre above first touch, m, positive in rebound;
            shape (point,).

        Returns
        -------
        force
            N, positive where it opposes the travel, zero at rest; shape (point,).
        gradient
            By each parameter, shape (point, parameter).
        """
        force, gradient = self._nonlinear_force(names, values, x)
        for element in self.linear:
            if isinstance(element.coefficient, str):
                position = names.index(element.coefficient)
                gradient[:, position] += element.factor * x
                force += values[position] * element.factor * x
            else:
                force += element.coefficient * element.factor * x
        return force / len(self.rows), gradient / len(self.rows)

    @property
    def is_of_tyre(self) -> bool:
        """Whether the travel counts from where a tyre first touches the ground."""
        return any(element.origin == "weightless" for element in self.nonlinear)

    def is_nonlinear(self, names: Sequence[str], values: Array, x: Array) -> bool:
        """Whether a nonlinear law acts at any of some arguments.

        Parameters
        ----------
        names, values, x
            As for `force`.
        """
        return bool(self._nonlinear_force(names, values, x)[1].any())

    def hysteresis(self, names: Sequence[str], values: Array) -> tuple[float, Array]:
        """Return half the width of the hysteresis, of each wheel on average, and its gradient.

        Parameters
        ----------
        names, values
            As for `force`.

        Returns
        -------
        force
            N.
        gradient
            By each parameter, shape (parameter,).
        """
        one, zero = np.ones(1), np.zeros(1)
        force, gradient = _sum(self.hysteretic, names, values, ElementInput(zero, zero, zero, one))
        return float(force[0]) / len(self.rows), gradient[0] / len(self.rows)

    def _nonlinear_force(self, names: Sequence[str], values: Array, x: Array) -> tuple[Array, Array]:
        zero = np.zeros_like(x)
        travel, rate = (zero, x) if self.law == "damper" else (x, zero)
        force, gradient = _sum(self.nonlinear, names, values, ElementInput(travel, rate, zero, zero))
        rest = ElementInput(*np.zeros((4, 1)))
        force_at_rest, gradient_at_rest = _sum(self.nonlinear, names, values, rest)
        return force - force_at_rest, gradient - gradient_at_rest


def _sum(
    elements: Sequence[NonlinearElement], names: Sequence[str], values: Array, given: ElementInput
) -> tuple[Array, Array]:
    """Return the sum of the forces, shape (point,), and its derivatives by the parameters, shape (point, parameter)."""
    force, gradient = np.zeros(len(given.travel)), np.zeros((len(given.travel), len(values)))
    column = ElementInput(*(part[:, None] for part in given))
    for element in elements:
        positions = [names.index(name) for name in element.parameters]
        own, weight = values[positions][:, None], 1.0 if element.weight is None else element.weight
        force += weight * element.law.evaluate(own, column).force[:, 0]
        for position, derivative in zip(positions, element.law.differentiate(own, column)[0], strict=True):
            gradient[:, position] += weight * derivative[:, 0]
    return force, gradient


def _rows_of(parameter: str, linear: Sequence[Element], nonlinear: Sequence[NonlinearElement]) -> list[Row]:
    """Return the rows of the elements that have a parameter, each once."""
    rows: list[Row] = []
    elements = [element.row for element in linear if element.coefficient == parameter]
    for row in [*elements, *(element.row for element in nonlinear if parameter in element.parameters)]:
        if not _is_on(row, rows):
            rows.append(row)
    return rows


def _is_on(row: Row, rows: Sequence[Row]) -> bool:
    return any(row.constant == other.constant and row.slopes == other.slopes for other in rows)

"""Equivalent linearisation: rate and damping of nonlinear elements that move as a sine, by their describing functions.

The travel of an element is x = x₀ + X sin ωt about its rest x₀. Of its force f the first harmonic remains, which a spring k
and a damper c would have: k = 2/X · mean(f sin ωt) and c = 2/(ωX) · mean(f cos ωt) (Gelb and Vander Velde, Multiple-Input
Describing Functions and Nonlinear System Design, 1968, section 2.2).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.errors import Problem
from sprung.export.equations import Equations
from sprung.vehicle import Matrices, NonlinearForces, Rows, linearise_harmonic

Array = NDArray[np.float64]


@shown
@dataclass(frozen=True, slots=True)
class EquivalentElement:
    """A spring and a damper instead of the nonlinear elements on one travel.

    Attributes
    ----------
    laws
        Names of their force laws.
    parameters
        Names of their parameters.
    stiffness, damping
        N/m and N s/m, beside those of the linear elements there.
    """

    laws: tuple[str, ...]
    parameters: tuple[str, ...]
    stiffness: float
    damping: float


@shown
@dataclass(frozen=True, slots=True)
class Linearisation:
    """Motion for which a vehicle with nonlinear elements was linearised.

    Attributes
    ----------
    amplitude
        Of the travel of every nonlinear element, m.
    frequency
        Hz.
    elements
        What was put instead of the nonlinear elements.
    """

    amplitude: float
    frequency: float
    elements: tuple[EquivalentElement, ...]

    @property
    def text(self) -> str:
        """One sentence for the reader of the export."""
        laws = sorted({law for element in self.elements for law in element.laws})
        return (
            f"Linearised ({', '.join(laws)}) by describing functions for a travel of {1e3 * self.amplitude:g} mm amplitude at "
            f"{self.frequency:.4g} Hz; it holds near this amplitude only."
        )


def linearised(
    equations: Equations, matrices: Matrices, amplitude: float, frequency: float
) -> tuple[Matrices, Linearisation]:
    """Return matrices with the equivalent elements added, and what these are.

    Parameters
    ----------
    equations
        Of the vehicle, with its nonlinear elements.
    matrices
        M, C and K of its linear elements, tyres as they are at rest.
    amplitude, frequency
        m and Hz.
    """
    model, values = equations.nonlinear, equations.values
    forces = model.forces
    rates = _describing_functions(forces, values, _travels_at_rest(equations), amplitude, 2 * math.pi * frequency)
    # A tyre is linearised at its static load, as the vehicle room does it.
    rates = rates * (1.0 - forces.weightless)
    G, directions = forces.rows.at(values), forces.directions(values)
    K, C = (matrix + (directions.T * rate) @ G for matrix, rate in zip((matrices.K, matrices.C), rates, strict=True))
    elements = tuple(
        EquivalentElement(
            *_named(forces, equations.names, row), float(forces.weights[row] * k), float(forces.weights[row] * c)
        )
        for row, (k, c) in enumerate(rates.T)
        if not forces.weightless[row]
    )
    return matrices._replace(K=K, C=C), Linearisation(amplitude, frequency, elements)


def is_linear(equations: Equations) -> bool:
    """Return whether nothing but tyres, which are linearised at their static load, is nonlinear."""
    return not equations.forces


def stop_problems(equations: Equations, amplitude: float, where: str) -> list[Problem]:
    """Return the bump stops that are met in a motion of an amplitude, m, as problems: no linear element is like them."""
    values = dict(zip(equations.names, equations.values.tolist(), strict=True))
    rest, found = equations.rest(), dict[str, Problem]()
    for force in equations.forces:
        if force.law == "bump-stop":
            stiffness, clearance = force.element.parameters
            row = Rows.of([force.element.row], equations.names).at(equations.values)[0]
            left = values[clearance] + float(row @ rest) - force.offset
            if values[stiffness] and left < amplitude:
                met = f"that are met {1e3 * left:.3g} mm from rest, within the amplitude of {1e3 * amplitude:.3g} mm"
                smaller = f"Give an amplitude below {1e3 * left:.3g} mm, or export"
                if left <= 0:
                    met, smaller = "on which the vehicle rests", "Export"
                expected = "elements that a spring and a damper can replace"
                do = f"{smaller} to modelica or fmu, which have bump stops."
                found[stiffness] = Problem(where, f"bump stops ({stiffness}) {met}", expected, do)
    return list(found.values())


def _named(forces: NonlinearForces, names: Sequence[str], row: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the laws on a row, and their parameters."""
    laws: list[str] = []
    parameters: list[str] = []
    for law, at, _, positions in forces.laws:
        for element, own in enumerate(np.arange(forces.number)[at].tolist()):
            if own == row:
                laws.append(law.name)
                parameters += [names[position] for position in positions[:, element]]
    return tuple(laws), tuple(dict.fromkeys(parameters))


def _travels_at_rest(equations: Equations) -> Array:
    """Return the travel of each nonlinear element at rest, m, shape (row,)."""
    model, values = equations.nonlinear, equations.values
    from_empty = equations.rest() - equations.empty_rest
    return np.asarray(model.forces.rows.at(values) @ from_empty + model.travel_offsets(values)[0])


def _describing_functions(forces: NonlinearForces, values: Array, rest: Array, amplitude: float, omega: float) -> Array:
    """Return stiffness and damping of each row, N/m and N s/m, shape (2, row)."""
    _, (found,) = linearise_harmonic(forces, values, rest[None], np.full((1, len(rest)), amplitude), np.array([omega]))
    return np.array([found.real, found.imag / omega])

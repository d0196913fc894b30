"""Modelica: the equations of motion written out, with a drop test that simulates them; no library is needed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.errors import InputError
from sprung.export.equations import Equations
from sprung.export.file import ExportedFile
from sprung.export.modelica_expressions import (
    BY_TRAVEL,
    joined,
    law_expression,
    number,
    product,
    row_coefficient,
    row_expression,
    times,
    tyre_expression,
)
from sprung.export.outputs import (
    Output,
    Signal,
    identifier,
    outputs_of,
    rest_of,
    road_inputs,
    sensor_problems,
)
from sprung.export.requests import resolve_load
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import PARAMETERS, Load, Row, Sensor, Vehicle

Array = NDArray[np.float64]

_UNITS = str.maketrans({" ": ".", "^": ""})
"""From the units of results to those of Modelica: kg m^2 is kg.m2."""

_RELEASE = 0.1
"""s at which the model of a drop releases the vehicle."""


_ZERO = 1e-12
"""m and rad: position of rest that is a rounding error."""


def modelica(
    vehicle: Vehicle, load: Load | None = None, *, sensors: Sequence[Sensor] = (), height: float = 0.05
) -> ExportedFile:
    """Return a vehicle as Modelica text: its equations of motion, and a drop from blocks that simulates them.

    Every linear and nonlinear element is an equation of its own, and every parameter a Modelica parameter. Tyres lift off.
    The vehicle begins at rest on the road as it is at the start.

    Parameters
    ----------
    vehicle
        The vehicle, such as `Result.vehicle`.
    load
        What is on it; nothing unless given.
    sensors
        Sensors on body and wheels that become outputs too, SI, positive up.
    height
        Of the blocks under all wheels in the model ``Drop``, m.

    Returns
    -------
    ExportedFile
        A package with the models ``Vehicle`` and ``Drop``.

    Raises
    ------
    InputError
        If a sensor is on a pad, or two outputs have one name.
    """
    equations = Equations.of(vehicle, resolve_load(load))
    outputs = outputs_of(vehicle, sensors)
    if problems := sensor_problems(sensors, outputs, f"Modelica of {vehicle.name}"):
        raise InputError(problems)
    text = "\n".join(_package(equations, outputs, height)) + "\n"
    return ExportedFile(f"{_package_name(vehicle.name)}.mo", text.encode())


def _package(equations: Equations, outputs: Sequence[Output], height: float) -> Iterable[str]:
    vehicle, name = equations.vehicle, _package_name(equations.vehicle.name)
    yield f"package {name} {_quoted(f'{vehicle.name}, {equations.load.name}: ride model written by sprung')}"
    yield f"  model Vehicle {_quoted('Positions count from springs and tyres without force; outputs from rest')}"
    yield from (f"    {line}" for line in _vehicle(equations, outputs))
    yield "  end Vehicle;"
    yield ""
    yield f"  model Drop {_quoted('Rests on blocks under all wheels, which are removed')}"
    yield f'    parameter Real height(unit="m") = {number(height)} "height of the blocks";'
    yield f'    parameter Real release(unit="s") = {number(_RELEASE)} "when they are removed";'
    yield "    Vehicle vehicle;"
    yield "  equation"
    for signal in road_inputs(vehicle):
        value = "if time < release then height else 0" if signal.unit == "m" else "0"
        yield f"    vehicle.{signal.name} = {value};"
    yield "    annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.001, Tolerance = 1e-8));"
    yield "  end Drop;"
    yield f"end {name};"


def _vehicle(equations: Equations, outputs: Sequence[Output]) -> Iterable[str]:
    """Yield the lines of the model of the vehicle."""
    rest = equations.rest()
    rest[np.abs(rest) < _ZERO] = 0.0
    yield from _parameters(equations)
    yield from (f"input Real {signal.name}{_about(signal)};" for signal in road_inputs(equations.vehicle))
    yield from (f"output Real {output.signal.name}{_about(output.signal)};" for output in outputs)
    yield from (f"Real {variable};" for variable in _variables(equations, rest))
    yield "initial equation"
    yield from (f"  {line}" for line in _initial(equations))
    yield "equation"
    yield from (f"  {line}" for line in (*_derivatives(equations), *_element_forces(equations)))
    yield from (f"  {_balance(equations, coordinate)}" for coordinate in equations.coordinates)
    yield from (f"  {output.signal.name} = {_output(output, equations, rest)};" for output in outputs)


def _parameters(equations: Equations) -> Iterable[str]:
    for name, value in equations.vehicle.parameters.items():
        unit, meaning, *_ = PARAMETERS[name]
        yield f"parameter Real {name}(unit={_quoted(_modelica_unit(unit))}) = {number(value)} {_quoted(meaning)};"
    yield f'parameter Real gravity(unit="m.s-2") = {number(STANDARD_GRAVITY)};'
    about = "travel from which the curve of a spring counts"
    for i, force in enumerate(equations.forces):
        if force.law in BY_TRAVEL:
            yield f'parameter Real travel_at_rest{i}(unit="m") = {number(force.offset)} "{about}";'


def _variables(equations: Equations, rest: Array) -> Iterable[str]:
    forced = equations.forced
    for coordinate, position in zip(forced, rest.tolist(), strict=True):
        yield from (f"{coordinate}(start={number(position)})", f"vel_{coordinate}(start=0)")
    yield from (f"acc_{coordinate}" for coordinate in _accelerated(equations))
    yield from (f"memory{i}(start=0, fixed=true)" for i in _memories(equations))
    yield from (f"pressing_{tyre.coordinate}" for tyre in equations.tyres)
    yield from (f"{kind}{row}" for row in _used(equations) for kind in _kinds(equations, row))


def _accelerated(equations: Equations) -> list[str]:
    """Return the coordinates with mass."""
    return [*equations.forced[: equations.massive], *equations.coordinates[len(equations.forced) :]]


def _memories(equations: Equations) -> list[int]:
    """Return the positions of the forces with a memory."""
    return [i for i, force in enumerate(equations.forces) if force.element.law.has_memory]


def _used(equations: Equations) -> list[int]:
    """Return the rows on which an element acts."""
    return sorted({one.row for one in equations.linear} | {force.row for force in equations.forces})


def _derivatives(equations: Equations) -> Iterable[str]:
    for i, coordinate in enumerate(equations.forced):
        yield f"der({coordinate}) = vel_{coordinate};"
        if i < equations.massive:
            yield f"der(vel_{coordinate}) = acc_{coordinate};"
    for i in _memories(equations):
        force = equations.forces[i]
        limit, stiffness = force.element.parameters[-2:]
        # Without a force the memory has no effect, and would only shorten the steps of a solver.
        factor = limit if force.side else force.element.parameters[0]
        length = f"(if {factor} > 0 then max({limit}/{stiffness}, 1e-7) else 1)"
        moving = f"rate{force.row}"
        yield f"der(memory{i}) = ({moving} - abs({moving})*memory{i})/{length};"


def _element_forces(equations: Equations) -> Iterable[str]:
    for row in _used(equations):
        for kind, prefix in zip(("travel", "rate", "accel"), ("", "vel_", "acc_"), strict=True):
            if kind in _kinds(equations, row):
                yield f"{kind}{row} = {row_expression(equations.rows[row], prefix)};"
        yield f"force{row} = {_force(equations, row)};"
    yield from (f"pressing_{tyre.coordinate} = {tyre_expression(tyre)};" for tyre in equations.tyres)


def _kinds(equations: Equations, row: int) -> list[str]:
    """Return which variables a row has: travel, rate, acceleration and force, as far as an element needs them."""
    laws = {one.element.law for one in equations.linear if one.row == row}
    forces = [force for force in equations.forces if force.row == row]
    needs = {
        "travel": "spring" in laws or any(force.law in BY_TRAVEL for force in forces),
        "rate": "damper" in laws or any(force.law not in BY_TRAVEL for force in forces),
        "accel": "mass" in laws,
        "force": True,
    }
    return [kind for kind, is_needed in needs.items() if is_needed]


def _initial(equations: Equations) -> Iterable[str]:
    """Yield the equations of rest: nothing moves, and a coordinate that no spring holds is at zero."""
    stiffness = equations.vehicle.matrices(equations.load).K
    for i, coordinate in enumerate(equations.forced):
        yield f"der({coordinate}) = 0;" if stiffness[i].any() else f"{coordinate} = 0;"
        if i < equations.massive:
            yield f"der(vel_{coordinate}) = 0;"


def _force(equations: Equations, row: int) -> str:
    """Return the force of everything on a row."""
    rising = equations.weight_factor(row)
    parts = []
    for element, at, offset in equations.linear:
        if at == row:
            motion = {"mass": f"accel{row}", "damper": f"rate{row}", "spring": f"travel{row}"}[element.law]
            if offset:
                motion = f"({motion} - ({number(offset)}))"
            if element.law == "mass" and rising:
                motion = f"({motion} + {product(rising, 'gravity')})"
            coefficient = element.coefficient
            parts.append(
                product(element.factor, coefficient, motion)
                if isinstance(coefficient, str)
                else product(element.factor * coefficient, motion)
            )
    parts += [law_expression(force, i) for i, force in enumerate(equations.forces) if force.row == row]
    return joined(parts)


def _balance(equations: Equations, coordinate: str) -> str:
    """Return the equation of motion of a coordinate."""
    parts = []
    for row in _used(equations):
        if part := row_coefficient(equations.rows[row], coordinate):
            parts.append(times(part, f"force{row}"))
    tyres = [f"pressing_{tyre.coordinate}" for tyre in equations.tyres if tyre.coordinate == coordinate]
    return f"{joined(parts)} = {joined(tyres)};"


def _output(output: Output, equations: Equations, rest: Array) -> str:
    if output.tyre is not None:
        return next(f"pressing_{tyre.coordinate}" for tyre in equations.tyres if tyre.wheel == output.tyre)
    parts = []
    for order, row in output.rows.items():
        own = Row(*(_known(row, equations)))
        parts.append(row_expression(own, ("", "vel_", "acc_")[order]))
    at_rest = rest_of(output, equations.vehicle, rest)
    return joined([*parts, number(-at_rest)] if at_rest else parts)


def _known(row: Row, equations: Equations) -> tuple[dict[str, float], dict[str, dict[str, float]]]:
    """Return constant and slopes of a row, without coordinates and parameters that the vehicle has not."""
    known = equations.forced
    kept = [
        {coordinate: value for coordinate, value in shape.items() if coordinate in known and value}
        for shape in (row.constant, *row.slopes.values())
    ]
    return kept[0], {name: slope for name, slope in zip(row.slopes, kept[1:], strict=True) if slope}


def _about(signal: Signal) -> str:
    return f"(unit={_quoted(_modelica_unit(signal.unit))}) {_quoted(signal.meaning)}"


def _modelica_unit(unit: str) -> str:
    """Return a unit as Modelica writes it: kg m^2 is kg.m2, and N s/m is N.s/m."""
    top, slash, bottom = (part.translate(_UNITS) for part in unit.partition("/"))
    return f"{top}{slash}{bottom}"


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _package_name(name: str) -> str:
    words = identifier(name).replace("_", " ").split()
    return "".join(word[:1].upper() + word[1:] for word in words) + "Model"

"""Modelica: the equations of motion written out, with a drop test that simulates them; no library is needed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence


import numpy as np
from numpy.typing import NDArray

from sprung.export.equations import Equations, RowForce, Tyre
from sprung.export.file import ExportedFile
from sprung.export.outputs import (
    Output,
    Signal,
    identifier,
    of_wheel,
    outputs_of,
    rest_of,
    road_inputs,
    sensor_problems,
)
from sprung.export.requests import resolve_load
from sprung.errors import InputError
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
    yield f'    parameter Real height(unit="m") = {_number(height)} "height of the blocks";'
    yield f'    parameter Real release(unit="s") = {_number(_RELEASE)} "when they are removed";'
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
    coordinates, massive = equations.coordinates, equations.massive
    forced = equations.forced
    rest = equations.rest()
    rest[np.abs(rest) < _ZERO] = 0.0
    for name, value in equations.vehicle.parameters.items():
        unit, meaning, *_ = PARAMETERS[name]
        yield f"parameter Real {name}(unit={_quoted(unit.translate(_UNITS))}) = {_number(value)} {_quoted(meaning)};"
    yield f'parameter Real gravity(unit="m.s-2") = {_number(STANDARD_GRAVITY)};'
    offsets = {force.row: force.offset for force in equations.forces if force.law in _BY_TRAVEL}
    for row, offset in offsets.items():
        yield f'parameter Real travel_at_rest{row}(unit="m") = {_number(offset)} "from which the curve of a spring counts";'
    for signal in road_inputs(equations.vehicle):
        yield f"input Real {signal.name}{_about(signal)};"
    for output in outputs:
        yield f"output Real {output.signal.name}{_about(output.signal)};"
    for i, coordinate in enumerate(coordinates):
        if coordinate in forced:
            yield f"Real {coordinate}(start={_number(rest[i])});"
            yield f"Real vel_{coordinate}(start=0);"
        if i < massive or coordinate not in forced:
            yield f"Real acc_{coordinate};"
    memories = [i for i, force in enumerate(equations.forces) if force.element.law.has_memory]
    yield from (f"Real memory{i}(start=0, fixed=true);" for i in memories)
    yield from (f"Real pressing_{tyre.coordinate};" for tyre in equations.tyres)
    used = sorted({one.row for one in (*equations.linear, *equations.forces)})
    yield from (f"Real {kind}{row};" for row in used for kind in _kinds(equations, row))
    yield "initial equation"
    yield from (f"  {line}" for line in _initial(equations))
    yield "equation"
    for i, coordinate in enumerate(forced):
        yield f"  der({coordinate}) = vel_{coordinate};"
        if i < massive:
            yield f"  der(vel_{coordinate}) = acc_{coordinate};"
    for row in used:
        for kind, prefix in zip(("travel", "rate", "accel"), ("", "vel_", "acc_"), strict=True):
            if kind in _kinds(equations, row):
                yield f"  {kind}{row} = {_sum_of(equations.rows[row], prefix)};"
        yield f"  force{row} = {_force(equations, row)};"
    for tyre in equations.tyres:
        yield f"  pressing_{tyre.coordinate} = {_tyre_force(tyre)};"
    for i in memories:
        force = equations.forces[i]
        limit, stiffness = force.element.parameters[-2:]
        length = f"max(abs({limit})/{stiffness}, 1e-7)"
        yield f"  der(memory{i}) = (rate{force.row} - abs(rate{force.row})*memory{i})/{length};"
    for coordinate in coordinates:
        yield f"  {_balance(equations, coordinate, used)};"
    for output in outputs:
        yield f"  {output.signal.name} = {_output(output, equations, rest)};"


def _kinds(equations: Equations, row: int) -> list[str]:
    """Return which variables a row has: travel, rate, acceleration and force, as far as an element needs them."""
    laws = {one.element.law for one in equations.linear if one.row == row}
    forces = [force for force in equations.forces if force.row == row]
    needs = {
        "travel": "spring" in laws or any(force.law in _BY_TRAVEL for force in forces),
        "rate": "damper" in laws or any(force.law not in _BY_TRAVEL for force in forces),
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
    for element, at, _ in equations.linear:
        if at == row:
            motion = {"mass": f"accel{row}", "damper": f"rate{row}", "spring": f"travel{row}"}[element.law]
            if element.law == "mass" and rising:
                motion = f"({motion} + {_product(rising, 'gravity')})"
            coefficient = element.coefficient
            parts.append(
                _product(element.factor, coefficient, motion)
                if isinstance(coefficient, str)
                else _product(element.factor * coefficient, motion)
            )
    parts += [_law(force, i) for i, force in enumerate(equations.forces) if force.row == row]
    return _joined(parts)


def _balance(equations: Equations, coordinate: str, used: Sequence[int]) -> str:
    """Return the equation of motion of a coordinate."""
    parts = []
    for row in used:
        if part := _coefficient(equations.rows[row], coordinate):
            parts.append(_times(part, f"force{row}"))
    tyres = [f"pressing_{tyre.coordinate}" for tyre in equations.tyres if tyre.coordinate == coordinate]
    return f"{_joined(parts)} = {_joined(tyres)}"


def _output(output: Output, equations: Equations, rest: Array) -> str:
    if output.tyre is not None:
        return next(f"pressing_{tyre.coordinate}" for tyre in equations.tyres if tyre.wheel == output.tyre)
    parts = []
    for order, row in output.rows.items():
        own = Row(*(_known(row, equations)))
        parts.append(_sum_of(own, ("", "vel_", "acc_")[order]))
    at_rest = rest_of(output, equations.vehicle, rest)
    return _joined([*parts, _number(-at_rest)] if at_rest else parts)


def _known(row: Row, equations: Equations) -> tuple[dict[str, float], dict[str, dict[str, float]]]:
    """Return constant and slopes of a row, without coordinates and parameters that the vehicle has not."""
    known = equations.forced
    kept = [
        {coordinate: value for coordinate, value in shape.items() if coordinate in known and value}
        for shape in (row.constant, *row.slopes.values())
    ]
    return kept[0], {name: slope for name, slope in zip(row.slopes, kept[1:], strict=True) if slope}


def _tyre_force(tyre: Tyre) -> str:
    """Return the force of the ground on a tyre, N."""
    road = of_wheel("road", tyre.wheel)
    rise = f"({tyre.coordinate} - {road})"
    tension = [_product(factor, name, rise) for name, factor in tyre.stiffness]
    rate = f"(vel_{tyre.coordinate} - {of_wheel('road_rate', tyre.wheel)})"
    tension += [_product(factor, name, rate) for name, factor in tyre.damping]
    pressing = f"max(0, -({_joined(tension)}))"
    if tyre.growth is None:
        return pressing
    growth, stiffness = tyre.growth
    return f"{pressing} + 0.5*{growth}*{stiffness}*min({rise}, 0)^2"


_POLYTROPIC = 1.3
"""Exponent of the gas in an air spring, as in the vehicle room."""


def _progressive(parameters: Sequence[str], x: str, _: str) -> str:
    growth, rate = parameters
    return f"-0.5*{growth}*{rate}*({x})^2"


def _air(parameters: Sequence[str], x: str, _: str) -> str:
    inverse, rate = parameters
    strain, n = f"{inverse}*({x})", _POLYTROPIC
    exact = f"({x})*((1 - max(1 + {strain}, 0.05)^(-{n}))/({n}*{strain}) - 1)"
    series = f"({x})*{n + 1}*{strain}*(-0.5 + {n + 2}*{strain}/6)"
    return f"{rate}*(if noEvent(abs({strain}) < 1e-4) then {series} else {exact})"


def _bump_stop(parameters: Sequence[str], x: str, _: str) -> str:
    stiffness, clearance = parameters
    return f"-{stiffness}*max(-({x}) - {clearance}, 0)"


def _rebound(parameters: Sequence[str], _: str, v: str) -> str:
    ratio, damping = parameters
    return f"({ratio} - 1)*{damping}*max({v}, 0)"


def _damper_curve(parameters: Sequence[str], v: str, *, has_ratio: bool, is_rounded: bool) -> str:
    """Return what the knots of a damper's curve add to its force."""
    damping, *further = parameters
    ratio = further.pop(0) if has_ratio else "1"
    rounding = further.pop(0) if is_rounded else ""
    knots, before = [], "1"
    for velocity, slope in zip(further[::2], further[1::2], strict=True):
        beyond = f"(abs({v}) - {velocity})"
        excess = f"max({beyond}, 0)"
        if rounding:
            at_rest = f"sqrt({velocity}^2 + {rounding}^2) - {velocity}"
            excess = f"0.5*({beyond} + sqrt({beyond}^2 + {rounding}^2) - ({at_rest}))"
        knots.append(f"{before}*(1 - {slope})*{excess}")
        before = f"{before}*{slope}"
    side = f"(if noEvent({v} > 0) then {ratio} else -1)"
    return f"-{damping}*{side}*({' + '.join(knots)})"


_BY_TRAVEL: Mapping[str, Callable[[Sequence[str], str, str], str]] = {
    "progressive": _progressive,
    "air": _air,
    "bump-stop": _bump_stop,
}
"""Force by the name of its law, of the travel of a spring."""


def _law(force: RowForce, position: int) -> str:
    """Return the force of a nonlinear element."""
    parameters, travel, rate = force.element.parameters, f"travel{force.row}", f"rate{force.row}"
    match force.law:
        case "friction":
            return f"{parameters[0]}*memory{position}"
        case "load-friction":
            return _product(force.element.weight or 0.0, parameters[0], f"memory{position}")
        case "rebound":
            return _rebound(parameters, travel, rate)
        case "damper-curve":
            has_ratio, is_rounded = force.knots_after
            return _damper_curve(parameters, rate, has_ratio=has_ratio, is_rounded=is_rounded)
        case law:
            return _BY_TRAVEL[law](parameters, f"{travel} - travel_at_rest{force.row}", rate)


def _sum_of(row: Row, prefix: str) -> str:
    """Return the displacement of a row, or its derivative with a prefix."""
    known = dict.fromkeys((*row.constant, *(name for slope in row.slopes.values() for name in slope)))
    parts = []
    for coordinate in known:
        parts.append(_times(_coefficient(row, coordinate), f"{prefix}{coordinate}"))
    return _joined(parts)


def _coefficient(row: Row, coordinate: str) -> str:
    """Return the entry of a row for a coordinate; empty where there is none."""
    parts = [_number(row.constant[coordinate])] if row.constant.get(coordinate) else []
    parts += [_product(slope[coordinate], name) for name, slope in row.slopes.items() if slope.get(coordinate)]
    return _joined(parts) if parts else ""


def _product(factor: float, *names: str) -> str:
    """Return a product, a factor of 1 left out."""
    product = "*".join(names)
    return {1.0: product, -1.0: f"-{product}"}.get(factor, f"{_number(factor)}*{product}")


def _times(coefficient: str, name: str) -> str:
    """Return a coefficient, itself an expression, times a variable."""
    return {"1": name, "-1": f"-{name}"}.get(coefficient, f"({coefficient})*{name}")


def _joined(parts: Sequence[str]) -> str:
    return " + ".join(parts).replace("+ -", "- ") if parts else "0"


def _number(value: float) -> str:
    """Return a number with all its digits; whole numbers without a point."""
    return str(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(float(value))


def _about(signal: Signal) -> str:
    return f"(unit={_quoted(_modelica_unit(signal.unit))}) {_quoted(signal.meaning)}"


def _modelica_unit(unit: str) -> str:
    top, _, bottom = unit.partition("/")
    return f"{top.translate(_UNITS)}.{bottom[0]}-{bottom[2:] or 1}" if bottom else top.translate(_UNITS)


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _package_name(name: str) -> str:
    words = identifier(name).replace("_", " ").split()
    return "".join(word[:1].upper() + word[1:] for word in words) + "Model"

"""The equations of motion as tables in C: what `vehicle.c` assembles and integrates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from sprung.export.equations import Equations, RowForce, Tyre
from sprung.export.outputs import Output, rest_of
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import STATIONS

_LAWS: Mapping[str, str] = {
    "friction": "FRICTION",
    "load-friction": "LOAD_FRICTION",
    "friction left": "UNEVEN_FRICTION",
    "friction right": "UNEVEN_FRICTION",
    "rebound": "REBOUND",
    "damper-curve": "DAMPER_CURVE",
    "progressive": "PROGRESSIVE",
    "air": "AIR",
    "bump-stop": "BUMP_STOP",
}
"""Names of the force laws in C."""

_TOLERANCE = 1e-7
"""Relative error of a step at the most."""


def model_tables(equations: Equations, outputs: Sequence[Output]) -> Iterable[str]:
    """Yield the lines of model.h."""
    number = {name: i for i, name in enumerate(equations.names)}
    at = {coordinate: i for i, coordinate in enumerate(equations.coordinates)}
    memories = [i for i, force in enumerate(equations.forces) if force.element.law.has_memory]
    massless = set(equations.forced[equations.massive :])
    touched = {one for force in equations.forces for one in equations.rows[force.row].constant}
    sizes = {
        "PARAMETERS": len(number),
        "ALL": len(at),
        "FORCED": len(equations.forced),
        "MASSIVE": equations.massive,
        "ROWS": len(equations.rows),
        "FORCES": len(equations.forces),
        "MEMORIES": len(memories),
        "WHEELS": len(equations.wheels),
        "OUTPUTS": len(outputs),
    }
    yield f"/* {_comment(equations.vehicle.name)}, {_comment(equations.load.name)}: tables written by sprung. */"
    yield from (f"#define N_{name} {size}" for name, size in sizes.items())
    yield f"#define IS_COUPLED {int(bool(massless & touched))}"
    yield f"#define GRAVITY {STANDARD_GRAVITY!r}"
    yield f"#define DEFAULT_TOLERANCE {_TOLERANCE!r}"
    yield _table(
        "double parameter_values[]", [f"{value!r} /* {name} */" for name, value in equations.vehicle.parameters.items()]
    )
    yield _table("double heave[]", [repr(value) for value in equations.heave.values()])
    yield _table("double rest[]", [repr(value) for value in equations.rest().tolist()])
    entries = [
        f"{{{i}, {at[coordinate]}, {number.get(name, -1)}, {value!r}}}"
        for i, row in enumerate(equations.rows)
        for name, shape in (("", row.constant), *row.slopes.items())
        for coordinate, value in shape.items()
    ]
    yield _table("RowEntry row_entries[]", entries)
    elements = []
    for element, row, offset in equations.linear:
        is_parameter = isinstance(element.coefficient, str)
        factor = element.factor if is_parameter else element.factor * float(element.coefficient)
        parameter = number[str(element.coefficient)] if is_parameter else -1
        elements.append(f"{{{element.law.upper()}, {row}, {parameter}, {factor!r}, {offset!r}}}")
    yield _table("Element elements[]", elements)
    forces = [
        _force(force, number, memories.index(i) if i in memories else -1) for i, force in enumerate(equations.forces)
    ]
    yield _table("Force forces[]", forces or ["{0}"])
    yield _table("Tyre tyres[]", [_tyre(tyre, number, at) for tyre in equations.tyres])
    yield from _output_tables(equations, outputs, number, at)


def _output_tables(
    equations: Equations, outputs: Sequence[Output], number: Mapping[str, int], at: Mapping[str, int]
) -> Iterable[str]:
    rest = equations.rest()
    entries = [
        f"{{{i}, {order}, {at[coordinate]}, {number.get(name, -1)}, {value!r}}}"
        for i, output in enumerate(outputs)
        for order, row in output.rows.items()
        for name, shape in (("", row.constant), *row.slopes.items())
        for coordinate, value in shape.items()
        if coordinate in at and value
    ]
    yield _table("OutputEntry output_entries[]", entries)
    yield _table("double output_offsets[]", [repr(-rest_of(output, equations.vehicle, rest)) for output in outputs])
    wheels = {wheel: i for i, wheel in enumerate(equations.wheels)}
    tyres = [f"{{{i}, {wheels[one.tyre]}}}" for i, one in enumerate(outputs) if one.tyre is not None]
    yield _table("TyreOutput tyre_outputs[]", tyres)


def _table(declaration: str, rows: Sequence[str]) -> str:
    return f"static const {declaration} = {{\n    " + ",\n    ".join(rows) + "};"


def _force(force: RowForce, number: Mapping[str, int], memory: int) -> str:
    names = force.element.parameters
    parts = ", ".join(str(int(part)) for part in force.curve_parts)
    listed = ", ".join(str(number[name]) for name in names)
    factor = force.side if force.element.weight is None else force.element.weight
    return (
        f"{{{_LAWS[force.law]}, {force.row}, {len(names)}, {{{listed}}}, {parts}, {memory}, "
        f"{force.offset!r}, {factor!r}}}"
    )


def _tyre(tyre: Tyre, number: Mapping[str, int], at: Mapping[str, int]) -> str:
    (stiffness, _), *difference = tyre.stiffness
    numbers = [
        at[tyre.coordinate],
        number[stiffness],
        number[difference[0][0]] if difference else -1,
        number[tyre.damping[0][0]] if tyre.damping else -1,
        number[tyre.growth[0]] if tyre.growth else -1,
    ]
    return f"{{{', '.join(map(str, numbers))}, {STATIONS[tyre.wheel].side!r}}}"


def _comment(text: str) -> str:
    return text.replace("*/", "* /").replace("\n", " ")

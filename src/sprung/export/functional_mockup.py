"""FMU: the equations of motion as tables in C, behind the co-simulation interface of FMI 3.0."""

from __future__ import annotations

import io
import os
import platform
import re
import shlex
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from sprung.errors import InputError
from sprung.export.equations import Equations, RowForce, Tyre
from sprung.export.file import ExportedFile
from sprung.export.outputs import Output, Signal, identifier, of_wheel, outputs_of, rest_of, sensor_problems
from sprung.export.requests import resolve_load
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import PARAMETERS, STATIONS, Load, Sensor, Vehicle

_SOURCES = ("fmu.c", "vehicle.c")
"""Files of C in this room; the first one includes the others."""

_LAWS: Mapping[str, str] = {
    "friction": "FRICTION",
    "load-friction": "LOAD_FRICTION",
    "rebound": "REBOUND",
    "damper-curve": "DAMPER_CURVE",
    "progressive": "PROGRESSIVE",
    "air": "AIR",
    "bump-stop": "BUMP_STOP",
}
"""Names of the force laws in C."""

_TOLERANCE = 1e-7
"""Relative error of a step at the most."""

_BUILD_TIME = 120.0
"""s after which a compiler is stopped."""

_FILE_TIME = (1980, 1, 1, 0, 0, 0)
"""Time of the files in the archive: equal vehicles give equal files."""


def fmu(
    vehicle: Vehicle, load: Load | None = None, *, sensors: Sequence[Sensor] = (), build: bool = True
) -> ExportedFile:
    """Return a vehicle as an FMU for co-simulation (FMI 3.0), with its source in C.

    All linear and nonlinear elements are in it, and tyres lift off. Inputs are the height of the road under each wheel, in m, and
    its rate, in m/s, with which the height goes on from the beginning of a communication step. The vehicle begins at rest on the
    road as it is then. Parameters are those of the vehicle.

    Parameters
    ----------
    vehicle
        The vehicle, such as `Result.vehicle`.
    load
        What is on it; nothing unless given.
    sensors
        Sensors on body and wheels that become outputs too, SI, positive up.
    build
        Whether to build the library for this system, if it has a compiler; the source alone is a complete FMU that the
        importing program has to build.

    Returns
    -------
    ExportedFile
        The archive; its notes say for which system a library is in it.

    Raises
    ------
    InputError
        If a sensor is on a pad, or two outputs have one name.
    """
    equations = Equations.of(vehicle, resolve_load(load))
    outputs = outputs_of(vehicle, sensors)
    if problems := sensor_problems(sensors, outputs, f"FMU of {vehicle.name}"):
        raise InputError(problems)
    name = identifier(vehicle.name)
    sources = {one: (files("sprung.export") / "c" / one).read_text(encoding="utf-8") for one in _SOURCES}
    tables = "\n".join(_tables(equations, outputs)) + "\n"
    token = sha256("".join((*sources.values(), tables, name)).encode()).hexdigest()
    sources["model.h"] = tables + f'#define INSTANTIATION_TOKEN "{token}"\n'
    content: dict[str, bytes] = {
        "modelDescription.xml": _description(equations, outputs, name, token).encode(),
        "sources/buildDescription.xml": _build_description(name).encode(),
        **{f"sources/{one}": text.encode() for one, text in sources.items()},
    }
    note = "The FMU contains its source in C only: the importing program has to build it."
    if build and (library := _built(sources)) is not None:
        folder, suffix = _system()
        content[f"binaries/{folder}/{name}{suffix}"] = library
        note = f"The FMU contains its source in C and a library for {folder}."
    return ExportedFile(f"{name}.fmu", _zipped(content), (note,))


def _zipped(content: Mapping[str, bytes]) -> bytes:
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as opened:
        for name, data in content.items():
            opened.writestr(zipfile.ZipInfo(name, _FILE_TIME), data, zipfile.ZIP_DEFLATED)
    return archive.getvalue()


def _tables(equations: Equations, outputs: Sequence[Output]) -> Iterable[str]:
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
    entries = [
        f"{{{i}, {at[coordinate]}, {number.get(name, -1)}, {value!r}}}"
        for i, row in enumerate(equations.rows)
        for name, shape in (("", row.constant), *row.slopes.items())
        for coordinate, value in shape.items()
    ]
    yield _table("RowEntry row_entries[]", entries)
    elements = []
    for element, row, _ in equations.linear:
        is_parameter = isinstance(element.coefficient, str)
        factor = element.factor if is_parameter else element.factor * float(element.coefficient)
        parameter = number[str(element.coefficient)] if is_parameter else -1
        elements.append(f"{{{element.law.upper()}, {row}, {parameter}, {factor!r}}}")
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
    has_ratio, is_rounded = force.knots_after
    listed = ", ".join(str(number[name]) for name in names)
    weight = 0.0 if force.element.weight is None else force.element.weight
    return (
        f"{{{_LAWS[force.law]}, {force.row}, {len(names)}, {{{listed}}}, {int(has_ratio)}, {int(is_rounded)}, {memory}, "
        f"{force.offset!r}, {weight!r}}}"
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


def _description(equations: Equations, outputs: Sequence[Output], name: str, token: str) -> str:
    """Return modelDescription.xml."""
    vehicle = equations.vehicle
    roads = [
        Signal(of_wheel("road", wheel), "m", f"height of road or pad under wheel {wheel}") for wheel in equations.wheels
    ]
    rates = [
        Signal(of_wheel("road_rate", wheel), "m/s", f"rate of the road under wheel {wheel}")
        for wheel in equations.wheels
    ]
    variables = ['<Float64 name="time" valueReference="0" causality="independent" variability="continuous" unit="s"/>']
    lines: list[tuple[str, Signal]] = [
        (
            f'causality="parameter" variability="fixed" start="{value!r}"',
            Signal(one, PARAMETERS[one].unit, PARAMETERS[one].meaning),
        )
        for one, value in vehicle.parameters.items()
    ]
    lines += [('causality="input" start="0"', signal) for signal in (*roads, *rates)]
    lines += [('causality="output" initial="calculated"', output.signal) for output in outputs]
    units = dict.fromkeys(["s", *(signal.unit for _, signal in lines)])
    for reference, (kind, signal) in enumerate(lines, start=1):
        variables.append(
            f'<Float64 name={quoteattr(signal.name)} valueReference="{reference}" {kind} '
            f"unit={quoteattr(signal.unit)} description={quoteattr(signal.meaning)}/>"
        )
    first = 1 + len(lines) - len(outputs)
    shown = range(first, first + len(outputs))
    structure = [f'<Output valueReference="{one}"/>' for one in shown]
    structure += [f'<InitialUnknown valueReference="{one}"/>' for one in shown]
    about = f"{vehicle.name}, {equations.load.name}: ride model by sprung; displacements count from rest on flat road"
    parts = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<fmiModelDescription fmiVersion="3.0" modelName={quoteattr(vehicle.name)} instantiationToken="{token}" '
        f'description={quoteattr(about)} generationTool="sprung">',
        f'<CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true" '
        'canGetAndSetFMUState="true" maxOutputDerivativeOrder="0"/>',
        "<UnitDefinitions>",
        *(f"<Unit name={quoteattr(unit)}>{_base_unit(unit)}</Unit>" for unit in units),
        "</UnitDefinitions>",
        '<LogCategories><Category name="logStatusError"/></LogCategories>',
        '<DefaultExperiment startTime="0" stopTime="3" stepSize="0.001"/>',
        "<ModelVariables>",
        *variables,
        "</ModelVariables>",
        "<ModelStructure>",
        *structure,
        "</ModelStructure>",
        "</fmiModelDescription>",
    ]
    return "\n".join(parts) + "\n"


def _base_unit(unit: str) -> str:
    """Return a unit by its SI base units."""
    exponents = dict.fromkeys(("kg", "m", "s", "rad"), 0)
    top, _, bottom = unit.partition("/")
    for part, sign in ((top, 1), (bottom, -1)):
        for symbol, power in re.findall(r"(kg|rad|m|s|N)(?:\^(\d))?", part):
            parts = {"kg": 1, "m": 1, "s": -2} if symbol == "N" else {symbol: 1}
            for base, exponent in parts.items():
                exponents[base] += sign * exponent * int(power or 1)
    listed = " ".join(f'{base}="{exponent}"' for base, exponent in exponents.items() if exponent)
    return f"<BaseUnit {listed}/>" if listed else "<BaseUnit/>"


def _build_description(name: str) -> str:
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<fmiBuildDescription fmiVersion="3.0">\n'
        f'<BuildConfiguration modelIdentifier="{name}"><SourceFileSet language="C99"><SourceFile name="{_SOURCES[0]}"/>'
        "</SourceFileSet></BuildConfiguration>\n</fmiBuildDescription>\n"
    )


def _system() -> tuple[str, str]:
    """Return the folder of libraries for this system, and the suffix of their names."""
    machine = {"amd64": "x86_64", "arm64": "aarch64", "i386": "x86", "i686": "x86"}.get(
        platform.machine().lower(), platform.machine().lower()
    )
    system, suffix = {"Darwin": ("darwin", ".dylib"), "Windows": ("windows", ".dll")}.get(
        platform.system(), ("linux", ".so")
    )
    return f"{machine}-{system}", suffix


def _built(sources: Mapping[str, str]) -> bytes | None:
    """Return the library built from sources by name; None without a compiler that can."""
    named = shlex.split(os.environ.get("CC", ""))
    compiler = named or [found for found in map(shutil.which, ("cc", "gcc", "clang")) if found][:1]
    if not compiler:
        return None
    with tempfile.TemporaryDirectory(prefix="sprung-fmu-") as folder:
        for name, text in sources.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        library = Path(folder) / "library"
        options = ["-std=c99", "-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-o", str(library), _SOURCES[0], "-lm"]
        try:
            subprocess.run([*compiler, *options], cwd=folder, check=True, capture_output=True, timeout=_BUILD_TIME)  # noqa: S603 (no shell)
        except (OSError, subprocess.SubprocessError):
            return None
        return library.read_bytes()

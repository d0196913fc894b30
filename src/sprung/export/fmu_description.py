"""The descriptions in an FMU: its variables, units and structure, and how it is built."""

from __future__ import annotations

import re
from collections.abc import Sequence
from xml.sax.saxutils import quoteattr

from sprung.export.equations import Equations
from sprung.export.outputs import Output, Signal, of_wheel
from sprung.vehicle import PARAMETERS


def model_description(equations: Equations, outputs: Sequence[Output], name: str, token: str) -> str:
    """Return modelDescription.xml.

    Parameters
    ----------
    equations, outputs
        Of the vehicle.
    name, token
        Identifier of the model, and what tells it from others.
    """
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
        f'<fmiModelDescription fmiVersion="3.0" modelName={quoteattr(vehicle.name)}',
        f'instantiationToken="{token}" description={quoteattr(about)} generationTool="sprung">',
        f'<CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true"',
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


def build_description(name: str, source: str) -> str:
    """Return buildDescription.xml.

    Parameters
    ----------
    name
        Identifier of the model.
    source
        File in C that includes all others.
    """
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<fmiBuildDescription fmiVersion="3.0">\n'
        f'<BuildConfiguration modelIdentifier="{name}"><SourceFileSet language="C99"><SourceFile name="{source}"/>'
        "</SourceFileSet></BuildConfiguration>\n</fmiBuildDescription>\n"
    )

"""The tables of a result, shared by terminal, notebook and report."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

from sprung.estimation import ForceCurve, ModeEstimate
from sprung.results.records import SensorEstimate, TraceStep
from sprung.tables import Table, unit_text, value_cells, with_std
from sprung.uncertainty import Estimate, Ratio, round_by_uncertainty
from sprung.vehicle import (
    CHARACTERISTICS,
    FULL,
    LOAD_MASS,
    MOTION_RATIOS,
    PARAMETERS,
    WHEEL_LOADS,
    Layout,
    layout_of,
    parameter_of,
)

TRACE_TITLE = "How the result was reached"
"""Title of the trace wherever it is shown."""

_WHOLE_VEHICLE = "of the empty vehicle"
"""Meaning of a quantity that has no text of its own."""

_DERIVED = {
    "I_xx_roll_axis": "roll inertia of the sprung mass about the roll axis",
    "wheelbase": "front axle to rear axle",
    **{name: quantity.meaning for name, quantity in CHARACTERISTICS.items()},
    **{quantity: meaning for _, quantity, meaning in MOTION_RATIOS.values()},
    **WHEEL_LOADS,
}
"""Meaning of each derived quantity."""

_CHARACTERISTICS = (
    ("mass, kg", "front_axle_mass", "rear_axle_mass", "total_mass"),
    ("share of the mass", "front_axle_share", "", ""),
    ("load of each wheel, N", "front_wheel_load", "rear_wheel_load", "wheel_load"),
    ("load of the left wheel, N", "front_left_wheel_load", "rear_left_wheel_load", "left_wheel_load"),
    ("load of the right wheel, N", "front_right_wheel_load", "rear_right_wheel_load", "right_wheel_load"),
    ("centre of gravity, m behind front axle", "", "", "cg_from_front_axle"),
    ("centre of gravity, m left of centreline", "", "", "cg_left"),
    ("ride frequency, Hz", "front_ride_frequency", "rear_ride_frequency", "ride_frequency"),
    ("ride damping ratio", "front_ride_damping", "rear_ride_damping", "ride_damping"),
    ("wheel hop frequency, Hz", "front_hop_frequency", "rear_hop_frequency", "hop_frequency"),
    ("wheel hop damping ratio", "front_hop_damping", "rear_hop_damping", "hop_damping"),
    ("twist of the body, Hz", "", "", "twist_frequency"),
    ("damping ratio of twist", "", "", "twist_damping"),
    ("bending of the body, Hz", "", "", "bending_frequency"),
    ("damping ratio of bending", "", "", "bending_damping"),
    ("people on seats, Hz", "", "", "seat_frequency"),
    ("damping ratio of seats", "", "", "seat_damping"),
)
"""Rows of the table of characteristics: what is shown, and the quantities of front axle, rear axle and whole vehicle."""


_EXACT_DIGITS = 6
"""Significant figures of a derived quantity that is exact."""

_VELOCITIES = (0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.2)
"""Velocities of the table of damper forces, m/s."""


def meaning_of(name: str, layout: Layout = FULL) -> str:
    """Return the meaning of a parameter or derived quantity.

    Parameters
    ----------
    name
        Its name.
    layout
        Of the vehicle; in the pitch plane both wheels of an axle are one wheel station.

    Returns
    -------
    str

    Examples
    --------
    >>> from sprung.vehicle import LAYOUTS
    >>> meaning_of("m_uf"), meaning_of("m_uf", LAYOUTS["pitch-plane"])
    ('unsprung mass, each front wheel', 'unsprung mass, front station')
    """
    if name in PARAMETERS or name.startswith(LOAD_MASS):
        meaning = parameter_of(name).meaning
    else:
        meaning = _DERIVED.get(name, _WHOLE_VEHICLE)
    if layout.rolls or not layout.pitches:
        return meaning
    meaning = re.sub(r"\bof each (front|rear) wheel", r"of the \1 station", meaning)
    return re.sub(r"\beach (front|rear) wheel", r"\1 station", meaning)


def parameters_table(vehicle: str, parameters: Mapping[str, Estimate]) -> Table:
    """Return the table of all parameters with their uncertainties.

    Parameters
    ----------
    vehicle
        Name of the vehicle.
    parameters
        By name, derived quantities among them.

    Returns
    -------
    Table
    """
    headers = ("parameter", "value", "±", "%", "unit", "status", "meaning")
    layout = layout_of(parameters)
    rows = tuple((name, *value_cells(estimate), meaning_of(name, layout)) for name, estimate in parameters.items())
    title = f"{vehicle}: parameters, one standard uncertainty"
    return Table(title, headers, rows, frozenset(("value", "±", "%")), ("meaning", "%", "status"))


def other_quantities(derived: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Return the derived quantities that are in none of the `characteristics_tables`.

    Parameters
    ----------
    derived
        By name.

    Returns
    -------
    dict
        By name.
    """
    return {name: estimate for name, estimate in derived.items() if name not in {**CHARACTERISTICS, **WHEEL_LOADS}}


def derived_table(vehicle: str, derived: Mapping[str, Estimate]) -> Table:
    """Return the table of masses, loads, centre of gravity, ride and wheel hop, one quantity a row.

    Parameters
    ----------
    vehicle
        Name of the vehicle.
    derived
        By name; other quantities are left out.

    Returns
    -------
    Table
    """
    rows = []
    for name in (name for _, *names in _CHARACTERISTICS for name in names if name in derived):
        value, std, _, unit, _ = value_cells(derived[name])
        rows.append((name, _rounded(derived[name], value), std, unit))
    headers = ("empty vehicle", "value", "±", "unit")
    title = f"{vehicle}: masses, ride and wheel hop, one standard uncertainty"
    return Table(title, headers, tuple(rows), frozenset(("value", "±")))


def characteristics_tables(vehicle: str, derived: Mapping[str, Estimate]) -> tuple[Table, ...]:
    """Return the table of masses, loads, centre of gravity, ride and wheel hop, axle by axle.

    Parameters
    ----------
    vehicle
        Name of the vehicle.
    derived
        By name.

    Returns
    -------
    tuple of Table
        One, or none where no quantity has a value.
    """
    rows = []
    for label, *names in _CHARACTERISTICS:
        cells = [_with_uncertainty(derived[name]) if name in derived else "" for name in names]
        if any(name in derived for name in names):
            rows.append((label, *cells))
    if not any(derived[name].value is not None for _, *names in _CHARACTERISTICS for name in names if name in derived):
        return ()
    headers = ("empty vehicle", "front", "rear", "whole")
    # A vehicle with one axle has neither front nor rear.
    used = [i for i, column in enumerate(zip(headers, *rows, strict=True)) if any(column[1:])]
    shown, cells_of = tuple(headers[i] for i in used), [tuple(row[i] for i in used) for row in rows]
    title = f"{vehicle}: masses, ride and wheel hop, ± one standard uncertainty"
    return (Table(title, shown, tuple(cells_of), frozenset(shown[1:])),)


def damper_tables(curves: Mapping[str, ForceCurve]) -> tuple[Table, ...]:
    """Return the table of damper forces at the velocities of a dynamometer, as far as the drops reached.

    Parameters
    ----------
    curves
        Force curves by name.

    Returns
    -------
    tuple of Table
        One, or none where no damper has a curve.
    """
    dampers = {name.removeprefix("damper_"): curve for name, curve in curves.items() if name.startswith("damper_")}
    columns = [(axle, way, sign) for axle in dampers for way, sign in (("rebound", 1.0), ("compression", -1.0))]
    rows = []
    for velocity in _VELOCITIES:
        cells = [_damper_force(dampers[axle], sign * velocity) for axle, _, sign in columns]
        if any(cells):
            rows.append((f"{velocity:g}", *cells))
    if not rows:
        return ()
    headers = ("velocity, m/s", *(f"{axle}, {way}" for axle, way, _ in columns))
    title = "Damper forces, N, ± one standard uncertainty, at velocities that the drops reached"
    return (Table(title, headers, tuple(rows), frozenset(headers)),)


def _damper_force(curve: ForceCurve, velocity: float) -> str:
    if not curve.reached[0] <= velocity <= curve.reached[1]:
        return ""
    value, std = round_by_uncertainty(*map(float, curve.at(velocity)))
    return f"{value} ± {std}" if std else value


def _with_uncertainty(estimate: Estimate | None) -> str:
    if estimate is None or estimate.value is None or estimate.std is None:
        return "-"
    value, std = round_by_uncertainty(estimate.value, estimate.std)
    return f"{value} ± {std}" if std else _rounded(estimate, value)


def _rounded(estimate: Estimate, text: str) -> str:
    """Return the text of a derived value, an exact one with as many digits as are of use: nobody stated it with more."""
    return f"{estimate.value:.{_EXACT_DIGITS}g}" if estimate.value is not None and estimate.std == 0 else text


def ratios_table(ratios: Mapping[str, Ratio]) -> Table:
    """Return the table of ratios that are determined without absolute scale.

    Parameters
    ----------
    ratios
        By parameter.

    Returns
    -------
    Table
    """
    rows = []
    for name, ratio in ratios.items():
        value, std = round_by_uncertainty(ratio.value, ratio.std)
        rows.append((name, value, std, unit_text(ratio.unit)))
    title = "Divided by the empty vehicle's total mass"
    return Table(title, ("parameter", "value", "±", "unit"), tuple(rows), frozenset(("value", "±")))


_OF_SENSORS = {
    "gain": ("gain, %", 100.0),
    "x": ("x, mm", 1e3),
    "y": ("y, mm", 1e3),
    "tilt_x": ("tilt x, °", math.degrees(1.0)),
    "tilt_y": ("tilt y, °", math.degrees(1.0)),
    "delay": ("delay, ms", 1e3),
}
"""Headers of the table of sensors, and the factor from SI to the unit there."""


def sensors_table(sensors: Sequence[SensorEstimate]) -> Table:
    """Return the table of what was found of each sensor, beside its stated uncertainty.

    Parameters
    ----------
    sensors
        Of a result.

    Returns
    -------
    Table
    """
    found: dict[str, dict[str, str]] = {}
    for one in sensors:
        factor = _OF_SENSORS[one.quantity][1]
        value, std = round_by_uncertainty(factor * one.value, factor * one.std)
        found.setdefault(one.channel, {})[one.quantity] = f"{value} ± {std} ({factor * one.stated_std:.2g})"
    present = [kind for kind in _OF_SENSORS if any(one.quantity == kind for one in sensors)]
    rows = tuple((channel, *(cells.get(kind, "") for kind in present)) for channel, cells in found.items())
    headers = tuple(_OF_SENSORS[kind][0] for kind in present)
    title = "Sensors: difference from what is stated, ± one standard uncertainty (and the stated one)"
    return Table(title, ("channel", *headers), rows, frozenset(headers))


def modes_table(load: str, modes: Sequence[ModeEstimate]) -> Table:
    """Return the table of the modes of one load, with uncertainties; "-" where undetermined.

    Parameters
    ----------
    load
        Its name.
    modes
        Of the identified vehicle.

    Returns
    -------
    Table
    """
    rows = []
    for mode in modes:
        damped = "-" if mode.frequency_std is None else f"{mode.damped_frequency:.3f}"
        frequency = with_std(mode.frequency, mode.frequency_std)
        rows.append((mode.name, *frequency, damped, *with_std(mode.damping_ratio, mode.damping_ratio_std)))
    headers = ("mode", "f_n Hz", "± Hz", "f_d Hz", "damping", "±")
    return Table(f"Modes, {load}", headers, tuple(rows), frozenset(headers[1:]), ("f_d Hz", "±"))


def trace_table(trace: Sequence[TraceStep]) -> Table:
    """Return the table of the steps of the analysis.

    Parameters
    ----------
    trace
        Of a result.

    Returns
    -------
    Table
    """
    rows = tuple((step.stage, step.what, step.why) for step in trace)
    return Table(TRACE_TITLE, ("stage", "what", "why"), rows)

"""The tables of a result: what every place that shows them shows, each in its own way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sprung.estimation import ModeEstimate
from sprung.tables import Table, unit_text, value_cells, with_std
from sprung.uncertainty import Estimate, Ratio, round_by_uncertainty
from sprung.vehicle import CHARACTERISTICS, LOAD_MASS, PARAMETERS, WHEEL_LOADS

_OF_ALL = "of the empty vehicle"
_DERIVED = {
    "I_xx_roll_axis": "roll inertia of the sprung mass about the axis of roll",
    "wheelbase": "front axle to rear axle",
    **{name: one.meaning for name, one in CHARACTERISTICS.items()},
    **WHEEL_LOADS,
}
"""What derived quantities mean."""

_CHARACTERISTICS = (
    ("mass, kg", "front_axle_mass", "rear_axle_mass", "total_mass"),
    ("part of the mass", "front_axle_share", "", ""),
    ("load of each wheel, N", "front_wheel_load", "rear_wheel_load", ""),
    ("load of the left wheel, N", "front_left_wheel_load", "rear_left_wheel_load", ""),
    ("load of the right wheel, N", "front_right_wheel_load", "rear_right_wheel_load", ""),
    ("centre of gravity, m behind front axle", "", "", "cg_from_front_axle"),
    ("centre of gravity, m left of centreline", "", "", "cg_left"),
    ("ride frequency, Hz", "front_ride_frequency", "rear_ride_frequency", ""),
    ("ride damping ratio", "front_ride_damping", "rear_ride_damping", ""),
    ("wheel hop frequency, Hz", "front_hop_frequency", "rear_hop_frequency", ""),
    ("wheel hop damping ratio", "front_hop_damping", "rear_hop_damping", ""),
)
"""Rows of the table of characteristics: what is shown, and the quantities of front axle, rear axle and whole vehicle."""


def meaning_of(name: str) -> str:
    """Say what a parameter or derived quantity is.

    Parameters
    ----------
    name
        Its name.

    Returns
    -------
    str
    """
    if name in PARAMETERS or name.startswith(LOAD_MASS):
        return PARAMETERS[name].meaning
    return _DERIVED.get(name, _OF_ALL)


def parameters_table(vehicle: str, parameters: Mapping[str, Estimate]) -> Table:
    """Show every parameter with its uncertainty.

    Parameters
    ----------
    vehicle
        Whose they are.
    parameters
        By name, derived quantities among them.

    Returns
    -------
    Table
    """
    headers = ("parameter", "value", "±", "%", "unit", "status", "meaning")
    rows = tuple((name, *value_cells(found), meaning_of(name)) for name, found in parameters.items())
    title = f"{vehicle}: parameters, one standard uncertainty"
    return Table(title, headers, rows, frozenset(("value", "±", "%")), ("meaning", "%", "status"))


def other_quantities(derived: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Return the derived quantities that no `characteristics_tables` show.

    Parameters
    ----------
    derived
        By name.

    Returns
    -------
    dict
        By name.
    """
    return {name: found for name, found in derived.items() if name not in {**CHARACTERISTICS, **WHEEL_LOADS}}


def derived_table(vehicle: str, derived: Mapping[str, Estimate]) -> Table:
    """Show masses, loads, centre of gravity, ride and wheel hop by their names, one below the other.

    Parameters
    ----------
    vehicle
        Whose they are.
    derived
        By name; others than these are left out.

    Returns
    -------
    Table
    """
    rows = []
    for name in (name for _, *names in _CHARACTERISTICS for name in names if name in derived):
        value, std, _, unit, _ = value_cells(derived[name])
        rows.append((name, value, std, unit))
    headers = ("empty vehicle", "value", "±", "unit")
    title = f"{vehicle}: masses, ride and wheel hop, one standard uncertainty"
    return Table(title, headers, tuple(rows), frozenset(("value", "±")))


def characteristics_tables(vehicle: str, derived: Mapping[str, Estimate]) -> tuple[Table, ...]:
    """Show masses, loads, centre of gravity, ride and wheel hop, axle by axle.

    Parameters
    ----------
    vehicle
        Whose they are.
    derived
        By name.

    Returns
    -------
    tuple of Table
        One, or none where a result has no value for any of them.
    """
    rows = []
    for label, *names in _CHARACTERISTICS:
        cells = [_with_uncertainty(derived.get(name)) if name else "" for name in names]
        if any(name in derived for name in names):
            rows.append((label, *cells))
    if not any(derived[name].value is not None for _, *names in _CHARACTERISTICS for name in names if name in derived):
        return ()
    headers = ("empty vehicle", "front", "rear", "whole")
    title = f"{vehicle}: masses, ride and wheel hop, ± one standard uncertainty"
    return (Table(title, headers, tuple(rows), frozenset(headers[1:])),)


def _with_uncertainty(found: Estimate | None) -> str:
    if found is None or found.value is None or found.std is None:
        return "-"
    value, std = round_by_uncertainty(found.value, found.std)
    return f"{value} ± {std}" if std else value


def ratios_table(ratios: Mapping[str, Ratio]) -> Table:
    """Show what is left without absolute scale.

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


def modes_table(load: str, modes: Sequence[ModeEstimate]) -> Table:
    """Show the modes of one load, with uncertainties; what is undetermined gets no number.

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

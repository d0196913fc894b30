"""The tables of a result: what every place that shows them shows, each in its own way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from sprung.estimate import Estimate, Ratio, round_by_uncertainty
from sprung.identification import ModeEstimate
from sprung.tables import Table, unit_text, value_cells, with_std
from sprung.vehicle import LOAD_MASS, PARAMETERS

if TYPE_CHECKING:
    from sprung.pipeline.found import FoundMode

_OF_ALL = "of the empty vehicle"
_DERIVED = {"I_xx_roll_axis": "roll inertia of the sprung mass about the axis of roll"}
"""What derived quantities mean."""


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


def found_modes_table(load: str, method: str, drops: int, modes: Sequence[FoundMode]) -> Table:
    """Show modes that were found without a vehicle model.

    Parameters
    ----------
    load
        Its name.
    method, drops
        By which they were found, in how many drops.
    modes
        The modes.

    Returns
    -------
    Table
    """
    headers = ("mode", "f_n Hz", "± Hz", "f_d Hz", "damping", "±", "MPC")
    title = f"Modes, {load} ({method}, {drops} drop{'s' * (drops > 1)})"
    return Table(title, headers, tuple(map(_found, modes)), frozenset(headers[1:]), ("MPC", "f_d Hz"))


def _found(mode: FoundMode) -> tuple[str, ...]:
    if mode.status == "unresolved":
        return (mode.name, f"~{mode.frequency:.2g}", "-", "-", "-", "-", "-")
    return (
        mode.name,
        *_told(mode.frequency, mode.frequency_std),
        f"{mode.damped_frequency:.4f}",
        *_told(mode.damping_ratio, mode.damping_ratio_std),
        f"{mode.collinearity:.2f}",
    )


def _told(value: float, std: float | None) -> tuple[str, str]:
    """Round by the uncertainty; a method that tells none gets four digits."""
    return (f"{value:.4f}", "-") if std is None else with_std(value, std)

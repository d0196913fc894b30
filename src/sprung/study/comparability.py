"""What each result has of a quantity, and which quantities of two results are the same."""

from __future__ import annotations

from sprung.results import Result
from sprung.study.comparison import ResultValue
from sprung.vehicle import PART_NAMES, layout_of

ABSENT = "has another model"
"""Why a result whose model lacks the quantity has no value."""

_ABOUT_AXES = ("I_xx", "I_yy")
"""Inertias, which can be compared only if they refer to the same axes."""


def value_of(result: Result, name: str, per_mass: bool) -> ResultValue:
    """Return the value of a parameter or derived quantity in a result, or why it has none.

    Parameters
    ----------
    result
        From an identification.
    name
        Of the quantity.
    per_mass
        Whether it is divided by the total mass.

    Returns
    -------
    ResultValue
        In the unit of `unit_of`.
    """
    if result.verdict.state == "reject":
        return ResultValue(None, None, "was rejected")
    estimate = result.parameters.get(name) or result.derived.get(name)
    if estimate is None:
        return ResultValue(None, None, ABSENT)
    if per_mass:
        ratio = result.scale.per_total_mass.get(name)
        return (
            ResultValue(ratio.value, ratio.std)
            if ratio is not None
            else ResultValue(None, None, "does not determine it")
        )
    return ResultValue(estimate.value, estimate.std, "" if estimate.value is not None else "does not determine it")


def unit_of(result: Result, name: str, per_mass: bool) -> str | None:
    """Return the unit of a parameter or derived quantity in a result; None where it lacks the quantity.

    Parameters
    ----------
    result
        From an identification.
    name
        Of the quantity.
    per_mass
        Whether it is divided by the total mass.
    """
    if per_mass:
        ratio = result.scale.per_total_mass.get(name)
        return None if ratio is None else ratio.unit
    estimate = result.parameters.get(name) or result.derived.get(name)
    return None if estimate is None else estimate.unit


def part_of(result: Result) -> str:
    """Return the part of a vehicle of which a result is, such as ``pitch plane``.

    Parameters
    ----------
    result
        From an identification.
    """
    return PART_NAMES[layout_of(result.parameters).model]


def contradiction_of(first: Result, second: Result, name: str = "") -> str:
    """Return why a quantity of two results is not the same quantity; empty where it is.

    Parameters
    ----------
    first, second
        From identifications.
    name
        A parameter or derived quantity; empty for modes.

    Returns
    -------
    str
    """
    parts = [part_of(result) for result in (first, second)]
    if parts[0] != parts[1]:
        return f"a {parts[0]} and a {parts[1]}: the same name means another quantity"
    units = [unit_of(result, name, False) for result in (first, second)]
    if None in units or "reject" in (first.verdict.state, second.verdict.state):
        return ""  # nothing to compare: `value_of` says why
    if units[0] != units[1]:
        return f"units {units[0]} and {units[1]}"
    if name in _ABOUT_AXES and first.fit.axes != second.fit.axes:
        return "different axes, because the heights that were given or found differ"
    return ""

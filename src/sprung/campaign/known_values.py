"""Quantities known beforehand, as Python code may give them: records, numbers, or mappings as in a campaign file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeAlias

from sprung.errors import Problems, did_you_mean
from sprung.uncertainty import KnownValue
from sprung.vehicle import DERIVED, MOTION_RATIOS, PARAMETERS

KnownValueLike: TypeAlias = KnownValue | float | Mapping[str, float]
"""A known quantity: a record, a number (exact), or {value, std} as in a campaign file."""


def parse_known_value(given: KnownValueLike, where: str, problems: Problems) -> KnownValue | None:
    """Return a known quantity as a record.

    Parameters
    ----------
    given
        The quantity.
    where
        What to call it in a problem.
    problems
        Takes what is wrong.

    Returns
    -------
    KnownValue or None
        None where it is invalid.
    """
    if isinstance(given, Mapping):
        if not {"value"} <= given.keys() <= {"value", "std"}:
            problems.add(where, repr(dict(given)), "{value, std}", "Give the value, and std if it has one.")
            return None
        given = KnownValue(**given)
    elif not isinstance(given, KnownValue):
        if isinstance(given, bool) or not isinstance(given, int | float):
            problems.add(where, repr(given), "a number, or {value, std}", "Correct it.")
            return None
        given = KnownValue(float(given))
    if not (math.isfinite(given.value) and math.isfinite(given.std) and given.std >= 0):
        problems.add(where, repr(given), "a finite value, and a std that is not negative", "Correct it.")
        return None
    return given


def parse_known_values(given: Mapping[str, KnownValueLike], where: str, problems: Problems) -> dict[str, KnownValue]:
    """Return known quantities as records, as far as they are possible.

    Parameters
    ----------
    given
        By the name of a parameter or derived quantity, SI.
    where
        What to call them in a problem.
    problems
        Takes what is wrong.

    Returns
    -------
    dict
        By name.
    """
    known: dict[str, KnownValue] = {}
    allowed = PARAMETERS.keys() | DERIVED.keys()
    for name, quantity in given.items():
        place = f"{where}['{name}']"
        if name not in allowed:
            problems.add(place, f"'{name}'", "a parameter or a derived quantity", did_you_mean(name, allowed))
            continue
        value = parse_known_value(quantity, place, problems)
        if value is None:
            continue
        parameter = PARAMETERS.get(name)
        if (parameter is None or parameter.positive) and value.value <= 0:
            problems.add(place, f"{value.value:g}", "a positive number", "Correct it.")
        elif parameter is not None and not parameter.signed and value.value < 0:
            problems.add(place, f"{value.value:g}", "a number that is not negative", "Correct it.")
        else:
            known[name] = value
    return known


def parse_motion_ratios(given: Mapping[str, KnownValueLike], where: str, problems: Problems) -> dict[str, KnownValue]:
    """Return motion ratios as records, as far as they are possible.

    Parameters
    ----------
    given
        Travel of a spring or damper per travel of its wheel, dimensionless, by the names of `MOTION_RATIOS`.
    where
        What to call them in a problem.
    problems
        Takes what is wrong.

    Returns
    -------
    dict
        By name.
    """
    ratios: dict[str, KnownValue] = {}
    for name, quantity in given.items():
        place = f"{where}['{name}']"
        if name not in MOTION_RATIOS:
            do = did_you_mean(name, MOTION_RATIOS, listed=True)
            problems.add(place, f"'{name}'", f"one of {', '.join(MOTION_RATIOS)}", do)
            continue
        ratio = parse_known_value(quantity, place, problems)
        if ratio is not None:
            ratios[name] = ratio
    return ratios

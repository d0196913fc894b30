"""What a simulated campaign says was measured beforehand."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeAlias

from sprung.errors import Problems, did_you_mean
from sprung.estimate import Known
from sprung.vehicle import DERIVED, PARAMETERS

Given: TypeAlias = Known | float | Mapping[str, float]
"""A known quantity: a record, a number (exact), or {value, std} as in a campaign file."""


def known_quantities(given: Mapping[str, Given] | None, wheelbase: float, problems: Problems) -> dict[str, Known]:
    """Turn what is given into records; what is wrong is added to the problems.

    Parameters
    ----------
    given
        By the name of a parameter or derived quantity, SI.
    wheelbase
        Counts as known exactly where it is not given, m.
    problems
        Collects what is wrong.

    Returns
    -------
    dict
        By name; ``wheelbase`` is always among them.
    """
    known = {"wheelbase": Known(wheelbase)}
    allowed = PARAMETERS.keys() | DERIVED.keys()
    for name, quantity in (given or {}).items():
        where = f"simulate: known['{name}']"
        if name not in allowed:
            problems.add(where, f"'{name}'", "a parameter or a derived quantity", did_you_mean(name, allowed))
        if isinstance(quantity, Mapping):
            if not {"value"} <= quantity.keys() <= {"value", "std"}:
                problems.add(where, repr(dict(quantity)), "{value, std}", "Give the value, and std if it has one.")
                continue
            quantity = Known(**quantity)  # noqa: PLW2901 (one form from here on)
        elif not isinstance(quantity, Known):
            quantity = Known(quantity)  # noqa: PLW2901
        if not (math.isfinite(quantity.value) and math.isfinite(quantity.std) and quantity.std >= 0):
            problems.add(where, repr(quantity), "a finite value, and a std that is not negative", "Correct it.")
        known[name] = quantity
    return known

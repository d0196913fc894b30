"""Where the search for the likeliest vehicle may begin, as the user gives it."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from sprung.errors import Problems, did_you_mean
from sprung.results import Result
from sprung.vehicle import PARAMETERS, Vehicle, all_names


def start_values(start: Result | Vehicle | Mapping[str, float] | None) -> dict[str, float]:
    """Return the values of parameters from which a search may begin.

    Parameters
    ----------
    start
        An earlier result, a vehicle, or values by name, SI.

    Returns
    -------
    dict
        By name, SI; empty where nothing is given. Parameters that a result does not determine are left out.

    Raises
    ------
    InputError
        If a name is unknown, or a value impossible; all faults at once.
    """
    if start is None:
        return {}
    if isinstance(start, Result):
        return {name: found.value for name, found in start.parameters.items() if found.value is not None}
    if isinstance(start, Vehicle):
        return dict(start.parameters)
    problems = Problems()
    if not isinstance(start, Mapping):
        do = 'Give start={"k_sf": 20000}, an earlier result, or nothing.'
        problems.add("start", type(start).__name__, "a result, a vehicle, or values by name", do)
        problems.raise_if_any()
    for name, value in start.items():
        if isinstance(value, bool) or not isinstance(value, int | float | np.number):
            problems.add(f"start[{name!r}]", repr(value), "a number, SI", "Correct it.")
        elif name not in PARAMETERS:
            problems.add(
                f"start[{name!r}]", f"'{name}'", "the name of a parameter", did_you_mean(name, all_names("full"))
            )
        elif not math.isfinite(value) or (PARAMETERS[name].positive and value <= 0):
            problems.add(f"start[{name!r}]", f"{value:g}", f"a possible value, {PARAMETERS[name].unit}", "Correct it.")
    problems.raise_if_any()
    return {name: float(value) for name, value in start.items()}

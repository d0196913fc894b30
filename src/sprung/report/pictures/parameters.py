"""95 % intervals of all parameters on one scale."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sprung.report.drawing.axis import Axis
from sprung.report.drawing.picture import Curve, Mark, Panel, Picture, Points, Rule
from sprung.uncertainty import NORMAL_95, Estimate

_SCALES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)

_FAR = 8.0
"""Ratio of the widest interval that is shown whole to the median one."""


def half_width(parameters: Mapping[str, Estimate]) -> float:
    """Return the half-width of a common scale for all intervals, %.

    Parameters
    ----------
    parameters
        By name.
    """
    wide = sorted(NORMAL_95 * found.percent for found in parameters.values() if found.percent)
    if not wide:
        return 1.0
    usual = wide[len(wide) // 2]
    enough = max(width for width in wide if width <= _FAR * usual)
    return next((scale for scale in _SCALES if scale >= enough), _SCALES[-1])


def limits_percent(found: Estimate) -> tuple[float, float] | None:
    """Return the limits of a 95 % interval in percent of the value, infinite where it is open; None without a value."""
    if found.value is None or not found.value or found.interval95 is None or found.status != "estimated":
        return None
    low, high = found.interval95
    ends = sorted(
        100 * (limit - found.value) / abs(found.value) if limit is not None else sign * np.inf
        for limit, sign in ((low, -1), (high, 1))
    )
    return float(ends[0]), float(ends[1])


def parameters_picture(parameters: Mapping[str, Estimate]) -> Picture:
    """Return the picture of the 95 % interval of every estimated parameter.

    Parameters
    ----------
    parameters
        By name.

    Returns
    -------
    Picture
        One panel, percent to the right.
    """
    half = half_width(parameters)
    intervals = {name: limits for name, found in parameters.items() if (limits := limits_percent(found)) is not None}
    places = {name: float(len(intervals) - i) for i, name in enumerate(intervals)}
    marks: list[Mark] = [Rule(0.0, "reference")]
    for name, ends in intervals.items():
        inside = np.clip(np.array(ends), -half, half)
        marks.append(Curve(inside, np.full(2, places[name]), "simulated", width=1.6))
    marks.append(Points(np.zeros(len(intervals)), np.array(list(places.values())), "simulated"))
    y = Axis("", 0.3, len(intervals) + 0.7, ticks=tuple((place, name) for name, place in places.items()))
    panel = Panel(y, tuple(marks), height=0.17 * max(len(intervals), 2))
    x = Axis("95 % interval, percent of the value", -half, half)
    return Picture("Parameters", x, (panel,), "The 95 % interval of every parameter in percent of its value.")

"""A fleet: each vehicle with its error and the limits, the spread between vehicles, and both control charts."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sprung.fleets import FleetType
from sprung.report.drawing.axis import Axis, axis_limits
from sprung.report.drawing.picture import Curve, Mark, Panel, Picture, Points, Rule
from sprung.tables import unit_text
from sprung.uncertainty import NORMAL_95

Real = NDArray[np.float64]

_DOTS = 60
"""Number of vehicles above which points are small, and error bars left out."""


def fleet_pictures(one: FleetType) -> dict[str, Picture]:
    """Return the pictures of the vehicles of a type.

    Parameters
    ----------
    one
        Of a fleet.

    Returns
    -------
    dict
        By ``spread``, ``rig``, ``vehicle`` and, for each parameter that is not the same exact value in all, its name.
    """
    pictures = {"spread": _spread(one), "rig": _rig(one), "vehicle": _vehicle(one)}
    names = enumerate(one.estimates.names)
    return pictures | {name: _parameter(one, j) for j, name in names if not one.parameters[name].exact}


def _numbers(one: FleetType) -> Axis:
    return Axis("vehicle, in the order of the tests", 0, one.estimates.count + 1)


def _spread(one: FleetType) -> Picture:
    """Draw the spread between vehicles beside the errors of their tests."""
    parameters = {name: spread for name, spread in one.parameters.items() if not spread.exact}
    places = {name: float(len(parameters) - i) for i, name in enumerate(parameters)}
    y = np.array(list(places.values()))
    # Neither what is not determined nor what is known exactly has a place on a logarithmic axis.
    own = np.array([one.error or np.nan for one in parameters.values()])
    joint = np.array([one.hierarchical_error or np.nan for one in parameters.values()])
    between = np.array([one.spread for one in parameters.values()])
    seen = np.concatenate([between, own, joint])
    seen = seen[seen > 0]
    low, high = float(seen.min()) / 1.5, float(seen.max()) * 2
    half = NORMAL_95 * np.array([one.spread_std for one in parameters.values()])
    ends = np.clip([between - half, between + half], low, high)
    marks: list[Mark] = [
        Curve(end, np.full(2, place), "simulated", width=1.6) for end, place in zip(ends.T, y, strict=True)
    ]
    marks += [
        Points(between, y, "simulated", "spread between vehicles"),
        Points(own, y, "first", "error of a vehicle, own test"),
        Points(joint, y, "second", "with the others", hollow=True),
    ]
    axis = Axis("", 0.3, len(places) + 0.7, ticks=tuple((place, name) for name, place in places.items()))
    panel = Panel(axis, tuple(marks), height=0.17 * max(len(places), 2))
    x = Axis("standard deviation, percent of the mean", low, high, log=True)
    return Picture(
        "Spread between vehicles and errors",
        x,
        (panel,),
        "Standard deviation between vehicles of every parameter with its 95 % interval, and the median standard "
        "uncertainty of a vehicle from its own test and together with the others.",
    )


def _rig(one: FleetType) -> Picture:
    chart = one.chart
    alarms = [alarm.number for alarm in chart.rig_alarms]
    rules = [
        *(
            Rule(alarm.since, "fault", f"since {alarm.since}", dashed=True)
            for alarm in chart.rig_alarms
            if alarm.since > 0
        ),
    ]
    panel = _chart_panel("moving average", chart.rig_average, chart.rig_limit, alarms, rules)
    text = "; ".join(f"alarm at vehicle {alarm.number}, since vehicle {alarm.since}" for alarm in chart.rig_alarms)
    return Picture(
        "Rig: moving average of all vehicles",
        _numbers(one),
        (panel,),
        f"Length of the moving average of the scores of the vehicles, and its limit. {text or 'No alarm'}.",
    )


def _vehicle(one: FleetType) -> Picture:
    chart = one.chart
    alarms = [alarm.number for alarm in chart.vehicle_alarms]
    panel = _chart_panel("largest score", chart.vehicle_scores, chart.vehicle_limit, alarms, [], joined=False)
    text = "; ".join(f"vehicle {alarm.label}" for alarm in chart.vehicle_alarms)
    return Picture(
        "Vehicles: largest score of a parameter",
        _numbers(one),
        (panel,),
        f"Largest score of a single parameter of each vehicle, and its limit. Alarms: {text or 'none'}.",
    )


def _chart_panel(
    label: str, values: Real, limit: float, alarms: list[int], rules: list[Rule], joined: bool = True
) -> Panel:
    numbers = np.arange(1, values.size + 1, dtype=float)
    raised = np.array([number - 1 for number in alarms], dtype=int)
    marks: list[Mark] = [Rule(limit, "fault", horizontal=True, dashed=True), *rules]
    if joined:
        marks.append(Curve(numbers, values, "simulated", width=1.2))
    else:
        marks.append(Points(numbers, values, "simulated", size=0.8 if values.size <= _DOTS else 0.5))
    if raised.size:
        marks.append(Points(numbers[raised], values[raised], "fault", "alarm", size=1.3))
    high = 1.08 * max(limit, float(np.nanmax(values, initial=0.0)))
    return Panel(Axis(label, 0, high), tuple(marks), height=1.5, note=f"dashed: limit {limit:.2f}")


def _parameter(one: FleetType, j: int) -> Picture:
    """Draw each vehicle's own estimate with its error, its estimate with the others, mean and limits."""
    own, joint, name = one.estimates, one.hierarchical, one.estimates.names[j]
    spread = one.parameters[name]
    shown = own.known[:, j] & (own.own_stds[:, j] < 1)
    numbers = np.arange(1, own.count + 1, dtype=float)
    values, value_stds = (
        own.values(own.positions)[:, j],
        own.stds(own.positions, own.own_stds)[:, j],
    )
    joint_values = own.values(joint.positions)[:, j]
    few = own.count <= _DOTS
    size = 0.8 if few else 0.5
    marks: list[Mark] = [
        Rule(spread.mean, "reference", horizontal=True),
        *(Rule(limit, "reference", horizontal=True, dashed=True) for limit in spread.limits),
    ]
    if shown.any():
        bars = NORMAL_95 * value_stds[shown] if few else None
        marks.append(Points(numbers[shown], values[shown], "first", "own test", bars=bars, size=size))
    marks.append(Points(numbers, joint_values, "simulated", "with the others", size=size))
    raised = _alarmed(one, name)
    if raised.size:
        marks.append(Points(numbers[raised], joint_values[raised], "fault", "alarm", hollow=True, size=1.8))
    seen = [joint_values, np.array(spread.limits), *([values[shown]] if shown.any() else [])]
    if few and shown.any():
        seen += [values[shown] + sign * NORMAL_95 * value_stds[shown] for sign in (-1, 1)]
    label = ", ".join(filter(None, (name, unit_text(spread.unit))))
    panel = Panel(Axis(label, *axis_limits(*seen)), tuple(marks), height=1.5)
    return Picture(
        name,
        _numbers(one),
        (panel,),
        f"{name} of each vehicle, from its own test and together with the others; mean and 95 % limits as lines.",
    )


def _alarmed(one: FleetType, name: str) -> NDArray[np.intp]:
    return np.array(list(_alarm_numbers(one, name)), dtype=int)


def _alarm_numbers(one: FleetType, name: str) -> Iterator[int]:
    for alarm in one.chart.vehicle_alarms:
        if any(deviation.name == name for deviation in alarm.deviations):
            yield alarm.number - 1

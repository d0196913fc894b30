"""Corrections of what was found beside nonlinear terms or on pads: a sensor in error, drops that are unlike all others."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import Any

from sprung.errors import Fault
from sprung.faults.campaign.exchanged_loads import loads_fault
from sprung.faults.campaign.several_vehicles import of_two_vehicles
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.channel.delay import delay_fault
from sprung.faults.channel.gain import gain_fault
from sprung.faults.channel.position import position_fault
from sprung.faults.channel.sign import sign_fault
from sprung.faults.correction import (
    Correction,
    advance_channel,
    describe_sensor,
    exclude_drops,
    mask_channel,
    relabel_loads,
    scale_channel,
)
from sprung.faults.drop.unlike import unlike_fault
from sprung.faults.hypothesis import Hypothesis
from sprung.selection import SensorError, UnlikeDrops
from sprung.vehicle import Sensor

_STATED = {"gain_std", "position_std", "delay_std"}
"""What is stated of a sensor's uncertainty."""

_LEFT = 0.05
"""Part of a correction that may be left, as its standard uncertainty: it was estimated with a model that may lack something."""


def correct_beside_terms(base: CandidateFit, fault: SensorError | UnlikeDrops) -> list[Hypothesis]:
    """Return the hypotheses that sensors or drops are at fault as the search for nonlinear terms found it.

    Parameters
    ----------
    base
        The present fit of the campaign as it is.
    fault
        What was found.

    Returns
    -------
    list of Hypothesis
        The correction of a sensor states how uncertain it is: what is left of its error remains an unknown of each fit.
    """
    if isinstance(fault, SensorError):
        return [_of_sensor(base, fault)]
    if fault.others:
        return [of_two_vehicles(base, (fault.others, fault.recordings))]
    if fault.loads:
        return [
            Hypothesis(
                loads_fault(fault.recordings),
                "corrected",
                relabel_loads(fault.loads),
                base.table,
                base,
                is_fitted=True,
                is_sufficient=True,
            )
        ]
    return [
        Hypothesis(
            unlike_fault(name), "left out", exclude_drops(name), base.table, base, recording=name, is_specific=False
        )
        for name in fault.recordings
    ]


def _of_sensor(base: CandidateFit, error: SensorError) -> Hypothesis:
    """Return the hypothesis that a sensor is in error."""
    sensors = base.campaign.sensors
    channel = [sensor.channel for sensor in sensors].index(error.channel)
    if not error.found:
        return _without_channel(base, channel)
    std = max(max(uncertainty, _LEFT * abs(size)) for size, uncertainty in error.found.values())
    rates = {recording.rate for recording in base.campaign.recordings}
    fault, correction, changes = _corrected(sensors[channel], channel, error, rates)
    uncertain = {
        name: max(changes.get(name, 0.0), getattr(sensors[channel], name), std) for name in _STATED & {*changes}
    }
    stated = replace(sensors[channel], **{**changes, **uncertain})
    correction = replace(correction, description=describe_sensor(channel, stated).description)
    return Hypothesis(
        fault, "corrected", correction, base.table, base, free=len(error.found), is_fitted=True, is_sufficient=True
    )


def _without_channel(base: CandidateFit, channel: int) -> Hypothesis:
    """Return the hypothesis that a channel, by its position, is of no use, corrected as it is."""
    what = "corrected as it is, the channel still contradicts all other channels; it is left out"
    do = "Check the sensor, its cable, its logger's filter and its place."
    fault = Fault("unlike-others", base.campaign.sensors[channel].channel, what, do)
    return Hypothesis(fault, "left out", mask_channel(channel), base.table, base, is_fitted=True, is_sufficient=True)


def _corrected(
    sensor: Sensor, channel: int, error: SensorError, rates: Collection[float]
) -> tuple[Fault, Correction, dict[str, Any]]:
    """Return the fault, what it changes of the samples, and what is stated of the sensor then."""
    sizes = {quantity: size for quantity, (size, _) in error.found.items()}
    if "delay" in sizes:
        # Whole samples: between them, a jump at the release would ring. What is left is an unknown.
        sample = 1 / max(rates)
        whole = advance_channel(channel, round(sizes["delay"] / sample) * sample)
        return delay_fault(sensor.channel, sizes["delay"]), whole, {"delay_std": sample / 2}
    if "gain" in sizes:
        gain = 1.0 + sizes["gain"]
        if gain < 0:
            return sign_fault(sensor.channel), scale_channel(channel, -1.0), {"gain_std": sensor.gain_std}
        return gain_fault(sensor.channel, gain), scale_channel(channel, 1 / gain), {"gain_std": sensor.gain_std}
    x, y, z = sensor.position or (0.0, 0.0, 0.0)
    x, y = x + sizes.get("x", 0.0), y + sizes.get("y", 0.0)
    return position_fault(sensor, x, y), Correction(), {"position": (x, y, z), "position_std": sensor.position_std}

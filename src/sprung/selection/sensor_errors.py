"""The error of one sensor beside nonlinear terms: what no term explains may be its gain, its place or its delay.

With every usual term a vehicle as it is leaves little but what its sensors do wrong. The score test of each unknown of each
sensor, from one evaluation, tells which: what the fit would take it to be if nothing were stated of it. Where the model lacks
something instead, all sensors gain about as little by it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sprung.estimation import lift_priors
from sprung.selection.error_budget import required_gain
from sprung.selection.structure import ModelStructure
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import LARGEST_PLACE, SENSOR_UNKNOWNS, Sensor, SensorQuantity, sensor_unknown

if TYPE_CHECKING:
    from sprung.selection.search import ModelSearch

_STATED = {"gain_std": 1e-3, "position_std": 1e-3, "delay_std": 1e-4}
"""Standard uncertainties that are taken as stated at least, so that each is an unknown: relative, m and s."""

_FREE: Mapping[SensorQuantity, tuple[tuple[SensorQuantity, ...], str, float]] = {
    "gain": (("gain",), "gain_std", 0.5),
    "x": (("x", "y"), "position_std", LARGEST_PLACE),
    "y": (("x", "y"), "position_std", LARGEST_PLACE),
    "delay": (("delay",), "delay_std", 0.05),
}
"""Which unknowns go together, and the standard uncertainty with which they are as good as free: relative, m and s."""

_OUTSTANDING = 2.0
"""By how many times the score of one sensor stands out from that of any other: what a model lacks shows in several."""

_EXPLAINS = 0.1
"""Part of what noise alone would gain that the sensor gains at least."""

_CORRECTED: frozenset[SensorQuantity] = frozenset({"x", "y", "delay"})
"""Unknowns that are corrected where a fit that leaves nothing takes them far off."""

FAR = 5.0
"""Standard uncertainties from which a sensor is not what is stated of it."""

_TELLS_GAIN = 0.1
"""Part of gravity at rest from which a sensor that feels it has shown its gain before any fit."""

_ITERATIONS = 22
"""Of the fit in which the unknown is free, at the most."""


class SensorError(NamedTuple):
    """What is wrong with one sensor.

    Attributes
    ----------
    channel
        Its channel.
    found
        Gain (the part by which it reads too much), or place (m further forward and left than stated), or delay (s), with
        standard uncertainties, by the unknown. Empty where none of them is all that is wrong.
    """

    channel: str
    found: Mapping[SensorQuantity, tuple[float, float]]


def furthest_from_stated(search: ModelSearch) -> tuple[float, str, SensorQuantity]:
    """Return the unknown of a sensor that a fit takes furthest from what is stated of it.

    Parameters
    ----------
    search
        A model and its fit.

    Returns
    -------
    tuple
        How far, in standard uncertainties with its sign, the channel, and which unknown; 0 where nothing of sensors is unknown.
    """
    distances = _distances(search)
    if not distances:
        return 0.0, "", "gain"
    channel, quantity = max(distances, key=lambda unknown: abs(distances[unknown]))
    return distances[channel, quantity], channel, quantity


def _distances(search: ModelSearch) -> dict[tuple[str, SensorQuantity], float]:
    """Return how far a fit takes each unknown of each sensor from what is stated of it, in standard uncertainties."""
    found = search.fit.parameters
    return {
        (sensor.channel, quantity): (found[name] - stated.value) / stated.std
        for sensor in search.structure.sensors
        for quantity in SENSOR_UNKNOWNS
        if (name := sensor_unknown(quantity, sensor.channel)) in found
        and (stated := sensor.uncertainties.get(name)) is not None
    }


def sensor_error_of_fit(search: ModelSearch) -> SensorError | None:
    """Return the error in place or time of the one sensor that a fit takes far from what is stated of it.

    A gain is not corrected by this: gravity at rest has not contradicted what is stated of it.

    Parameters
    ----------
    search
        A model and its fit, which leaves hardly more than noise.

    Returns
    -------
    SensorError or None
        None where none is far off, or not by much more than another one, or has been corrected before.
    """
    farthest, channel, quantity = furthest_from_stated(search)
    if quantity not in _CORRECTED or abs(farthest) < FAR or channel in _at_fault(search):
        return None
    others = max((abs(ratio) for (other, _), ratio in _distances(search).items() if other != channel), default=0.0)
    if abs(farthest) < _OUTSTANDING * others:
        return None
    together, statement, _ = _FREE[quantity]
    sensor = next(one for one in search.structure.sensors if one.channel == channel)
    found = {
        one: (search.fit.parameters[name], float(getattr(sensor, statement)))
        for one in together
        if (name := sensor_unknown(one, channel)) in search.fit.parameters
    }
    return SensorError(channel, found)


def find_sensor_error(search: ModelSearch) -> SensorError | None:
    """Find the one sensor that is in error by more than is stated of it, once a fit confirms it.

    Parameters
    ----------
    search
        A nonlinear model and its fit, of the decays or of their beginnings.

    Returns
    -------
    SensorError or None
        None where no sensor stands out, and where its error would explain too little.
    """
    if (spoilt := _still_at_fault(search)) is not None:
        return SensorError(spoilt, {})
    scores = _scores(search)
    ranked = sorted(scores, key=lambda unknown: -scores[unknown])
    if not ranked:
        return None
    channel, quantity = ranked[0]
    others = max((score for (other, _), score in scores.items() if other != channel), default=0.0)
    required = required_gain(1, len(scores), search.samples)
    if scores[ranked[0]] < max(required, _OUTSTANDING * others):
        return None
    together, statement, std = _FREE[quantity]
    present, free = (
        search.refit(structure, _ITERATIONS, beginning_only=True, enough=search.required_of_switch)
        for structure in (search.structure, _with_stated(search.structure, {statement: std}, channel))
    )
    # What is stated of the sensors gains as well: a fit may have pulled it far off to explain the recordings.
    gain = free.gain_over(present)
    # Where a term is missing any freedom gains something: a body that bends seems to have a sensor elsewhere.
    if gain < max(required, _EXPLAINS * search.unexplained_gain):
        return None
    lifted = lift_priors(free.fit, [sensor_unknown(one, channel) for one in together])
    # The uncertainty of the distance from what is stated counts that of the statement, which is none now.
    found = {
        one: (free.fit.parameters[name], float(np.sqrt(max(lifted[name][1] ** 2 - std**2, 0.0))))
        for one in together
        if (name := sensor_unknown(one, channel)) in lifted
    }
    return SensorError(channel, found) if quantity in found else None


def _still_at_fault(search: ModelSearch) -> str | None:
    """Return the channel that was corrected before and still leaves far more than any other one; None without any."""
    left = search.excess_over_noise
    worst = int(np.argmax(left))
    channel = search.structure.sensors[worst].channel
    stands_out = left[worst] > _OUTSTANDING**2 * np.delete(left, worst).max(initial=0.0)
    return channel if stands_out and channel in _at_fault(search) else None


def _scores(search: ModelSearch) -> dict[tuple[str, SensorQuantity], float]:
    """Return by channel and unknown the square of its distance from what is stated, over the variance of that distance."""
    # One that is corrected already has an unknown for what is left.
    at_fault = _at_fault(search)
    sensors = {one.channel: one for one in search.structure.sensors if one.channel not in at_fault}
    scored = search.refit(_with_stated(search.structure, _STATED), 0, beginning_only=True)
    quantities = {
        sensor_unknown(quantity, channel): (channel, quantity)
        for channel, sensor in sensors.items()
        for quantity in _FREE
        if quantity != "gain" or not _shows_gain(search, sensor)
    }
    lifted = lift_priors(scored.fit, [name for name in scored.fit.names if name in quantities])
    return {quantities[name]: (distance / std) ** 2 for name, (distance, std, _) in lifted.items()}


def _at_fault(search: ModelSearch) -> set[str]:
    """Return where faults were found and corrected before."""
    return {fault.where for fault in search.structure.campaign.faults}


def _shows_gain(search: ModelSearch, sensor: Sensor) -> bool:
    """Whether a sensor feels gravity at rest: with it, its gain was judged before anything was fitted."""
    channel = [one.channel for one in search.structure.sensors].index(sensor.channel)
    levels = [decay.rest.level[channel] for decay in search.decays]
    return sensor.reads_gravity and abs(float(np.median(levels))) > _TELLS_GAIN * STANDARD_GRAVITY


def _with_stated(structure: ModelStructure, least: Mapping[str, float], channel: str | None = None) -> ModelStructure:
    """State standard uncertainties of all sensors, or of one of them, that are no smaller than these."""
    sensors = tuple(
        replace(sensor, **{name: max(getattr(sensor, name), std) for name, std in least.items()})
        if channel in (None, sensor.channel)
        else sensor
        for sensor in structure.campaign.sensors
    )
    return replace(structure, campaign=replace(structure.campaign, sensors=sensors))

"""A body sensor that sits elsewhere than is stated."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis, Numbers, stated_place
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.faults.correction import Correction, describe_sensor
from sprung.vehicle import Row, Rows, Sensor

_MIRRORED = 0.1
"""Share of its distance from the centreline by which a place may miss the mirrored one."""


def position(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Estimate the place on the body: the reading is linear in it."""
    sensor = prediction.sensor
    if sensor.quantity in ("angular-rate", "force") or (sensor.relative_to is not None and sensor.position is None):
        return
    stated = sensor.position or (0.0, 0.0, 0.0)
    origin = replace(sensor, on="body", position=(0.0, 0.0, stated[2]))
    heave = prediction.row(origin) @ prediction.motion
    turning = Rows.of([Row({"theta": -1.0}), Row({"phi": 1.0})], prediction.candidate.fit.names)
    rotation = turning.at(prediction.candidate.fit.values) @ prediction.motion
    place = np.linalg.lstsq(rotation.T, prediction.record - heave, rcond=None)[0]

    def fault(numbers: Numbers, _: Numbers) -> Fault:
        return position_fault(sensor, *numbers)

    def correction(numbers: Numbers) -> Correction:
        x, y = numbers
        return describe_sensor(prediction.channel, replace(origin, position=(x, y, stated[2])))

    yield ChannelHypothesis(
        _code(sensor),
        fault,
        lambda: (tuple(place.tolist()), prediction.residual_of(heave + place @ rotation)),
        correction,
        stated[:2] if sensor.position else (),
    )


def position_fault(sensor: Sensor, x: float, y: float) -> Fault:
    """Return the fault of a sensor that shows the motion of the body at another place, m, than is stated."""
    what = f"the channel shows the motion of the body at x = {x:.2f} m, y = {y:.2f} m, not at {stated_place(sensor)}"
    stated = sensor.position
    if stated is not None and np.hypot(x - stated[0], y + stated[1]) < _MIRRORED * abs(stated[1]):
        what += ": left and right are exchanged"
    do = "Measure the place of the sensor and correct it in the campaign file."
    return Fault(_code(sensor), sensor.channel, what, do)


def _code(sensor: Sensor) -> str:
    return "wrong-wheel" if sensor.position is None else "position"

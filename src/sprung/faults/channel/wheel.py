"""A sensor that sits on another wheel than is stated."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis, Real, stated_place
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.faults.correction import Correction, describe_sensor


def wheel(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Put the sensor on each other wheel; what measures suspension travel does so at each other one."""
    stated = prediction.sensor
    if stated.quantity in ("angular-rate", "force"):
        return
    for station in prediction.candidate.campaign.layout.wheels:
        if station in (stated.wheel, stated.relative_to):
            continue
        there = {"on": station, "position": None} if stated.relative_to is None else {"relative_to": station}
        sensor = replace(stated, **there)
        what = f"the channel shows the motion of wheel {station}, not of {stated_place(stated)}"
        key = "on" if stated.relative_to is None else "relative_to"
        do = f"Correct {key} = ... in the campaign file, or move the sensor."
        fault = Fault("wrong-wheel", prediction.sensor.channel, what, do)
        residual = prediction.residual_of(prediction.row(sensor) @ prediction.motion)
        yield _on_wheel(fault, residual, describe_sensor(prediction.channel, sensor))


def _on_wheel(fault: Fault, residual: Real, correction: Correction) -> ChannelHypothesis:
    return ChannelHypothesis("wrong-wheel", lambda *_: fault, lambda: ((), residual), lambda _: correction)

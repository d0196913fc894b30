"""A channel whose gain is wrong: calibration, or a sensor that is tilted."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis, Numbers, figures
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.faults.correction import scale_channel

_LARGEST = 1.0
"""Logarithm of a gain up to which it may be one of calibration or tilt."""


def gain(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Estimate the gain, unless the reading at rest contradicts it."""

    def allows(numbers: Numbers) -> bool:
        (number,) = numbers
        return number > 0 and bool(abs(np.log(number)) < _LARGEST) and prediction.rest_allows(number)

    estimate = prediction.gain
    if not allows((estimate,)):
        return

    def fault(numbers: Numbers, _: Numbers) -> Fault:
        return gain_fault(prediction.sensor.channel, numbers[0])

    yield ChannelHypothesis(
        "gain",
        fault,
        lambda: ((estimate,), prediction.residual_of(estimate * prediction.stated)),
        lambda numbers: scale_channel(prediction.channel, 1 / numbers[0]),
        (1.0,),
        lambda numbers: numbers[0],
        allows=allows,
    )


def gain_fault(channel: str, gain: float) -> Fault:
    """Return the fault of a channel with a gain."""
    way = "high" if gain > 1 else "low"
    what = f"the channel reads {figures(100 * abs(gain - 1))} % too {way}, compared with the other channels"
    return Fault("gain", channel, what, "Check its calibration, its unit, and that the sensor is mounted vertically.")

"""A channel whose samples are in another unit than is stated."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.faults.correction import scale_channel
from sprung.units import STANDARD_GRAVITY

_UNITS = {"g": STANDARD_GRAVITY, "mm/s²": 1e-3, "cm/s²": 1e-2, "mg": STANDARD_GRAVITY / 1000, "ft/s²": 0.3048}
"""m/s² in each unit that may be taken for m/s², or m/s² for it."""

_NEAR = 0.5
"""Logarithm by which the estimated gain may miss that of a unit before the vehicle is fitted with it."""


def unit(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Take the samples to be in each other unit whose factor is near the estimated gain."""
    gain = prediction.gain
    if not gain > 0:
        return
    for factor, reading in _factors():
        if abs(np.log(gain / factor)) < _NEAR and prediction.gravity_allows(factor):
            yield _in_unit(prediction, factor, f"{reading}, as the comparison with the other channels shows")


def _in_unit(prediction: ChannelPrediction, factor: float, what: str) -> ChannelHypothesis:
    fault = Fault("unit", prediction.sensor.channel, what, "Correct its unit in the campaign file.")
    return ChannelHypothesis(
        "unit",
        lambda *_: fault,
        lambda: ((), prediction.residual_of(factor * prediction.stated)),
        lambda _: scale_channel(prediction.channel, 1 / factor),
        reading=lambda _: factor,
    )


def _factors() -> Iterator[tuple[float, str]]:
    """Yield by how much a channel reads too much where one unit is taken for another, and which."""
    for name, si in _UNITS.items():
        yield 1 / si, f"the samples are in {name}, not in m/s² as stated"
        yield si, f"the samples are in m/s², not in {name} as stated"

"""A channel whose samples are in another unit than is stated."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping

import numpy as np

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.faults.correction import scale_channel
from sprung.units import Quantity, si_factor, si_symbol
from sprung.vehicle import Sensor

_MISTAKEN: Mapping[Quantity, tuple[str, ...]] = {
    "acceleration": ("g", "mm/s²", "cm/s²", "mg", "ft/s²"),
    "velocity": ("mm/s", "cm/s", "km/h", "in/s"),
    "displacement": ("mm", "cm", "in"),
    "angular-rate": ("deg/s", "rpm"),
    "force": ("kN", "daN", "lbf"),
}
"""Units that may be taken for the SI unit, or that for them."""

_NEAR = 0.5
"""Logarithm by which the estimated gain may miss that of a unit before the vehicle is fitted with it."""


def unit(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Take the samples to be in each other unit whose factor is near the estimated gain."""
    gain = prediction.gain
    if not gain > 0:
        return
    for factor, reading in _factors(prediction.sensor):
        if abs(np.log(gain / factor)) < _NEAR and prediction.rest_allows(factor):
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


def _factors(sensor: Sensor) -> Iterator[tuple[float, str]]:
    """Yield by how much a channel reads too much where one unit is taken for another, and which.

    Of a unit that its file states, and the campaign does not, nothing is known but that the SI unit is one of both.
    """
    quantity, si = sensor.quantity, si_symbol(sensor.quantity)
    units = (si, *_MISTAKEN[quantity])
    pairs = itertools.product(units, units if sensor.unit is None else (sensor.unit,))
    for actual, stated in pairs:
        factor = si_factor(stated, quantity) / si_factor(actual, quantity)
        if factor != 1.0 and (sensor.unit is not None or si in (actual, stated)):
            yield factor, f"the samples are in {actual}, not in {stated} as stated"
    if sensor.unit is not None and (once := si_factor(sensor.unit, quantity)) != 1.0:
        yield 1 / once, f"the samples were converted from {si} to {sensor.unit} twice"

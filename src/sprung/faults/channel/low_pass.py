"""A channel that was recorded through another low-pass than the others."""

from __future__ import annotations

import math
from collections.abc import Iterator

from sprung.errors import Fault
from sprung.estimation import LowPass
from sprung.faults.channel.hypothesis import ChannelHypothesis, Numbers, Real, figures
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.faults.correction import Correction, advance_channel
from sprung.faults.low_pass import recorded_energy, undo_low_pass
from sprung.uncertainty import round_by_uncertainty

_ORDERS = {1: "first", 2: "second", 4: "fourth"}
"""Orders that are tried: one pole, the mechanics of a sensor or two poles, and the anti-alias filter of a logger."""

_LOWEST, _HIGHEST = 4.0, 400.0
"""Hz between which a corner is admitted: the hop of the wheels passes no lower one, and a higher one is a delay alone."""


def low_pass(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Estimate the corner frequency of a low-pass of each order."""
    for order in _ORDERS:
        yield _of_order(prediction, order)


def _of_order(prediction: ChannelPrediction, order: int) -> ChannelHypothesis:
    product = LowPass(1.0, order).delay

    def estimated() -> tuple[Numbers, Real]:
        found = prediction.low_pass(order)
        return (found.corner,), prediction.residual_of(prediction.through_low_pass(found))

    def fault(numbers: Numbers, stds: Numbers) -> Fault:
        std = 0.0 if not stds else stds[0] * numbers[0] ** 2 / product  # of a delay, s
        return low_pass_fault(prediction.sensor.channel, LowPass(numbers[0], order), std)

    def delayed(numbers: Numbers, steps: Numbers) -> Numbers:
        delay = product / numbers[0] + steps[0]
        return (product / delay if delay > 0 else math.inf,)

    def change(before: Numbers, after: Numbers) -> Correction:
        return advance_channel(prediction.channel, product / after[0] - product / before[0])

    return ChannelHypothesis(
        "low-pass",
        fault,
        estimated,
        lambda numbers: undo_low_pass(prediction.channel, LowPass(numbers[0], order)),
        (math.inf,),
        allows=lambda numbers: _LOWEST < numbers[0] < _HIGHEST,
        law=order,
        first_order="late",
        improve=delayed,
        change=change,
        recorded=lambda residual, rate, numbers: recorded_energy(residual, LowPass(numbers[0], order), rate),
    )


def low_pass_fault(channel: str, low_pass: LowPass, std: float = 0.0) -> Fault:
    """Return the fault of a channel with a low-pass that the others do not have; its corner has a standard uncertainty, Hz."""
    corner, error = round_by_uncertainty(low_pass.corner, std) if std > 0 else (figures(low_pass.corner), "")
    size = f"{corner} ± {error} Hz" if error else f"{corner} Hz"
    what = (
        f"the channel passed a low-pass that the other channels did not pass, of {_ORDERS[low_pass.order]} order, "
        f"with a corner frequency of {size}"
    )
    do = "Set the same low-pass for all channels, in the sensors and in the logger."
    return Fault("low-pass", channel, what, do)

"""A channel that is delayed against the others."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis, Numbers, Real, figures
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.faults.correction import advance_channel


def delay(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Estimate the delay."""
    row = prediction.row(prediction.sensor)

    def estimated() -> tuple[Numbers, Real]:
        number = prediction.delay(row)
        return (number,), prediction.residual_of(row @ prediction.delayed_motion(number)[0])

    def fault(numbers: Numbers, _: Numbers) -> Fault:
        return delay_fault(prediction.sensor.channel, numbers[0])

    yield ChannelHypothesis(
        "late",
        fault,
        estimated,
        lambda numbers: advance_channel(prediction.channel, numbers[0]),
        (0.0,),
    )


def delay_fault(channel: str, delay: float) -> Fault:
    """Return the fault of a channel with a delay, s."""
    way = "late" if delay > 0 else "early"
    what = f"the channel is {figures(1000 * abs(delay))} ms {way}, compared with the other channels"
    return Fault("late", channel, what, "Check the delays of the logger and its filters, channel by channel.")

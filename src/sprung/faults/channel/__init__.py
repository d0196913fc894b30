"""What may be wrong with one channel: one hypothesis per file.

A hypothesis predicts the channel from the motion of a vehicle that was fitted without it; its numbers (a gain, a delay, a
place, a corner frequency) follow from the records in closed form, and its residual tells how likely it is.
"""

from collections.abc import Iterator

from sprung.faults.channel.contradiction import contradiction
from sprung.faults.channel.copy import copy
from sprung.faults.channel.delay import delay
from sprung.faults.channel.drift import drift
from sprung.faults.channel.flat import flat
from sprung.faults.channel.gain import gain
from sprung.faults.channel.high_pass import high_pass
from sprung.faults.channel.hypothesis import ChannelHypothesis, Numbers
from sprung.faults.channel.low_pass import low_pass
from sprung.faults.channel.position import position
from sprung.faults.channel.sign import sign
from sprung.faults.channel.unit import unit
from sprung.faults.channel.wheel import wheel
from sprung.faults.channel_prediction import ChannelPrediction

CHANNEL_HYPOTHESES = (sign, unit, gain, delay, low_pass, high_pass, wheel, position, drift, copy, contradiction)
"""Each takes a `ChannelPrediction` and yields hypotheses."""


def channel_hypotheses(prediction: ChannelPrediction, noise: float) -> Iterator[ChannelHypothesis]:
    """Yield all hypotheses about a channel.

    Parameters
    ----------
    prediction
        Of the channel.
    noise
        Of it at rest, m/s².

    Yields
    ------
    ChannelHypothesis
        Of a channel that shows no motion, that it is flat, or holds the samples of another one: no number follows from it.
    """
    silent = flat(prediction, noise)
    if silent is not None:
        yield silent
    for hypotheses in CHANNEL_HYPOTHESES if silent is None else (copy,):
        yield from hypotheses(prediction)


__all__ = ["CHANNEL_HYPOTHESES", "ChannelHypothesis", "Numbers", "channel_hypotheses"]

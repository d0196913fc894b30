"""What may be wrong with one channel: one hypothesis per file.

A hypothesis predicts the channel from the motion of a vehicle that was fitted without it; its numbers (a gain, a delay, a
place, a corner frequency) follow from the records in closed form, and its residual tells how likely it is.
"""

from sprung.faults.channel.contradiction import contradiction
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

CHANNEL_HYPOTHESES = (sign, unit, gain, delay, low_pass, high_pass, wheel, position, drift, contradiction)
"""Each takes a `ChannelPrediction` and yields hypotheses; a channel that is `flat` is nothing else."""

__all__ = ["CHANNEL_HYPOTHESES", "ChannelHypothesis", "Numbers", "flat"]

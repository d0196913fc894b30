"""A channel that holds the samples of another one."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis, Numbers, Real
from sprung.faults.channel_prediction import ChannelPrediction


def copy(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Compare the channel with each other one of the same quantity."""
    own = prediction.sensor
    for channel, sensor in enumerate(prediction.candidate.campaign.sensors):
        is_other = channel != prediction.channel and sensor.quantity == own.quantity
        if is_other and all(decay.usable[channel] for decay in prediction.decays):
            what = f"the channel has the samples of {sensor.channel}"
            do = "Check which input of the logger each channel was recorded from."
            fault = Fault("copy", own.channel, what, do)
            yield _copy_of(prediction, channel, fault)


def _copy_of(prediction: ChannelPrediction, channel: int, fault: Fault) -> ChannelHypothesis:
    # Nothing of the sensor was recorded: there is nothing to correct, and the channel is left out.
    return ChannelHypothesis("copy", lambda *_: fault, partial(_left_by, prediction, channel))


def _left_by(prediction: ChannelPrediction, channel: int) -> tuple[Numbers, Real]:
    """Return no number, and what the samples of another channel leave of the record."""
    others = [decay.values[channel] for decay in prediction.decays]
    return (), prediction.residual_of(np.concatenate([values - values.mean() for values in others]))

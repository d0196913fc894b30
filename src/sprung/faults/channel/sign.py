"""A sensor that is mounted upside down, or whose polarity is inverted."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.faults.correction import scale_channel


def sign(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Invert the polarity, unless the reading at rest shows that it is right."""
    if not prediction.rest_allows(-1.0):
        return
    fault = sign_fault(prediction.sensor.channel)
    yield ChannelHypothesis(
        "sign",
        lambda *_: fault,
        lambda: ((), prediction.residual_of(-prediction.stated)),
        lambda _: scale_channel(prediction.channel, -1.0),
    )


def sign_fault(channel: str) -> Fault:
    """Return the fault of a channel whose polarity is inverted."""
    what = "the polarity is inverted relative to the other channels"
    do = "State the sensor the other way up in the campaign file, or turn it over."
    return Fault("sign", channel, what, do)

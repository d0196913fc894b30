"""A channel that contradicts all others, whatever it measures."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis, Real
from sprung.faults.channel_prediction import ChannelPrediction


def contradiction(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Take the channel for unrelated to the motion, or for any linear function of it."""
    if prediction.drifts:
        return
    yield _unlike(prediction, "the channel shows something else than the motion that the other channels show", 0)
    row = np.asarray(np.linalg.lstsq(prediction.motion.T, prediction.record, rcond=1e-9)[0], dtype=np.float64)
    yield _unlike(prediction, "the channel contradicts the other channels at every possible place", len(row), row)


def _unlike(prediction: ChannelPrediction, what: str, free: int, row: Real | None = None) -> ChannelHypothesis:
    do = "Check the sensor, its cable and how it is fastened."
    fault = Fault("unlike-others", prediction.sensor.channel, what, do)
    predicted = 0.0 * prediction.record if row is None else row @ prediction.motion
    return ChannelHypothesis(
        "unlike-others", lambda *_: fault, lambda: ((), prediction.residual_of(predicted)), free=free
    )

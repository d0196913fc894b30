"""A channel whose baseline drifts."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis
from sprung.faults.channel_prediction import ChannelPrediction

DRIFT_DO = "Let sensor and logger warm up before the test, and check that nothing strains the base of the sensor."


def drift(prediction: ChannelPrediction) -> Iterator[ChannelHypothesis]:
    """Take the residual of the channel for a drift, where it is as slow as one."""
    if not prediction.drifts:
        return
    residual, free = prediction.drift
    fault = Fault("drift", prediction.sensor.channel, "the baseline drifts, compared with the other channels", DRIFT_DO)
    yield ChannelHypothesis("drift", lambda *_: fault, lambda: ((), residual), free=free)

"""A channel that shows no motion."""

from __future__ import annotations

import numpy as np

from sprung.errors import Fault
from sprung.faults.channel.hypothesis import ChannelHypothesis
from sprung.faults.channel_prediction import ChannelPrediction

_SILENT = 3.0
"""Noise at rest up to which the whole record is no motion."""

_SHARE = 0.25
"""Share of the energy that a channel should show, below which it shows none."""

_SCORE = 25.0
"""Square of the standard errors that the predicted motion may have in the record by chance."""


def flat(prediction: ChannelPrediction, noise: float) -> ChannelHypothesis | None:
    """Return the hypothesis that the channel shows nothing but noise; None where it shows motion.

    Parameters
    ----------
    prediction
        Of the channel.
    noise
        Of it at rest, m/s².
    """
    stated, energy = prediction.stated, prediction.energy
    expected = float(stated @ stated)
    projected = float(prediction.record @ stated) ** 2 / max(expected, np.finfo(float).tiny)
    is_silent = (energy / prediction.record.size) ** 0.5 < _SILENT * noise and projected < _SCORE * noise**2
    if not is_silent or energy >= _SHARE * expected:
        return None
    what = "the channel shows no motion where the other channels show motion"
    fault = Fault("flat", prediction.sensor.channel, what, "Check the sensor, its cable and how it is fastened.")
    residual = prediction.residual_of(0.0 * prediction.record)
    return ChannelHypothesis("flat", lambda *_: fault, lambda: ((), residual))

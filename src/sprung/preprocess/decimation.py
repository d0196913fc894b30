"""Decimation: a recording with far more samples than a vehicle's motion needs is low-passed and thinned out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.signal import resample_poly

from sprung.campaign import Recording

_ENOUGH, _MANY = 1000.0, 3000.0
"""Samples per second that are kept at least, and from which a recording is decimated: wheels hop at 8 to 20 Hz."""


def decimate(recording: Recording) -> Recording:
    """Decimate a recording that has been sampled very fast; the same filter passes all channels without delay.

    Parameters
    ----------
    recording
        As it was read; one of several loggers is left as it is.

    Returns
    -------
    Recording
        With at least a thousand samples per second.
    """
    every = int(recording.rate // _ENOUGH)
    if recording.rate < _MANY or recording.parts or recording.clocks or recording.values.shape[1] < 100 * every:
        return recording
    usable = recording.usable
    thinned = np.full((len(recording.values), -(-recording.values.shape[1] // every)), np.nan)
    thinned[usable] = resample_poly(recording.values[usable], 1, every, axis=1, padtype="line")
    done = f"every {every}th sample used, behind a low-pass that is the same in all channels"
    return replace(recording, values=thinned, rate=recording.rate / every, history=(*recording.history, done))

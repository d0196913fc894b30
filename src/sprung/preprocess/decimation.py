"""Decimation: of a recording with far more samples than a vehicle's motion needs, means of neighbouring samples are used."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sprung.campaign import Recording

_ENOUGH, _MANY = 1000.0, 2000.0
"""Samples per second that are kept at least, and from which a recording is decimated: wheels hop at 8 to 20 Hz."""


def decimate(recording: Recording) -> Recording:
    """Decimate a recording that has been sampled very fast, the same way in all channels.

    Parameters
    ----------
    recording
        As it was read; one of several loggers is left as it is.

    Returns
    -------
    Recording
        With at least a thousand samples per second.

    Notes
    -----
    Means of samples that do not overlap leave white noise white, and a release or a landing where it is: a steeper low-pass
    rings around them. What they do not suppress lies near multiples of the new rate at the least, far from any motion of a
    vehicle, and they hardly change what is slow: at 20 Hz by 0.07 % (Hogenauer, IEEE Trans. ASSP 29 (1981) 155).
    """
    every = int(recording.rate // _ENOUGH)
    if recording.rate < _MANY or recording.parts or recording.clocks or recording.values.shape[1] < 100 * every:
        return recording
    number = recording.values.shape[1] // every
    means = recording.values[:, : number * every].reshape(len(recording.values), number, every).mean(axis=2)
    return replace(
        recording,
        values=np.ascontiguousarray(means),
        start=recording.start + (every - 1) / (2 * recording.rate),
        rate=recording.rate / every,
        history=(*recording.history, f"mean of every {every} samples used"),
    )

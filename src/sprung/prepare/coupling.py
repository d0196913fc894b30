"""AC-coupled sensors: what a first-order high-pass took away is put back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.integrate import cumulative_trapezoid

from sprung.prepare.release import Release
from sprung.recording import Recording
from sprung.vehicle import Sensor


def direct_coupled(recording: Recording, release: Release, sensors: Sequence[Sensor]) -> Recording:
    """Give the recording as sensors without a high-pass would have made it.

    Parameters
    ----------
    recording
        As it was read.
    release
        The release in it: at rest before it, the filter had settled.
    sensors
        One for each channel; those with a `high_pass` are undone.

    Returns
    -------
    Recording

    Notes
    -----
    A first-order high-pass with the corner ω turns x into y with ẏ + ω y = ẋ, so x is y + ω ∫ y dt.
    """
    values = recording.values
    history = []
    for channel, sensor in enumerate(sensors):
        if sensor.high_pass is not None and recording.usable[channel]:
            left = values[channel] - release.rest.level[channel]
            lost = 2 * np.pi * sensor.high_pass * cumulative_trapezoid(left, dx=1 / recording.rate, initial=0)
            values = np.vstack([values[:channel], values[channel] + lost, values[channel + 1 :]])
            history.append(f"{sensor.channel}: high-pass of {sensor.high_pass:g} Hz undone")
    return replace(recording, values=values, history=(*recording.history, *history)) if history else recording

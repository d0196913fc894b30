"""The passage over a bump: front wheels meet it first, rear wheels a wheelbase later, which tells the speed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.signal import correlate

from sprung.campaign import Campaign, DropTest
from sprung.errors import Fault
from sprung.vehicle import STATIONS

Real = NDArray[np.float64]

_SMOOTH = 0.02
"""s over which the size of a wheel's motion is averaged."""

_CLEAR = 5.0
"""Largest over usual size of a wheel's motion that shows a bump."""

_TOLERANCE = 0.15
"""Part by which a stated speed may differ from the recorded one."""

_KILOMETRES_PER_HOUR = 3.6


def measure_delay(drop: DropTest, campaign: Campaign) -> float | None:
    """Measure by how much later the rear wheels meet a bump than the front wheels.

    Parameters
    ----------
    drop
        With its recording, corrected.
    campaign
        Its sensors.

    Returns
    -------
    float or None
        s, negative where the rear wheels meet it first; None where the wheels' sensors do not show it.
    """
    recording = drop.recording
    sizes: dict[float, list[Real]] = {1.0: [], -1.0: []}
    for channel, sensor in enumerate(campaign.sensors):
        end = 0.0 if sensor.wheel is None else STATIONS[sensor.wheel].end
        if end and sensor.reads_gravity and recording.usable[channel]:
            moved = recording.values[channel] - np.median(recording.values[channel])
            size = uniform_filter1d(np.abs(moved), max(round(_SMOOTH * recording.rate), 1))
            if size.max() > _CLEAR * np.median(size):
                sizes[end].append(size)
    if not (sizes[1.0] and sizes[-1.0]):
        return None
    # Of a wheel on the side without a bump there is little in the sum.
    front, rear = (np.sum(own, axis=0) for own in sizes.values())
    alike = correlate(rear, front, mode="full", method="fft")
    return float(int(np.argmax(alike)) - (front.size - 1)) / recording.rate


def check_speed(campaign: Campaign, drop: DropTest) -> list[Fault]:
    """Compare the stated speed of a pass with the delay between its front and rear wheels.

    Parameters
    ----------
    campaign
        Its sensors and wheelbase.
    drop
        With its recording, corrected.

    Returns
    -------
    list of Fault
        One where they contradict each other; nothing depends on the speed.
    """
    if drop.excitation != "pass" or campaign.wheelbase is None:
        return []
    delay, wheelbase, where = measure_delay(drop, campaign), campaign.wheelbase.value, drop.recording.name
    if delay is None:
        return []
    if delay < 0:
        what = f"the rear wheels meet the bump {-delay:.2f} s before the front wheels"
        do = "See that front and rear sensors are not exchanged; a vehicle that is driven backwards needs nothing else."
        return [Fault("speed", where, what, do)]
    if drop.speed is None or abs(delay * drop.speed / wheelbase - 1) < _TOLERANCE or not delay:
        return []
    shown = wheelbase / delay
    what = (
        f"the rear wheels meet the bump {delay:.3g} s after the front wheels, which with a wheelbase of {wheelbase:.4g} m is "
        f"{shown:.3g} m/s; {drop.speed:g} m/s is stated. The stated speed is not used"
    )
    meant = drop.speed / _KILOMETRES_PER_HOUR
    is_per_hour = abs(meant / shown - 1) < _TOLERANCE
    kmh = f"{drop.speed:g} km/h are {meant:.3g} m/s" if is_per_hour else f"it is read in m/s, not in km/h: {shown:.3g}"
    return [Fault("speed", where, what, f"Correct speed = ... of this drop: {kmh}.")]

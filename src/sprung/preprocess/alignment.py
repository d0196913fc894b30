"""Alignment: the recordings of several loggers with clocks of their own put on one clock by the release."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import CLOCK_STD, Recording, merge_loggers
from sprung.errors import Fault
from sprung.preprocess.release import detect_release

_PEAK_OVER_NOISE = 8.0
"""Peak over noise from which the release of one logger counts: others recorded it too, so that it need not be so clear."""

_LARGE = 3.0
"""m/s² from rest: a sensor above or on a wheel that falls reads more, and shows the release at once."""

_SHORTEST = 0.2
"""s that the recordings of all loggers must have in common."""

_CLEAR_STD = 0.005
"""Standard uncertainty of the moment of the release where a logger's sensors show it at once, s."""


def align_loggers(recording: Recording) -> Recording:
    """Align the recordings of several loggers to within some milliseconds; the fit estimates what remains.

    Parameters
    ----------
    recording
        Of one logger it is returned as it is. Clock offsets that are known already are used as they are.

    Returns
    -------
    Recording
        Without the channels of loggers that show no release, for which there is a fault.
    """
    if not recording.parts:
        return recording
    known = {clock.name: (clock.offset, clock.delay_std) for clock in recording.clocks}
    synchronised = any(clock.delay_std < CLOCK_STD for clock in recording.clocks)
    releases = [known.get(part.name) if synchronised else _release_of(part) for part in recording.parts]
    if not any(releases):  # nothing ties the clocks but that all loggers were started
        return recording
    faults = [
        Fault(
            "clock",
            f"{recording.name}: {part.name}",
            "no motion above the noise after the release, so its clock cannot be aligned with the others; "
            f"{', '.join(part.channels)} left out of this drop",
            "Start every logger before the release. The sensor of a wheel that was not dropped is no loss.",
        )
        for part, release in zip(recording.parts, releases, strict=True)
        if release is None and part.usable.any()
    ]
    aligned = merge_loggers(recording, [None if release is None else release[0] for release in releases])
    if aligned.values.shape[1] < _SHORTEST * aligned.rate:
        what = f"the recordings of its loggers overlap by less than {_SHORTEST:g} s; the drop is left out"
        fault = Fault("clock", recording.name, what, "Name the files of one and the same drop, each of some seconds.")
        nothing = np.full_like(recording.values, np.nan)
        return replace(recording, values=nothing, faults=(*recording.faults, fault))
    stds = [release[1] for release in releases if release is not None]
    clocks = tuple(replace(clock, delay_std=std) for clock, std in zip(aligned.clocks, stds, strict=True))
    return replace(aligned, clocks=clocks, faults=(*recording.faults, *faults))


def active_channels(recording: Recording) -> NDArray[np.bool_]:
    """Return which channels show the moment of the release: of several loggers those with a clear one; shape (channel,)."""
    active = np.ones(len(recording.channels), dtype=bool)
    for clock in recording.clocks:
        active[list(clock.channels)] = clock.delay_std <= _CLEAR_STD
    return active if (active & recording.usable).any() else np.ones_like(active)


def _release_of(part: Recording) -> tuple[float, float] | None:
    """Return when a logger first recorded motion, s on its own clock, and the standard uncertainty of that, s."""
    found = detect_release(part.values, part.rate, _PEAK_OVER_NOISE)
    if found is None:
        return None
    peak = np.nanmax(np.abs(part.values - found.level[:, None]))
    return part.start + found.sample / part.rate, _CLEAR_STD if peak > _LARGE else CLOCK_STD

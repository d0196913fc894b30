"""Several loggers of one drop, whose clocks know nothing of each other, put on one clock by the release they all saw."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import CLOCK_STD, Recording, merge_loggers
from sprung.errors import Fault
from sprung.preprocess.release import detect_release

_STANDS_OUT = 8.0
"""Peak over noise from which one logger's release is believed: others saw it too, so that it need not be so clear."""

_LIVELY = 3.0
"""m/s² from rest: what rests above or on a wheel that falls reaches more, and shows the release at once."""

_SHORTEST = 0.2
"""s that all loggers must have in common for there to be anything to look at."""

_TOLD = 0.005
"""s to which such a logger has told it."""


def align_loggers(recording: Recording) -> Recording:
    """Put what several loggers recorded on one clock, to within some milliseconds: the fit finds the rest.

    Parameters
    ----------
    recording
        Of one logger it is given back as it is. Where its clocks are known already, they are taken as they are.

    Returns
    -------
    Recording
        Without the channels of loggers that show no release; a fault says so.
    """
    if not recording.parts:
        return recording
    known = {clock.name: _Told(clock.offset, clock.delay_std) for clock in recording.clocks}
    set_before = any(clock.delay_std < CLOCK_STD for clock in recording.clocks)
    told = [known.get(part.name) if set_before else _release(part) for part in recording.parts]
    if not any(told):  # nothing but that they were all started has tied them
        return recording
    faults = [
        Fault(
            "clock",
            f"{recording.name}: {part.name}",
            f"its sensors show no motion clear of their noise after the release, which alone would tie its clock to the "
            f"others; {', '.join(part.channels)} left out of this drop",
            "Start every logger before the release. Of a wheel that did not fall, nothing is lost.",
        )
        for part, moment in zip(recording.parts, told, strict=True)
        if moment is None and part.usable.any()
    ]
    together = merge_loggers(recording, [None if one is None else one.moment for one in told])
    if together.values.shape[1] < _SHORTEST * together.rate:
        what = "the recordings of its loggers overlap too little; the drop is left out"
        fault = Fault("clock", recording.name, what, "Name the files of one and the same drop, each of some seconds.")
        nothing = np.full_like(recording.values, np.nan)
        return replace(recording, values=nothing, faults=(*recording.faults, fault))
    stds = iter([one.std for one in told if one is not None])
    clocks = tuple(replace(clock, delay_std=next(stds)) for clock in together.clocks)
    return replace(together, clocks=clocks, faults=(*recording.faults, *faults))


def active_channels(recording: Recording) -> NDArray[np.bool_]:
    """Say which channels tell the release: of several loggers those that showed it at once; shape (channel,)."""
    told = np.ones(len(recording.channels), dtype=bool)
    for clock in recording.clocks:
        told[list(clock.channels)] = clock.delay_std <= _TOLD
    return told if (told & recording.usable).any() else np.ones_like(told)


class _Told(NamedTuple):
    """A moment that is the same for all loggers, s on one's own clock, and how sure that is, s."""

    moment: float
    std: float


def _release(part: Recording) -> _Told | None:
    """Find when a logger first moved."""
    if not part.usable.any():
        return None
    values = part.values[part.usable]
    found = detect_release(values, part.rate, _STANDS_OUT)
    if found is None:
        return None
    peak = np.abs(values - found.rest.level[:, None]).max()
    return _Told(part.start + found.sample / part.rate, _TOLD if peak > _LIVELY else CLOCK_STD)

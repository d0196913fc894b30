"""Flight: a drop from just after its release on, when the tyres that fell have yet to come down."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sprung.preprocess.decay import FreeDecay
from sprung.preprocess.events import DropObservation
from sprung.vehicle import Wheel

_CLEAR = 0.01
"""s after the release by which the blocks are out of the way."""

FROM_RELEASE = "the blocks are out of the way, and the fall is used too"
"""Why a drop that is used from its release on starts where it does."""


class Flight(NamedTuple):
    """A drop from just after its release on.

    Attributes
    ----------
    decay
        With the samples from then on.
    wheels
        Which wheels fell.
    height
        Of the blocks, m; None where nobody wrote it down.
    since
        Time of the first sample, s after the release.
    """

    decay: FreeDecay
    wheels: tuple[Wheel, ...]
    height: float | None
    since: float


def find_flights(decays: Sequence[FreeDecay], seen: Sequence[DropObservation]) -> list[Flight | None]:
    """Give drops from just after their releases on.

    Parameters
    ----------
    decays
        Their decays, as they are used.
    seen
        What the recording of every drop of the campaign shows.

    Returns
    -------
    list of Flight or None
        For each decay; None where the fall cannot be used: no release was found, somebody said from when on the drop is to be
        used, several loggers recorded it, or samples of the fall were clipped or mended.
    """
    by_file = {observation.recording.name: observation for observation in seen}
    return [_flight(decay, by_file[decay.file]) for decay in decays]


def _flight(decay: FreeDecay, seen: DropObservation) -> Flight | None:
    drop, recording, release = seen.drop, seen.recording, seen.release
    if release is None or drop.start is not None or decay.clocks or recording.rate != decay.rate:
        return None
    first = release + math.ceil(_CLEAR * decay.rate)
    begin = round((decay.start - recording.start) * decay.rate)
    if not first < begin or any(np.any((mark.samples >= release) & (mark.samples <= begin)) for mark in seen.marks):
        return None
    whole = recording.values[:, first : begin + decay.samples]
    values = np.where(decay.usable[:, None], whole, np.nan)
    if np.isnan(values[decay.usable]).any():
        return None
    start = recording.start + first / decay.rate
    events = replace(decay.events, why_fit=FROM_RELEASE)
    return Flight(
        replace(decay, values=values, earlier=values[:, :0], start=start, events=events),
        seen.wheels,
        drop.height,
        (first - release) / decay.rate,
    )

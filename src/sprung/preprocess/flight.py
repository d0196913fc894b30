"""Flight: a drop from just after its release on, while the tyres that fell are off the ground."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sprung.preprocess.decay import FreeDecay
from sprung.preprocess.events import DropObservation

_CLEAR = 0.01
"""s after the release by which the blocks are out of the way."""

FROM_RELEASE = "the blocks are out of the way, and the fall is used too"
"""Reason for the start of a drop that is used from its release on."""


def find_flights(decays: Sequence[FreeDecay], observations: Sequence[DropObservation]) -> list[FreeDecay | None]:
    """Find the drops that can be used from just after their release on.

    Parameters
    ----------
    decays
        Their decays, as they are used.
    observations
        Of every drop of the campaign.

    Returns
    -------
    list of FreeDecay or None
        Each decay with the samples from then on; None where the fall cannot be used: no release was detected, the campaign
        states the start, several loggers recorded the drop, or samples of the fall were clipped or replaced.
    """
    by_file = {observation.recording.name: observation for observation in observations}
    return [_flight(decay, by_file[decay.file]) for decay in decays]


def _flight(decay: FreeDecay, observation: DropObservation) -> FreeDecay | None:
    drop, recording, release = observation.drop, observation.recording, observation.release
    if release is None or drop.is_driven or drop.start is not None or decay.clocks or recording.rate != decay.rate:
        return None
    first = release + math.ceil(_CLEAR * decay.rate)
    begin = round((decay.start - recording.start) * decay.rate)
    if not first < begin or any(
        np.any((mark.samples >= release) & (mark.samples <= begin)) for mark in observation.marks
    ):
        return None
    whole = recording.values[:, first : begin + decay.samples]
    values = np.where(decay.usable[:, None], whole, np.nan)
    if np.isnan(values[decay.usable]).any():
        return None
    start = recording.start + first / decay.rate
    events = replace(decay.events, why_fit=FROM_RELEASE)
    return replace(decay, values=values, earlier=values[:, :0], start=start, events=events)

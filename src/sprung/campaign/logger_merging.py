"""Several loggers, each with a clock and a rate of its own, put on one clock as far as anybody knows how they stand."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from sprung.campaign.recording import LoggerClock, Recording
from sprung.formats import interpolate

SAME_RATE = 1.5e-4
"""Part by which rates may differ to be one: crystals differ by less, and times written in ms tell it no better."""


def merge_loggers(whole: Recording, moments: Sequence[float | None]) -> Recording:
    """Merge the recordings of several loggers on the clock of the first one whose offset is known.

    Samples are left as they were taken where a logger has the fastest rate; to less than a step its clock then stands
    elsewhere, which the fit finds. Slower loggers are interpolated.

    Parameters
    ----------
    whole
        A recording with parts.
    moments
        One moment on each part's own clock, the same for all of them, s; None for those that nobody can tell.

    Returns
    -------
    Recording
        With values over the time that all these loggers recorded; NaN in the channels of the others.
    """
    known = [(part, moment) for part, moment in zip(whole.parts, moments, strict=True) if moment is not None]
    empty = np.full((len(whole.channels), 0), np.nan)
    if not known:
        return Recording(whole.name, whole.channels, empty, 0.0, 1.0, whole.history, whole.faults, whole.parts)
    reference = known[0][1]
    rate = max(part.rate for part, _ in known)
    rate = next(part.rate for part, _ in known if abs(part.rate / rate - 1) < SAME_RATE)
    first = max(part.start - moment for part, moment in known)
    last = min(float(part.time[-1]) - moment for part, moment in known)
    there = [part.values.shape[1] for part, _ in known if abs(part.rate / rate - 1) < SAME_RATE]
    samples = max(min(int((last - first) * rate * (1 + 1e-9)) + 1, *there), 0)
    values = np.full((len(whole.channels), samples), np.nan)
    clocks = []
    for part, moment in known:
        channels = [whole.channels.index(channel) for channel in part.channels]
        same = abs(part.rate / rate - 1) < SAME_RATE
        # The sample next to the first common moment, which is to come at the recording's first one.
        begin = max(min(round((first - part.start + moment) * part.rate), part.values.shape[1] - samples), 0) * same
        shift = part.start + begin / part.rate - (first + reference) if same else moment - reference
        if samples:
            values[channels] = (
                part.values[:, begin : begin + samples] if same else _resampled(part, first + moment, rate, samples)
            )
        clocks.append(LoggerClock(part.name, tuple(channels), shift, 1.0 if same else min(part.rate / rate, 1.0)))
    return Recording(
        name=whole.name,
        channels=whole.channels,
        values=values,
        start=first + reference,
        rate=rate,
        history=(*whole.history, *chain.from_iterable(part.history for part in whole.parts)),
        faults=whole.faults,
        parts=whole.parts,
        clocks=tuple(clocks),
        full_scale=_full_scales(whole),
        rate_ratios=_rate_ratios(whole),
    )


def _rate_ratios(whole: Recording) -> tuple[float, ...]:
    """Return the rate ratio of each channel within its logger's file; empty where it is 1 for all."""
    of_channels = {
        channel: ratio for part in whole.parts for channel, ratio in zip(part.channels, part.rate_ratios, strict=False)
    }
    return tuple(of_channels.get(channel, 1.0) for channel in whole.channels) if of_channels else ()


def _full_scales(whole: Recording) -> tuple[float | None, ...]:
    """Return the full scale of each channel, m/s²; None where neither its logger nor its sensor states one."""
    of_channels = {
        channel: size for part in whole.parts for channel, size in zip(part.channels, part.full_scale, strict=False)
    }
    return tuple(of_channels.get(channel) for channel in whole.channels)


def _resampled(part: Recording, start: float, rate: float, samples: int) -> NDArray[np.float64]:
    """Return the channels of a slower logger at other times of its own clock; shape (channel, time)."""
    values, taken = np.full((len(part.channels), samples), np.nan), part.time
    # The logger that began last or ended first did so at one of these times, but for rounding.
    times = np.clip(start + np.arange(samples) / rate, taken[0], taken[-1])
    values[part.usable] = interpolate(part.values[part.usable], taken, times)
    return values

"""Recordings of several loggers, each with a clock and a rate of its own, merged on one clock."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from sprung.campaign.recording import LoggerClock, Recording
from sprung.formats import interpolate

SAME_RATE = 1.5e-4
"""Relative difference up to which two rates are equal: that of quartz clocks is less, and times in ms resolve no more."""


def merge_loggers(whole: Recording, moments: Sequence[float | None]) -> Recording:
    """Merge the recordings of several loggers on the clock of the first one whose offset is known.

    The samples of loggers with the fastest rate are not interpolated: their clocks are aligned to less than a step, and the
    rest is estimated by the fit. Slower loggers are interpolated.

    Parameters
    ----------
    whole
        A recording with parts.
    moments
        Time of one common event on each part's own clock, s; None where it is unknown.

    Returns
    -------
    Recording
        Over the time that all these loggers recorded; NaN in the channels of the others.
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
    lengths = [part.values.shape[1] for part, _ in known if abs(part.rate / rate - 1) < SAME_RATE]
    samples = max(min(int((last - first) * rate * (1 + 1e-9)) + 1, *lengths), 0)
    values = np.full((len(whole.channels), samples), np.nan)
    clocks = []
    for part, moment in known:
        channels = [whole.channels.index(channel) for channel in part.channels]
        is_fastest = abs(part.rate / rate - 1) < SAME_RATE
        # The sample nearest to the first common time, which becomes the first of the recording.
        begin = (
            max(min(round((first - part.start + moment) * part.rate), part.values.shape[1] - samples), 0) * is_fastest
        )
        shift = part.start + begin / part.rate - (first + reference) if is_fastest else moment - reference
        if samples:
            values[channels] = (
                part.values[:, begin : begin + samples]
                if is_fastest
                else _resampled(part, first + moment, rate, samples)
            )
        clocks.append(LoggerClock(part.name, tuple(channels), shift, 1.0 if is_fastest else min(part.rate / rate, 1.0)))
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
    values, own_time = np.full((len(part.channels), samples), np.nan), part.time
    # The logger that began last or ended first did so at one of these times, but for rounding.
    times = np.clip(start + np.arange(samples) / rate, own_time[0], own_time[-1])
    values[part.usable] = interpolate(part.values[part.usable], own_time, times)
    return values

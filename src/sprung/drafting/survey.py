"""A survey of a recording: which of its columns are vertical accelerations, its rate and length, and how large they get."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from sprung.drafting.channel import Channel, channel_of, disambiguate_units
from sprung.drafting.names import axis_named
from sprung.errors import Problem

if TYPE_CHECKING:
    from sprung.formats import SampleTable

Real = NDArray[np.float64]

_SPOTS, _SPOT = 60, 0.5
"""Stretches of a recording that its rest is looked for in, and how long each is, s."""

_SHORT = 0.01
"""s over which readings are averaged, so that a spike is not taken for the size of what was recorded."""

_PLATEAU = 3
"""Samples in a row at a channel's extreme that show its full scale."""

_PIECE = 1 << 17
"""Samples that are read together."""


@dataclass(frozen=True, eq=False)
class Survey:
    """What a recording's channels are.

    Attributes
    ----------
    channels
        The vertical accelerations, and their columns in the table.
    columns
        Of those channels.
    left_out
        The other channels, and why each is none.
    rate
        Samples per second.
    start, end
        s on the file's clock.
    samples
        How many.
    """

    channels: tuple[Channel, ...]
    columns: tuple[int, ...]
    left_out: dict[str, str]
    rate: float
    start: float
    end: float
    samples: int


def survey(table: SampleTable) -> Survey:
    """Tell what the channels of a recording are.

    Parameters
    ----------
    table
        The recording.

    Returns
    -------
    Survey
    """
    samples = table.samples
    clock = table.clock
    if isinstance(clock, np.ndarray):
        rate = 1 / float(np.median(np.diff(clock))) if samples > 1 else float("nan")
        start, end = float(clock[0]), float(clock[-1])
    else:
        rate, start, end = clock, 0.0, (samples - 1) / clock
    begins, spots = _spots(table, rate)
    channels, columns, left_out = [], [], {}
    for column, (name, written) in enumerate(zip(table.channels, table.units, strict=True)):
        own = spots[:, column]
        if (problem := _spoilt(table, column, begins, own)) is not None:
            left_out[name] = f"it holds {problem.found}"
            continue
        axis = axis_named(name, table.channels)
        found = (
            f"it measures along {axis}, beside one along z" if axis in ("x", "y") else channel_of(name, written, own)
        )
        if isinstance(found, Channel):
            channels.append(found)
            columns.append(column)
        else:
            left_out[name] = found
    return Survey(disambiguate_units(channels), tuple(columns), left_out, rate, start, end, samples)


def _spots(table: SampleTable, rate: float) -> tuple[list[int], Real]:
    """Take some short stretches of all channels: the samples they begin with, and shape (stretch, channel, time)."""
    length = max(1, min(table.samples, int(_SPOT * rate) if np.isfinite(rate) else 1))
    begins: list[int] = np.unique(np.linspace(0, table.samples - length, _SPOTS).astype(int)).tolist()
    return begins, np.array([table.take(None, begin, begin + length) for begin in begins])


def _spoilt(table: SampleTable, column: int, begins: list[int], spots: Real) -> Problem | None:
    """Say what stands in the stretches of a channel that is no number."""
    length = spots.shape[1]
    missing = (begin for begin, spot in zip(begins, spots, strict=True) if not np.isfinite(spot).all())
    return next(
        (problem for begin in missing if (problem := table.find_non_number(column, begin, begin + length))), None
    )


def pieces(table: SampleTable, surveyed: Survey, factors: Real) -> Iterator[tuple[int, Real]]:
    """Give a recording's accelerations piece by piece.

    Parameters
    ----------
    table
        The recording.
    surveyed
        Its survey.
    factors
        m/s² upward in one of each channel's unit, shape (channel,).

    Yields
    ------
    tuple
        Index of the first sample, and readings of shape (channel, time), m/s².
    """
    for begin, piece in table.pieces(surveyed.columns, _PIECE):
        yield begin, piece * factors[:, None]


def largest(table: SampleTable, surveyed: Survey) -> float:
    """Give the largest reading of the channels whose unit nothing tells, averaged over some milliseconds.

    Parameters
    ----------
    table
        The recording.
    surveyed
        Its survey.

    Returns
    -------
    float
        In whatever unit it is.
    """
    unknown = np.array([channel.unit is None for channel in surveyed.channels])
    width = max(round(_SHORT * surveyed.rate), 1)
    most = 0.0
    for _, piece in pieces(table, surveyed, np.ones(len(surveyed.channels))):
        smooth = uniform_filter1d(np.nan_to_num(piece[unknown]), width, axis=1)
        most = max(most, float(np.abs(smooth).max(initial=0.0)))
    return most


def full_scales(table: SampleTable, surveyed: Survey, first: int, last: int) -> dict[str, float]:
    """Find channels that stay at their extreme for some samples, as at full scale.

    Parameters
    ----------
    table
        The recording.
    surveyed
        Its survey.
    first, last
        Samples between which to look.

    Returns
    -------
    dict
        By channel that reading's size, in its own unit.
    """
    found = {}
    for channel, reading in zip(surveyed.channels, table.take(surveyed.columns, first, last), strict=True):
        size = np.nan_to_num(np.abs(reading))
        at = size == size.max(initial=0.0)
        if size.size > _PLATEAU and (at[:-2] & at[1:-1] & at[2:]).any():
            found[channel.name] = float(size.max())
    return found

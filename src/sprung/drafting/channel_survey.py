"""Channel survey of a recording: what its columns measure, its rate, length and largest readings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from sprung.drafting.channel import Channel, classify_channel, disambiguate_units
from sprung.drafting.names import axis_named
from sprung.drafting.other_channel import OtherChannel, classify_other_channel
from sprung.errors import Problem

if TYPE_CHECKING:
    from sprung.formats import SampleTable

Real = NDArray[np.float64]

_SPOTS, _SPOT = 60, 0.5
"""Stretches of a recording in which a rest is looked for, and the length of each, s."""

_SHORT = 0.01
"""s over which readings are averaged, so that a spike is not taken for the size of what was recorded."""

_PLATEAU = 3
"""Samples in a row at a channel's extreme that show its full scale."""

PIECE = 1 << 17
"""Samples that are read together."""


@dataclass(frozen=True, eq=False)
class ChannelSurvey:
    """Channels of a recording.

    Attributes
    ----------
    channels
        The vertical accelerations, and their columns in the table.
    columns
        Of those channels.
    left_out
        The other channels, each with the reason.
    rate
        Samples per second.
    start, end
        s on the file's clock.
    samples
        Number of samples.
    others
        The channels of other quantities, and their columns in the table.
    other_columns
        Of those channels.
    """

    channels: tuple[Channel, ...]
    columns: tuple[int, ...]
    left_out: dict[str, str]
    rate: float
    start: float
    end: float
    samples: int
    others: tuple[OtherChannel, ...] = ()
    other_columns: tuple[int, ...] = ()


def survey_channels(table: SampleTable) -> ChannelSurvey:
    """Classify the channels of a recording.

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
    begins, spots = _sample_stretches(table, rate)
    channels, columns, left_out = [], [], {}
    others: dict[int, OtherChannel] = {}
    for column, name in enumerate(table.channels):
        own = spots[:, column]
        if (problem := _find_non_number(table, column, begins, own)) is not None:
            left_out[name] = f"it holds {problem.found}"
            continue
        found = _classify(table, column, own)
        if isinstance(found, OtherChannel):
            others[column] = found
        elif isinstance(found, Channel):
            channels.append(found)
            columns.append(column)
        else:
            left_out[name] = found
    return ChannelSurvey(
        disambiguate_units(channels),
        tuple(columns),
        left_out,
        rate,
        start,
        end,
        samples,
        tuple(others.values()),
        tuple(others),
    )


def _classify(table: SampleTable, column: int, own: Real) -> Channel | OtherChannel | str:
    """Classify a channel by its quantity, or return why it is of no use."""
    name, stated_unit = table.channels[column], table.units[column]
    other = classify_other_channel(name, stated_unit, own)
    axis = axis_named(name, table.channels)
    if axis in ("x", "y") and (other is None or (isinstance(other, OtherChannel) and other.quantity != "angular-rate")):
        return f"it measures along {axis}, beside one along z"
    return other or classify_channel(name, stated_unit, own)


def _sample_stretches(table: SampleTable, rate: float) -> tuple[list[int], Real]:
    """Return short stretches of all channels, shape (stretch, channel, time), and the samples they begin with."""
    length = max(1, min(table.samples, int(_SPOT * rate) if np.isfinite(rate) else 1))
    begins: list[int] = np.unique(np.linspace(0, table.samples - length, _SPOTS).astype(int)).tolist()
    return begins, np.array([table.take(None, begin, begin + length) for begin in begins])


def _find_non_number(table: SampleTable, column: int, begins: list[int], spots: Real) -> Problem | None:
    """Find what is no number in the stretches of a channel."""
    length = spots.shape[1]
    missing = (begin for begin, spot in zip(begins, spots, strict=True) if not np.isfinite(spot).all())
    return next(
        (problem for begin in missing if (problem := table.find_non_number(column, begin, begin + length))), None
    )


def read_pieces(table: SampleTable, survey: ChannelSurvey, factors: Real) -> Iterator[tuple[int, Real]]:
    """Read a recording's accelerations piece by piece.

    Parameters
    ----------
    table
        The recording.
    survey
        Its survey.
    factors
        m/s² upward in one of each channel's unit, shape (channel,).

    Yields
    ------
    tuple
        Index of the first sample, and readings of shape (channel, time), m/s².
    """
    for begin, piece in table.pieces(survey.columns, PIECE):
        yield begin, piece * factors[:, None]


def largest_reading(table: SampleTable, survey: ChannelSurvey) -> float:
    """Largest reading of the channels without a known unit, averaged over some milliseconds.

    Parameters
    ----------
    table
        The recording.
    survey
        Its survey.

    Returns
    -------
    float
        In the unit of the file.
    """
    unknown = np.array([channel.unit is None for channel in survey.channels])
    width = max(round(_SHORT * survey.rate), 1)
    most = 0.0
    for _, piece in read_pieces(table, survey, np.ones(len(survey.channels))):
        smooth = uniform_filter1d(np.nan_to_num(piece[unknown]), width, axis=1)
        most = max(most, float(np.abs(smooth).max(initial=0.0)))
    return most


def detect_full_scales(table: SampleTable, survey: ChannelSurvey, first: int, last: int) -> dict[str, float]:
    """Detect channels that stay at their extreme for some samples, as at full scale.

    Parameters
    ----------
    table
        The recording.
    survey
        Its survey.
    first, last
        Samples between which to look.

    Returns
    -------
    dict
        By channel that reading's size, in its own unit.
    """
    found = {}
    for channel, reading in zip(survey.channels, table.take(survey.columns, first, last), strict=True):
        size = np.nan_to_num(np.abs(reading))
        at = size == size.max(initial=0.0)
        if size.size > _PLATEAU and (at[:-2] & at[1:-1] & at[2:]).any():
            found[channel.name] = float(size.max())
    return found

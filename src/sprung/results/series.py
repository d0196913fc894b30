"""Time series of a result, which its figures draw: arrays in memory, and series.npz."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sprung.checking import PlottedRecording
from sprung.display import shown
from sprung.preprocess import MarkedSamples

Real = NDArray[np.float64]
Single = NDArray[np.float32]

_FITTED = ("channels", "time", "measured", "fitted", "body_measured", "body_simulated")
_RECORDED = ("recording", "clock")
_MARKS = "marks "
"""Names of arrays after the drop's name: of the fit, of its recording, and the beginning of each mark's."""


@shown
@dataclass(frozen=True, eq=False)
class Series:
    """One drop as it was fitted.

    Attributes
    ----------
    channels
        Channel names.
    time
        On the file's own clock, s, shape (time,).
    measured, fitted
        m/s², positive up, shape (channel, time); NaN in channels that were left out.
    body_measured, body_simulated
        Vertical acceleration of the centre of gravity, m/s², pitch and roll acceleration of the body, rad/s², shape (3, time);
        NaN where the sensors do not measure it.
    """

    channels: tuple[str, ...]
    time: Real
    measured: Real
    fitted: Real
    body_measured: Single
    body_simulated: Single


def npz_bytes(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Return the content of an .npz file.

    Parameters
    ----------
    arrays
        By name, of any shape and unit.

    Returns
    -------
    bytes
    """
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
    return buffer.getvalue()


def arrays_of(series: Mapping[str, Series], recordings: Mapping[str, PlottedRecording]) -> dict[str, NDArray[Any]]:
    """Return all series as arrays.

    Parameters
    ----------
    series, recordings
        By the drop's name.

    Returns
    -------
    dict
        Arrays by name: ``drop/what``.
    """
    arrays: dict[str, NDArray[Any]] = {}
    for drop, fitted in series.items():
        arrays |= {f"{drop}/{what}": np.asarray(getattr(fitted, what)) for what in _FITTED}
    for drop, recorded in recordings.items():
        arrays |= {f"{drop}/recording": recorded.values, f"{drop}/clock": np.array([recorded.start, recorded.rate])}
        for i, mark in enumerate(recorded.marks):
            channels = np.full(len(mark.samples), mark.channel)
            arrays[f"{drop}/{_MARKS}{i} {mark.code}"] = np.stack([channels, mark.samples])
    return arrays


def series_from(arrays: Mapping[str, NDArray[Any]]) -> tuple[dict[str, Series], dict[str, PlottedRecording]]:
    """Return series and recordings by drop name, from the arrays that `arrays_of` makes.

    Parameters
    ----------
    arrays
        By name: ``drop/what``.

    Returns
    -------
    series
        Of the drops that were fitted.
    recordings
        Of all drops.

    Raises
    ------
    ValueError
        If an array is unknown or missing.
    """
    by_drop: dict[str, dict[str, NDArray[Any]]] = {}
    for key, array in arrays.items():
        drop, _, what = key.rpartition("/")
        by_drop.setdefault(drop, {})[what] = array
    wrong = sorted(f"{drop}/{what}" for drop, own in by_drop.items() for what in _unknown_or_missing(own))
    if wrong:
        raise ValueError(f"{', '.join(wrong[:3])} unknown or missing")
    series, recordings = {}, {}
    for drop, own in by_drop.items():
        if "clock" in own:
            start, rate = own["clock"].tolist()
            recordings[drop] = PlottedRecording(start, rate, own["recording"], tuple(_marks(own)))
        if "channels" in own:
            channels = tuple(own["channels"].tolist())
            series[drop] = Series(channels, *(own[what] for what in _FITTED[1:]))
    return series, recordings


def _unknown_or_missing(arrays: Iterable[str]) -> set[str]:
    """Return the unknown and the missing arrays of one drop; those of a fit, or of a recording, are all there or none."""
    marks = {what for what in arrays if what.startswith(_MARKS)}
    present = set(arrays) - marks
    complete = set(_RECORDED) if marks else set()
    for group in (_FITTED, _RECORDED):
        if present.intersection(group):
            complete.update(group)
    return present ^ complete


def _marks(arrays: Mapping[str, NDArray[Any]]) -> Iterator[MarkedSamples]:
    for what, (channels, samples) in ((what, array) for what, array in arrays.items() if what.startswith(_MARKS)):
        code = what.removeprefix(_MARKS).partition(" ")[2]
        yield MarkedSamples(code, int(channels[0]), samples.astype(np.int64))

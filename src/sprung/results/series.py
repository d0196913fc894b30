"""What the figures draw, and its way to series.npz and back."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.checking import PlottedRecording
from sprung.display import shown
from sprung.preprocess import MarkedSamples

Real = NDArray[np.float64]
Drawn = NDArray[np.float32]

_FITTED = ("channels", "time", "measured", "fitted")
_BODY = ("body_measured", "body_simulated")
_WHOLE = ("recording", "clock")
_MARKS = "marks "
"""What stands behind a drop's name: of the fit, of the body, of its recording, and of each mark."""


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
        NaN for what the sensors do not tell; None where an older sprung wrote the result.
    """

    channels: tuple[str, ...]
    time: Real
    measured: Real
    fitted: Real
    body_measured: Drawn | None = None
    body_simulated: Drawn | None = None


class Everything(NamedTuple):
    """All series of a result, by the names of their drops.

    Attributes
    ----------
    series
        Of the drops that were fitted.
    recordings
        Of all drops.
    """

    series: dict[str, Series]
    recordings: dict[str, PlottedRecording]


def packed(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Give the bytes of an .npz file of arrays by name."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
    return buffer.getvalue()


def arrays_of(series: Mapping[str, Series], recordings: Mapping[str, PlottedRecording]) -> dict[str, NDArray[Any]]:
    """Give everything as arrays by name: ``drop/what``.

    Parameters
    ----------
    series, recordings
        By the drop's name.
    """
    arrays: dict[str, NDArray[Any]] = {}
    for name, one in series.items():
        arrays |= {
            f"{name}/channels": np.array(one.channels),
            f"{name}/time": one.time,
            f"{name}/measured": one.measured,
            f"{name}/fitted": one.fitted,
        }
        if one.body_measured is not None and one.body_simulated is not None:
            arrays |= {f"{name}/body_measured": one.body_measured, f"{name}/body_simulated": one.body_simulated}
    for name, whole in recordings.items():
        arrays |= {f"{name}/recording": whole.values, f"{name}/clock": np.array([whole.start, whole.rate])}
        for i, mark in enumerate(whole.marks):
            place = np.stack([np.full(len(mark.samples), mark.channel), mark.samples])
            arrays[f"{name}/{_MARKS}{i} {mark.code}"] = place
    return arrays


def everything_in(arrays: Mapping[str, NDArray[Any]]) -> Everything:
    """Give back what `arrays_of` made arrays of.

    Parameters
    ----------
    arrays
        By name: ``drop/what``.

    Returns
    -------
    Everything

    Raises
    ------
    ValueError
        If something is left over or missing.
    """
    held: dict[str, dict[str, NDArray[Any]]] = {}
    for key, array in arrays.items():
        name, _, what = key.rpartition("/")
        held.setdefault(name, {})[what] = array
    wrong = sorted(f"{name}/{what}" for name, found in held.items() for what in _wrong(found))
    if wrong:
        raise ValueError(f"{', '.join(wrong[:3])} left over or missing")
    series, recordings = {}, {}
    for name, found in held.items():
        if "clock" in found:
            start, rate = found["clock"].tolist()
            recordings[name] = PlottedRecording(start, rate, found["recording"], tuple(_marks(found)))
        if "channels" in found:
            channels = tuple(found["channels"].tolist())
            series[name] = Series(channels, **{what: found[what] for what in (*_FITTED[1:], *_BODY) if what in found})
    return Everything(series, recordings)


def _wrong(found: Iterable[str]) -> set[str]:
    """Name what is left over or missing of one drop: what belongs together is there together."""
    marks = {what for what in found if what.startswith(_MARKS)}
    there = set(found) - marks
    whole = set(_WHOLE) if marks else set()
    for together in (_FITTED, _BODY, _WHOLE):
        if there.intersection(together):
            whole.update(together)
    if there.intersection(_BODY):
        whole.update(_FITTED)
    return there ^ whole


def _marks(found: Mapping[str, NDArray[Any]]) -> Iterator[MarkedSamples]:
    for what, place in found.items():
        if what.startswith(_MARKS):
            code = what.removeprefix(_MARKS).partition(" ")[2]
            yield MarkedSamples(code, int(place[0, 0]), place[1].astype(np.int64))

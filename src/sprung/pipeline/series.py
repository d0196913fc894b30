"""What the figures draw, and its way to series.npz and back."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.prepare import Mark, Seen
from sprung.recording import Recording

Real = NDArray[np.float64]
Drawn = NDArray[np.float32]

_MARKS = "marks "


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


@dataclass(frozen=True, eq=False)
class Recorded:
    """One drop's whole recording, in SI, put right as far as it could be.

    Attributes
    ----------
    start
        Time of the first sample on the recording's clock, s.
    rate
        Samples per second.
    values
        m/s², positive up, shape (channel, time); of channels that are left out what was read, NaN where nothing was.
    marks
        Samples with which something is the matter.
    """

    start: float
    rate: float
    values: Drawn
    marks: tuple[Mark, ...] = ()

    @classmethod
    def of(cls, seen: Seen, as_read: Recording) -> Recorded:
        """Take what a recording shows.

        Parameters
        ----------
        seen
            What its drop shows.
        as_read
            The same before anything was left out.
        """
        values = seen.recording.values
        if values.shape == as_read.values.shape:
            values = np.where(np.isnan(values).any(axis=1, keepdims=True), as_read.values, values)
        return cls(seen.recording.start, seen.recording.rate, values.astype(np.float32), seen.marks)

    @property
    def time(self) -> Real:
        """Time of every sample on the recording's clock, s; shape (time,)."""
        return self.start + np.arange(self.values.shape[1]) / self.rate


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
    recordings: dict[str, Recorded]


def packed(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Give the bytes of an .npz file of arrays by name."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
    return buffer.getvalue()


def arrays_of(series: Mapping[str, Series], recordings: Mapping[str, Recorded]) -> dict[str, NDArray[Any]]:
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


def read_series(path: Path) -> Everything:
    """Read series.npz.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    OSError, ValueError, KeyError, EOFError
        If it is missing, cut off or of other content.
    """
    with np.load(path, allow_pickle=False) as archive:
        held: dict[str, list[str]] = {}
        for key in archive.files:
            name, _, what = key.rpartition("/")
            held.setdefault(name, []).append(what)
        series, recordings = {}, {}
        for name, whats in held.items():
            found = {what: archive[f"{name}/{what}"] for what in whats}
            if "clock" in found:
                start, rate = found["clock"].tolist()
                recordings[name] = Recorded(start, rate, found["recording"], tuple(_marks(found)))
            if set(found) - {"clock", "recording"} - {what for what in found if what.startswith(_MARKS)}:
                series[name] = Series(
                    tuple(found["channels"].tolist()),
                    found["time"],
                    found["measured"],
                    found["fitted"],
                    found.get("body_measured"),
                    found.get("body_simulated"),
                )
    return Everything(series, recordings)


def _marks(found: Mapping[str, NDArray[Any]]) -> Iterator[Mark]:
    for what, place in found.items():
        if what.startswith(_MARKS):
            code = what.removeprefix(_MARKS).partition(" ")[2]
            yield Mark(code, int(place[0, 0]), place[1].astype(np.int64))

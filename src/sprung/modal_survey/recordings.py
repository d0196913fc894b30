"""Modes of recordings and arrays alone, without a campaign file or a vehicle."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import CAMPAIGN_FILE
from sprung.drafting import detect_drops
from sprung.errors import Problems
from sprung.formats import SampleTable, read_table
from sprung.modal_survey.load_modes import LoadModes
from sprung.modal_survey.modal_analysis import modal_analysis
from sprung.progress import Progress, counted, silent
from sprung.units import STANDARD_GRAVITY, si_factor

Real = NDArray[np.float64]

RECORDINGS = "recordings"
"""Key of the modes, in place of the name of a load."""

_OTHER_FILES = frozenset({".toml", ".json", ".md", ".html", ".svg", ".png", ".npz", ".py"})

_HOP_TIME = 0.125
"""s after the landing in which a tyre may leave the ground once more: a period of the slowest usual wheel hop, 8 Hz. It is not
known which channel is on a wheel."""

_LARGEST_JITTER = 0.01
"""Largest variation of the sampling interval, as a part of it, of a recording that is fitted."""


def is_recordings(path: str | os.PathLike[str]) -> bool:
    """Return whether a path is a recording or a folder of them, and no campaign.

    Parameters
    ----------
    path
        A file or a folder.

    Returns
    -------
    bool
    """
    place = Path(path)
    return bool(recordings_in(place)) and not (place / CAMPAIGN_FILE).exists()


def recordings_in(place: Path) -> list[Path]:
    """Return the files that may be recordings: one file itself, or those in a folder."""
    files = sorted(place.iterdir()) if place.is_dir() else [place]
    return [
        file
        for file in files
        if file.is_file() and file.suffix.lower() not in _OTHER_FILES and not file.name.startswith(".")
    ]


def modes_of_recordings(
    path: str | os.PathLike[str],
    method: str,
    order: int | None,
    *,
    start: float | None,
    amplitude: bool,
    diagram: bool,
    progress: Progress = silent,
) -> LoadModes:
    """Identify the modes common to the free decays of recordings.

    Parameters
    ----------
    path
        A recording in any format sprung reads, or a folder of them: one decay each, the same channels and rate.
    method, order, amplitude, diagram
        As for `modes`.
    start
        Start of the free decay, s on the files' own clock. Unless given, after the landing of each drop that is detected in a
        recording, as by `check`; in a recording without a drop at its largest reading.
    progress
        Called with each step that begins.

    Returns
    -------
    LoadModes
        Modes are numbered. Channels keep their unit, except accelerations, which are in m/s².

    Raises
    ------
    InputError
        If a file cannot be read, or channels or rates differ; every problem at once.
    """
    problems = Problems()
    tables: list[tuple[Path, SampleTable]] = []
    files = recordings_in(Path(path))
    for file in counted(progress, "reading the recordings", files):
        with problems.collect():
            tables.append((file, read_table(file)))
    problems.raise_if_any()
    if not tables:
        problems.add(str(path), "no recording", "at least one", "Give a recording, or a folder of them.")
        problems.raise_if_any()
    first = tables[0][1]
    channels = [name for name in first.channels if all(name in table.channels for _, table in tables)]
    if len(channels) < 2:
        found = f"{len(channels)} channels that all {len(tables)} files have"
        problems.add(
            str(path), found, "two or more: shapes are ratios of channels", "Give files with the same channels."
        )
    rates = [_rate(file, table, problems) for file, table in tables]
    if len({round(rate, 6) for rate in rates}) > 1:
        found = ", ".join(f"{file.name} {rate:g} Hz" for (file, _), rate in zip(tables, rates, strict=True))
        problems.add(str(path), found, "one rate", "Give files of one rate together.")
    for file, table in tables:
        if start is not None and not table.time[0] <= start < table.time[-1]:
            expected = f"a time of this recording, {table.time[0]:g} to {table.time[-1]:g} s"
            problems.add(f"{file.name}: start", f"{start:g} s", expected, "Correct the start.")
    problems.raise_if_any()
    records, names = [], list[str]()
    for file, table in tables:
        values = table.take([table.channels.index(name) for name in channels])
        factors = [_factor(table.units[table.channels.index(name)]) for name in channels]
        values = np.array(factors)[:, None] * values
        spans = (
            _decays(values, rates[0], table.time)
            if start is None
            else [(int(np.searchsorted(table.time, start)), None)]
        )
        for begin, end in spans:
            decay = values[:, begin:end]
            if not np.isfinite(decay).all():
                bad = int((~np.isfinite(decay)).sum())
                do = "Leave them out, or repair the file."
                problems.add(file.name, f"{bad} cells that are not numbers", "numbers", do)
            records.append(decay)
            names.append(file.stem if len(spans) == 1 else f"{file.stem} from {table.time[begin]:.3f} s")
    problems.raise_if_any()
    return modal_analysis(
        records,
        rates[0],
        method,
        order,
        tuple(channels),
        tuple(names),
        amplitude=amplitude,
        diagram=diagram,
        progress=progress,
    )


def modes_of_arrays(
    arrays: Sequence[Real],
    rate: float | None,
    method: str,
    order: int | None,
    *,
    channels: Sequence[str] | None,
    start: float | None,
    amplitude: bool,
    diagram: bool,
) -> LoadModes:
    """Identify the modes common to free decays in memory.

    Parameters
    ----------
    arrays
        One decay each, shape (channel, time).
    rate
        Samples per second.
    method, order, amplitude, diagram
        As for `modes`.
    channels
        Names; ``channel 1`` and so on unless given.
    start
        Start of the free decay, s from the first sample; 0 unless given.

    Returns
    -------
    LoadModes
        Modes are numbered.

    Raises
    ------
    InputError
        If the arrays cannot be used together, or the rate is missing; every problem at once.
    """
    problems = Problems()
    if rate is None or not (math.isfinite(rate) and rate > 0):
        found = "nothing" if rate is None else f"{rate:g}"
        problems.add("modes: rate", found, "samples per second", "Give rate = ... of the array.")
    decays = [np.asarray(array, dtype=float) for array in arrays]
    for number, decay in enumerate(decays, start=1):
        where = f"modes: array {number}"
        if decay.ndim != 2 or decay.shape[0] < 2 or decay.shape[1] <= decay.shape[0]:
            expected = "(channel, time), with two channels or more and more samples than channels"
            problems.add(where, f"shape {decay.shape}", expected, "Transpose it, or give all channels.")
        elif not np.isfinite(decay).all():
            bad = int((~np.isfinite(decay)).sum())
            problems.add(where, f"{bad} values that are not finite", "numbers", "Leave those channels or samples out.")
    counts = {decay.shape[0] for decay in decays}
    if not decays:
        problems.add("modes", "no array", "at least one", "Give an array of shape (channel, time).")
    elif len(counts) > 1:
        problems.add(
            "modes", f"arrays of {sorted(counts)} channels", "the same channels in all", "Leave the others out."
        )
    elif channels is not None and len(channels) not in counts:
        problems.add("modes: channels", f"{len(channels)} names", f"{counts.pop()}, one each", "Correct the names.")
    problems.raise_if_any()
    assert rate is not None  # noqa: S101 (checked above; for the type checker)
    longest = max(decay.shape[1] for decay in decays) / rate
    if start is not None and not 0 <= start < longest:
        problems.add("modes: start", f"{start:g} s", f"0 to {longest:g} s, from the first sample", "Correct the start.")
        problems.raise_if_any()
    begin = round((start or 0.0) * rate)
    records = [decay[:, begin:] for decay in decays]
    named = tuple(channels or (f"channel {i + 1}" for i in range(decays[0].shape[0])))
    numbers = tuple(f"array {i + 1}" for i in range(len(records)))
    return modal_analysis(records, rate, method, order, named, numbers, amplitude=amplitude, diagram=diagram)


def _rate(file: Path, table: SampleTable, problems: Problems) -> float:
    steps = np.diff(table.time)
    step = float(np.median(steps)) if len(steps) else 0.0
    if not step > 0 or float(np.abs(steps - step).max()) > _LARGEST_JITTER * step:
        problems.add(file.name, "an uneven sampling interval", "equal sampling intervals", "Resample the recording.")
        return 1.0
    return (len(steps)) / float(table.time[-1] - table.time[0])


def _factor(unit: str | None) -> float:
    """Return the factor of an acceleration to m/s²; 1 for any other quantity."""
    try:
        return 1.0 if unit is None else si_factor(unit)
    except ValueError:
        return 1.0


def _decays(values: Real, rate: float, time: Real) -> list[tuple[int, int | None]]:
    """Return first and last sample of each free decay: after the landing of each drop, or from the largest reading."""
    # Files without a unit are as often in g as in m/s².
    for factor in (1.0, STANDARD_GRAVITY):
        if found := detect_drops([(0, factor * values)], rate, start=float(time[0])).drops:
            break
    else:
        return [(_largest_reading(values), None)]
    spans = [np.searchsorted(time, (drop.landing + _HOP_TIME, drop.end)).tolist() for drop in found]
    return [(begin, end + 1) for begin, end in spans]


def _largest_reading(values: Real) -> int:
    """Return the sample of the largest reading, with each channel divided by its root-mean-square."""
    deviation = values - np.nanmedian(values, axis=1, keepdims=True)
    size = np.sqrt(np.nanmean(deviation**2, axis=1, keepdims=True))
    power: Sequence[float] = np.nansum((deviation / np.where(size > 0, size, 1.0)) ** 2, axis=0).tolist()
    return int(np.argmax(power))

"""Recordings of pure rest: nothing moves, because the logger was stopped before the release or the file is another one.

Noise at rest is stationary and, in the band of a vehicle's modes, white. A vibration is neither: its power lies about the
natural frequencies, and dies away. The lines of periodograms of white noise are independent and have one exponential
distribution (Priestley, Spectral Analysis and Time Series, 1981, section 6.1.3), so the ratio of their mean in one octave of
one piece of a recording to that of all others follows an F distribution, whatever the level of the noise. Noise that is not
white may be motion too, so nothing is claimed of it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import f as f_distribution

from sprung.campaign import DropTest
from sprung.errors import Fault
from sprung.formats import MIN_RATE
from sprung.preprocess.extraction import find_end, find_stated_start
from sprung.preprocess.release import Release
from sprung.units import si_symbol
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

_LOWEST, _HIGHEST = 0.5, MIN_RATE / 2
"""Hz between which the modes of vehicles lie: ride of a coach on air springs, and what the lowest sampling rate resolves."""

_LEVEL = 0.01
"""Level of significance: the part of recordings of pure rest that are not recognised as such. A vibration is taken for noise
only if the test does not see it: with eight channels, if its amplitude is below about half the standard deviation of noise."""

_PIECES = (2.0, 0.25)
"""s of a recording that are tested together: within so long the motion of a usual body, and of a wheel, dies away. In a longer
piece there would be more noise beside it."""

_FEWEST = 8
"""Lines of the periodogram, those of all channels together, from which the test has any power."""


def rest_only_fault(drop: DropTest, release: Release | None, sensors: Sequence[Sensor]) -> Fault | None:
    """Return the fault that a recording holds nothing but noise at rest; None where something may move in it.

    Parameters
    ----------
    drop
        With its recording, before any filter is undone; of it the part from its stated start to its stated end.
    release
        The release that was detected in the whole recording: where there is one, and no limit is stated, something moves.
    sensors
        One for each channel.

    Returns
    -------
    Fault or None
    """
    recording = drop.recording
    is_whole = drop.start is None and drop.end is None
    if release is not None and is_whole:
        return None
    channels = np.flatnonzero(recording.usable)
    values = recording.values[channels, find_stated_start(drop) : find_end(drop)[0] + 1]
    if not values.size or not is_noise(values, recording.rate):
        return None
    std = values.std(axis=1)
    most = int(np.argmax(std / np.maximum(np.median(std), np.finfo(float).tiny)))
    name, unit = recording.channels[channels[most]], si_symbol(sensors[channels[most]].quantity)
    span = f"{values.shape[1] / recording.rate:.3g} s" + ("" if is_whole else " from its start to its end as stated")
    what = (
        f"no channel moves more than its noise at rest in {span} (standard deviation of {name}: {std[most]:.2g} {unit}); "
        "the drop is left out"
    )
    do = "See that the logger was not stopped before the release, and that this is the right file"
    return Fault("no-motion", recording.name, what, f"{do}{'.' if is_whole else ', and correct start and end.'}")


def is_noise(values: Real, rate: float) -> bool:
    """Return whether all channels hold nothing but white noise in the band of a vehicle's modes.

    Parameters
    ----------
    values
        Any unit, shape (channel, time), without NaN.
    rate
        Samples per second.

    Returns
    -------
    bool
        Constant channels count as noise. False where there are too few samples to tell.

    Notes
    -----
    Each octave of each piece of a channel is compared with the rest of the channel, and all channels together: what one channel
    hides in its noise shows in the sum. Noise that channels have in common makes the joint tests reject more often, so that
    nothing is claimed.
    """
    found = [_probabilities_of_white_noise(values, rate, length) for length in _PIECES]
    probabilities = np.concatenate(found)
    return bool(probabilities.size and probabilities.min() * probabilities.size > _LEVEL)


def _probabilities_of_white_noise(values: Real, rate: float, length: float) -> Real:
    """Return how probable at least as much power is for white noise, in octaves of pieces of some length, s; flat."""
    pieces = max(round(values.shape[1] / rate / length), 1)
    samples = values.shape[1] // pieces
    frequencies = np.fft.rfftfreq(samples, 1 / rate)
    band = (frequencies > _LOWEST) & (frequencies < _HIGHEST)
    octaves, counts = np.unique(
        np.floor(np.log2(frequencies[band] / _LOWEST)), return_inverse=True, return_counts=True
    )[1:]
    if octaves.size * pieces * len(values) < _FEWEST or counts.size * pieces < 2:
        return np.ones(0)
    moved = values[:, : pieces * samples].reshape(len(values), pieces, samples)
    lines = np.abs(np.fft.rfft(moved - moved.mean(axis=2, keepdims=True))[:, :, band]) ** 2
    power = lines.mean(axis=(1, 2))
    lines = lines / np.where(power > 0, power, 1.0)[:, None, None]
    # Twice a line is a chi-squared variable of two degrees of freedom. Shapes (channel, piece, octave), and (octave,).
    sums = lines @ (octaves[:, None] == np.arange(counts.size)).astype(float)
    moving = int(np.count_nonzero(power))
    return np.concatenate(
        [
            _f_test(sums, counts, 1),
            _f_test(sums.sum(axis=0, keepdims=True), counts, moving),
            _f_test(sums.sum(axis=(0, 1), keepdims=True), counts, moving * pieces),
        ]
    )


def _f_test(sums: Real, counts: NDArray[np.int64], members: int) -> Real:
    """Return how probable at least as large sums are against the other ones of their row, shape (row, piece, octave); flat.

    Of each octave there are so many lines, times so many members.
    """
    lines = np.broadcast_to(counts * max(members, 1), sums.shape)
    others = lines.sum(axis=(1, 2), keepdims=True) - lines
    rest = np.maximum(sums.sum(axis=(1, 2), keepdims=True) - sums, np.finfo(float).tiny)
    ratio = sums / lines / (rest / others)
    probability: Real = np.asarray(f_distribution.sf(ratio, 2 * lines, 2 * others), dtype=float)
    return np.asarray(probability[others > 0])

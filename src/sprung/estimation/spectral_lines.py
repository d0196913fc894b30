"""Records of a vehicle on pads as lines of their discrete Fourier transforms.

Scaled by √(2/N), the real and the imaginary part of each line of N samples have the noise of one sample. So a line counts as
two samples, and noise levels are the same as in the time domain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.preprocess import FreeDecay
from sprung.vehicle import Wheel

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.int64]

LOWEST, HIGHEST = 0.25, 50.0
"""Hz of the lines that are fitted. Below lies the drift of sensors, and the vehicle follows its pads as a whole; above, at
three times the frequency of wheel hop, wheels hardly follow, and tyres and body have modes of their own. What lies above shows
the noise of the channels beforehand."""

_NYQUIST = 0.8
"""Part of half the sampling rate up to which the filter of a logger leaves a signal as it is."""

_LENGTH = 256
"""Lines in a block."""

_FEWEST = 50
"""Lines above the others that show a channel's noise."""

_BAND, _EXCITED = 24, 3.0
"""Lines over which power is averaged, and times that of the noise from which it is more: ten standard errors."""


@dataclass(frozen=True, eq=False)
class SpectralLines:
    """The lines of a record that are fitted.

    Attributes
    ----------
    load
        Name of the load on the vehicle.
    wheels
        Wheel stations over the pads that move.
    numbers
        Of the lines: frequency times the length of the record, ascending, shape (line,).
    values
        Scaled lines, SI, shape (line, channel); 0 for channels that are left out.
    usable
        Which channels are not left out, shape (channel,).
    samples
        Samples of the record.
    step
        Sampling interval, s.
    ends
        Prior of the end corrections: a jump between the ends of the record, and a change of slope, as they enter the lines; SI,
        shape (2, channel).
    noise
        Noise variance of each channel by what is above the lines, SI, shape (channel,): a first guess.
    """

    load: str
    wheels: tuple[Wheel, ...]
    numbers: Index
    values: Complex
    usable: NDArray[np.bool_]
    samples: int
    step: float
    ends: Real
    noise: Real

    @classmethod
    def of(cls, decay: FreeDecay) -> SpectralLines:
        """Return the lines of a record."""
        usable, step = decay.usable, 1.0 / decay.rate
        values = np.where(usable[:, None], decay.values, 0.0)
        samples = values.shape[1]
        span = samples * step
        first = max(int(np.ceil(LOWEST * span)), 1)
        last = int(min(HIGHEST, _NYQUIST * decay.rate / 2) * span)
        whole = np.fft.rfft(values, axis=1).T * np.sqrt(2 / samples)
        lines, above = whole[first : last + 1], whole[last + 1 : int(_NYQUIST * samples / 2)]
        noise = np.mean(np.abs(above if len(above) >= _FEWEST else lines[-_FEWEST:]) ** 2, axis=0) / 2
        lines = lines[: _last_excited(lines, noise)]
        spread = np.ptp(values, axis=1)
        ends = np.array([spread / np.sqrt(2 * samples), spread * step * np.sqrt(2 / samples) / 12])
        high_pass = np.array(decay.high_pass) if decay.high_pass else np.zeros(len(values))
        # What a high-pass of the first order takes off is given back.
        frequencies = np.arange(first, first + len(lines)) / span
        lines = lines * (1 - 1j * high_pass / frequencies[:, None])
        return cls(
            load=decay.load,
            wheels=decay.pads,
            numbers=np.arange(first, first + len(lines)),
            values=np.ascontiguousarray(lines),
            usable=usable,
            samples=samples,
            step=step,
            ends=ends,
            noise=noise,
        )

    @cached_property
    def omega(self) -> Real:
        """Angular frequencies, rad/s, shape (line,)."""
        return np.asarray(2 * np.pi / (self.samples * self.step) * self.numbers, dtype=np.float64)

    @cached_property
    def blocks(self) -> tuple[slice, ...]:
        """Parts of the lines that stay in a processor's cache together with what is computed at them."""
        return tuple(slice(first, first + _LENGTH) for first in range(0, len(self.values), _LENGTH))

    def decimated(self, most: int) -> SpectralLines:
        """Return so many of the lines at the most, evenly spread."""
        every = max(len(self.values) // most, 1)
        return replace(self, numbers=self.numbers[::every], values=self.values[::every])

    @property
    def jump(self) -> float:
        """Scaled line of a unit impulse, 1/s: what a difference of the states at both ends enters the lines with."""
        return float(np.sqrt(2 / self.samples) / self.step)

    @property
    def counts(self) -> Real:
        """Real numbers in the lines of each channel, shape (channel,)."""
        return np.asarray(2.0 * len(self.values) * self.usable)

    @cached_property
    def energy(self) -> Real:
        """Sum of squares of each channel, SI, shape (channel,)."""
        return np.asarray(np.sum(np.abs(self.values) ** 2, axis=0))

    def to_time(self, lines: Complex) -> Real:
        """Return the samples of lines, scaled and of shape (line, channel); shape (channel, time)."""
        whole = np.zeros((lines.shape[1], self.samples // 2 + 1), dtype=np.complex128)
        whole[:, self.numbers] = lines.T / np.sqrt(2 / self.samples)
        return np.asarray(np.fft.irfft(whole, self.samples, axis=1))

    def up_to_highest(self, decay: FreeDecay) -> Real:
        """Return a record without its mean and without what is faster than the lines; SI, shape (channel, time)."""
        whole = np.fft.rfft(np.where(self.usable[:, None], decay.values, 0.0), axis=1)
        whole[:, 0] = 0
        whole[:, self.numbers[-1] + 1 :] = 0
        return np.asarray(np.fft.irfft(whole, self.samples, axis=1))


def _last_excited(lines: Complex, noise: Real) -> int:
    """Return the number of lines up to the last that any channel shows: those above are nothing but noise."""
    power = np.array(
        [np.mean(np.abs(band) ** 2, axis=0) / 2 for band in np.split(lines, range(_BAND, len(lines), _BAND))]
    )
    excited = np.flatnonzero((power > _EXCITED * noise).any(axis=1))
    return _BAND * (int(excited[-1]) + 1) if excited.size else len(lines)


def lines_of(decays: Sequence[FreeDecay]) -> tuple[SpectralLines, ...]:
    """Return the lines of records of a driven vehicle."""
    return tuple(SpectralLines.of(decay) for decay in decays)

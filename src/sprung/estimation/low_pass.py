"""The low-pass of a logger that all channels passed: what it makes of a motion, and what it remembers when a decay begins.

One that is the same in all channels changes only the amplitudes of the modes of a linear vehicle. Where forces are not linear,
knees and friction make harmonics, which it delays by other times than the wheels' motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.signal import butter, lfilter, lfilter_zi

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

HIGHEST_CORNER = 0.8
"""Corner frequency, as a part of the sampling rate, from which a low-pass does nothing to the samples: far above those of
anti-alias filters, of which one at 0.4 still delays what lies below."""

_BAND = 0.4
"""Frequencies, as a part of the sampling rate, up to which a sampled low-pass responds as the low-pass does."""

_FREQUENCIES, _EXACT = 200, 1e3
"""How many frequencies a sampled low-pass is fitted at, and by how much more the response at rest weighs than the others."""

_BLOCK = 64
"""Samples that are filtered by one product of matrices."""

_FORGOTTEN = 1e-6
"""Part of what a low-pass remembers from which its further directions count as none."""


class LowPass(NamedTuple):
    """A Butterworth low-pass.

    Attributes
    ----------
    corner
        At which its gain is 0.71, Hz.
    order
        1 for one resistor and one capacitor.
    passes_all
        Whether nothing passed it, but its memory counts as unknown all the same: so much freedom a fit behind it has anyway.
    """

    corner: float
    order: int
    passes_all: bool = False

    @property
    def has_effect(self) -> bool:
        """Whether anything passes it otherwise than without it, so that its corner may be found."""
        return bool(np.isfinite(self.corner)) and not self.passes_all

    @property
    def poles(self) -> Complex:
        """Its poles, 1/s, shape (order,)."""
        poles: Complex = 2 * np.pi * self.corner * _unit_poles(self.order)
        return poles

    @property
    def delay(self) -> float:
        """By how much it delays slow motions, s."""
        return float(np.sum(-1 / self.poles).real)

    def response(self, s: Complex) -> Complex:
        """Return its response at complex frequencies.

        Parameters
        ----------
        s
            1/s, any shape.

        Returns
        -------
        ndarray
            Of that shape, dimensionless.
        """
        poles = self.poles
        response: Complex = np.prod(-poles) / np.prod(np.asarray(s)[..., None] - poles, axis=-1)
        return response


class SampledLowPass(NamedTuple):
    """A low-pass at a sampling rate, without its delay of slow motions as far as that is a number of samples.

    Attributes
    ----------
    low_pass
        The low-pass; None where it does nothing.
    rate
        Samples per second.
    lag
        Samples of its delay: so many at the end of a record are not known.
    """

    low_pass: LowPass | None
    rate: float
    lag: int

    @classmethod
    def of(cls, low_pass: LowPass | None, rate: float) -> SampledLowPass:
        """Return a low-pass at a sampling rate.

        Parameters
        ----------
        low_pass
            None for no low-pass.
        rate
            Samples per second.
        """
        if low_pass is None or low_pass.corner >= HIGHEST_CORNER * rate:
            return cls(None, rate, 0)
        return cls(low_pass, rate, round(low_pass.delay * rate))

    @property
    def remaining_delay(self) -> float:
        """What is left of its delay of slow motions, s: half a sample at the most, unless it has another corner since."""
        if self.low_pass is None or self.low_pass.passes_all:
            return 0.0
        return self.low_pass.delay - self.lag / self.rate

    def with_corner(self, corner: float) -> SampledLowPass:
        """Return the low-pass with another corner, Hz, without the delay of this one."""
        return self if self.low_pass is None else self._replace(low_pass=self.low_pass._replace(corner=corner))

    @property
    def coefficients(self) -> tuple[Real, Real]:
        """Numerator and denominator of its transfer function in z⁻¹."""
        if self.low_pass is None:
            return np.ones(1), np.ones(1)
        return _transfer_function(self.low_pass, self.rate)

    def filtered(self, signals: Real, finer: int = 1) -> Real:
        """Return the samples of signals behind the low-pass, which rested before at their first values.

        Parameters
        ----------
        signals
            m/s², shape (..., time), sampled `finer` times as fast.
        finer
            A low-pass sees what lies between the samples that it gives.

        Returns
        -------
        ndarray
            m/s², shape (..., sample); zero where they are not known.
        """
        samples = signals if finer == 1 else signals[..., ::finer]
        if self.low_pass is None:
            return samples
        known = samples.shape[-1] - self.lag
        later = samples[..., :known] if self.low_pass.passes_all else self._passed(signals, finer)[..., self.lag :]
        return np.concatenate([later, np.zeros_like(samples[..., known:])], axis=-1)

    def _passed(self, signals: Real, finer: int) -> Real:
        """Return one in so many samples of signals behind the low-pass and with its delay.

        Blocks of samples are products of matrices, and only what the filter remembers goes from one to the next.
        """
        blocks = _blocks(self.low_pass, finer * self.rate, finer)
        shape, time, length = signals.shape[:-1], signals.shape[-1], len(blocks.by_signal)
        last = np.zeros((*shape, 1, length))
        last[..., 0, : time % length] = signals[..., time - time % length :]
        whole = sliding_window_view(signals, length, axis=-1)[..., ::length, :] if time >= length else last[..., :0, :]
        given = np.concatenate([whole @ blocks.by_signal, last @ blocks.by_signal], axis=-2)
        kept = len(blocks.at_rest)
        memory = signals[..., :1] * blocks.at_rest
        memories = np.empty((*given.shape[:-1], kept))
        for block in range(given.shape[-2]):
            memories[..., block, :] = memory
            memory = memory @ blocks.memory_by_memory + given[..., block, -kept:]
        passed: Real = given[..., :-kept] + memories @ blocks.by_memory
        return passed.reshape(*shape, -1)[..., : -(-time // finer)]

    def free_signals(self, samples: int) -> Real:
        """Return what a record may show whatever the motion: an offset, and what the low-pass remembers of earlier motions.

        Parameters
        ----------
        samples
            Of the record.

        Returns
        -------
        ndarray
            Orthonormal signals, zero where the low-pass is not known, shape (samples, signal).
        """
        return _free_signals(self, samples)

    def remembered(self, samples: int) -> Real:
        """Return an offset and the decays of its own modes, zero where it is not known.

        Parameters
        ----------
        samples
            Of the record.

        Returns
        -------
        ndarray
            Shape (samples, signal), not orthogonal; the same signals for any corner.
        """
        poles = np.zeros(0) if self.low_pass is None else np.exp(self.low_pass.poles / self.rate)
        decaying = np.exp(np.outer(np.arange(samples - self.lag), np.log(poles[poles.imag >= 0])))
        signals = np.hstack([np.ones((len(decaying), 1)), decaying.real, decaying.imag])
        return np.concatenate([signals, np.zeros((self.lag, signals.shape[1]))])


class _Blocks(NamedTuple):
    """What a filter makes of blocks of signals, and what it remembers after each.

    Attributes
    ----------
    by_signal
        One in so many of the samples behind it, and then its memory, by the samples of a block; shape (time, sample + memory).
    by_memory
        Samples by the memory at the start of the block, shape (memory, sample).
    memory_by_memory
        Memory at the end by that at the start, shape (memory, memory).
    at_rest
        Memory of a signal that has been 1 for ever, shape (memory,).
    """

    by_signal: Real
    by_memory: Real
    memory_by_memory: Real
    at_rest: Real


@lru_cache
def _blocks(low_pass: LowPass, rate: float, every: int) -> _Blocks:
    """Arrange a low-pass at a sampling rate for blocks, of which one in so many samples is wanted."""
    numerator, denominator = _transfer_function(low_pass, rate)
    at_rest = np.asarray(lfilter_zi(numerator, denominator))
    samples, kept = max(_BLOCK // every, 1), len(at_rest)
    length = samples * every
    # Signals of a single 1, and no signal at all after each memory.
    signals = np.concatenate([np.eye(length), np.zeros((kept, length))])
    memories = np.concatenate([np.zeros((length, kept)), np.eye(kept)])
    passed, after = lfilter(numerator, denominator, signals, axis=-1, zi=memories)
    wanted = passed[:, ::every]
    return _Blocks(np.hstack([wanted, after])[:length], wanted[length:], after[length:], at_rest)


@lru_cache
def _free_signals(sampled: SampledLowPass, samples: int) -> Real:
    left, sizes, _ = np.linalg.svd(sampled.remembered(samples), full_matrices=False)
    known: Real = left[:, sizes > _FORGOTTEN * sizes[0]]
    return known


@lru_cache
def _unit_poles(order: int) -> Complex:
    return np.asarray(butter(order, 1.0, analog=True, output="zpk")[1], dtype=np.complex128)


@lru_cache
def _transfer_function(low_pass: LowPass, rate: float) -> tuple[Real, Real]:
    """Return the numerator and denominator in z⁻¹ that respond as the low-pass does up to the highest frequencies of samples.

    Its poles are those of the low-pass; the numerator comes nearest by least squares, and is exact at rest. With a corner of
    100 Hz and 1000 samples per second it is 2e-4 off at the most, the bilinear transformation 0.03 at 60 Hz.
    """
    denominator = np.real(np.poly(np.exp(low_pass.poles / rate)))
    frequencies = np.linspace(0.0, _BAND * rate, _FREQUENCIES)
    delays = np.exp(-2j * np.pi / rate * np.outer(frequencies, np.arange(len(denominator))))
    basis = delays / (delays @ denominator)[:, None]
    at_rest = np.where(frequencies == 0, _EXACT, 1.0)
    wanted = at_rest * low_pass.response(np.asarray(2j * np.pi * frequencies, dtype=np.complex128))
    basis *= at_rest[:, None]
    numerator = np.linalg.lstsq(
        np.concatenate([basis.real, basis.imag]), np.concatenate([wanted.real, wanted.imag]), rcond=None
    )[0]
    return np.asarray(numerator), denominator


def unexplained_squares(
    residuals: Sequence[Real], rates: Sequence[float], low_pass: LowPass | None
) -> tuple[Real, Real]:
    """Return the squares that residuals have beyond what records may show whatever the motion.

    With the same low-pass, fits with and without it are compared on equal terms.

    Parameters
    ----------
    residuals
        Of each drop, m/s², shape (channel, time); NaN for channels that are left out.
    rates
        Samples per second of each drop.
    low_pass
        Of the loggers; None for none.

    Returns
    -------
    squares, samples
        Sum of squares, (m/s²)², and how many samples count, each of shape (channel,).
    """
    squares, counts = np.zeros(len(residuals[0])), np.zeros(len(residuals[0]))
    for residual, rate in zip(residuals, rates, strict=True):
        sampled, samples = SampledLowPass.of(low_pass, rate), residual.shape[1]
        free, counted = sampled.free_signals(samples), samples - sampled.lag
        left = residual[:, :counted] - (residual @ free) @ free[:counted].T
        is_used = ~np.isnan(left).any(axis=1)
        squares += np.where(is_used, np.einsum("ct,ct->c", left, left), 0.0)
        counts += np.where(is_used, counted, 0)
    return squares, counts

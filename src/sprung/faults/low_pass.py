"""What undoes the low-pass of a single channel, which delays it, and lowers its gain as the frequency grows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import LowPass
from sprung.faults.correction import Correction
from sprung.preprocess import detect_release

Real = NDArray[np.float64]

_PASSED = 30.0
"""Hz up to which a low-pass is undone: vehicles vibrate below."""

_OPEN = 100.0
"""Hz from which the gain is only kept from growing; what it is between helps to keep the kernel short."""

_PRECISE, _LOOSE = 1e4, 0.03
"""Weights of the frequencies that are passed and of those between, against those above."""

_SPAN = 0.016
"""s to each side from which a value is computed."""

_LEAST_GAIN = 0.1
"""Gain of the correction below which nothing is concluded from what it leaves."""

_FREQUENCIES = 400
"""Frequencies up to half the sampling rate at which the response is prescribed."""


def undo_low_pass(channel: int, low_pass: LowPass) -> Correction:
    """Undo a low-pass of a channel for the frequencies at which vehicles vibrate.

    Above them its noise is raised by as much as at their limit, so that it stays white. At rest nothing is undone where the
    release would show before it happens.

    Parameters
    ----------
    channel
        Index of the channel.
    low_pass
        Through which it was recorded.

    Returns
    -------
    Correction
    """

    def undone(values: Real, rate: float) -> Real:
        margin = round(_SPAN * rate)
        if values.shape[1] <= 2 * margin:  # a level at rest passes
            return values
        advance, kernel = inverse_kernel(low_pass, rate)
        padded = np.pad(values[channel], margin + abs(advance), mode="edge")
        first = abs(advance) + advance
        samples = values.copy()
        samples[channel] = np.convolve(padded, kernel, mode="valid")[first : first + values.shape[1]]
        release = detect_release(values, rate)
        if release is not None:  # what comes after it does not move the vehicle before it
            rest = slice(max(release.sample - margin - abs(advance), 0), release.sample)
            samples[channel, rest] = values[channel, rest]
        return samples

    return Correction(samples=undone)


def recorded_energy(residual: Real, low_pass: LowPass, rate: float) -> float:
    """Return the sum of squares that a residual had in the recording, given it where a low-pass was undone.

    Parameters
    ----------
    residual
        m/s², shape (time,).
    low_pass
        That was undone by `undo_low_pass`.
    rate
        Samples per second.

    Returns
    -------
    float
        (m/s²)².
    """
    _, kernel = inverse_kernel(low_pass, rate)
    length = residual.size + kernel.size
    spectrum, gain = np.fft.fft(residual, length), np.fft.fft(kernel, length)
    return float(np.sum(np.abs(spectrum) ** 2 / np.maximum(np.abs(gain), _LEAST_GAIN) ** 2) / length)


def inverse_kernel(low_pass: LowPass, rate: float) -> tuple[int, Real]:
    """Return by how many samples to advance a record, and the kernel of the convolution that then undoes a low-pass.

    Parameters
    ----------
    low_pass
        Through which it was recorded.
    rate
        Samples per second.

    Returns
    -------
    advance
        Samples.
    kernel
        Shape (odd number,), its sum being 1.
    """
    half, limit = round(_SPAN * rate), min(_PASSED, rate / 4)
    frequency = rate / 2 * (np.arange(_FREQUENCIES) + 0.5) / _FREQUENCIES
    passed = np.minimum(frequency, limit)
    inverse = 1 / low_pass.response(2j * np.pi * passed)
    phase = np.unwrap(np.angle(inverse))
    # Above the limit the gain stays what it is there, and so does the delay.
    wanted = np.abs(inverse) * np.exp(1j * phase * frequency / passed)
    advance = round(float(phase[-1]) / (2 * np.pi * limit) * rate)
    wanted = wanted * np.exp(-2j * np.pi * frequency * advance / rate)
    # The convolution takes the value at a lag of k samples from the sample k before.
    design = np.exp(-2j * np.pi * np.outer(frequency, np.arange(-half, half + 1)) / rate)
    weight = np.where(frequency <= limit, _PRECISE, np.where(frequency < _OPEN, _LOOSE, 1.0))
    rows, values = weight[:, None] * design, weight * wanted
    kernel = np.linalg.lstsq(
        np.concatenate([rows.real, rows.imag]), np.concatenate([values.real, values.imag]), rcond=None
    )[0]
    return advance, np.asarray(kernel / kernel.sum(), dtype=np.float64)

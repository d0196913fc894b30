"""How sure poles and shapes are that make the records likeliest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.modal.likelihood import Stand, inverse_information
from sprung.vibration import ModeUncertainty

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_BANDWIDTH, _BINS = 1.5, 6.0
"""Half the band around a mode in which residuals are looked at: times its decay rate as a frequency, and bins at the least."""

_SIGNIFICANT = 3.0
"""Standard errors by which an excess must be real before it counts."""


def spreads(stand: Stand, disagreement: float) -> tuple[ModeUncertainty, ...]:
    """Give the covariances of all modes: the inverse of the Fisher information, enlarged where the residuals are not white.

    Parameters
    ----------
    stand
        At the summit of the likelihood.
    disagreement
        Variance by which pieces of the records differ, in units of what noise alone would make them; 1 for none.

    Returns
    -------
    tuple of Spread
        In the order of the poles.
    """
    samples = stand.decays.numbers
    # Degrees of freedom: what all of the fit takes up, spread over the channels.
    lost = samples / max(samples - stand.parameters / stand.decays.channels, 1.0)
    return bounds(stand, _colour_of_modes(stand) + disagreement - 1, lost)


def bounds(stand: Stand, excess: Real | None = None, lost: float = 1.0) -> tuple[ModeUncertainty, ...]:
    """Give the Cramér-Rao bound of all modes: at true poles, shapes and noise, what no unbiased estimate can better.

    Parameters
    ----------
    stand
        Poles, shapes and, in its weights, the noise of the channels.
    excess
        By which to enlarge the variances of each mode, shape (mode,); by nothing unless given.
    lost
        By which the noise is larger than the weights have it.

    Returns
    -------
    tuple of Spread
        In the order of the poles.
    """
    size, count, channels = stand.shapes.shape[1], stand.poles.count, stand.decays.channels
    covariance = stand.covariance.reshape(channels + 1, size, channels + 1, size)
    conjugate = np.arange(count)
    conjugate[stand.poles.paired] = count + np.arange(len(stand.poles.paired))
    factors, every = np.ones(count) if excess is None else excess, np.arange(channels + 1)
    found = []
    for j, other in enumerate(conjugate.tolist()):
        own, across = covariance[every, j, every, j].real, covariance[every, j, every, other]
        parts = _parts(own, across if other != j else own) * (factors[j] * lost)
        entries = np.sqrt(np.maximum(parts[:-1, [0, 1], [0, 1]], 0.0))
        found.append(
            ModeUncertainty(parts[-1] * stand.decays.rate**2, entries[:, 0] + 1j * entries[:, 1], float(factors[j]))
        )
    return tuple(found)


def bound_alone(stand: Stand, which: int) -> ModeUncertainty:
    """Give the bound of one mode's pole, everything but amplitudes and offsets being known.

    Parameters
    ----------
    stand
        Poles, shapes and, in its weights, the noise of the channels.
    which
        The mode, which vibrates.
    """
    free = stand.pole_of(which)
    covariance = inverse_information(stand.information[np.ix_(free, free)])
    pole = _parts(covariance[:1, 0].real, covariance[:1, 1])[0] * stand.decays.rate**2
    return ModeUncertainty(pole, np.zeros(stand.decays.channels, dtype=np.complex128))


def _parts(own: Real, across: Complex) -> Real:
    """Turn covariances of complex numbers with themselves and with their conjugates into those of their parts.

    Both of shape (number,), the result of shape (number, 2, 2); that of a real number is its own with itself, twice.
    """
    across = np.asarray(across, dtype=np.complex128)
    rows = [[own + across.real, across.imag], [across.imag, own - across.real]]
    parts = np.asarray(np.moveaxis(np.array(rows), -1, 0) / 2, dtype=float)
    # Where one direction is all but undetermined, rounding may make the other negative.
    eigenvalues, vectors = np.linalg.eigh(parts)
    return np.asarray((vectors * np.maximum(eigenvalues, 0.0)[:, None, :]) @ np.swapaxes(vectors, 1, 2), dtype=float)


def _colour_of_modes(stand: Stand) -> Real:
    """Give by how much the residuals' spectrum around each mode exceeds its mean; at least 1, shape (mode,).

    What a mode's pole and shape take from the noise lies in its own band. Channels count as they tell of the mode.
    """
    spectrum = stand.left_spectrum
    power = spectrum.power.mean(axis=0)
    # The spectrum of what is only rounding is no noise's: nothing follows from its colour.
    relative = power / np.maximum(power[:, 1:].mean(axis=1), stand.least_variance)[:, None]
    poles = stand.poles.exponent * stand.decays.rate / (2 * np.pi)
    shares = np.abs(stand.poles.shapes) ** 2 * stand.weights[:, None]
    shares /= shares.sum(axis=0)
    bin_width = float(spectrum.frequency[1])
    found = np.ones(len(poles))
    for j, pole in enumerate(poles):
        half = max(_BANDWIDTH * abs(pole.real), _BINS * bin_width)
        inside = (np.abs(spectrum.frequency - pole.imag) <= half) & (spectrum.frequency > 0)
        excess = float(shares[:, j] @ relative[:, inside].mean(axis=1))
        independent = stand.decays.count * inside.sum() / float((shares[:, j] ** 2).sum())
        if excess > 1 + _SIGNIFICANT / np.sqrt(independent):
            found[j] = excess
    return found

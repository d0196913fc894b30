"""Uncertainty of maximum likelihood poles and shapes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.modal.likelihood import ModalObjective, invert_information
from sprung.vibration import ModeUncertainty

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_BANDWIDTH, _BINS = 1.5, 6.0
"""Half the band around a mode in which residuals are looked at: times its decay rate as a frequency, and bins at the least."""

_SIGNIFICANT = 3.0
"""Standard errors by which an excess must be real before it counts."""


def mode_uncertainties(objective: ModalObjective, disagreement: float) -> tuple[ModeUncertainty, ...]:
    """Return the covariances of all modes: the inverse of the Fisher information, enlarged where the residuals are not white.

    Parameters
    ----------
    objective
        At the maximum of the likelihood.
    disagreement
        Square of the Birge ratio of parts of the records; 1 where they agree.

    Returns
    -------
    tuple of ModeUncertainty
        In the order of the poles.
    """
    samples = objective.decays.sample_count
    # Degrees of freedom: the parameters of the fit are distributed over the channels.
    lost = samples / max(samples - objective.parameters / objective.decays.channels, 1.0)
    return cramer_rao_bounds(objective, _colour_of_modes(objective) + disagreement - 1, lost)


def cramer_rao_bounds(
    objective: ModalObjective, excess: Real | None = None, lost: float = 1.0
) -> tuple[ModeUncertainty, ...]:
    """Return the :term:`Cramér-Rao bound` of all modes: the least covariance of an unbiased estimate, at true values.

    Parameters
    ----------
    objective
        Poles, shapes and, in its weights, the noise of the channels.
    excess
        Factor of the variances of each mode, shape (mode,); 1 unless given.
    lost
        Factor of the noise variance for lost degrees of freedom.

    Returns
    -------
    tuple of ModeUncertainty
        In the order of the poles.
    """
    size, count, channels = objective.shapes.shape[1], objective.poles.count, objective.decays.channels
    covariance = objective.covariance.reshape(channels + 1, size, channels + 1, size)
    conjugate = np.arange(count)
    conjugate[objective.poles.paired] = count + np.arange(len(objective.poles.paired))
    factors, every = np.ones(count) if excess is None else excess, np.arange(channels + 1)
    found = []
    for j, twin in enumerate(conjugate.tolist()):
        own, across = covariance[every, j, every, j].real, covariance[every, j, every, twin]
        parts = _parts(own, across if twin != j else own) * (factors[j] * lost)
        entries = np.sqrt(np.maximum(parts[:-1, [0, 1], [0, 1]], 0.0))
        found.append(
            ModeUncertainty(parts[-1] * objective.decays.rate**2, entries[:, 0] + 1j * entries[:, 1], float(factors[j]))
        )
    return tuple(found)


def pole_bound(objective: ModalObjective, which: int) -> ModeUncertainty:
    """Return the Cramér-Rao bound of one mode's pole, with only amplitudes and offsets unknown besides.

    Parameters
    ----------
    objective
        Poles, shapes and, in its weights, the noise of the channels.
    which
        The mode, which vibrates.
    """
    free = objective.pole_of(which)
    covariance = invert_information(objective.information[np.ix_(free, free)])
    pole = _parts(covariance[:1, 0].real, covariance[:1, 1])[0] * objective.decays.rate**2
    return ModeUncertainty(pole, np.zeros(objective.decays.channels, dtype=np.complex128))


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


def _colour_of_modes(objective: ModalObjective) -> Real:
    """Return the ratio of the residuals' spectrum around each mode to its mean; at least 1, shape (mode,).

    The noise that disturbs a mode's pole and shape lies in the band of the mode. Channels are weighted by their information.
    """
    spectrum = objective.residual_spectrum
    power = spectrum.power.mean(axis=0)
    # The spectrum of rounding errors is not that of noise: its colour has no meaning.
    relative = power / np.maximum(power[:, 1:].mean(axis=1), objective.least_variance)[:, None]
    poles = objective.poles.exponent * objective.decays.rate / (2 * np.pi)
    shares = np.abs(objective.poles.shapes) ** 2 * objective.weights[:, None]
    shares /= shares.sum(axis=0)
    bin_width = float(spectrum.frequency[1])
    found = np.ones(len(poles))
    for j, pole in enumerate(poles):
        half = max(_BANDWIDTH * abs(pole.real), _BINS * bin_width)
        inside = (np.abs(spectrum.frequency - pole.imag) <= half) & (spectrum.frequency > 0)
        excess = float(shares[:, j] @ relative[:, inside].mean(axis=1))
        independent = objective.decays.count * inside.sum() / float((shares[:, j] ** 2).sum())
        if excess > 1 + _SIGNIFICANT / np.sqrt(independent):
            found[j] = excess
    return found

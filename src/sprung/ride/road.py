"""Roads: spectra of ISO 8608, and what the tracks of the wheels have in common.

A road is a stationary Gaussian profile. Its one-sided displacement spectrum over the spatial frequency n is
G_d(n) = G_d(n₀) (n/n₀)^-w with n₀ = 0.1 cycles/m and the waviness w = 2 (ISO 8608:2016). At the speed v the frequency is
f = n v, and the spectrum over f is G_d(f/v)/v.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import gamma, kv

from sprung.display import shown

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

ROAD_CLASSES: Mapping[str, float] = MappingProxyType({name: 16e-6 * 4.0**i for i, name in enumerate("ABCDEFGH")})
"""Geometric mean of the displacement spectrum of each class at 0.1 cycles/m, m³ (ISO 8608, table C.1)."""

REFERENCE_FREQUENCY = 0.1
"""Spatial frequency n₀ at which a class is defined, cycles/m."""

Tracks = Literal["isotropic", "same", "independent"]
"""What the left and the right track have in common: an isotropic surface, one profile, or nothing."""


@shown
@dataclass(frozen=True, slots=True)
class Road:
    """A random road.

    Attributes
    ----------
    name
        Class of ISO 8608, or any other name.
    roughness
        Displacement spectrum at 0.1 cycles/m, G_d(n₀), m³.
    waviness
        Exponent w by which the spectrum falls with the spatial frequency.
    """

    name: str
    roughness: float
    waviness: float = 2.0

    @classmethod
    def of_class(cls, name: str) -> Road:
        """Return the road in the middle of a class of ISO 8608, ``A`` (very good) to ``H``.

        Parameters
        ----------
        name
            The class; `KeyError` for another letter.
        """
        return cls(name, ROAD_CLASSES[name])

    def spectrum(self, frequency: Real, speed: float) -> Real:
        """Return the one-sided spectrum of the height of the road under a wheel.

        Parameters
        ----------
        frequency
            Hz, positive.
        speed
            m/s.

        Returns
        -------
        ndarray
            m²/Hz, of the shape of the frequencies.
        """
        n = frequency / speed
        return np.asarray(self.roughness * (n / REFERENCE_FREQUENCY) ** -self.waviness / speed)


def coherence_of_tracks(wavenumber: Real, distance: Real | float, waviness: float = 2.0) -> Real:
    """Return the coherence function of two parallel tracks on an isotropic surface.

    The profile along any line of an isotropic Gaussian surface has one spectrum, and with it follows that of two parallel lines
    (Dodds and Robson, J. Sound Vib. 31 (1973) 175). For G_d(n) ∝ n^-w the ratio of cross-spectrum to spectrum is
    2^(1 - w/2) / Γ(w/2) (2πnd)^(w/2) K_(w/2)(2πnd), with the modified Bessel function K.

    Parameters
    ----------
    wavenumber
        Spatial frequency n, cycles/m, positive.
    distance
        Between the tracks, d, m; not negative.
    waviness
        w.

    Returns
    -------
    ndarray
        0 to 1, of the shape of both together.
    """
    order = waviness / 2
    x = 2 * np.pi * np.asarray(wavenumber) * distance
    with np.errstate(invalid="ignore"):
        found = 2 ** (1 - order) / gamma(order) * x**order * kv(order, x)
    return np.where(x > 0, found, 1.0)


def spectral_matrix(
    road: Road, frequency: Real, speed: float, places: tuple[Real, Real], tracks: Tracks = "isotropic"
) -> Complex:
    """Return the spectra and cross-spectra of the road under all wheels of a vehicle.

    Parameters
    ----------
    road
        The road.
    frequency
        Hz, shape (line,).
    speed
        m/s; a wheel behind passes everything later, at the distance over the speed.
    places
        Of the wheels, m: forward, and left of the centreline; shape (wheel,) each.
    tracks
        What the left and the right track have in common. Wheels at one distance from the centreline run in one track.

    Returns
    -------
    ndarray of complex
        m²/Hz, shape (line, wheel, wheel); one-sided, Hermitian.
    """
    forward, left = places
    apart = np.abs(left[:, None] - left[None, :])
    delay = np.exp(2j * np.pi * frequency[:, None] * forward / speed)
    shared: Real
    if tracks == "same":
        shared = np.ones((len(frequency), len(left), len(left)))
    elif tracks == "independent":
        same_side = np.sign(left)[:, None] == np.sign(left)[None, :]
        shared = np.broadcast_to(same_side.astype(float), (len(frequency), len(left), len(left)))
    else:
        distances, place = np.unique(apart, return_inverse=True)
        each = coherence_of_tracks(frequency[:, None] / speed, distances, road.waviness)
        shared = each[:, place.reshape(apart.shape)]
    spectrum = road.spectrum(frequency, speed)[:, None, None]
    return np.asarray(spectrum * shared * delay[:, :, None] * delay[:, None, :].conj())

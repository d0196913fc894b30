"""Roads: spectra of the classes, and an isotropic surface against the integral over its wavenumbers."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from sprung.ride import ROAD_CLASSES, Road, coherence_of_tracks
from sprung.ride.road import spectral_matrix


def test_classes_are_those_of_iso_8608() -> None:
    """Table C.1: geometric means in 1e-6 m³ at 0.1 cycles/m."""
    assert [round(ROAD_CLASSES[name] * 1e6) for name in "ABCDEFGH"] == [16, 64, 256, 1024, 4096, 16384, 65536, 262144]


def test_velocity_of_a_road_of_waviness_two_is_white() -> None:
    frequency, speed = np.array([0.3, 2.0, 40.0]), 17.0
    white = Road.of_class("B").spectrum(frequency, speed) * (2 * np.pi * frequency) ** 2
    assert_allclose(white, 4 * np.pi**2 * 64e-6 * 0.1**2 * speed, rtol=1e-13)


@pytest.mark.parametrize("waviness", [1.5, 2.0, 2.6])
@pytest.mark.parametrize("distance", [0.4, 1.5])
def test_coherence_is_that_of_an_isotropic_surface(waviness: float, distance: float) -> None:
    """The profile along x at y has the cross-spectrum ∫ cos(k_y d) Φ(√(k_x² + k_y²)) dk_y, with Φ falling as k^-(w+1)."""
    n = 0.21
    kx = 2 * np.pi * n

    def surface(ky: float) -> float:
        return float((kx**2 + ky**2) ** (-(waviness + 1) / 2))

    whole, _ = quad(surface, 0, np.inf)
    shared, _ = quad(surface, 0, np.inf, weight="cos", wvar=distance)
    assert_allclose(coherence_of_tracks(np.array([n]), distance, waviness)[0], shared / whole, rtol=1e-6)


def test_tracks_at_one_place_are_one() -> None:
    assert_allclose(coherence_of_tracks(np.array([0.01, 1.0]), 0.0), 1.0)
    assert_allclose(coherence_of_tracks(np.array([1e-7]), 1.5), 1.0, rtol=1e-6)


@pytest.mark.parametrize("tracks", ["isotropic", "same", "independent"])
def test_spectra_of_four_wheels_are_those_of_a_possible_road(tracks: str) -> None:
    """Hermitian and not negative; and a rear wheel repeats what its front wheel did a wheelbase earlier."""
    places = (np.array([0.0, 0.0, -2.7, -2.7]), np.array([0.75, -0.75, 0.75, -0.75]))
    frequency, speed = np.geomspace(0.1, 50, 40), 20.0
    S = spectral_matrix(Road.of_class("C"), frequency, speed, places, tracks)  # type: ignore[arg-type]
    assert_allclose(S, np.swapaxes(S, 1, 2).conj(), rtol=1e-12)
    assert np.linalg.eigvalsh(S).min() > -1e-12 * np.abs(S).max()
    delay = np.exp(-2j * np.pi * frequency * 2.7 / speed)
    assert_allclose(S[:, 2, 0], delay * S[:, 0, 0], rtol=1e-12)
    assert_allclose(S[:, 3, 1], delay * S[:, 1, 1], rtol=1e-12)

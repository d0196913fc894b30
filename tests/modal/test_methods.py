"""Every method behind the one door: exact without noise where it can be, and what the others reach."""

from __future__ import annotations

import numpy as np
import pytest
from modal_records import CAR, bumps, noisy
from numpy.testing import assert_allclose

from decaying import SYSTEMS, System, poles
from sprung.errors import InputError
from sprung.modal import APPROXIMATE, METHODS, identify_modes

EXACT = [method for method in METHODS if method not in APPROXIMATE]


@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS)
@pytest.mark.parametrize("method", EXACT)
def test_exact_without_noise_for_complex_real_and_repeated_poles(method: str, system: System) -> None:
    records = system.decays(3, 100.0, 4.0)
    found = identify_modes(records, 100.0, method)
    assert_allclose(poles(found), poles(system.modes), rtol=1e-8)
    true = np.stack([mode.shape for mode in system.modes], axis=1)
    for mode in found:
        # A repeated pole has a plane of shapes: any in it is right.
        near = np.abs(np.array([one.pole for one in system.modes]) - mode.pole) < 1e-6
        plane = np.linalg.qr(true[:, near])[0]
        assert np.linalg.norm(mode.shape - plane @ (plane.conj().T @ mode.shape)) < 1e-6


@pytest.mark.parametrize("method", [method for method in EXACT if method != "svm-printed"])
def test_exact_for_the_car_whose_wheel_hops_are_nearly_one(method: str) -> None:
    # 10.768 and 10.771, 11.286 and 11.288 Hz: 0.003 Hz apart. Recursions of two samples know no offset.
    offset = 0.0 if method == "svm" else 0.3
    found = identify_modes([record + offset for record in bumps()], 1000.0, method)
    distance = np.abs(poles(found)[:, None] - poles(CAR)).min(axis=0)
    assert np.all(distance < 1e-8 * np.abs(poles(CAR)))


def test_one_lag_as_printed_loses_digits_at_a_millisecond() -> None:
    # At a millisecond the states before and after hardly differ: of sixteen digits about half are lost.
    found = identify_modes(bumps(), 1000.0, "svm-printed")
    distance = np.abs(poles(found)[:, None] - poles(CAR)).min(axis=0) / np.abs(poles(CAR))
    assert distance.max() < 1e-5


def test_peaks_are_near_where_modes_are_lightly_damped_and_apart() -> None:
    # Two oscillators of 2 and 6 Hz with 1 % damping: the half-power width is exact to the square of the damping ratio.
    omega = 2 * np.pi * np.array([2.0, 6.0])
    system = System.of(np.eye(2), np.diag(0.02 * omega), np.diag(omega**2))
    found = identify_modes(system.decays(3, 100.0, 60.0), 100.0, "peaks")
    assert_allclose([mode.frequency for mode in found], [2.0, 6.0], rtol=1e-3)
    assert_allclose([mode.damping_ratio for mode in found], [0.01, 0.01], rtol=0.05)


def test_intrinsic_motions_are_near_where_modes_are_lightly_damped_and_far_apart() -> None:
    omega = 2 * np.pi * np.array([1.0, 6.0])
    system = System.of(np.eye(2), np.diag(0.04 * omega), np.diag(omega**2))
    found = identify_modes(system.decays(3, 100.0, 20.0), 100.0, "emd", order=4)
    assert_allclose([mode.frequency for mode in found], [1.0, 6.0], rtol=0.01)
    assert_allclose([mode.damping_ratio for mode in found], [0.02, 0.02], rtol=0.1)


LIMITS = {
    # Percent of error of the body's frequencies and damping ratios with four drops at 40 dB: three times what one seed gave.
    "ml": (0.02, 0.1), "ml-frequency": (0.02, 0.1), "era": (0.06, 0.2), "svm-rows": (0.06, 0.2), "itd": (0.06, 0.2),
    "era-dc": (0.12, 0.3), "ssi-cov": (0.3, 0.4), "ssi-data": (0.4, 0.5), "arma": (0.4, 0.8), "lscf": (0.1, 0.4),
}  # fmt: skip


@pytest.mark.parametrize("method", LIMITS)
def test_with_noise_the_better_methods_find_all_seven(method: str) -> None:
    found = identify_modes(noisy(bumps(), 40.0, 1), 1000.0, method)
    assert len(found) == 7
    frequency, damping = LIMITS[method]
    for true in CAR[:3]:
        mode = found[int(np.argmin([abs(one.pole - true.pole) for one in found]))]
        assert abs(mode.frequency / true.frequency - 1) < frequency / 100
        assert abs(mode.damping_ratio / true.damping_ratio - 1) < damping / 100


@pytest.mark.parametrize("method", METHODS)
def test_what_was_asked_beyond_the_records_is_refused_with_numbers(method: str) -> None:
    records = SYSTEMS["complex"].decays(2, 100.0, 4.0)
    with pytest.raises(InputError, match=rf"{method}: order: found 5000; expected .*\d"):
        identify_modes(records, 100.0, method, order=5000)


@pytest.mark.parametrize("method", ["era", "ssi-data", "lscf", "arma"])
def test_what_is_not_kept_has_its_reason(method: str) -> None:
    found = identify_modes(noisy(bumps(), 40.0, 1), 1000.0, method, order=8)
    assert sum(2 if mode.pole.imag else 1 for mode in found) <= 8
    assert all(one.reason for one in found.rejected)

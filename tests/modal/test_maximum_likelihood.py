"""The default method: exact without noise, at the bound with it, and honest where the records do not tell."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from modal_records import CAR, bound, bumps, noisy
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from decaying import SYSTEMS, System, poles
from sprung.errors import InputError
from sprung.modal import ModeSet, identify_modes, maximum_likelihood
from sprung.vehicle import Vehicle, free_decay
from sprung.vibration import Mode, compute_modes, modal_assurance_criterion
from strategies import vehicles

Array = NDArray[np.float64]


@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS)
@pytest.mark.parametrize("rate", [100.0, 1000.0])
def test_poles_and_shapes_are_exact_without_noise(system: System, rate: float) -> None:
    found = maximum_likelihood(system.decays(3, rate, 4.0), rate)
    assert_allclose(poles(found), poles(system.modes), rtol=1e-8)
    true = np.stack([mode.shape for mode in system.modes], axis=1)
    for mode in found:
        # A repeated pole has a plane of shapes: any in it is right.
        near = np.abs(np.array([one.pole for one in system.modes]) - mode.pole) < 1e-6
        plane = np.linalg.qr(true[:, near])[0]
        assert np.linalg.norm(mode.shape - plane @ (plane.conj().T @ mode.shape)) < 1e-7


@given(vehicles, st.integers(0, 5))
@settings(max_examples=6, deadline=None)
def test_any_vehicle_without_noise(vehicle: Vehicle, seed: int) -> None:
    random = np.random.default_rng(seed)
    states = random.standard_normal((5, 14)) * np.repeat([0.01, 0.3], 7)
    records = [free_decay(vehicle.matrices(), state, 0.002, 1600).acceleration for state in states]
    found = maximum_likelihood(records, 500.0)
    expected = poles(compute_modes(vehicle.matrices()))
    distance = np.abs(poles(found)[:, None] - expected).min(axis=0)
    assert np.all(distance < 1e-8 * np.abs(expected))
    # What is left is rounding, the processor's own: its spectrum enlarges nothing.
    assert [mode.uncertainty.excess for mode in found if mode.uncertainty is not None] == [1.0] * len(found)


def matched(found: ModeSet) -> list[Mode]:
    """Bring modes into the order of the car's, the nearest to each."""
    measured = np.array([mode.pole for mode in found])
    return [found[int(np.argmin(np.abs(measured - true.pole)))] for true in CAR]


def test_twelve_seeds_are_at_the_bound_and_covered() -> None:
    # docs/studies/modal.md has a thousand. 168 errors over their bound: their mean square is 1 +- 0.11 (one sigma).
    clean = bumps()
    limits = bound(clean, 40.0)
    errors, covered = [], []
    for seed in range(12):
        found = identify_modes(noisy(clean, 40.0, seed), 1000.0)
        assert len(found) == 7
        for mode, true in zip(matched(found), limits, strict=True):
            assert mode.frequency_std is not None
            assert mode.damping_ratio_std is not None
            assert true.frequency_std is not None
            assert true.damping_ratio_std is not None
            off = mode.frequency - true.frequency, mode.damping_ratio - true.damping_ratio
            errors.append((off[0] / true.frequency_std, off[1] / true.damping_ratio_std))
            covered.append((abs(off[0]) < 1.96 * mode.frequency_std, abs(off[1]) < 1.96 * mode.damping_ratio_std))
    assert np.sqrt(np.mean(np.square(errors))) < 1.15
    assert 0.90 <= np.mean(covered) <= 0.99


def test_the_bound_is_that_of_another_computation() -> None:
    # The information written out sample by sample in another program: 0.0057 and 0.0225 % of the first mode, offsets known;
    # here every channel of every drop has an offset of its own.
    first = bound(bumps(), 40.0)[0]
    assert first.frequency_std is not None
    assert first.damping_ratio_std is not None
    assert first.frequency_std / first.frequency == pytest.approx(5.7e-5, rel=0.05)
    assert first.damping_ratio_std / first.damping_ratio == pytest.approx(2.25e-4, rel=0.05)


def test_coloured_noise_makes_the_uncertainty_grow() -> None:
    # A first-order process with ρ = 0.98 at 1 kHz has, at 1 Hz, (1 + ρ)/(1 - ρ) = 99 times the spectrum of white noise.
    random = np.random.default_rng(4)
    clean = bumps()
    size = 0.01 * np.sqrt((clean[0] ** 2).mean(axis=1, keepdims=True))
    records = []
    for record in clean:
        noise = random.standard_normal(record.shape)
        for k in range(1, noise.shape[1]):
            noise[:, k] = 0.98 * noise[:, k - 1] + np.sqrt(1 - 0.98**2) * noise[:, k]
        records.append(record + size * noise)
    found = maximum_likelihood(records, 1000.0)
    assert found[0].uncertainty is not None
    assert 40 < found[0].uncertainty.excess < 150
    for mode in (found[0], found[1]):
        true = CAR[int(np.argmin([abs(one.pole - mode.pole) for one in CAR]))]
        assert mode.frequency_std is not None
        assert abs(mode.frequency - true.frequency) < 4 * mode.frequency_std


def test_noise_alone_has_no_modes() -> None:
    random = np.random.default_rng(5)
    with pytest.raises(InputError, match="nothing above the noise"):
        identify_modes([random.standard_normal((4, 2000)) for _ in range(3)], 500.0)


@given(st.permutations(range(7)), st.floats(0.01, 100))
@settings(max_examples=5, deadline=None)
def test_channel_order_and_unit_do_not_matter(order: list[int], factor: float) -> None:
    measured = noisy(bumps(rate=250.0), 30.0, 3)
    plain = maximum_likelihood(measured, 250.0)
    changed = maximum_likelihood([factor * record[order] for record in measured], 250.0)
    assert_allclose(poles(changed), poles(plain), rtol=1e-6)
    for one, other in zip(plain, changed, strict=True):
        assert modal_assurance_criterion(one.shape[order, None], other.shape[:, None])[0, 0] > 1 - 1e-6


def test_records_may_differ_in_length() -> None:
    clean = [record[:, : 4000 - 300 * i] for i, record in enumerate(bumps())]
    assert_allclose(poles(maximum_likelihood(clean, 1000.0)), poles(CAR), rtol=1e-8)


def test_bad_input_is_refused_with_its_numbers() -> None:
    clean = bumps(rate=250.0)
    with pytest.raises(InputError, match="found 1 channel; expected two or more"):
        identify_modes([record[:1] for record in clean], 250.0)
    # 1.2 s are 1.26 periods of the lowest mode, 1.051 Hz.
    with pytest.raises(
        InputError, match=r"1\.2 s, 1\.3 periods of the lowest mode at 1\.05 Hz; expected at least 1\.9 s"
    ):
        identify_modes([record[:, :300] for record in clean], 250.0)
    with pytest.raises(InputError, match=r"order: found 400; expected 1 to \d+ for 7 channels and 4 s"):
        identify_modes(clean, 250.0, order=400)
    with pytest.raises(InputError, match="no motion in any channel"):
        identify_modes([np.ones((3, 500))], 250.0)

"""The stabilisation diagram, and what its criteria measure."""

from __future__ import annotations

import numpy as np
import pytest
from modal_records import CAR, bumps, noisy

import sprung
from decaying import SYSTEMS
from sprung.modal import StabilityCriteria, modal_phase_collinearity, stabilisation_diagram
from sprung.preprocess import prepare
from sprung.vehicle import Vehicle
from sprung.vibration import compute_modes


def test_the_seven_modes_of_the_car_stay_and_no_other() -> None:
    diagram = stabilisation_diagram(noisy(bumps(), 40.0, 1), 1000.0)
    chosen = np.array([cluster.pole for cluster in diagram.chosen])
    assert len(chosen) == 7
    for mode in CAR:
        assert np.min(np.abs(chosen - mode.pole)) < 0.01 * abs(mode.pole)
    assert diagram.rejected
    assert all("required" in one.reason or "grows" in one.reason for one in diagram.rejected)


def test_a_true_mode_is_coherent_from_first_to_last_block_row_however_damped() -> None:
    # Without noise the span of a sufficient order holds each mode as it is: the coherence is 1.
    diagram = stabilisation_diagram(bumps(), 1000.0, highest=14)
    assert all(one.coherence == pytest.approx(1.0, abs=1e-6) for one in diagram.poles if one.order == 14)


def test_a_mode_that_dies_away_before_the_last_block_row_stays() -> None:
    """Wheel hop of a quarter car, with a damping ratio of 0.27, is gone while its body bounces on."""
    quarter = Vehicle(model="quarter", m_s=345.0, m_u=40.35, k_s=17e3, k_t=180e3, c_s=1480.0)
    campaign = sprung.simulate(quarter, drops=[{"wheels": ("wheel",)}], rate=500.0, noise=0.02, seed=1)
    (decay,) = prepare(campaign).decays
    diagram = stabilisation_diagram([decay.values], decay.rate)
    chosen = np.array([cluster.pole for cluster in diagram.chosen])
    modes = compute_modes(quarter.matrices(), quarter.layout.coordinates)
    assert len(modes) == 2
    assert all(np.min(np.abs(chosen - mode.pole)) < 0.01 * abs(mode.pole) for mode in modes)


def test_stricter_criteria_leave_less() -> None:
    records = noisy(bumps(), 20.0, 2)
    usual = stabilisation_diagram(records, 1000.0)
    strict = stabilisation_diagram(records, 1000.0, criteria=StabilityCriteria(frequency=1e-4, damping=1e-3))
    assert len(strict.chosen) < len(usual.chosen)


def test_real_poles_stay_too() -> None:
    system = SYSTEMS["real"]
    chosen = [cluster.pole for cluster in stabilisation_diagram(system.decays(3, 200.0, 4.0), 200.0, highest=12).chosen]
    for mode in system.modes:
        assert min(abs(pole - mode.pole) for pole in chosen) < 1e-3 * abs(mode.pole)


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        # Points on a line through the origin; a circle; and by hand: real part (1, 0), imaginary part (0, 1/2), whose
        # covariance has the eigenvalues 1 and 1/4: ((1 - 1/4)/(1 + 1/4))² = 0.36.
        ([1 + 1j, -2 - 2j, 0.5 + 0.5j], 1.0),
        ([1, 1j, -1, -1j], 0.0),
        ([1, 0.5j], 0.36),
    ],
)
def test_phase_collinearity(shape: list[complex], expected: float) -> None:
    assert modal_phase_collinearity(shape) == pytest.approx(expected, abs=1e-12)

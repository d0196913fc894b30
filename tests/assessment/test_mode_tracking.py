"""Following a mode where there is nothing to follow: the pole of a window must not run away."""

from __future__ import annotations

import numpy as np
import pytest

from sprung.assessment.mode_tracking import follow_mode
from sprung.vehicle import Vehicle
from sprung.vibration import Mode, compute_modes

# Wheels that hop at 27 Hz: k_t = (2π 27 Hz)² m_u.
M_U = 30.0
K_T = (2 * np.pi * 27) ** 2 * M_U
STIFF = Vehicle(
    m_s=1380,
    I_yy=2440,
    I_xx=380,
    m_uf=M_U,
    m_ur=33,
    k_sf=17000,
    k_sr=22000,
    k_tf=K_T,
    k_tr=K_T * 1.1,
    c_sf=3000,
    c_sr=3000,
    a=1.25,
    b=1.51,
    t_f=0.74,
    t_r=0.74,
)


@pytest.fixture(scope="module")
def modes() -> list[Mode]:
    return [mode for mode in compute_modes(STIFF.matrices()) if mode.pole.imag != 0]


@pytest.mark.parametrize(("seed", "which"), [(53, 1), (229, 2)])
def test_steps_of_a_recorder_lead_to_no_runaway(modes: list[Mode], seed: int, which: int) -> None:
    """A motion that has died leaves steps of 12 bit at 2 kHz: no window may tell a frequency above half its rate.

    The pole of one window began the next one, which was shorter: soon there were fewer samples than unknowns, of which
    any pole is certain, and it grew until numbers overflowed.
    """
    record = np.round(np.random.default_rng(seed).normal(scale=0.6, size=(3, 3000))) * 0.03
    trace = follow_mode("x", record, 2000.0, np.full(3, 0.01), modes, which, 0.7)
    assert (trace.frequency < 6 * 27.2 / 2).all()  # six samples per period of the fastest mode, 27.13 Hz
    assert np.isfinite(trace.amplitude).all()


@pytest.mark.slow
def test_a_window_with_fewer_samples_than_unknowns_says_nothing(modes: list[Mode]) -> None:
    """1.5 periods of 26.7 Hz at 60 Hz are 4 samples of 3 motions, for 3 offsets, 12 other amplitudes and 4 unknowns."""
    record = np.random.default_rng(1).normal(size=(3, 200))
    which = next(i for i, mode in enumerate(modes) if mode.frequency > 20)
    assert follow_mode("x", record, 60.0, np.ones(3), modes, which, 1.0).time.size == 0


def test_what_grows_is_followed_without_overflow(modes: list[Mode]) -> None:
    """Damping of -0.05, within what a window may show; amplitude in the middle of each window as it was made."""
    time = np.arange(1200) / 400
    pole = 2 * np.pi * 1.2 * complex(0.05, np.sqrt(1 - 0.05**2))
    shape = modes[0].shape[:3]
    record = np.real(shape[:, None] * pole**2 * 0.01 * np.exp(pole * time))
    trace = follow_mode("x", record, 400.0, np.full(3, 1e-3), modes, 0, 1.0)
    assert trace.time.size >= 5
    # Averaging two neighbours at 400 Hz changes a motion of 1.2 Hz by 1 - (π 1.2 / 400)²/2 < 1e-4.
    np.testing.assert_allclose(trace.frequency, 1.2, rtol=1e-3)
    np.testing.assert_allclose(trace.damping_ratio, -0.05, atol=1e-3)
    np.testing.assert_allclose(trace.amplitude, 0.01 * np.exp(pole.real * trace.time), rtol=1e-2)

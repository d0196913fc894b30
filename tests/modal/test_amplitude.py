"""Modes followed through decays, and the bolted beam of the development recordings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from decaying import SYSTEMS
from sprung.modal import amplitude_dependence, identify_modes


def test_a_linear_system_has_the_same_modes_at_every_amplitude() -> None:
    system = SYSTEMS["complex"]
    random = np.random.default_rng(1)
    records = [record + 1e-3 * random.standard_normal(record.shape) for record in system.decays(2, 200.0, 6.0)]
    for trace in amplitude_dependence(records, 200.0, identify_modes(records, 200.0)):
        assert np.all(np.diff(trace.amplitude) <= 0)
        # Five standard errors, for some dozens of windows.
        assert np.all(np.abs(trace.frequency - trace.mode.frequency) < 5 * trace.frequency_std + 1e-9)
        assert np.all(np.abs(trace.damping_ratio - trace.mode.damping_ratio) < 5 * trace.damping_ratio_std + 1e-9)


def test_a_frequency_that_falls_with_amplitude_is_followed() -> None:
    # Amplitude a = e^{-0.2 t}, frequency 5 - 0.2 a Hz: the phase is 2π(5 t - (1 - e^{-0.2 t})). Two channels, one shape.
    time = np.arange(4000) / 200
    motion = np.exp(-0.2 * time) * np.cos(2 * np.pi * (5 * time - (1 - np.exp(-0.2 * time))))
    random = np.random.default_rng(2)
    records = [np.array([[1.0], [-0.5]]) * motion + 1e-3 * random.standard_normal((2, 4000))]
    trace = amplitude_dependence(records, 200.0, identify_modes(records, 200.0, order=2))[0]
    assert np.max(np.abs(trace.frequency - (5 - 0.2 * trace.amplitude))) < 0.02
    assert trace.frequency_trend is not None
    assert trace.frequency_trend[0] < -3 * trace.frequency_trend[1]


@pytest.mark.shared
@pytest.mark.long
def test_the_bolted_beam_is_softer_and_damps_more_at_large_amplitude(shared: Path) -> None:
    data = loadmat(shared / "data" / "real" / "HammerImpact.mat", squeeze_me=True, struct_as_record=False)["HIdata"]
    rate = 1 / float(np.diff(data.time).mean())
    record = np.stack([data.acc1, data.acc2, data.acc3])[:, int(0.02 * rate) :]  # the blow is over after 10 ms
    modes = identify_modes([record], rate)
    traces = amplitude_dependence([record], rate, modes)
    for peak in (80.5, 297.7):  # of the Fourier transform
        mode = min(modes, key=lambda one: abs(one.frequency - peak))
        assert mode.frequency == pytest.approx(peak, rel=0.003)
        assert 0.0005 < mode.damping_ratio < 0.004
        trace = next(one for one in traces if one.mode is mode)
        assert trace.frequency_trend is not None
        assert trace.damping_trend is not None
        assert trace.frequency_trend[0] < -3 * trace.frequency_trend[1]
        assert trace.damping_trend[0] > 3 * trace.damping_trend[1]

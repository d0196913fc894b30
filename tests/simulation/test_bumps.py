"""The paper's numerical example as a campaign."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sprung.simulation import drive_over_half_sine_bump, half_sine_bumps, tyre_rates
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import TABLE_1_CAR, WHEELS, Added, Load, Sensor, free_decay

# Ten per cent of every mass of Table 1, the paper's lost eq. (20).
TENTH = Load(name="tenth", added=Added(mass=138, I_yy=244, I_xx=38, m_uf=4.05, m_ur=4.54))
ON_WHEELS = [Sensor(channel=station, on=station) for station in WHEELS]


@pytest.mark.parametrize("rate", [500.0, 330.0], ids=["end on a sample", "bump begins and ends between samples"])
def test_the_decay_starts_at_the_end_of_the_bump(rate: float) -> None:
    campaign = half_sine_bumps(TABLE_1_CAR, loads=[TENTH], sensors=ON_WHEELS, rate=rate)
    assert [drop.file for drop in campaign.drops] == ["empty_bump.csv", "tenth_bump.csv"]
    for drop, recording in zip(campaign.drops, campaign.recordings, strict=True):
        before = round(0.1 * rate)
        assert drop.start == pytest.approx(before / rate + 0.2)
        assert_allclose(recording.values[:, :before], STANDARD_GRAVITY, rtol=1e-12)
        matrices = TABLE_1_CAR.matrices(campaign.load(drop.load))
        _, end = drive_over_half_sine_bump(matrices, tyre_rates(TABLE_1_CAR), ("fl", "rl"), 0.09, 0.2, 1 / rate, 2)
        first = int(np.flatnonzero(recording.time > before / rate + 0.2 - 1e-9)[0])
        lag = recording.time[first] - before / rate - 0.2
        assert lag < 1 / rate
        later = free_decay(matrices, end, max(lag, 0.0) + 1e-300, 2)
        state = np.concatenate([later.displacement[:, 1], later.velocity[:, 1]])
        expected = free_decay(matrices, state, 1 / rate, recording.values.shape[1] - first)
        assert_allclose(recording.values[:, first:], STANDARD_GRAVITY + expected.acceleration[3:], atol=1e-9)


def test_the_bump_of_the_paper_is_under_the_left_wheels() -> None:
    # Section 3: z_gA and z_gC are the bump, z_gB and z_gD are zero; the left wheels feel it at once.
    recording = half_sine_bumps(TABLE_1_CAR, sensors=ON_WHEELS, rate=1000).recordings[0]
    left_front, right_front, left_rear, right_rear = recording.values[:, 101] - STANDARD_GRAVITY
    # k_t z_g / m_u after 1 ms: 192000 · 0.09 sin(5π/1000) / 40.5 and / 45.4 m/s², less what the wheel has moved.
    assert left_front == pytest.approx(192_000 * 0.09 * np.sin(0.005 * np.pi) / 40.5, rel=0.05)
    assert left_rear == pytest.approx(192_000 * 0.09 * np.sin(0.005 * np.pi) / 45.4, rel=0.05)
    assert abs(right_front) + abs(right_rear) < 0.01

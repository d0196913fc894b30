"""Tables 2 (simulation) and 3 (school bus) of the paper as printed, misprints included."""

from __future__ import annotations

from typing import NamedTuple


class PrintedParameter(NamedTuple):
    """One row of Table 2."""

    known: float
    identified: float
    error_percent: float


class PrintedMode(NamedTuple):
    """One row of Table 3; frequencies in Hz."""

    fft: float | None
    damped_frequency: float
    fft_error_percent: float | None
    natural_frequency: float
    damping_ratio: float


TABLE_2 = {
    "m_s": PrintedParameter(1380, 1379.50, -0.036),
    "I_yy": PrintedParameter(2440, 2439.20, -0.033),
    "I_xx": PrintedParameter(380, 379.77, -0.059),
    "m_uf": PrintedParameter(40.5, 39.99, -1.261),
    "m_ur": PrintedParameter(45.4, 44.82, -1.288),
    "k_sf": PrintedParameter(17000, 16600.17, -0.587),
    "k_sr": PrintedParameter(22000, 21824.96, -0.796),
    "k_tf": PrintedParameter(192000, 189173.82, -1.472),
    "k_tr": PrintedParameter(192000, 189134.48, -1.493),
    "c_sf": PrintedParameter(1500, 1493.31, -0.446),
    "c_sr": PrintedParameter(1500, 1492.88, -0.475),
    "a": PrintedParameter(1.25, 1.232, -1.436),
    "b": PrintedParameter(1.51, 1.500, -0.692),
    "t_f": PrintedParameter(0.74, 0.731, -1.223),
    "t_r": PrintedParameter(0.74, 0.733, -0.916),
}

TABLE_3 = {
    "body bounce": PrintedMode(2.018, 1.9913, 1.34, 2.0074, 0.1264),
    "body pitch": PrintedMode(None, 2.8204, None, 2.8995, 0.1626),
    "body roll": PrintedMode(1.06, 1.0616, -0.15, 1.0707, 0.1297),
    "wheel bounce": PrintedMode(12.21, 12.4157, -1.66, 12.3449, 0.1066),
    "wheel pitch": PrintedMode(12.66, 12.4418, 1.75, 12.4550, 0.0984),
    "wheel roll": PrintedMode(13.47, 13.8558, -2.78, 14.0952, 0.1835),
    "wheel articulation": PrintedMode(13.57, 13.9655, -2.83, 14.1808, 0.1736),
}

K_ID_FRONT_RIGHT_WHEEL = 206073.9
"""Entry (5, 5) of K_id, eq. (23), N/m: k_sf + k_tf."""

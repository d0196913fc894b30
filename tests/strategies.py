"""Vehicles of every kind, for laws that hold for all of them."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from sprung.vehicle import Vehicle


def make_vehicle(
    mass: float,
    share: float,
    body: tuple[float, float],
    hop: tuple[float, float],
    damping: tuple[float, float],
    wheel: tuple[float, float],
    spread: tuple[float, float],
    tracks: tuple[float, float],
    damper_tracks: tuple[float, float] | None = None,
) -> Vehicle:
    """Make a vehicle from what an engineer would say of it.

    Mass of the body, kg; the front axle's share of its weight; frequency of each end, Hz; wheel hop, Hz; damping ratios; each
    wheel's part of the body's mass; the body's spread in pitch and roll; half-distances in wheelbases.
    """
    wheelbase = 2.4 * (mass / 1000) ** 0.25
    a, b = (1 - share) * wheelbase, share * wheelbase
    corner = mass / 2 * np.array([share, 1 - share])
    k_s = corner * (2 * np.pi * np.array(body)) ** 2
    m_u = mass * np.array(wheel)
    k_t = np.maximum(m_u * (2 * np.pi * np.array(hop)) ** 2 - k_s, 2 * k_s)
    c_s = 2 * np.array(damping) * np.sqrt(k_s * corner)
    t_f, t_r = (float(t * wheelbase) for t in tracks)
    t_f1, t_r1 = (t_f, t_r) if damper_tracks is None else (float(t * wheelbase) for t in damper_tracks)
    return Vehicle(
        m_s=mass, I_yy=mass * a * b * spread[0], I_xx=mass * (t_f + t_r) ** 2 / 4 * spread[1],
        m_uf=float(m_u[0]), m_ur=float(m_u[1]), k_sf=float(k_s[0]), k_sr=float(k_s[1]), k_tf=float(k_t[0]), k_tr=float(k_t[1]),
        c_sf=float(c_s[0]), c_sr=float(c_s[1]), a=a, b=b, t_f1=t_f1, t_r1=t_r1, t_f2=t_f, t_r2=t_r,
    )  # fmt: skip


def _pair(low: float, high: float) -> st.SearchStrategy[tuple[float, float]]:
    one = st.floats(low, high)
    return st.tuples(one, one)


vehicles = st.builds(
    make_vehicle,
    mass=st.floats(400, 16000),
    share=st.floats(0.35, 0.65),
    body=_pair(0.8, 3.0),
    hop=_pair(8, 22),
    damping=_pair(0.08, 0.7),
    wheel=_pair(0.015, 0.06),
    spread=_pair(0.7, 1.3),
    tracks=_pair(0.22, 0.32),
)
"""Two-axle vehicles from a microcar to a lorry, springs and dampers sharing their half-distances."""

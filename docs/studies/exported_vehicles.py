"""Vehicles with every model term and of every layout, and the drop with which an exported model is compared."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from numpy.typing import NDArray

from sprung.simulation import BlockSupport, drop_from_blocks, simulate_nonlinear_drops
from sprung.vehicle import EMPTY, TABLE_1_CAR, Item, Load, Motion, Vehicle, nonlinear_elements

RATE, SAMPLES, HEIGHT = 1000.0, 601, 0.05
"""Hz, and m: of the drop."""

WITHIN = 1e-3
"""Part of the range of a motion within which another program repeats it, by the issue: 0.1 %."""

LUGGAGE = Load(
    name="luggage", items=(Item(mass=200, position=(-2.0, 0.2, 0.8)), Item(mass=90, position=(-1.0, -0.3, 0.8)))
)
SEATED = Load(name="seated", items=(Item(mass=80, position=(-1.2, 0.3, 0.8), on="seat"), Item(mass=30, on="fl")))


def _car(**further: float) -> Vehicle:
    return Vehicle({**TABLE_1_CAR.parameters, **further}, name="car")


def _both(**further: float) -> dict[str, float]:
    return {f"{name}{axle}": value for name, value in further.items() for axle in "fr"}


_RUBBING = _both(F_=60.0, s_=2e5)
_KNEES = _both(v_k=0.15, q_=0.5, v_2=0.4, q_2=0.8)

VEHICLES: Mapping[str, Vehicle] = {
    "car": TABLE_1_CAR,
    "tyre-damping": _car(**_both(c_t=60.0)),
    "friction": _car(**_RUBBING),
    "front-friction": _car(F_f=60.0, s_f=2e5),
    "load-friction": _car(**_RUBBING, **_both(u_=0.05)),
    "uneven-friction": _car(**_RUBBING, d_Ff=25.0, d_Fr=-15.0),
    "rebound": _car(**_both(r_=1.8)),
    "curve": _car(**_both(r_=1.8), **_KNEES),
    "rounded": _car(**_KNEES, **_both(w_k=0.03)),
    "rebound-knee": _car(**_both(r_=1.8, b_k=0.7, b_q=1.3), **_KNEES),
    "rounded-rebound": _car(**_KNEES, **_both(b_k=0.7, b_q=1.3, w_k=0.03)),
    "degressive": _car(**_both(p_=-1.0, e_l=2.0, g_=15.0)),
    "progressive": _car(**_both(p_=3.0)),
    "air": _car(**_both(e_=2.5)),
    "levelled-air": _car(**_both(e_l=2.5, g_=15.0)),
    "air-and-stop": _car(**_both(e_=1.0, e_l=2.0, g_=15.0, k_b=6e4, x_b=0.03)),
    "bump-stop": _car(**_both(k_b=6e4, x_b=0.03)),
    "tyre-curve": _car(**_both(h_t=5.0)),
    "mount": _car(**_both(k_d=4e5, c_d=50.0), r_f=1.5, r_r=1.5),
    "zener": _car(**_both(k_z=5e3, c_z=300.0)),
    "left-right": _car(k_af=4e3, k_xf=5e3, c_xf=800.0, y_s=0.02, d_ktf=5e3, d_csf=100.0, d_ksr=500.0),
    "rigid-axle": _car(n_r=0.8),
    "heavy-axle": _car(n_r=0.8, m_xr=15.0),
    "attached": _car(
        m_e=180.0, k_e=4e5, c_e=1500.0, x_e=0.2, m_o=150.0, k_o=9e4, c_o=900.0, x_o=-1.2, y_o=0.1, t_o=0.4
    ),
    "uneven-seats": _car(m_o=150.0, k_o=9e4, c_o=900.0, x_o=-1.2, d_mo=12.0, d_ko=-7e3, d_co=80.0),
    "flexible": _car(
        I_w=150.0, k_w=4e5, c_w=200.0, a_w=0.1, u_w=0.05, e_w=-0.02, m_v=400.0, k_v=3e6, c_v=2e3, b_v=0.5, p_v=0.02
    ),
    "heights": TABLE_1_CAR.with_values(cg_height=0.55, wheel_height=0.3),
    "roll-axis": TABLE_1_CAR.with_values(cg_height=0.55, wheel_height=0.3, roll_axis_height=0.2),
    "rubbing-heights": _car(**_RUBBING).with_values(cg_height=0.55, wheel_height=0.3),
    "weight": _car(w_h=3000.0),
    "separate": Vehicle(
        {
            **{name: value for name, value in TABLE_1_CAR.parameters.items() if name not in ("t_f", "t_r")},
            "t_f1": 0.6, "t_f2": 0.7, "t_r1": 0.55, "t_r2": 0.65,
        }
    ),
    "quarter": Vehicle(model="quarter", m_s=300, m_u=40, k_s=2e4, k_t=2e5, c_s=1500),
    "pitch-plane": Vehicle(
        model="pitch-plane", m_s=600, I_yy=900, m_uf=40, m_ur=45, k_sf=18000, k_sr=20000, k_tf=2e5, k_tr=1.9e5,
        c_sf=1400, c_sr=1500, a=1.2, b=1.4, F_f=40.0, F_r=40.0, s_f=2e5, s_r=2e5,
    ),
    "roll-plane": Vehicle(model="roll-plane", m_s=433, I_xx=82, m_u=56, k_s=2e4, k_t=1.5e5, c_s=900, t=0.75, k_a=3e3),
}  # fmt: skip
"""By what they have beside the paper's car, or the part of a vehicle that they are."""

LOADS: Mapping[str, Load] = {
    "load-friction": LUGGAGE,
    "levelled-air": LUGGAGE,
    "air-and-stop": LUGGAGE,
    "progressive": LUGGAGE,
    "tyre-curve": LUGGAGE,
    "flexible": LUGGAGE,
    "heights": LUGGAGE,
    "rubbing-heights": LUGGAGE,
    "seated": SEATED,
}
"""Loads with which some of them are exported; the others are empty."""

SEATS = _car(w_l=400.0, c_l=8.0)
"""A car with seats for loads."""


def case(name: str) -> tuple[Vehicle, Load]:
    """Return a vehicle and its load by name."""
    return (SEATS if name == "seated" else VEHICLES[name]), LOADS.get(name, EMPTY)


CASES = (*VEHICLES, "seated")
"""Names of all."""

USUAL = (
    "car",
    "curve",
    "air-and-stop",
    "load-friction",
    "tyre-curve",
    "mount",
    "left-right",
    "heights",
    "quarter",
    "seated",
)
"""Names of some that have most of what the others have."""


def is_linear(vehicle: Vehicle) -> bool:
    """Return whether a vehicle has linear elements only, but for its tyres, which lift off."""
    return not nonlinear_elements(vehicle.tracks, vehicle.extras, vehicle.wheelbase, layout=vehicle.layout)


@cache
def dropped(name: str) -> Motion:
    """Return the drop of a vehicle from blocks under all wheels, as sprung simulates it."""
    vehicle, load = case(name)
    wheels = vehicle.layout.wheels
    if is_linear(vehicle):
        return drop_from_blocks(vehicle, load, wheels, HEIGHT).motion(1 / RATE, SAMPLES)
    support = BlockSupport(load, wheels, HEIGHT)
    return simulate_nonlinear_drops(vehicle, [support], 1 / RATE, SAMPLES)[0]


def greatest_difference(name: str, moved: NDArray[np.float64]) -> float:
    """Return the greatest difference of a drop from ours, over the range of the body's or a wheel's motion.

    Parameters
    ----------
    name
        Of the vehicle.
    moved
        Displacements of body and wheels, shape (coordinate, time).
    """
    layout = case(name)[0].layout
    ours = dropped(name).displacement[: len(layout.coordinates)]
    # They count from rest there, and what is called rest may differ by a constant: both from the blocks.
    ours, other = ours - ours[:, :1], moved - moved[:, :1]
    ranges = np.ptp(ours, axis=1)
    ranges[1 : len(layout.body)] = np.maximum(ranges[1 : len(layout.body)], ranges[0])
    return float((np.abs(other - ours).max(axis=1) / ranges).max())

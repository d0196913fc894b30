"""The two vehicles of the paper."""

from __future__ import annotations

from sprung.vehicle.vehicle import Vehicle

TABLE_1_CAR = Vehicle(
    name="Table 1 car",
    m_s=1380,
    I_yy=2440,
    I_xx=380,
    m_uf=40.5,
    m_ur=45.4,
    k_sf=17_000,
    k_sr=22_000,
    k_tf=192_000,
    k_tr=192_000,
    c_sf=1500,
    c_sr=1500,
    a=1.25,
    b=1.51,
    t_f=0.74,
    t_r=0.74,
)
"""The car of the paper's simulation, Table 1."""

SCHOOL_BUS = Vehicle(
    name="School bus",
    m_s=4320,
    I_yy=8800,
    I_xx=3450,
    m_uf=130,
    m_ur=330,
    k_sf=155_000,
    k_sr=260_000,
    k_tf=880_000,
    k_tr=1_760_000,
    c_sf=4000,
    c_sr=5000,
    a=2.22,
    b=1.73,
    t_f1=0.64,
    t_r1=0.64,
    t_f2=0.4,
    t_r2=0.5,
)
"""The school bus of the paper's experiment, Tables 4 and 5."""

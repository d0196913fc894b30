"""Raw recordings of the tutorial's car: ten drops without a campaign file, and what only its user can know."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import sprung

HATCHBACK = sprung.Vehicle(
    m_s=1050, I_yy=1450, I_xx=340, m_uf=38, m_ur=34, k_sf=19000, k_sr=18000, k_tf=190000, k_tr=190000, c_sf=1400, c_sr=1300,
    a=1.05, b=1.50, t_f=0.58, t_r=0.56, name="Hatchback",
)  # fmt: skip

ITEMS = ((120, (-1.9, 0.35, 0.6)), (60, (-0.6, -0.3, 0.7)))
"""Masses, kg, and positions, m, of the sandbags."""

POSITIONS = {
    "body_fl": (0.10, 0.58, 0.50),
    "body_fr": (0.10, -0.58, 0.50),
    "body_rl": (-2.65, 0.56, 0.50),
    "body_rr": (-2.65, -0.56, 0.50),
}
"""Positions of the body sensors, m."""

_WHEELS = (["fl", "fr", "rl", "rr"], ["fl", "fr"], ["rl", "rr"], ["fl", "rl"], ["fr", "rr"])


def simulated(loads: tuple[str, ...] = ("empty", "sandbags")) -> sprung.Campaign:
    """Simulate five drops with each load."""
    items: Any = tuple({"mass": mass, "position": position} for mass, position in ITEMS)
    drops: Any = tuple({"wheels": wheels, "load": load} for load in loads for wheels in _WHEELS)
    sandbags = sprung.Load(name="sandbags", items=items)
    return sprung.simulate(HATCHBACK, loads=(sandbags,), drops=drops, rate=250, noise=0.05, seed=1)


def write_recordings(folder: Path, loads: tuple[str, ...] = ("empty", "sandbags")) -> list[Path]:
    """Write the recordings of these drops, and nothing else that `sprung.write` writes."""
    sprung.write(simulated(loads), folder)
    for path in folder.iterdir():
        if path.suffix != ".csv":
            path.unlink()
    return sorted(folder.iterdir())

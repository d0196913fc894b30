"""A tall car with anti-roll bars, simulated by a rigid-body engine that is not ours.

Truth and recordings are from MuJoCo 4.0.0 (RK4, 0.5 ms): a free body, wheels on slide joints along its own vertical axis,
vertical tyre forces at the wheel centres that cannot pull, ballast as bodies fixed to it, accelerometers that read specific
force in the turning body. Drops from 0.05 m blocks that vanish at 0.4 to 0.5 s; 500 Hz, white noise of 0.02 m/s², stored in
steps of 0.001 m/s².
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import sprung
from sprung.vehicle import Heights, Load, Sensor, Vehicle, Wheel, parse_record

FOLDER = Path(__file__).parent / "data" / "tall_car"

RATE = 500.0

HEIGHTS = Heights(0.75, 0.33)

TALL_CAR = Vehicle(
    m_s=1900.0, I_yy=3300.0, I_xx=720.0, m_uf=48.0, m_ur=50.0, k_sf=26000.0, k_sr=30000.0, k_tf=230000.0, k_tr=240000.0,
    c_sf=2300.0, c_sr=2500.0, a=1.3, b=1.45, t_f=0.78, t_r=0.79, k_af=12000.0, k_ar=4000.0,
    cg_height=HEIGHTS.cg_height, wheel_height=HEIGHTS.wheel_height, name="tall car",
)  # fmt: skip

_PLACES = {"fl": (-0.1, 0.6, 0.5), "fr": (-0.1, -0.6, 0.5), "rl": (-2.65, 0.6, 0.5), "rr": (-2.65, -0.6, 0.5)}

SENSORS = (
    *(Sensor(channel=f"body_{at}", on="body", position=place) for at, place in _PLACES.items()),
    *(Sensor(channel=f"wheel_{at}", on=at) for at in ("fl", "fr", "rl", "rr")),
)

BALLAST = parse_record(
    Load,
    {
        "name": "ballast",
        "items": [
            {"mass": 150.0, "position": (-1.1, 0.0, 0.6), "inertia": (10.0, 60.0)},
            {"mass": 70.0, "position": (-2.75, 0.0, 0.6), "inertia": (6.0, 6.0)},
        ],
    },
)

_WHEELS: dict[str, tuple[Wheel, ...]] = {
    "bounce": ("fl", "fr", "rl", "rr"),
    "pitch_front": ("fl", "fr"),
    "pitch_rear": ("rl", "rr"),
    "roll_left": ("fl", "rl"),
    "roll_right": ("fr", "rr"),
}


def second_order() -> dict[str, np.ndarray[Any, np.dtype[np.float64]]]:
    """Return half the sum of the readings that follow from a deflection and from its opposite, without gravity, m/s².

    Everything of odd order cancels in it; the key says how the car was deflected, and its load.
    """
    with np.load(FOLDER / "second_order.npz") as stored:
        return {key: stored[key].astype(np.float64) for key in stored.files}


def campaign_in(folder: Path, heights: Heights | None) -> sprung.Campaign:
    """Write the campaign as files and read it, with its heights stated or not."""
    stated = [] if heights is None else [f"cg_height = {heights.cg_height}", f"wheel_height = {heights.wheel_height}"]
    lines = ["schema = 1", "[vehicle]", 'name = "tall car"', "wheelbase = 2.75", *stated]
    for sensor in SENSORS:
        place = [] if sensor.position is None else [f"position = {list(sensor.position)}"]
        lines += ["[[sensor]]", f'channel = "{sensor.channel}"', f'on = "{sensor.on}"', *place]
    lines += ["[[load]]", 'name = "ballast"', "items = ["]
    for item in BALLAST.items:
        lines.append(
            f"  {{ mass = {item.mass}, position = {list(item.position or ())}, inertia = {list(item.inertia)} }},"
        )
    lines.append("]")
    with np.load(FOLDER / "recordings.npz") as stored:
        for name in stored.files:
            load, wheels = name.split()
            values = 0.001 * stored[name]
            table = np.column_stack([np.arange(len(values)) / RATE, values])
            file = f"{load}_{wheels}.csv"
            header = ",".join(["time", *(sensor.channel for sensor in SENSORS)])
            np.savetxt(folder / file, table, delimiter=",", header=header, comments="", fmt="%.3f")
            dropped = ", ".join(f'"{wheel}"' for wheel in _WHEELS[wheels])
            lines += ["[[drop]]", f'file = "{file}"', f'load = "{load}"', f"wheels = [{dropped}]", "height = 0.05"]
    (folder / "campaign.toml").write_text("\n".join(lines), encoding="utf-8")
    return sprung.read(folder / "campaign.toml")

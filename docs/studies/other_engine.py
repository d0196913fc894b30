"""A car that MuJoCo drives over a bump: a rigid-body engine with other equations of motion than ours; not needed to run.

`python -m pip install "sprung[peers]"` installs it. The body is free, its wheels slide along its own vertical axis, and tyres
push vertically at the wheel centres as the ground under them rises, but never pull. Accelerometers turn with what they sit on
and read specific force.
"""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

import sprung
from sprung.campaign import Drop, Recording
from sprung.simulation import Bump, default_sensors, static_wheel_loads
from sprung.uncertainty import KnownValue
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import STATIONS, WHEELS, Sensor, Vehicle, Wheel

Real = NDArray[np.float64]

STEP, EVERY = 0.5e-3, 4
"""Time step of the engine, s, with its method of Runge and Kutta, and steps per sample."""

SPEED = 20 / 3.6
"""m/s."""

CAR = Vehicle(
    m_s=1250.0, I_yy=1900.0, I_xx=420.0, m_uf=38.0, m_ur=42.0, k_sf=21000.0, k_sr=23500.0, k_tf=205000.0, k_tr=198000.0,
    c_sf=1550.0, c_sr=1700.0, a=1.2, b=1.4, t_f=0.74, t_r=0.73, cg_height=0.56, wheel_height=0.3, name="MuJoCo's car",
)  # fmt: skip
"""Made up."""

_SETTLED, _REST, _DURATION = 0.5, 0.4, 3.0
"""s that the car rolls before it is recorded, before the bump, and behind it."""


def is_installed() -> bool:
    """Whether the engine is there."""
    return importlib.util.find_spec("mujoco") is not None


@lru_cache(maxsize=64)
def drive_over(wheels: tuple[Wheel, ...], bump: Bump = Bump(), speed: float = SPEED, car: Vehicle = CAR) -> Real:  # noqa: B008
    """Return what `default_sensors` read while a car drives over a bump onto flat road, m/s², shape (channel, time).

    Parameters
    ----------
    wheels
        That run over the bump.
    bump
        What they run over, a half sine.
    speed
        m/s.
    car
        What is driven.
    """
    mujoco: Any = importlib.import_module("mujoco")
    sensors, loads = default_sensors(car), static_wheel_loads(car)
    model = mujoco.MjModel.from_xml_string(_model_of(car, sensors, loads))
    data = mujoco.MjData(model)
    ids = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, wheel) for wheel in WHEELS]
    reached = speed * (_SETTLED + _REST)
    axles = [STATIONS[wheel].axle for wheel in WHEELS]
    rates = [getattr(car, f"k_t{axle}") for axle in axles]
    over = [wheel in wheels for wheel in WHEELS]

    def push_tyres(_: Any, state: Any) -> None:
        for body, load, rate, runs_over in zip(ids, loads, rates, over, strict=True):
            place = state.xipos[body]
            along = (place[0] - reached) / bump.length
            ground = bump.height * np.sin(np.pi * along) if runs_over and 0 < along < 1 else 0.0
            force = max(load - rate * (place[2] - car.wheel_height - ground), 0.0)
            mujoco.mj_applyFT(model, state, np.array([0.0, 0.0, force]), np.zeros(3), place, body, state.qfrc_passive)

    mujoco.set_mjcb_passive(push_tyres)
    try:
        data.qvel[0] = speed
        length = _REST + (car.wheelbase + bump.length) / speed + _DURATION
        for _ in range(round(_SETTLED / STEP)):
            mujoco.mj_step(model, data)
        samples = []
        for _ in range(round(length / STEP / EVERY)):
            mujoco.mj_forward(model, data)
            samples.append(data.sensordata[2::3].copy())
            for _ in range(EVERY):
                mujoco.mj_step(model, data)
    finally:
        mujoco.set_mjcb_passive(None)
    return np.array(samples).T


def _model_of(car: Vehicle, sensors: Sequence[Sensor], loads: Real) -> str:
    """Write the car in the engine's format: the origin is on the ground below the front axle."""
    height, axle_height = float(car.cg_height or 0), float(car.wheel_height or 0)
    sites, bodies, readings = [], [], []
    for sensor in sensors:
        readings.append(f'<accelerometer name="{sensor.channel}" site="{sensor.channel}"/>')
        if sensor.position is not None:
            x, y, z = sensor.position
            sites.append(f'<site name="{sensor.channel}" pos="{x} {y} {z}"/>')
    for wheel, load in zip(WHEELS, loads, strict=True):
        _, axle, side, end = STATIONS[wheel]
        mass, rate, damping = (getattr(car, f"{symbol}{axle}") for symbol in ("m_u", "k_s", "c_s"))
        x, y = 0.0 if end > 0 else -car.wheelbase, side * getattr(car, f"t_{axle}")
        carried = load - mass * STANDARD_GRAVITY
        bodies.append(
            f'<body name="{wheel}" pos="{x} {y} {axle_height}"><joint type="slide" axis="0 0 1" stiffness="{rate}" '
            f'damping="{damping}" springref="{-carried / rate}"/>'
            f'<inertial pos="0 0 0" mass="{mass}" diaginertia="1e-3 1e-3 1e-3"/><site name="wheel_{wheel}"/></body>'
        )
    return f"""<mujoco><option timestep="{STEP}" integrator="RK4" gravity="0 0 -{STANDARD_GRAVITY}"/>
<worldbody><body name="car"><freejoint/>
<inertial pos="{-car.a} 0 {height}" mass="{car.m_s}" diaginertia="{car.I_xx} {car.I_yy} {car.I_xx + car.I_yy}"/>
{"".join(sites)}{"".join(bodies)}</body></worldbody><sensor>{"".join(readings)}</sensor></mujoco>"""


def campaign_of_passes(
    times: int, noise: float, seed: int, known: Sequence[str] = (), car: Vehicle = CAR
) -> sprung.Campaign:
    """Return a campaign of passes on all, left and right wheels, white noise added.

    Parameters
    ----------
    times
        How often each is done.
    noise
        m/s² root-mean-square.
    seed
        Of the noise.
    known
        Quantities that are weighed: ``front_axle_mass`` for one.
    car
        What is driven.
    """
    random, drops = np.random.default_rng(seed), []
    sensors = tuple(sensor.exact for sensor in default_sensors(car))
    for wheels in (WHEELS, ("fl", "rl"), ("fr", "rr")):
        clean = drive_over(wheels, car=car)
        for number in range(times):
            name = f"{len(wheels)}_{wheels[0]}_{number + 1}.csv"
            recording = Recording(
                name=name,
                channels=tuple(sensor.channel for sensor in sensors),
                values=clean + noise * random.standard_normal(clean.shape),
                start=0.0,
                rate=1 / (STEP * EVERY),
            )
            drops.append(Drop(file=name, wheels=wheels, excitation="pass", speed=SPEED).with_recording(recording))
    weighed = {name: KnownValue(mass_of_axle(car, name)) for name in known}
    return sprung.Campaign(
        name=car.name,
        sensors=sensors,
        drops=tuple(drops),
        wheelbase=KnownValue(car.wheelbase),
        cg_height=car.cg_height,
        wheel_height=car.wheel_height,
        known=weighed,
    )


def mass_of_axle(car: Vehicle, name: str) -> float:
    """Return what an axle weighs with its wheels, kg."""
    ahead = car.m_s * (car.b if name.startswith("front") else car.a) / car.wheelbase
    return float(ahead + 2 * (car.m_uf if name.startswith("front") else car.m_ur))


def without_noise(campaign: sprung.Campaign) -> sprung.Campaign:
    """Return the same campaign as the engine has it."""
    clean = [drive_over(drop.wheels) for drop in campaign.drops]
    recordings = (replace(one, values=own) for one, own in zip(campaign.recordings, clean, strict=True))
    return campaign.with_recordings(tuple(recordings))

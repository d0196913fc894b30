"""Exported vehicles in the programs that they are for: drops in FMPy, rumoca (Modelica) and MuJoCo; not needed to run."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from exported_vehicles import HEIGHT, RATE, SAMPLES
from numpy.typing import NDArray

from sprung.vehicle import Vehicle

Real = NDArray[np.float64]

RELEASE = 0.1
"""s after which the blocks are removed: in Modelica by the exported model itself."""


def names_at_wheels(vehicle: Vehicle, what: str) -> list[str]:
    """Return the names of a signal at all wheels of a vehicle."""
    return [what if wheel == "wheel" else f"{what}_{wheel}" for wheel in vehicle.layout.wheels]


def moving_names(vehicle: Vehicle) -> list[str]:
    """Return the names of the outputs with the displacements of body and wheels."""
    body = {"z_s": "heave", "theta": "pitch", "phi": "roll"}
    return [*(body[coordinate] for coordinate in vehicle.layout.body), *names_at_wheels(vehicle, "wheel")]


def simulate_fmu(path: Path, roads: Mapping[str, Real], times: Real, **options: Any) -> Any:
    """Simulate an FMU in FMPy on roads, held over each step; its outputs by name."""
    fmpy: Any = importlib.import_module("fmpy")
    signal = np.zeros(len(times), dtype=[("time", float), *((name, float) for name in roads)])
    signal["time"] = times
    for name, road in roads.items():
        signal[name] = road
    step, stop = float(times[1] - times[0]), float(times[-1])
    return fmpy.simulate_fmu(str(path), stop_time=stop, step_size=step, output_interval=step, input=signal, **options)


def drop_fmu(path: Path, vehicle: Vehicle, **options: Any) -> Any:
    """Return the outputs of an FMU in a drop from blocks under all wheels, from the release on."""
    before = round(RELEASE * RATE)
    times: Real = np.asarray(np.arange(before + SAMPLES) / RATE)
    blocks = np.where(np.arange(len(times)) < before, HEIGHT, 0.0)
    roads = dict.fromkeys(names_at_wheels(vehicle, "road"), blocks)
    rates = dict.fromkeys(names_at_wheels(vehicle, "road_rate"), 0 * blocks)
    return simulate_fmu(path, {**roads, **rates}, times, **options)[before:]


def drop_modelica(text: str, folder: Path) -> dict[str, Real]:
    """Return the outputs of a Modelica model in a drop, compiled and simulated by rumoca, from the release on.

    Parameters
    ----------
    text
        The package.
    folder
        For its file, and for no other one.
    """
    rumoca: Any = importlib.import_module("rumoca")
    path = folder / "x.mo"
    path.write_text(text, encoding="utf-8")
    model = rumoca.Session().load(str(path), model=f"{text.split()[1]}.Drop")
    config = rumoca.SimConfig(rtol=1e-8, atol=1e-10, dt=1 / RATE, max_wall_seconds=60.0)
    found = model.simulate(t=(0, RELEASE + SAMPLES / RATE), config=config)
    times, computed = RELEASE + np.arange(SAMPLES) / RATE, np.array(found.time)
    return {name.removeprefix("vehicle."): np.interp(times, computed, np.array(found[name])) for name in found.names}


def drop_mjcf(text: str) -> Real:
    """Return the positions of all joints of a MuJoCo model in a drop, shape (joint, time)."""
    mujoco: Any = importlib.import_module("mujoco")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("drop").id)
    every = round(1 / RATE / model.opt.timestep)
    positions = [data.qpos.copy()]
    for _ in range(SAMPLES - 1):
        mujoco.mj_step(model, data, nstep=every)
        positions.append(data.qpos.copy())
    return np.array(positions).T

"""Do exported vehicles move in other programs as they do here? Writes exported-drops.md.

Run with `python docs/studies/exported_drops.py`, or `nox -s studies` for all studies. Needs FMPy, rumoca, MuJoCo and a
compiler for C.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
import tempfile
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

import numpy as np
from exported_vehicles import CASES, HEIGHT, RATE, SAMPLES, case, greatest_difference
from other_programs import Real, drop_fmu, drop_mjcf, drop_modelica, moving_names
from pages import run, table, write

from sprung import export
from sprung.errors import InputError
from sprung.vehicle import Load, Vehicle

FORMATS = ("modelica", "fmu", "mjcf")

WANTED = 0.1
"""Percent of the range of a motion, by the issue."""


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(description="Drops of exported vehicles in other programs.")
    parser.add_argument("--cases", nargs="*", default=CASES, help="vehicles (default: all)")
    parser.add_argument("--campaigns", type=int, help="of other studies; nothing here is random")
    parser.add_argument("--processes", type=int, default=1, help="how many at a time (default %(default)s)")
    parser.add_argument("--to", type=Path, default=Path(__file__).parent, help="folder of page and numbers")
    options = parser.parse_args()
    compared = run(differences, [(name,) for name in options.cases], options.processes, chunk=1)
    found = [{"vehicle": name, **one} for name, one in zip(options.cases, compared, strict=True)]
    write(options.to, "exported-drops", page(found), {"cases": found})


def differences(name: str) -> dict[str, float | None]:
    """Return the greatest difference of a drop in each program, percent; None where the format cannot hold the vehicle."""
    vehicle, load = case(name)
    found: dict[str, float | None] = {}
    for to in FORMATS:
        try:
            moved = motions(to, vehicle, load)
        except InputError:
            found[to] = None
        else:
            found[to] = float(f"{100 * greatest_difference(name, moved):.3g}")
    return found


def motions(to: str, vehicle: Vehicle, load: Load) -> Real:
    """Return the displacements of body and wheels in a drop, shape (coordinate, time)."""
    names = moving_names(vehicle)
    with tempfile.TemporaryDirectory() as folder:
        if to == "mjcf":
            return drop_mjcf(export.mjcf(vehicle, load).text)[: len(names)]
        if to == "modelica":
            moved = drop_modelica(export.modelica(vehicle, load).text, Path(folder))
        else:
            moved = drop_fmu(export.fmu(vehicle, load).save(Path(folder) / "x.fmu"), vehicle)
    return np.array([moved[name] for name in names])


def page(found: Sequence[Mapping[str, object]]) -> str:
    """Write the page."""
    worst = {to: max(float(str(one[to])) for one in found if one[to] is not None) for to in FORMATS}
    rows = [
        [str(one["vehicle"]), *("refused" if one[to] is None else f"{one[to]:.2g}" for to in FORMATS)] for one in found
    ]
    met = "are met" if max(worst.values()) < WANTED else "are not met"
    versions = ", ".join(f"{program} {version(program)}" for program in ("rumoca", "fmpy", "mujoco"))
    return f"""# Drops of exported vehicles in other programs

Does a vehicle move in another program as it does in `sprung simulate`? Here it is exported ([formats](../exports.md)), dropped
there, and the two motions are compared.

## Method

{len(found)} vehicles: the paper's car with one or several further model terms each, some with loads, and parts of a vehicle.
All wheels are on blocks of {1000 * HEIGHT:g} mm, which are removed. The motion is compared for {(SAMPLES - 1) / RATE:g} s at
{RATE:g} Hz, through the flight, the landing and the decay. Modelica is compiled and simulated by rumoca, the FMU by FMPy
from its library, MJCF by MuJoCo ({versions}). Our motion is exact for vehicles with linear elements, otherwise it is
computed in time steps of 0.2 ms at most.

## Result

The greatest difference of heave, pitch, roll and the rise of the wheels, in percent of the range of the motion; of pitch and
roll in percent of the range of the heave in m, where that is larger. The worst are {worst["modelica"]:.2g} % in Modelica,
{worst["fmu"]:.2g} % in the FMU and {worst["mjcf"]:.2g} % in MuJoCo; the {WANTED:g} % that are required {met}. *Refused*
vehicles have terms that MuJoCo has not; they are exported only as an approximation.

{table(["vehicle", *FORMATS], rows)}

The numbers are in [exported-drops.json](exported-drops.json).

## Reproduction

    python docs/studies/exported_drops.py
"""


if __name__ == "__main__":
    main()

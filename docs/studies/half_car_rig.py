"""A real half-car rig: the same springs, tyres and masses from all its settings? Writes half-car-rig.md.

Run with `python docs/studies/half_car_rig.py FOLDER --processes 2`, FOLDER being the recordings ("LAB TEST FOLDER" of the
public repository DARKMOONlite/DS-C_B-Half-Car-Rig-Analysis). They have no licence and are no part of this project.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import tempfile
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from half_car_rig_page import MASS, page
from pages import arguments, figures, report_progress, run, write

import sprung

HALF_DISTANCE = 0.75
"""m, of springs and sensors from the middle, of the rig's data sheet; that of the springs is left open."""

SPRINGS = 0.03
"""Standard uncertainty of the half-distance of the springs, m."""

TERMS = ("tyre-damping", "asymmetry", "friction", "uneven-friction", "interconnection")
"""Model terms that the recordings need; uneven friction and interconnection have to be stated, as no search tries them."""

ALIKE: Mapping[str, float] = {"y_s": 0.005, "d_ks": 200.0, "d_kt": 1e4}
"""Standard uncertainties within which both sides are built alike, SI: some 1 %, tyres 3 %. Without them the differences stand
for what else the model lacks."""

WHEEL = (80.0, 40.0)
"""Unsprung mass and its standard uncertainty, kg: displacements hardly tell it from the gains of the wheels' sensors. The data
sheet's 56.1 kg are within it."""

GAINS: Mapping[str, float] = {"Sprung LH": 0.0, "Sprung RH": 0.1, "Unsprung LH": 0.0, "Unsprung RH": 0.2}
"""Standard uncertainty of the gain of each sensor. No free vibration shows the gain of all body sensors, or of all wheel
sensors, so that the left ones are taken to be right."""

END = 3.99
"""s of each recording that are used: the shortest are no longer, and in the others hardly anything moves afterwards."""

SAME_WITH_LOAD = ("k_t", "m_u", "c_t", "t", "y_s", "d_ks", "d_kt", "d_cs")
"""What an added mass does not change: it is that of the same setting without it, within its error; and the spring rate, which
sets the scale, exactly."""


def main() -> None:
    """Run the study."""
    parser = arguments("A real half-car rig.", campaigns=1)
    parser.add_argument("folder", type=Path, help="the recordings")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        drafts = [Path(draft.write()) for draft in sprung.draft_campaigns(options.folder, Path(work))]
        found: dict[str, dict[str, Any]] = {}
        for setting, outcomes in run(identified, [(str(path),) for path in drafts], options.processes, chunk=1):
            found[setting] = outcomes
            report_progress(f"{setting}: {outcomes['empty']['verdict']}")
    ordered = dict(sorted(found.items(), key=lambda item: int("".join(filter(str.isdigit, item[0])) or 0)))
    numbers = {"settings": [{"setting": setting, **outcomes} for setting, outcomes in ordered.items()]}
    write(options.to, "half-car-rig", page(ordered), numbers)


def identified(path: str) -> tuple[str, dict[str, Any]]:
    """Identify one setting, without a load and then with each."""
    draft = Path(path)
    loads = [load["name"] for load in tomllib.loads(draft.read_text(encoding="utf-8")).get("load", [])]
    half_distance = {"value": HALF_DISTANCE, "std": SPRINGS}
    known: dict[str, Any] = {"m_s": MASS, "t": half_distance, "m_u": {"value": WHEEL[0], "std": WHEEL[1]}}
    known |= {name: {"value": 0.0, "std": std} for name, std in ALIKE.items()}
    found = {"empty": outcome_of(sprung.identify(completed(draft, "empty", known)))}
    estimates = found["empty"]["parameters"]
    if estimates["k_s"][0] is not None:
        same = {
            name: {"value": value, "std": std}
            for name, (value, std) in estimates.items()
            if name in SAME_WITH_LOAD and value is not None
        }
        same |= {"k_s": estimates["k_s"][0]}
        for load in loads:
            found[load] = outcome_of(sprung.identify(completed(draft, load, same)))
    return draft.parent.name, found


def completed(draft: Path, load: str, known: Mapping[str, Any]) -> Path:
    """Write a campaign file of the drops with one load, as if they were empty, with the gaps of the draft filled."""
    document = tomllib.loads(draft.read_text(encoding="utf-8"))
    document["known"] = dict(known)
    document["model"] = {"tracks": "shared", "extras": list(TERMS)}
    document.pop("load", None)
    document["drop"] = [
        {**drop, "load": "empty", "window": [0.0, END]} for drop in document["drop"] if drop["load"] == load
    ]
    for sensor in document["sensor"]:
        sensor["tilt_std"] = 0.0
        sensor["gain_std"] = next(std for place, std in GAINS.items() if f" {place} " in sensor["channel"])
        if sensor["on"] == "body":
            side = 1.0 if " LH" in sensor["channel"] else -1.0
            sensor |= {"position": [0.0, side * HALF_DISTANCE, 0.5], "position_std": 0.0}
    path = draft.with_name(f"{load}.toml")
    path.write_text(tomli_w.dumps(document), encoding="utf-8")
    return path


def outcome_of(result: sprung.Result) -> dict[str, Any]:
    """Return what the page shows of a result."""
    return {
        "verdict": result.verdict.state,
        "reasons": list(result.verdict.reasons),
        "faults": sorted({fault.code for fault in result.faults}),
        "drops": result.fit.drops,
        "inflation": figures(result.fit.inflation),
        "parameters": {name: [one.value, one.std] for name, one in result.parameters.items()},
        "gains": {one.channel: [one.value, one.std] for one in result.sensors if one.quantity == "gain"},
        "residual": dict(result.fit.noise),
        "span": {
            channel: float(max(np.ptp(series.measured[i]) for series in result.series.values()))
            for i, channel in enumerate(next(iter(result.series.values())).channels)
        },
    }


if __name__ == "__main__":
    main()

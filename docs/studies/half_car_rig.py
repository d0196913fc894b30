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
from pages import arguments, figures, report_progress, run, table, write

import sprung

MASS, HALF_DISTANCE = 433.0, 0.75
"""kg and m, of the rig's data sheet: the scale of everything, which no recording of it shows."""

SHEET: Mapping[str, float] = {"k_s": 20.5e3, "k_t": 147.2e3, "I_xx": 82.7, "m_u": 56.1}
"""What the data sheet states beside, SI."""

TERMS = ("tyre-damping", "friction")
"""Model terms that the recordings need."""

DAMPED_TERMS = (*TERMS, "interconnection")
"""With the hydraulic dampers; the interconnection has to be stated, as no search tries it."""

UNDAMPED = "damped_0"
"""The setting without them."""

WHEEL = 0.5
"""Relative standard uncertainty with which the data sheet's unsprung mass is taken: displacements hardly show it apart from the
gains of the wheels' sensors, and without it a fit may end with wheels heavier than the body."""

GAIN = 0.1
"""Standard uncertainty of the gain of the body's sensors: those of both sides differ by 9 % at rest."""

SHOWN: Mapping[str, tuple[str, float]] = {
    "k_s": ("kN/m", 1e3),
    "k_t": ("kN/m", 1e3),
    "I_xx": ("kg m²", 1.0),
    "m_u": ("kg", 1.0),
    "c_s": ("N s/m", 1.0),
    "F": ("N", 1.0),
    "k_x": ("kN/m", 1e3),
    "c_x": ("kN s/m", 1e3),
}
"""Columns of the table: unit, and SI units in it."""

SAME = ("k_s", "k_t", "I_xx", "m_u")
"""What has to be the same in all settings."""


def main() -> None:
    """Run the study."""
    parser = arguments("A real half-car rig.", campaigns=1)
    parser.add_argument("folder", type=Path, help="the recordings")
    options = parser.parse_args()
    found: dict[str, dict[str, Any]] = {}
    with tempfile.TemporaryDirectory() as work:
        paths = [complete(Path(draft.write())) for draft in sprung.draft_campaigns(options.folder, Path(work))]
        for setting, outcome in run(identified, [(str(path),) for path in paths], options.processes, chunk=1):
            found[setting] = outcome
            report_progress(f"{setting}: {outcome['verdict']}")
    ordered = dict(sorted(found.items(), key=lambda item: int("".join(filter(str.isdigit, item[0])) or 0)))
    numbers = {"settings": [{"setting": setting, **outcome} for setting, outcome in ordered.items()]}
    write(options.to, "half-car-rig", page(ordered), numbers)


def complete(path: Path) -> Path:
    """Fill the gaps of a drafted campaign file: what the data sheet states, and the drops without a load."""
    document = tomllib.loads(path.read_text(encoding="utf-8"))
    wheel = {"value": SHEET["m_u"], "std": WHEEL * SHEET["m_u"]}
    document["known"] = {"m_s": MASS, "t": HALF_DISTANCE, "m_u": wheel}
    terms = TERMS if path.parent.name == UNDAMPED else DAMPED_TERMS
    document["model"] = {"tracks": "shared", "extras": list(terms)}
    document.pop("load", None)
    document["drop"] = [drop for drop in document["drop"] if drop["load"] == "empty"]
    for sensor in document["sensor"]:
        sensor["tilt_std"] = 0.0
        if sensor["on"] == "body":
            side = 1.0 if " LH" in sensor["channel"] else -1.0
            sensor |= {"position": [0.0, side * HALF_DISTANCE, 0.5], "position_std": 0.0, "gain_std": GAIN}
    path.write_text(tomli_w.dumps(document), encoding="utf-8")
    return path


def identified(path: str) -> tuple[str, dict[str, Any]]:
    """Identify one setting."""
    result = sprung.identify(path)
    return Path(path).parent.name, {
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


def agreement(outcomes: Mapping[str, Mapping[str, Any]], name: str) -> tuple[float, float, float, float]:
    """Return mean, largest difference from it in percent, and in standard errors, and the rise from first to last, percent."""
    usable = [one for one in outcomes.values() if one["verdict"] != "reject"]
    values, stds = np.array([one["parameters"][name] for one in usable], dtype=float).T
    mean = float(np.sum(values / stds**2) / np.sum(stds**-2.0))
    apart = np.abs(values - mean)
    return mean, 100 * float(apart.max() / mean), float((apart / stds).max()), 100 * float(values[-1] / values[0] - 1)


def page(outcomes: Mapping[str, Mapping[str, Any]]) -> str:
    """Write the page."""
    head = ["setting", "verdict", "faults", *(f"{name}, {unit}" for name, (unit, _) in SHOWN.items()), "relaxes in, s"]
    rows = [_row(setting, outcome) for setting, outcome in outcomes.items()]
    same = [
        [
            name,
            f"{mean / SHOWN[name][1]:.4g} {SHOWN[name][0]}",
            f"{part:.1f}",
            f"{errors:.1f}",
            f"{rise:+.1f}",
            f"{SHEET[name] / SHOWN[name][1]:.4g}",
        ]
        for name in SAME
        for mean, part, errors, rise in [agreement(outcomes, name)]
    ]
    channels = list(next(iter(outcomes.values()))["residual"])
    left = [
        [
            setting,
            *(f"{1e3 * one['residual'][c]:.3f} ({100 * one['residual'][c] / one['span'][c]:.2f})" for c in channels),
        ]
        for setting, one in outcomes.items()
    ]
    sensors = max((list(one["gains"]) for one in outcomes.values()), key=len)
    gains = [
        [setting, *(_with_std(*one["gains"].get(c, (None, None)), 1.0) for c in sensors)]
        for setting, one in outcomes.items()
    ]
    reasons = "\n".join(f"- {setting}: {'; '.join(one['reasons'])}" for setting, one in outcomes.items())
    drops = sum(one["drops"] for one in outcomes.values())
    return f"""# A real half-car rig

The first recordings here that nature made and not a program: a full-size half-car rig (a body on two wheels, in the roll plane)
that is lifted in the middle or on its left side and let go, with four displacement sensors, in five settings. Springs, tyres
and masses are the same in all settings. Does the program find them so?

## Recordings

They are public ("LAB TEST FOLDER" of the repository DARKMOONlite/DS-C_B-Half-Car-Rig-Analysis on GitHub) and without a
licence, so that nothing of them is in this project. `sprung new FOLDER` drafts one campaign for each setting from the folder as
it is. {drops} lifts without added masses are identified here. What the folder does not say was filled in from the rig's data
sheet: the sprung mass, {MASS:g} kg, which gives the scale of everything, the half-distance of springs and sensors,
{HALF_DISTANCE:g} m, and the unsprung mass, {SHEET["m_u"]:g} kg, with half of it as its standard uncertainty.

What `sprung check` says of every recording: it is spliced from two parts. In the first half second to second all channels
passed a low-pass of some 50 Hz, and are 8.3 ms late; that part is advanced (fault `splice`). The right sensor of the body
reads some 9 % less than the left one, so that gains of {100 * GAIN:g} % are allowed for.

## What the rig has that the plain model has not

- **An interconnection of left and right.** The settings, which the recordings' names call damped, hardly change the damping of
  bounce. They change a rate against roll that relaxes in some tenths of a second, as a fluid line between both sides does.
- **Dry friction**, without which the wheels' motion is not explained at all.
- Tyre damping.

## Results

{table(head, rows)}

After ± one standard error, which contains what the model leaves and how far the lifts disagree. What has to be the same, over
the settings that are not rejected:

{table(["", "mean", "farthest from it, %", "in standard errors", "last setting over the first, %", "data sheet"], same)}

Gains of the sensors, part by which they read too much:

{table(["setting", *sensors], gains)}

What is left, mm root-mean-square (and as a part of the range of the motion, %):

{table(["setting", *channels], left)}

Reasons of the verdicts:

{reasons}

## What is not explained

- Unsprung masses and tyre rates are known only together with the gain of the wheels' sensors, which no free vibration shows: a
  gain {{math}}`g` with {{math}}`k_t/g` and {{math}}`m_u/g` fits alike. They are stated for sensors that are right within 1 %.
- The undamped rig (`damped_0`, three series of lifts) is rejected: its wheels move otherwise than the model's, with or
  without an interconnection.
- Unsprung masses scatter most, and three or four standard errors in a row are more than chance makes of them.
- The sheet's masses and rates are not those of the recordings. Its wheel hop, {{math}}`\\sqrt{{(k_t + k_s)/m_u}}`, would be at
  8.7 Hz.
- Added masses are not used: the folder names them "100" and "200" and does not say of what.

## Reproduction

    python docs/studies/half_car_rig.py "LAB TEST FOLDER" --processes 2
"""


def _row(setting: str, outcome: Mapping[str, Any]) -> list[str]:
    found = outcome["parameters"]
    cells = [_with_std(*found.get(name, (None, None)), factor) for name, (_, factor) in SHOWN.items()]
    rate, damping = (found.get(name, (None, None))[0] for name in ("k_x", "c_x"))
    relaxes = f"{damping / rate:.2f}" if rate and damping else "-"
    return [setting, outcome["verdict"], ", ".join(outcome["faults"]), *cells, relaxes]


def _with_std(value: float | None, std: float | None, factor: float) -> str:
    return "-" if value is None or std is None else f"{value / factor:.4g} ± {std / factor:.2g}"


if __name__ == "__main__":
    main()

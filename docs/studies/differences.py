"""Are the differences that `sprung compare` reports as likely or certain real? Writes differences.md.

Run with `python docs/studies/differences.py --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pages import arguments, figures, report_progress, run, table, write

import sprung
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Vehicle

NOISE = 0.05
CHANGES = (0.0, 0.005, 0.01, 0.02, 0.05)
"""By how much the front dampers of the second vehicle are weaker."""


@dataclass(frozen=True)
class Pair:
    """What came of two campaigns.

    Attributes
    ----------
    weighed
        Whether the vehicles were weighed.
    change
        By how much the front dampers of the second are weaker.
    z
        Differences of the parameters in standard uncertainties.
    joint
        Chance of all of them together.
    parameters, modes
        What was called likely or certain.
    """

    weighed: bool
    change: float
    z: tuple[float, ...]
    joint: float
    parameters: tuple[str, ...]
    modes: tuple[str, ...]


def main() -> None:
    """Run the study."""
    options = arguments("Whether differences are real.", campaigns=200).parse_args()
    tasks = [
        (weighed, change, seed)
        for weighed in (True, False)
        for change in CHANGES
        for seed in range(options.campaigns if change == 0 else max(1, options.campaigns // 10))
    ]
    pairs = list(run(attempt, tasks, options.processes))
    report_progress(f"{len(pairs)} pairs")
    cases = [case(pairs, weighed, change) for weighed in (True, False) for change in CHANGES]
    write(options.to, "differences", page(cases), {"cases": cases})


def attempt(weighed: bool, change: float, seed: int) -> Pair:
    """Identify one vehicle, and then another or the same again."""
    changed = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"c_sf": (1 - change) * TABLE_1_CAR.c_sf})
    results = [identified(vehicle, weighed, 2 * seed + i) for i, vehicle in enumerate((TABLE_1_CAR, changed))]
    found = sprung.compare(results)
    rows = found.parameters.values()
    seen = [
        tuple(name for name, row in kind.items() if row.differences[0].finding in ("likely", "certain"))
        for kind in (found.parameters, found.modes)
    ]
    together = found.joint[0]
    return Pair(
        weighed,
        change,
        tuple(row.differences[0].z for row in rows if row.differences[0].z is not None),
        float("nan") if together is None else together.p,
        *seen,
    )


def identified(vehicle: Vehicle, weighed: bool, seed: int) -> sprung.Result:
    """Identify one campaign of four drops, the model being known."""
    random = np.random.default_rng([seed, 11])
    scales = KnownValue(vehicle.total_mass + float(random.normal(0, 2.0)), 2.0)  # each time it is weighed anew
    campaign = sprung.simulate(vehicle, noise=NOISE, seed=seed, known={"total_mass": scales} if weighed else {})
    return sprung.identify(campaign, tracks="shared", extras=(), fall=False)


def case(pairs: Sequence[Pair], weighed: bool, change: float) -> dict[str, Any]:
    """Sum up the pairs of one kind."""
    chosen = [one for one in pairs if (one.weighed, one.change) == (weighed, change)]
    z = np.array([value for one in chosen for value in one.z])
    damper = [any(name.startswith("c_sf") for name in one.parameters) for one in chosen]
    others = [any(not name.startswith("c_sf") for name in one.parameters) for one in chosen]
    return {
        "weighed": weighed,
        "change": change,
        "pairs": len(chosen),
        "z_rms": figures(np.sqrt(np.mean(z**2))),
        "beyond_196": figures(np.mean(np.abs(z) > 1.96)),
        "joint_below_005": figures(np.mean([one.joint < 0.05 for one in chosen])),
        "damper_seen": figures(np.mean(damper)),
        "another_parameter_seen": figures(np.mean(others)),
        "any_mode_seen": figures(np.mean([bool(one.modes) for one in chosen])),
    }


def page(cases: Sequence[dict[str, Any]]) -> str:
    """Write the page."""
    same = [one for one in cases if one["change"] == 0]
    changed = [one for one in cases if one["change"] > 0]
    first = table(
        ("scale", "pairs", "RMS of z", "z beyond ±1.96", "joint p < 0.05", "parameter detected", "mode detected"),
        [
            (
                "weighed" if one["weighed"] else "unknown, per total mass",
                str(one["pairs"]),
                f"{one['z_rms']:.2f}",
                _percent(one["beyond_196"]),
                _percent(one["joint_below_005"]),
                _percent(max(one["damper_seen"], one["another_parameter_seen"])),
                _percent(one["any_mode_seen"]),
            )
            for one in same
        ],
    )
    second = table(
        (
            "front dampers weaker by",
            "scale",
            "pairs",
            "detected in c_sf",
            "detected in another",
            "joint p < 0.05",
            "mode detected",
        ),
        [
            (
                f"{100 * one['change']:g} %",
                "weighed" if one["weighed"] else "unknown",
                str(one["pairs"]),
                _percent(one["damper_seen"]),
                _percent(one["another_parameter_seen"]),
                _percent(one["joint_below_005"]),
                _percent(one["any_mode_seen"]),
            )
            for one in changed
        ],
    )
    return f"""# Differences between two results

`sprung compare` reports a difference as *likely* or *certain* if a difference as large anywhere in the table would be
improbable by chance. How often does this happen for an unchanged vehicle, and how small a change is detected?

## Method

The paper's car, four drops (all, front, rear, left wheels), empty, with the usual eight sensors and noise of {NOISE:g} m/s².
Two campaigns with independent noise were identified with the correct model and compared. In one series the car was weighed
for each campaign, with a standard uncertainty of 2 kg; in the other the scale was unknown, so that values per total mass were
compared.

## Unchanged vehicle

{first}

*RMS of z*: root-mean-square difference in standard uncertainties; 1 if these are correct. *z beyond ±1.96*: single
parameters; 5 % if the uncertainties are correct. *Joint p < 0.05*: all estimated parameters together; 5 % (with an
unknown scale, lengths only). *Detected*: tables in which any parameter, or any mode, was reported as likely or certain;
at most 5 % with Holm's correction.

## Vehicle with weaker front dampers

{second}

## Reproduction

    python docs/studies/differences.py --processes 2
"""


def _percent(part: float) -> str:
    return f"{100 * part:.1f} %"


if __name__ == "__main__":
    main()

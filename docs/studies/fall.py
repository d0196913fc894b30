"""How much information does the flight phase before the landing contain? Writes fall.md.

Run with `python docs/studies/fall.py --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from pages import arguments, figures, report_progress, run, table, write

import sprung
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Vehicle

RATE, DURATION, HEIGHT, NOISE = 250.0, 2.0, 0.05, 0.1
WHEELS = (("fl", "fr"), ("fl", "rl"))

CAR_WITH_FRICTION = Vehicle.from_parameters(
    TABLE_1_CAR.parameters | {"F_f": 60.0, "F_r": 80.0, "s_f": 1.5e5, "s_r": 2e5}, name="Table 1 car with friction"
)
VEHICLES = (TABLE_1_CAR, SCHOOL_BUS, CAR_WITH_FRICTION)


@dataclass(frozen=True)
class Trial:
    """What came of one campaign, used from the landing and from the release on.

    Attributes
    ----------
    vehicle
        Its name.
    since, verdict
        From when on it was used, and the verdict's state: without the fall and with it.
    errors, stated, covered
        The same by parameter: error and standard uncertainty as parts of the truth, and whether the interval holds it.
    """

    vehicle: str
    since: tuple[str, str]
    verdict: tuple[str, str]
    errors: dict[str, tuple[float, float]]
    stated: dict[str, tuple[float, float]]
    covered: dict[str, tuple[bool, bool]]


def main() -> None:
    """Run the study."""
    options = arguments("Information in the flight phase.", campaigns=40).parse_args()
    tasks = [(which, seed) for which in range(len(VEHICLES)) for seed in range(options.campaigns)]
    trials: list[Trial] = []
    for trial in run(attempt, tasks, options.processes, 1):
        trials.append(trial)
        report_progress(f"{len(trials)} of {len(tasks)}: {trial.vehicle}: {', '.join(trial.since)}")
        write(options.to, "fall", page(trials), {"campaigns": [_document(one) for one in trials]})


def attempt(which: int, seed: int) -> Trial:
    """Identify one campaign twice, the model being known."""
    vehicle = VEHICLES[which]
    weight = 0.1 * vehicle.m_s
    load = {"name": "ballast", "items": [{"mass": weight, "position": (-0.4 * vehicle.wheelbase, 0.3, 0.5)}]}
    drops = [{"wheels": wheels, "height": HEIGHT, "load": name} for name in ("empty", "ballast") for wheels in WHEELS]
    known = {"total_mass": sprung.uncertainty.KnownValue(vehicle.total_mass, 0.001 * vehicle.total_mass)}
    campaign = sprung.simulate(
        vehicle, loads=[load], drops=drops, rate=RATE, duration=DURATION, noise=NOISE, seed=seed, known=known
    )
    both = [
        sprung.identify(campaign, tracks=vehicle.tracks, extras=vehicle.extras, fall=fall) for fall in (False, True)
    ]
    errors, stated, covered = {}, {}, {}
    for name, truth in vehicle.parameters.items():
        found = [result.parameters[name] for result in both]
        if all(one.value is not None and one.std and one.interval95 is not None for one in found):
            errors[name] = tuple(float(one.value or 0.0) / truth - 1 for one in found)
            stated[name] = tuple(float(one.std or 0.0) / truth for one in found)
            limits = [one.interval95 or (None, None) for one in found]
            covered[name] = tuple(
                (low is None or low <= truth) and (high is None or truth <= high) for low, high in limits
            )
    since, verdict = tuple(one.fit.since for one in both), tuple(one.verdict.state for one in both)
    return Trial(vehicle.name, since, verdict, errors, stated, covered)  # type: ignore[arg-type]


def _document(trial: Trial) -> dict[str, Any]:
    rounded = {
        kind: {name: tuple(map(figures, pair)) for name, pair in getattr(trial, kind).items()}
        for kind in ("errors", "stated")
    }
    return asdict(trial) | rounded


def page(trials: Sequence[Trial]) -> str:
    """Write the page."""
    head = ["vehicle", "campaigns", "flight used", "accepted", "error ratio", "error over stated", "covered"]
    rows = [_row(vehicle.name, [one for one in trials if one.vehicle == vehicle.name]) for vehicle in VEHICLES]
    return f"""# The flight phase before the landing

From the release on a drop is a known experiment: first the tyres of the dropped wheels carry no force, then the wheels
land. `sprung.identify(campaign, fall=True)` uses this {{term}}`flight phase` as well. How much information does it
contain, and do the intervals have the stated coverage?

## Method

The paper's car and school bus, and the car with dry friction; two drops from {100 * HEIGHT:g} cm (front, left), each with
and without a load of a tenth of the sprung mass; {DURATION:g} s at {RATE:g} samples per second, noise {NOISE:g} m/s²;
total mass weighed to 0.1 %. Every campaign was identified twice, from the landing on and from the release on, with the
correct model.

## Results

{table(head, [row for row in rows if row])}

*Error ratio*: root-mean-square error from the release on, divided by that from the landing on, median over the
parameters. *Error over stated*: root-mean-square error divided by the stated standard uncertainty, over all parameters,
from the landing on and from the release on. *Covered*: 95 % intervals that contain the true value, likewise. *Accepted*:
from the release on. Rejected campaigns state no values: {_rejected(trials)} of all, from the landing on.

## Reproduction

    python docs/studies/fall.py --processes 2
"""


def _rejected(trials: Sequence[Trial]) -> int:
    return sum(trial.verdict[0] == "reject" for trial in trials)


def _row(name: str, trials: Sequence[Trial]) -> list[str]:
    if not trials:
        return []
    estimated = [trial for trial in trials if trial.errors]  # a rejected campaign states nothing
    names = [one for one in estimated[0].errors if all(one in trial.errors for trial in estimated)]
    errors = np.array([[trial.errors[one] for one in names] for trial in estimated])
    stated = np.array([[trial.stated[one] for one in names] for trial in estimated])
    covered = np.array([[trial.covered[one] for one in names] for trial in estimated])
    rms = np.sqrt((errors**2).mean(axis=0))
    scaled = np.sqrt(((errors / stated) ** 2).mean(axis=(0, 1)))
    return [
        name,
        f"{len(trials)}",
        f"{sum(trial.since[1] == 'release' for trial in trials)}",
        f"{sum(trial.verdict[1] == 'accept' for trial in trials)}",
        f"{float(np.median(rms[:, 1] / rms[:, 0])):.2f}",
        f"{scaled[0]:.2f}, {scaled[1]:.2f}",
        ", ".join(f"{100 * part:.1f} %" for part in covered.mean(axis=(0, 1)).tolist()),
    ]


if __name__ == "__main__":
    main()

"""Is dry friction detected, and is none reported for vehicles without it? Writes friction.md.

Run with `python docs/studies/friction.py --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
from fleet import FLEET
from hysteresis import Law, loads_of, measured
from pages import arguments, figures, report_progress, run, table, write

import sprung
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Vehicle

Kind = Literal["friction", "another law", "none"]

RATE, DURATION, HEIGHT = 250.0, 2.6, 0.06
WHEELS = (("fl", "fr", "rl", "rr"), ("fl", "fr"), ("rl", "rr"), ("fl", "rl"))


@dataclass(frozen=True)
class Trial:
    """What came of one campaign.

    Attributes
    ----------
    kind
        Friction of the law that is fitted, of another law, or none.
    vehicle
        Its name.
    verdict
        The verdict's state.
    extras
        Selected model terms.
    errors
        Relative error by parameter; undetermined parameters are missing.
    covered
        By parameter whether the 95 % interval holds the truth.
    noise
        Estimated over true noise, root-mean-square over the channels.
    """

    kind: Kind
    vehicle: str
    verdict: str
    extras: tuple[str, ...]
    errors: dict[str, float]
    covered: dict[str, bool]
    noise: float


def main() -> None:
    """Run the study."""
    options = arguments("Vehicles with dry friction.", campaigns=100).parse_args()
    tasks: list[tuple[Kind, int]] = [("none", seed) for seed in range(options.campaigns)]
    tasks += [("friction", seed) for seed in range(options.campaigns)]
    tasks += [("another law", seed) for seed in range(max(options.campaigns // 10, 1))]
    trials: list[Trial] = []
    for trial in run(attempt, tasks, options.processes, 1):
        trials.append(trial)
        report_progress(
            f"{len(trials)} of {len(tasks)}: {trial.kind}, {trial.vehicle}: {trial.verdict}, {trial.extras}"
        )
        # It takes a while: whoever interrupts it has what was found so far.
        write(options.to, "friction", page(trials), {"campaigns": [_document(one) for one in trials]})


def attempt(kind: Kind, seed: int) -> Trial:
    """Identify one campaign, with nothing said of the model."""
    random = np.random.default_rng(10_000 + seed)
    if kind == "none":
        test = FLEET[seed % len(FLEET)]
        return _judged(kind, test.vehicle, test.campaign(seed))
    vehicle = _with_friction((TABLE_1_CAR, SCHOOL_BUS)[seed % 2], random, uneven=kind == "another law")
    law: Law = "dahl" if kind == "friction" else "bouc-wen"
    loads = loads_of(vehicle)
    drops = [{"wheels": wheels, "height": HEIGHT, "load": name} for name in ("empty", "ballast") for wheels in WHEELS]
    campaign = measured(vehicle, law=law, seed=seed, rate=RATE, duration=DURATION, loads=loads, drops=drops)
    return _judged(kind, vehicle, campaign)


def _with_friction(vehicle: Vehicle, random: np.random.Generator, uneven: bool) -> Vehicle:
    """Return a vehicle with friction of 0.5 to 3 % of a wheel's load; for another law with rebound damping as well."""
    weight = 9.81 * vehicle.m_s / 4
    friction = {f"F_{axle}": float(weight * random.uniform(0.005, 0.03)) for axle in "fr"}
    stiff = {f"s_{axle}": float(friction[f"F_{axle}"] / random.uniform(3e-4, 8e-4)) for axle in "fr"}
    if uneven:
        friction, stiff = {"F_f": 100.0, "F_r": 100.0}, {"s_f": 2e5, "s_r": 2e5}
        friction |= {"r_f": 2.0, "r_r": 2.0}
    return Vehicle.from_parameters(vehicle.parameters | friction | stiff, name=f"{vehicle.name} with friction")


def _judged(kind: Kind, vehicle: Vehicle, campaign: sprung.Campaign) -> Trial:
    result = sprung.identify(campaign)
    errors, covered = {}, {}
    for name, found in result.parameters.items():
        truth = getattr(vehicle, name)
        if truth and found.status == "estimated" and found.value is not None and found.interval95 is not None:
            errors[name] = found.value / truth - 1
            covered[name] = bool(found.interval95[0] <= truth <= found.interval95[1])
    noise = float(np.sqrt(np.mean(np.array(list(result.fit.noise.values())) ** 2))) / 0.02
    apart = ("tracks apart",) if result.fit.tracks == "separate" and vehicle.tracks == "shared" else ()
    return Trial(kind, vehicle.name, result.verdict.state, (*result.fit.model, *apart), errors, covered, noise)


def _document(trial: Trial) -> dict[str, Any]:
    rounded = {name: figures(error) for name, error in trial.errors.items()}
    return asdict(trial) | {"errors": rounded, "noise": figures(trial.noise)}


def page(trials: Sequence[Trial]) -> str:
    """Write the page."""
    rows = [_row(kind, [one for one in trials if one.kind == kind]) for kind in ("friction", "another law", "none")]
    head = [
        "friction",
        "campaigns",
        "accept / doubtful / reject",
        "model",
        "error, rms",
        "error, worst accepted",
        "covered",
    ]
    sound = [one for one in trials if one.kind == "none"]
    added = sum(bool(one.extras) for one in sound)
    return f"""# Dry friction

Is dry friction detected if the campaign file does not mention it, and how accurate are the results? Is friction reported for
vehicles without it?

## Method

*Friction*: the paper's car and school bus, with friction of 0.5 to 3 % of a wheel's load on each spring and a presliding
deflection of 0.3 to 0.8 mm (drawn at random), dropped from {100 * HEIGHT:g} cm in four ways, with and without a load of a
tenth of the sprung mass; {RATE:g} samples per second, noise 0.02 m/s². The drops were simulated with separately written
equations and a separate solver (`hysteresis.py`: Runge-Kutta, step 0.2 ms; {{term}}`Dahl's model <Dahl model>`). *Another
law*: the same with 100 N, dampers with twice the rate in rebound, and hysteresis after Bouc and Wen, which is not the
model of the fit. *None*: the linear vehicles of the study of faults. Every campaign was identified with default options:
`sprung.identify(campaign)`.

## Results

{table(head, [row for row in rows if row])}

Errors are those of all parameters except the presliding stiffness, in percent of the true value; *covered* is the
percentage of 95 % intervals that contain it. Of {len(sound)} campaigns without friction {added} were given a model term
that the vehicle does not have.

## Reproduction

    python docs/studies/friction.py --processes 2
"""


def _row(kind: str, trials: Sequence[Trial]) -> list[str]:
    if not trials:
        return []
    verdicts = Counter(one.verdict for one in trials)
    models = Counter(" + ".join(one.extras) or "none" for one in trials)
    errors = np.array([e for one in trials for name, e in one.errors.items() if name[:2] != "s_"] or [np.nan])
    accepted = [
        e for one in trials if one.verdict == "accept" for name, e in one.errors.items() if name[:2] != "s_"
    ] or [np.nan]
    covered = [hit for one in trials for hit in one.covered.values()] or [False]
    return [
        kind,
        f"{len(trials)}",
        " / ".join(str(verdicts[state]) for state in ("accept", "doubtful", "reject")),
        ", ".join(f"{name} {count}" for name, count in models.most_common(4)),
        f"{100 * float(np.sqrt(np.mean(errors**2))):.2f} %",
        f"{100 * float(np.abs(accepted).max()):.1f} %",
        f"{100 * float(np.mean(covered)):.1f} %",
    ]


if __name__ == "__main__":
    main()

"""Parts of vehicles as they are: rubber, friction, curves, and sensors of any kind. Writes parts-as-they-are.md.

Run with `python docs/studies/parts_as_they_are.py --campaigns 60 --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from pages import arguments, figures, report_progress, run, table, write
from real_cars import LIMIT, STATES
from real_outcomes import WIDE, Outcome, judge
from rigs import EFFECTS, MODELS, READINGS, Rig, draw_rig


class Judged(NamedTuple):
    """One campaign: what was tested, and what came of it."""

    rig: Rig
    outcome: Outcome


def try_rig(number: int, limit: float) -> Judged:
    """Record and identify one campaign."""
    rig = draw_rig(number)
    truth = {name: value for name, value in rig.vehicle.parameters.items() if value}
    outcome, _ = judge((rig.vehicle.model, number, rig.label), rig.record(), truth, limit)
    return Judged(rig, outcome)


def main() -> None:
    """Run the study."""
    parser = arguments("Parts of vehicles with further properties and any sensors.", campaigns=60)
    parser.add_argument("--first", type=int, default=0, help="number of the first campaign (default 0)")
    parser.add_argument("--limit", type=float, default=LIMIT, help="s of processor time for each (default %(default)g)")
    options = parser.parse_args()
    tasks = [(n, options.limit) for n in range(options.first, options.first + options.campaigns)]
    tested: list[Judged] = []
    for one in run(try_rig, tasks, options.processes, 1):
        tested.append(one)
        report_progress(_sentence(one))
        write(options.to, "parts-as-they-are", page(tested), {"campaigns": [_document(each) for each in tested]})


def _document(one: Judged) -> dict[str, Any]:
    outcome = one.outcome
    return {
        "number": one.rig.number,
        "test": one.rig.label,
        "verdict": outcome.verdict,
        "reason": outcome.reason,
        "model": list(outcome.model),
        "faults": list(outcome.faults),
        "errors_percent": {name: figures(100 * error[0]) for name, error in outcome.errors.items()},
        "errors_in_standard_errors": {name: figures(error[1]) for name, error in outcome.errors.items()},
        "covered": sum(error[2] for error in outcome.errors.values()),
        "seconds": round(outcome.seconds, 1),
    }


def _sentence(one: Judged) -> str:
    outcome = one.outcome
    found = [outcome.verdict]
    wide, name = outcome.worst_scaled
    if name:
        found.append(f"{wide:.3g} standard errors ({name}, {100 * outcome.errors[name][0]:.3g} %)")
    found += [f"reported {fault}" for fault in outcome.faults]
    if outcome.verdict != "accept":
        found.append(outcome.reason)
    return f"number {one.rig.number}, {one.rig.label}: {', '.join(found)}; {outcome.seconds:.0f} s"


def page(tested: Sequence[Judged]) -> str:
    """Write the page."""
    head = ["", "campaigns", " / ".join(STATES), "with false faults", "worst in standard errors", "covered, %"]
    head += ["time, median and worst, s"]
    groups: list[tuple[str, Callable[[Judged], bool]]] = [
        *((model, lambda one, model=model: one.rig.vehicle.model == model) for model in MODELS),
        *((effect, lambda one, effect=effect: effect in one.rig.effects) for effect in EFFECTS),
        *((reading, lambda one, reading=reading: one.rig.readings == reading) for reading in READINGS),
        ("all", lambda _: True),
    ]
    chosen = [(name, [one.outcome for one in tested if belongs(one)]) for name, belongs in groups]
    others = "\n".join(f"- {_sentence(one)}" for one in tested if not one.outcome.is_right)
    return f"""# Parts of vehicles as they are

Rigs for a corner or an axle have rubber mounts, friction and curved dampers as cars have, and they are measured with
whatever is at hand: accelerometers, displacement sensors, gyroscopes. Are the parameters identified, and are the stated errors
correct?

## Method

Vehicles are drawn at random: quarter cars, pitch planes, roll planes and whole vehicles, each with one to three further
properties of usual size. Sensors are drawn, too: accelerometers on body and wheels, displacement sensors in their place,
travel sensors beside accelerometers or displacement sensors on the wheels, accelerometers with travel sensors; besides a
gyroscope in a third, and wherever nothing else would tell the roll of the body. They have the default errors of gain, tilt and
place, which in a third are stated to be zero. All are dropped four or five times from 3 to 6 cm; half of them also with a known
load. The total mass is known. Recordings take 3 or 5 s at 400, 500 or 1000 Hz; noise is half to twice 0.02 m/s², 0.05 mm,
0.002 rad/s. `sprung.simulate` makes the recordings: unlike the [cars as they are](real-cars.md), the vehicles are those of the
model that is fitted. A vehicle counts in the row of each of its properties.

The program has seen the campaigns up to number 229, and those from 282 to 371. When they were new to it, 18 of the first 230
were misjudged: accepted with errors of 8 to 31 standard errors (4, 49, 122, 183, 184 and 187), with sound sensors or drops
reported (15, 21, 35, 112, 166, 180 and 184), rejected (12 and 129), or without a result (101, 111 and 115); a doubtful one (84)
was 4.7 standard errors off. So were five of the 90 from 282 on: 300 (tyre damping missing, nine standard errors) and 335 (the
same, 5.5), 306 and 320 (two vehicles blamed), and 326 (no result). What was wrong is mended but for 84 and 335, whose tyre
damping gains 10 where 11 are required: its parameters are 0.3 to 2.7 % off. Numbers from 372 on are new to it.

## Results

{table(head, [_row(*one) for one in chosen if one[1]])}

Not accepted, with a false fault, or with an error beyond {WIDE:g} standard errors:

{others or "- none"}

Every campaign is in [parts-as-they-are.json](parts-as-they-are.json).

## Reproduction

    python docs/studies/parts_as_they_are.py --first {tested[0].rig.number} --campaigns {len(tested)} --processes 2
"""


def _row(name: str, outcomes: Sequence[Outcome]) -> list[str]:
    errors = [error for one in outcomes for error in one.errors.values()]
    seconds = [one.seconds for one in outcomes]
    return [
        name,
        str(len(outcomes)),
        " / ".join(str(sum(one.verdict == state for one in outcomes)) for state in STATES),
        str(sum(bool(one.faults) for one in outcomes)),
        f"{max((one.worst_scaled[0] for one in outcomes if one.errors), default=np.nan):.3g}",
        f"{100 * np.mean([error[2] for error in errors]) if errors else np.nan:.3g}",
        f"{np.median(seconds):.3g}, {max(seconds):.3g}",
    ]


if __name__ == "__main__":
    main()

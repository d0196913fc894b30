"""Cars as they are: mounts, curves, rubber, bodies that bend, sensors off by one per cent. Writes real-cars.md.

Run with `python docs/studies/real_cars.py --campaigns 60 --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import json
import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pages import PROGRAM, VERDICTS, arguments, figures, report_progress, run, table, write, write_figure
from real_kinds import KINDS, NO_VEHICLE, NOISE, RATE, WEIGHING
from real_outcomes import SLOWEST, Outcome, examine_seeds

LIMIT = 300.0
"""s of processor time for one campaign."""

TOGETHER = 6
"""Campaigns that are recorded at once."""

STATES = (*VERDICTS, "failed")


def main() -> None:
    """Run the study."""
    parser = arguments("Real cars, from a simulator of its own.", campaigns=60)
    every = (*KINDS, *NO_VEHICLE)
    parser.add_argument("--kinds", nargs="+", choices=every, default=every, help="kinds of cars (default: all)")
    parser.add_argument("--add", action="store_true", help="keep the kinds in real-cars.json that are not run")
    parser.add_argument("--limit", type=float, default=LIMIT, help="s of processor time for each (default %(default)g)")
    options = parser.parse_args()
    before = json.loads((options.to / "real-cars.json").read_text()) if options.add else None
    seeds = [range(i, min(i + TOGETHER, options.campaigns)) for i in range(0, options.campaigns, TOGETHER)]
    tasks = [(kind, some, options.limit) for kind in options.kinds for some in seeds]
    outcomes: list[Outcome] = []
    for some in run(examine_seeds, tasks, options.processes, chunk=1):
        outcomes += some
        last = some[-1]
        report_progress(f"{last.kind} to {last.seed}: {', '.join(one.verdict for one in some)}")
    numbers = {
        "kinds": [document(_of(kind, outcomes)) | {"program": PROGRAM} for kind in options.kinds],
        "campaigns": [campaign_document(one) for one in outcomes],
        "notes": [],
    }
    if before is not None:
        numbers = merged(before, numbers)
    drawn = draw(numbers, options.to / "real-cars.svg")
    write(options.to, "real-cars", page(numbers, drawn), numbers, made_by="")


Numbers = Mapping[str, list[dict[str, Any]]]
"""What the JSON file holds: the figures of each kind, each campaign, and what was found out about single ones of a kind.

The last is written by hand, and goes when the kind is run again.
"""


def merged(before: Numbers, added: Numbers) -> dict[str, list[dict[str, Any]]]:
    """Return the figures of two runs, those of the later one where both have a kind, in the order of the table of kinds."""
    new = {one["kind"] for one in added["kinds"]}
    order = (*KINDS, *NO_VEHICLE)
    return {
        part: sorted(
            [*(one for one in before[part] if one["kind"] not in new), *added[part]],
            key=lambda one: order.index(one["kind"]),
        )
        for part in added
    }


def _of(kind: str, outcomes: Sequence[Outcome]) -> list[Outcome]:
    return [one for one in outcomes if one.kind == kind]


def document(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Return the figures of a kind for JSON."""
    stated = [one for one in outcomes if one.errors and one.verdict != "reject"]
    names = list(dict.fromkeys(name for one in stated for name in one.errors))
    held = [error[2] for one in stated for error in one.errors.values()]
    curves = np.array([one.curve for one in stated], dtype=float).reshape(-1, 2)
    return {
        "kind": outcomes[0].kind,
        "campaigns": len(outcomes),
        "verdicts": {state: sum(one.verdict == state for one in outcomes) for state in STATES},
        "with_false_faults": sum(bool(one.faults) for one in outcomes),
        "median_worst_percent": figures(100 * _over(np.nanmedian, [one.worst[0] for one in stated])),
        "worst_percent": figures(100 * _over(np.nanmax, [one.worst[0] for one in stated])),
        "worst_in_standard_errors": figures(_over(np.nanmax, [one.worst_scaled[0] for one in stated])),
        "coverage_percent": figures(100 * float(np.mean(held)) if held else np.nan),
        "curve_median_percent": figures(100 * _over(np.nanmedian, curves[:, 0].tolist())),
        "curve_worst_percent": figures(100 * _over(np.nanmax, curves[:, 0].tolist())),
        "curve_worst_in_standard_errors": figures(_over(np.nanmax, curves[:, 1].tolist())),
        "seconds_median": figures(_over(np.nanmedian, [one.seconds for one in outcomes])),
        "seconds_worst": figures(_over(np.nanmax, [one.seconds for one in outcomes])),
        "models": dict(Counter(", ".join(one.model) or "none" for one in outcomes if one.errors).most_common()),
        "faults": dict(Counter(fault for one in outcomes for fault in one.faults).most_common()),
        "parameters": {
            name: _of_parameter([one.errors[name] for one in stated if name in one.errors]) for name in names
        },
    }


def _of_parameter(errors: Sequence[tuple[float, float, bool]]) -> dict[str, Any]:
    """Return the figures of one parameter, from its errors in all campaigns of a kind."""
    part, scaled, held = np.array(errors, dtype=float).T
    return {
        "estimated": len(errors),
        "median_percent": figures(100 * np.median(np.abs(part))),
        "worst_percent": figures(100 * np.abs(part).max()),
        "worst_in_standard_errors": figures(np.abs(scaled).max()),
        "coverage_percent": figures(100 * held.mean()),
    }


def campaign_document(one: Outcome) -> dict[str, Any]:
    """Return one campaign for JSON: what it was, and what came of it."""
    return {
        "kind": one.kind,
        "seed": one.seed,
        "type": one.type,
        "verdict": one.verdict,
        "reason": one.reason,
        "model": one.model,
        "faults": one.faults,
        "worst_percent": figures(100 * one.worst[0]),
        "worst": one.worst[1],
        "worst_in_standard_errors": figures(one.worst_scaled[0]),
        "worst_scaled": one.worst_scaled[1],
        "curve_percent": figures(100 * one.curve[0]),
        "seconds": figures(one.seconds),
    }


def _over(statistic: Callable[[Sequence[float]], Any], values: Sequence[float]) -> float:
    """Return a statistic of the values that are numbers; NaN where there are none."""
    there = [value for value in values if not np.isnan(value)]
    return float(statistic(there)) if there else np.nan


def page(numbers: Numbers, drawn: bool) -> str:
    """Write the page."""
    head = ["car with", "campaigns", " / ".join(STATES), "false faults", "median error, %", "worst, %"]
    head += ["worst in standard errors", "covered, %", "damper curve, median and worst, %", "time, median and worst, s"]
    sound = [one for one in numbers["kinds"] if one["kind"] not in NO_VEHICLE]
    rows = [_row(one) for one in sound]
    others = [one for one in numbers["kinds"] if one["kind"] in NO_VEHICLE]
    refused = [
        [one["kind"], str(one["campaigns"]), _verdicts(one)]
        + [_text(one[key]) for key in ("worst_percent", "worst_in_standard_errors", "seconds_worst")]
        for one in others
    ]
    head_refused = ["no vehicle", "campaigns", " / ".join(STATES), "worst of those accepted, %", "in standard errors"]
    accused, tested = (sum(one[count] for one in sound) for count in ("with_false_faults", "campaigns"))
    picture = "\n![Worst error of each campaign](real-cars.svg)\n" if drawn else ""
    return f"""# Cars as they are

Real cars have damper mounts, damper curves with a knee, rubber beside the springs, tyres that stiffen and damp, bodies that
twist and bend, air springs, people on seats, and sensors with errors of one per cent. Are their parameters identified, and
are the stated errors correct?

## Method

The recordings are from a simulator of its own (`real_motion.py`): Newton's and Euler's equations of each body, with internal
states of mounts and rubber as differential equations, followed by the method of Runge and Kutta in steps of 0.25 ms. It
shares no equation with `sprung.vehicle`, and equals `sprung.simulate` within 1e-5 of the largest acceleration for a plain
car. Tall cars turn with finite angles (`real_rotations.py`). Each car was drawn at random from six types, all sizes
log-uniform in the usual ranges (`real_kinds.py`).

Each campaign: ten drops from 5 cm (buses 7 cm), five with ballast; {RATE:g} samples per second; noise
{NOISE:g} m/s²; axle masses known within {WEIGHING:g} kg. The campaign file says nothing about the kind.

*Knee* are dampers of which 20 to 60 % of the rate are left beyond the knee, *orifice* such that have 1.5 to 3 times as much
there.

*Seats* are two people side by side, each with a weight and a seat of his own. *Tall* cars have anti-roll bars and a centre of
gravity 0.75 to 1 m high, of which the campaign file says nothing. *Usual* is everything at once that every car has: mount,
curve, rubber, tyre, dry friction, sensors as they are; those are tilted and misplaced, have errors of gain, and loggers with
a low-pass. *Two effects* go through the 35 pairs of mount, knee, Zener, tyre, friction, twist, bending, air and seats, with
sensors that are tilted and misplaced and have errors of gain. *Median error* is that of the worst parameter of each campaign,
among the fifteen of the plain vehicle; *worst* the largest of all. *Covered*: 95 % intervals of all parameters that contain
the true value. Errors do not include rejected campaigns, of which no parameters are stated. The damper curve is compared from
{SLOWEST:g} m/s to the largest velocity in the decays.

## Results

{table(head, rows)}

Of {tested} sound campaigns {accused} have a fault reported.
{picture}
Rows by the commit of the program that made them: {_made_by(numbers["kinds"])}.
Times depend on the machine, with a program on each of its cores: compare them with those of plain cars by the same program.
{_notes(numbers["notes"])}
What no vehicle is, to be rejected: a wheel that strikes a stop after some play, a loose sensor that slaps, and recordings
of two vehicles mixed.

{table([*head_refused, "longest time, s"], refused)}

A sensor that slaps only while a wheel is in the air spoils no decay: such campaigns are accepted, and its spikes are named.
Of two vehicles the drops of each are named.

Every parameter and every campaign is in [real-cars.json](real-cars.json).

## Reproduction

    python docs/studies/real_cars.py --kinds plain --campaigns 200 --processes 2
    python docs/studies/real_cars.py --kinds KIND ... --campaigns 60 --processes 2 --add
"""


def _made_by(kinds: Sequence[dict[str, Any]]) -> str:
    """Return by which commits the rows were made, the one that made most of them first."""
    made = Counter(one["program"] for one in kinds)
    return "; ".join(
        f"{commit}: {', '.join(one['kind'] for one in kinds if one['program'] == commit)}"
        for commit, _ in made.most_common()
    )


def _notes(notes: Sequence[dict[str, Any]]) -> str:
    return "".join(f"\n*{one['kind'].capitalize()}.* {one['text']}\n" for one in notes)


def _row(one: dict[str, Any]) -> list[str]:
    return [
        one["kind"],
        str(one["campaigns"]),
        _verdicts(one),
        str(one["with_false_faults"]),
        *(
            _text(one[key])
            for key in ("median_worst_percent", "worst_percent", "worst_in_standard_errors", "coverage_percent")
        ),
        f"{_text(one['curve_median_percent'])}, {_text(one['curve_worst_percent'])}",
        f"{_text(one['seconds_median'])}, {_text(one['seconds_worst'])}",
    ]


def _verdicts(one: dict[str, Any]) -> str:
    return " / ".join(str(count) for count in one["verdicts"].values())


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


def draw(numbers: Numbers, path: Path) -> bool:
    """Draw the worst error of each campaign by kind; False without matplotlib."""
    try:
        from matplotlib.figure import Figure  # noqa: PLC0415 (optional)
    except ImportError:
        return False
    kinds = [one["kind"] for one in numbers["kinds"] if one["kind"] not in NO_VEHICLE]
    figure = Figure(figsize=(7.5, 0.6 + 0.32 * max(len(kinds), 1)), layout="constrained")
    axes = figure.subplots()
    colours = {"accept": "#2a6f97", "doubtful": "#edae49", "reject": "#d1495b"}
    for row, kind in enumerate(kinds):
        for state, colour in colours.items():
            own = [one for one in numbers["campaigns"] if (one["kind"], one["verdict"]) == (kind, state)]
            worst = [one["worst_percent"] for one in own if one["worst_percent"] is not None]
            axes.plot(worst, np.full(len(worst), row), "|", color=colour, markersize=9)
    axes.axvline(2.0, color="#888888", linewidth=0.8)
    axes.set(xscale="log", xlabel="error of the worst plain parameter, %", yticks=range(len(kinds)), yticklabels=kinds)
    axes.invert_yaxis()
    write_figure(figure, path)
    return True


if __name__ == "__main__":
    main()

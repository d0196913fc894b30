"""Cars as they are, tested in other ways: other rates, noise, heights, drops, ballast. Writes real-car-tests.md.

Run with `python docs/studies/real_car_tests.py --campaigns 120 --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from pages import arguments, report_progress, run, table, write
from real_campaigns import record
from real_cars import LIMIT, STATES, campaign_document, document
from real_kinds import FIVE, KINDS, WEIGHING, Draw, RealTest, draw_test
from real_outcomes import WIDE, Outcome, examine

RATES = (250.0, 400.0, 500.0, 1000.0, 2000.0)
"""Samples per second."""

NOISE, DURATION, HEIGHT = (0.005, 0.1), (2.0, 8.0), (0.03, 0.08)
"""Ranges: m/s² root-mean-square; s of each recording; m of the blocks."""

BALLAST = (0.4, 1.5)
"""Range of the ballast, as a part of that in the study of real cars."""

UNWEIGHED = 0.3
"""Part of the campaigns in which nothing is weighed but the ballast."""

SEEDS = 1000
"""The first car's seed: none that the study of real cars has."""


class Judged(NamedTuple):
    """One campaign: how the car was tested, and what came of it."""

    number: int
    test: RealTest
    outcome: Outcome

    @property
    def way(self) -> str:
        """How the car was tested."""
        test = self.test
        drops = sum(not loaded for loaded, _ in test.drops)
        weighed = "weighed" if test.weighing else "not weighed"
        return (
            f"{test.rate:g} Hz, {test.noise:.3f} m/s², {test.duration:g} s, {100 * test.height:.1f} cm, {drops} + {drops} "
            f"drops, {sum(one.mass for one in test.items) / test.car.m_s:.0%} ballast, {weighed}"
        )


def draw_other_test(number: int) -> RealTest:
    """Draw a car of the kind whose turn it is, and how it is tested."""
    kind = tuple(KINDS)[number % len(KINDS)]
    test, draw = draw_test(kind, SEEDS + number), Draw("tested otherwise", number)
    part, kept = draw.size(*BALLAST), int(draw.random.integers(3, len(FIVE) + 1))
    items = tuple(
        replace(one, mass=float(round(part * one.mass)), inertia=(part * one.inertia[0], part * one.inertia[1]))
        for one in test.items
    )
    return replace(
        test,
        rate=float(draw.random.choice(RATES)),
        noise=draw.size(*NOISE),
        duration=round(draw.random.uniform(*DURATION), 1),
        height=round(draw.size(*HEIGHT), 3),
        drops=tuple(one for one in test.drops if one[1] in FIVE[:kept]),
        items=items,
        weighing=None if draw.random.uniform() < UNWEIGHED else WEIGHING,
    )


def try_test(number: int, limit: float) -> Judged:
    """Record and identify one campaign."""
    test = draw_other_test(number)
    ((campaign, truth),) = record([test])
    return Judged(number, test, examine(campaign, truth, limit))


def main() -> None:
    """Run the study."""
    parser = arguments("Real cars, tested in other ways.", campaigns=120)
    parser.add_argument("--first", type=int, default=0, help="number of the first campaign (default 0)")
    parser.add_argument("--kinds", nargs="+", choices=tuple(KINDS), default=tuple(KINDS), help="only these kinds")
    parser.add_argument("--limit", type=float, default=LIMIT, help="s of processor time for each (default %(default)g)")
    options = parser.parse_args()
    numbers = range(options.first, options.first + options.campaigns)
    tasks = [(n, options.limit) for n in numbers if tuple(KINDS)[n % len(KINDS)] in options.kinds]
    tested: list[Judged] = []
    for one in run(try_test, tasks, options.processes, 1):
        tested.append(one)
        report_progress(f"{one.number}: {_sentence(one)}")
        write(options.to, "real-car-tests", page(tested), {"campaigns": [_document(each) for each in tested]})


def _document(one: Judged) -> dict[str, Any]:
    return {"number": one.number, "way": one.way} | campaign_document(one.outcome)


def _sentence(one: Judged) -> str:
    outcome = one.outcome
    found = [outcome.verdict]
    if np.isfinite(outcome.worst[0]):
        found.append(f"{100 * outcome.worst[0]:.3g} % ({outcome.worst[1]})")
        found.append(f"{outcome.worst_scaled[0]:.3g} standard errors ({outcome.worst_scaled[1]})")
    found += [f"reported {fault}" for fault in outcome.faults]
    if outcome.verdict != "accept":
        found.append(outcome.reason)
    return f"{outcome.kind} at {one.way}: {', '.join(found)}; {outcome.seconds:.0f} s"


def page(tested: Sequence[Judged]) -> str:
    """Write the page."""
    head = ["car with", "campaigns", " / ".join(STATES), "false faults", "median error, %", "worst, %"]
    head += ["worst in standard errors", "covered, %", "time, median and worst, s"]
    kinds = list(dict.fromkeys(one.outcome.kind for one in tested))
    rows = [_row(kind, [one.outcome for one in tested if one.outcome.kind == kind]) for kind in kinds]
    rows.append(_row("all", [one.outcome for one in tested]))
    others = "\n".join(f"- number {one.number}, {_sentence(one)}" for one in tested if not one.outcome.is_right)
    return f"""# Cars as they are, tested in other ways

In the [study of real cars](real-cars.md) all cars are tested alike. Nobody else tests like that: other loggers, noisier
sensors, lower blocks, fewer drops, less ballast, no scales. Are the parameters identified, and are the stated errors correct?

## Method

Cars and simulator are those of the study of real cars, with other seeds. Drawn at random for each campaign were: samples per
second, of {", ".join(f"{one:g}" for one in RATES)}; noise, {NOISE[0]:g} to {NOISE[1]:g} m/s²; length of the recordings,
{DURATION[0]:g} to {DURATION[1]:g} s; blocks, {100 * HEIGHT[0]:g} to {100 * HEIGHT[1]:g} cm; drops without ballast and as many
with it, 3 (bounce and both axles) to 5 (roll to either side, too); ballast, {BALLAST[0]:g} to {BALLAST[1]:g} of that in the
other study. In {UNWEIGHED:.0%} nothing was weighed but the ballast, so that the scale of all masses, rates and forces is found
from what the ballast changes. The columns are as there. A large error beside much noise or without scales is no fault of the
program if its standard error says so: *worst in standard errors* and *covered* judge it.

The program has seen the campaigns up to number 586. When they were new, seven of the first 120 were misjudged (7, 17, 82,
98, 104, 117 and 119), and seven of the next 120: 149 (a sound drop left out, the roll inertia 14 standard errors off), 146,
178, 221 and 230 (six standard errors), and 143 and 236 (no result after 300 s). Of the 60 from 240 on, one was rejected (249:
two people of unlike mass), one had no result after 300 s (290), and one error was of five standard errors (251: falls of
damped tyres). Of the 58 from 300 on, one had no result (356), and four errors were too large: 309 (two people again, seven
standard errors), 313 (rubber that noise hides, beside a body that bends: nine, and 4 % of the spring rates), 316 (no drop
rolls: nine, doubtful) and 320 (4.4). No sensor and no drop of all these was blamed. Of the 60 from 358 on, one was rejected
and three healthy sensors blamed (407: a knee), and two errors were too large: 358 (friction and air springs, no drop rolls:
5.5, doubtful) and 389 (a tall van, no drop rolls: six). Numbers 418 to 432 were looked at one by one. Of the 60 from 433 on,
one had no result (491: everything usual; now after 170 s), and three errors were too large: 433 (bending and two people, very
little noise: five standard errors, 1.5 % of the half-distances), 449 (a tall van again: ten) and 463 (friction and air
springs: nine). Of the 27 from 504 on, which were looked at one by one, 25 were accepted; two errors were too large, of a Zener
branch that a damper mount took the place of (523: sixteen) and of one that was left out (514: twenty, doubtful). What was wrong
is mended but for 433: 313 has its largest error at 3.4 standard errors now, and 236 a result after 290 s. The 56 from 531 on
were all accepted when they were new: the largest error is of 3.3 standard errors, and one (551: everything usual, 8 s at 1000
Hz) took 222 s. So were the 30 from 587 on: the largest error is of 2.9 standard errors, the longest time 130 s. Numbers from
617 on are new to it.

## Results

{table(head, rows)}

Not accepted, with a false fault, or with an error beyond {WIDE:g} standard errors:

{others or "- none"}

Every campaign is in [real-car-tests.json](real-car-tests.json).

## Reproduction

    python docs/studies/real_car_tests.py --first {tested[0].number} --campaigns {len(tested)} --processes 2
"""


def _row(name: str, outcomes: Sequence[Outcome]) -> list[str]:
    one = document(outcomes)
    keys = "median_worst_percent", "worst_percent", "worst_in_standard_errors", "coverage_percent"
    return [
        name,
        str(one["campaigns"]),
        " / ".join(str(count) for count in one["verdicts"].values()),
        str(one["with_false_faults"]),
        *("-" if one[key] is None else f"{one[key]:.3g}" for key in keys),
        f"{one['seconds_median']:.3g}, {one['seconds_worst']:.3g}",
    ]


if __name__ == "__main__":
    main()

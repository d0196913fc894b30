"""Which faults are detected in cars as they are, which no linear model describes? Writes real-car-faults.md.

Run with `python docs/studies/real_car_faults.py --campaigns 1 --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple, cast
from zlib import crc32

import numpy as np
from fleet import VehicleTest
from outcomes import INJURIES, read_back
from pages import arguments, figures, report_progress, run, table, write
from real_campaigns import record
from real_cars import STATES
from real_kinds import draw_test
from real_outcomes import Outcome, examine

KINDS = ("tyre", "air", "twist", "knee", "usual")
"""Kinds of cars, as in the study of real cars."""

FAULTS = (
    "sign, DC",
    "late",
    "low-pass",
    "position, 0.3 m",
    "exchanged, wheels",
    "exchanged, body and wheel",
    "exchanged, body",
    "wrong wheel",
    "load exchanged, one",
)
"""What is introduced, as in the study of faults."""

RATE, NOISE, REST = 500.0, 0.02, 0.5
"""Samples per second, m/s² and s before the release of these recordings."""

LIMIT = 400.0
"""s of processor time for one campaign."""


class Found(NamedTuple):
    """What came of one campaign with a fault; None where the fault cannot be introduced into it."""

    fault: str
    codes: tuple[str, ...]
    names: tuple[str, ...]
    outcome: Outcome

    @property
    def is_named(self) -> bool:
        """Whether one reported fault has the code and names all that is at fault."""
        own = [text for text in self.outcome.faults if text.partition(" (")[0] in self.codes]
        return any(all(name.removesuffix(".csv") in text for name in self.names) for text in own)


def try_fault(kind: str, seed: int, fault: str) -> Found | None:
    """Introduce a fault into the campaign of a car, and identify it."""
    ((campaign, truth),) = record([draw_test(kind, seed)])
    injury = INJURIES[fault]
    test = cast("VehicleTest", SimpleNamespace(rate=RATE, noise=NOISE, rest=REST))
    injured = injury.act(test, campaign, np.random.default_rng([seed, crc32(fault.encode())]))
    if injured is None:
        return None
    return Found(fault, injury.codes, injured.names, examine(read_back(injured), truth, LIMIT))


def main() -> None:
    """Run the study."""
    parser = arguments("Which faults are noticed in cars as they are.", campaigns=1)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS, help="only these kinds of cars")
    parser.add_argument("--faults", nargs="+", choices=FAULTS, default=FAULTS, metavar="NAME", help="only these")
    options = parser.parse_args()
    tasks = [
        (kind, seed, fault) for seed in range(options.campaigns) for kind in options.kinds for fault in options.faults
    ]
    found: list[Found] = []
    for (kind, seed, fault), one in zip(tasks, run(try_fault, tasks, options.processes, 1), strict=True):
        if one is None:
            continue
        found.append(one)
        named = "named" if one.is_named else "not named"
        report_progress(f"{kind} {seed}, {fault}: {named}, {one.outcome.verdict}, {one.outcome.seconds:.0f} s")
        # Each takes a minute: whoever interrupts the study has what was found so far.
        write(options.to, "real-car-faults", page(found), {"campaigns": [document(each) for each in found]})


def document(one: Found) -> dict[str, Any]:
    """Return one campaign for JSON."""
    outcome = one.outcome
    return {
        "fault": one.fault,
        "at": list(one.names),
        "kind": outcome.kind,
        "seed": outcome.seed,
        "vehicle": outcome.type,
        "named": one.is_named,
        "verdict": outcome.verdict,
        "reported": list(outcome.faults),
        "reason": outcome.reason,
        "worst_percent": figures(100 * outcome.worst[0]),
        "worst_in_standard_errors": figures(outcome.worst_scaled[0]),
        "model": list(outcome.model),
    }


def row(name: str, every: Sequence[Found]) -> list[str]:
    """Return a row of the table."""
    outcomes = [one.outcome for one in every]
    counts = [sum(one.verdict == verdict for one in outcomes) for verdict in STATES]
    accepted = [one for one in outcomes if one.verdict == "accept" and one.errors]
    worst = max((100 * one.worst[0] for one in accepted), default=np.nan)
    scaled = max((one.worst_scaled[0] for one in accepted), default=np.nan)
    times = [one.seconds for one in outcomes]
    return [
        name,
        str(len(every)),
        str(sum(one.is_named for one in every)),
        " / ".join(map(str, counts)),
        "-" if np.isnan(worst) else f"{worst:.3g}",
        "-" if np.isnan(scaled) else f"{scaled:.3g}",
        f"{np.median(times):.3g}, {max(times):.3g}",
    ]


def page(found: Sequence[Found]) -> str:
    """Return the page."""
    head = (
        *("campaigns", "named", "accept / doubtful / reject / failed", "worst of those accepted, %"),
        *("in standard errors", "time, median and worst, s"),
    )
    by_fault = {name: [one for one in found if one.fault == name] for name in FAULTS}
    by_kind = {name: [one for one in found if one.outcome.kind == name] for name in KINDS}
    faults = table(("fault", *head), [row(name, every) for name, every in by_fault.items() if every])
    kinds = table(("car with", *head), [row(name, every) for name, every in by_kind.items() if every])
    named = sum(one.is_named for one in found)
    missed = [
        f"- {one.outcome.kind} {one.outcome.seed}, {one.fault} ({', '.join(one.names)}): {one.outcome.verdict}, reported "
        f"{', '.join(one.outcome.faults) or 'nothing'}."
        for one in found
        if not one.is_named
    ]
    campaigns = max((one.outcome.seed for one in found), default=0) + 1
    done = [name for name in FAULTS if by_fault[name]]
    what = "\n".join(f"- {name}: {INJURIES[name].what}." for name in done)
    only = "".join(f' "{name}"' for name in done) if len(done) < len(FAULTS) else ""
    chosen = f" --faults{only}" if only else ""
    return f"""# Faults in cars as they are

No linear model describes a car with mounts, knees, stiffening tyres or a body that twists, and no such term explains a fault.
Are both identified if both are there?

## Method

The cars are those of the [study of real cars](real-cars.md): motions by an integration of its own, ten drops, five of them with
ballast, eight sensors, {RATE:g} samples per second, {NOISE:g} m/s² of noise, axle masses known. The faults are of the
[study of faults](faults.md); place and size were drawn at random:

{what}

A fault is *named* if a reported fault has its code and names everything that is at fault. Errors are those of the fifteen
plain parameters (percent) and of all parameters (standard errors) of accepted campaigns. Times are processor times.

## Results

{named} of {len(found)} faults were named.

{faults}

{kinds}

Not named:

{chr(10).join(missed) or "- None."}

Every campaign is in [real-car-faults.json](real-car-faults.json).

## Reproduction

    python docs/studies/real_car_faults.py --campaigns {campaigns}{chosen} --processes 2
"""


if __name__ == "__main__":
    main()

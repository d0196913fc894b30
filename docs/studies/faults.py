"""Which faults are detected, and what are the consequences? Writes faults.md.

Run with `python docs/studies/faults.py --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict

import numpy as np
from coloured import TIME_CONSTANT
from fleet import FLEET, OFFSET
from outcomes import INJURIES, Clean, Outcome, try_all, try_clean
from pages import arguments, figures, report_progress, run, table, write

VERDICTS = ("accept", "doubtful", "reject", "refused", "crash")

KINDS = ("white", "low-passed", "white", "12 bits over ±10 g")
"""The noise of sound campaigns, in turn."""

FAR = 3.0
"""Its own standard uncertainties by which a parameter may miss that of the sound campaign before harm is done."""

FIRST = 1000
"""Seed of the first sound campaign: none that is spoilt has it."""


def main() -> None:
    """Run the study."""
    parser = arguments("What is noticed of what goes wrong.", campaigns=500)
    parser.add_argument(
        "--faults", nargs="+", choices=[*INJURIES], default=[*INJURIES], metavar="NAME", help="only these"
    )
    parser.add_argument("--vehicles", type=int, default=len(FLEET), help="how many of them (default %(default)s)")
    parser.add_argument(
        "--seeds", type=int, default=10, help="campaigns of each, every fault in each (default %(default)s)"
    )
    options = parser.parse_args()
    sound = [
        (i % options.vehicles, FIRST + i, KINDS[i // options.vehicles % len(KINDS)]) for i in range(options.campaigns)
    ]
    cleans = list(run(try_clean, sound, options.processes))
    report_progress(f"{sum(one.alarm for one in cleans)} false alarms of {len(cleans)} sound campaigns")
    tasks = [(number, seed, options.faults) for seed in range(options.seeds) for number in range(options.vehicles)]
    outcomes: list[Outcome] = []
    for (number, seed, _), done in zip(tasks, run(try_all, tasks, options.processes, 1), strict=True):
        outcomes += done
        report_progress(
            f"{FLEET[number].vehicle.name}, {seed}: {sum(one.named for one in done)} of {len(done)} identified"
        )
        # It takes an hour: whoever interrupts it has what was found so far.
        write(options.to, "faults", page(outcomes, cleans), numbers(outcomes, cleans))


def numbers(outcomes: Sequence[Outcome], cleans: Sequence[Clean]) -> dict[str, list[dict[str, object]]]:
    """Return the figures for JSON: every kind of fault, all that were not identified, every false alarm."""
    missed = [
        asdict(one) | {name: figures(getattr(one, name)) for name in ("worst", "rms", "beyond")}
        for one in outcomes
        if not one.named
    ]
    every = [document(each) for each in by_injury(outcomes).values()]
    return {"faults": every, "missed": missed, "alarms": [asdict(one) for one in cleans if one.alarm]}


def by_injury(outcomes: Iterable[Outcome]) -> dict[str, list[Outcome]]:
    """Sort by what was done."""
    found: dict[str, list[Outcome]] = {name: [] for name in INJURIES}
    for one in outcomes:
        found[one.injury].append(one)
    return {name: each for name, each in found.items() if each}


def harmed(one: Outcome) -> bool:
    """Whether an accepted result deviates from that of the sound campaign."""
    return one.verdict == "accept" and one.beyond > FAR


def distances(outcomes: Iterable[Outcome]) -> tuple[float, float]:
    """Return root-mean-square and largest deviation of the accepted results; NaN without any."""
    accepted = [one for one in outcomes if one.verdict == "accept" and not np.isnan(one.rms)]
    if not accepted:
        return np.nan, np.nan
    return float(np.sqrt(np.mean([one.rms**2 for one in accepted]))), max(one.worst for one in accepted)


def document(outcomes: Sequence[Outcome]) -> dict[str, object]:
    """Return the figures of one kind of fault for JSON."""
    injury = INJURIES[outcomes[0].injury]
    rms, worst = distances(outcomes)
    return {
        "fault": injury.name,
        "codes": injury.codes,
        "done": injury.what,
        "campaigns": len(outcomes),
        "noticed": sum(one.noticed for one in outcomes),
        "named": sum(one.named for one in outcomes),
        "put_right": sum(one.put_right for one in outcomes),
        "left_out": sum(one.left_out for one in outcomes),
        "verdicts": {verdict: sum(one.verdict == verdict for one in outcomes) for verdict in VERDICTS},
        "rms_of_accepted": figures(rms),
        "worst_of_accepted": figures(worst),
        "harmed": sum(harmed(one) for one in outcomes),
        "harmed_unnoticed": sum(harmed(one) and not one.noticed for one in outcomes),
    }


def page(outcomes: Sequence[Outcome], cleans: Sequence[Clean]) -> str:
    """Write the page."""
    sorted_out = by_injury(outcomes)
    head = [
        "fault",
        "campaigns",
        "noticed",
        "identified",
        "corrected",
        "excluded",
        " / ".join(VERDICTS),
        "deviation, rms",
        "deviation, worst",
        "harm",
    ]
    rows = [_row(name, each) for name, each in sorted_out.items()]
    everything = len(outcomes)
    noticed, named = sum(one.noticed for one in outcomes), sum(one.named for one in outcomes)
    harm, unseen = sum(map(harmed, outcomes)), sum(harmed(one) and not one.noticed for one in outcomes)
    doubted = sum(not one.noticed and one.verdict != "accept" for one in outcomes)
    alarms = [one for one in cleans if one.alarm]
    vehicles = dict.fromkeys(one.vehicle for one in outcomes)
    tests = "\n".join(f"- {one.vehicle.name}: {one.label}." for one in FLEET if one.vehicle.name in vehicles)
    done = "\n".join(f"- {name}: {INJURIES[name].what}." for name in sorted_out)
    return f"""# Faults

Which faults of sensors, loggers, the campaign file or the test are detected, and what are the consequences for the result?

## Method

The vehicles, each with a different test:

{tests}

Sensors that measure gravity have an offset of {OFFSET:g} m/s² root-mean-square, drawn for every drop. Every fault was
introduced into the campaigns of each vehicle, one at a time. Place and size were drawn at random within these limits:

{done}

A fault is *noticed* if the result reports a fault that the result of the sound campaign does not report, and this has the
correct code or names the affected channel, recording or load. It is *identified* if one reported fault has the correct
code and names all of these; if the campaign is to be refused, the refusal must name them and state the reason. *Excluded*
counts the campaigns in which a channel or drop was not used. *Corrected* counts those in which the fault was noticed and
all data were used and accepted. The *deviation* is the difference of a parameter from that of the sound campaign, in
standard uncertainties of the latter, for the campaigns that were accepted. *Harm* counts the accepted campaigns with a
parameter that deviates by more than {FAR:g} of its own standard uncertainties, and in brackets those of them in which
nothing was noticed.

{len(cleans)} sound campaigns were identified, half of them with white noise, a quarter with noise filtered by a first-order
low-pass of {1000 * TIME_CONSTANT:g} ms and a quarter quantised to twelve bits over ±10 g; drift is not noise here but a
fault. Any reported fault, and any verdict other than accept, is a false alarm.

## Results

Of {everything} faults {noticed} were noticed ({_percent(noticed, everything)}) and {named} identified
({_percent(named, everything)}). Of those not noticed {doubted} had the verdict doubtful or reject, or were refused. Wrong
numbers were accepted {harm} times, {unseen} times without a reported fault. Of {len(cleans)} sound campaigns
{len(alarms)} gave a false alarm.

{table(head, rows)}

Reports for faults that were not identified, most frequent first:

{_missed(sorted_out)}

False alarms:

{_alarms(cleans)}

Every fault that was not identified, and every false alarm, is in [faults.json](faults.json).

## Reproduction

    python docs/studies/faults.py --processes 2
"""


def _row(name: str, outcomes: Sequence[Outcome]) -> list[str]:
    verdicts = " / ".join(str(sum(one.verdict == verdict for one in outcomes)) for verdict in VERDICTS)
    rms, worst = (f"{one:.2g}" if np.isfinite(one) else "-" for one in distances(outcomes))
    unseen = sum(harmed(one) and not one.noticed for one in outcomes)
    counts = (sum(getattr(one, what) for one in outcomes) for what in ("noticed", "named", "put_right", "left_out"))
    return [
        name,
        f"{len(outcomes)}",
        *map(str, counts),
        verdicts,
        rms,
        worst,
        f"{sum(map(harmed, outcomes))} ({unseen})",
    ]


def _percent(part: int, whole: int) -> str:
    return f"{100 * part / max(whole, 1):.1f} %"


def _missed(sorted_out: Mapping[str, Sequence[Outcome]]) -> str:
    rows = []
    for name, each in sorted_out.items():
        missed = Counter(f"{_codes(one)}: {one.verdict}" for one in each if not one.named)
        if missed:
            said = "; ".join(f"{count} × {what}" for what, count in missed.most_common(4))
            rows.append([name, f"{sum(missed.values())} of {len(each)}", said])
    return table(["fault", "missed", "reported instead"], rows) if rows else "Nothing was missed."


def _alarms(cleans: Sequence[Clean]) -> str:
    def rows() -> Iterator[list[str]]:
        for kind in dict.fromkeys(one.kind for one in cleans):
            each = [one for one in cleans if one.kind == kind]
            said = Counter(f"{_codes(one)}: {one.verdict}" for one in each if one.alarm)
            text = "; ".join(f"{count} × {what}" for what, count in said.most_common(4)) or "-"
            yield [kind, f"{len(each)}", f"{sum(said.values())}", text]

    return table(["noise", "campaigns", "false alarms", "reported"], rows())


def _codes(one: Clean | Outcome) -> str:
    return ", ".join(sorted({said.split(" ")[0] for said in one.said})) or "nothing"


if __name__ == "__main__":
    main()

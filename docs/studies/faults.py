"""What is noticed when something is wrong, and what comes of it? Writes faults.md.

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
from pages import arguments, figures, run, table, tell, write

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
    told = parser.parse_args()
    sound = [(i % told.vehicles, FIRST + i, KINDS[i // told.vehicles % len(KINDS)]) for i in range(told.campaigns)]
    cleans = list(run(try_clean, sound, told.processes))
    tell(f"{sum(one.alarm for one in cleans)} false alarms of {len(cleans)} sound campaigns")
    tasks = [(number, seed, told.faults) for seed in range(told.seeds) for number in range(told.vehicles)]
    outcomes: list[Outcome] = []
    for (number, seed, _), done in zip(tasks, run(try_all, tasks, told.processes, 1), strict=True):
        outcomes += done
        tell(f"{FLEET[number].vehicle.name}, {seed}: {sum(one.named for one in done)} of {len(done)} named rightly")
        # It takes an hour: whoever interrupts it has what was found so far.
        write(told.to, "faults", page(outcomes, cleans), numbers(outcomes, cleans))


def numbers(outcomes: Sequence[Outcome], cleans: Sequence[Clean]) -> dict[str, list[dict[str, object]]]:
    """Give what came out as what JSON knows: every injury, all that was not named, every false alarm."""
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
    """Say whether numbers were accepted that are far from what they would have been."""
    return one.verdict == "accept" and one.beyond > FAR


def distances(outcomes: Iterable[Outcome]) -> tuple[float, float]:
    """Give root-mean-square and worst distance of those that were accepted; NaN without any."""
    accepted = [one for one in outcomes if one.verdict == "accept" and not np.isnan(one.rms)]
    if not accepted:
        return np.nan, np.nan
    return float(np.sqrt(np.mean([one.rms**2 for one in accepted]))), max(one.worst for one in accepted)


def document(outcomes: Sequence[Outcome]) -> dict[str, object]:
    """Give what came of one injury as what JSON knows."""
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
        "named rightly",
        "put right",
        "left out",
        " / ".join(VERDICTS),
        "off, rms",
        "off, worst",
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

What is noticed when a sensor, a logger, the campaign file or the test itself is at fault, and what comes of it?

## How it was done

Vehicles, each tested in its own way:

{tests}

Sensors that feel gravity read {OFFSET:g} m/s² too much or too little at rest (root-mean-square), anew in every drop. To
each of the vehicles' campaigns every fault was done, one at a time; where and how much was drawn at random, within

{done}

A fault is *noticed* if a fault of the result, which the sound campaign's has not, has its code or names the channel,
recording or load that was spoilt; it is *named rightly* if one has its code and names all of these, or where the
campaign is to be refused, if the refusal names them and says what is wrong. *Left out* counts the
campaigns of which a channel or drop was not used, *put right* those in which it was noticed, and everything used and
accepted all the same. *Off* are the parameters' distances from those of the sound campaign, in that one's standard
uncertainties, of the campaigns that were accepted; *harm* counts those accepted with a parameter that is off by more than
{FAR:g} of its own, and in brackets those of them in which nothing was noticed.

{len(cleans)} campaigns were identified as they were, half of them with white noise, a quarter with noise behind a first-order
low-pass of {1000 * TIME_CONSTANT:g} ms and a quarter rounded to twelve bits over ±10 g; a drift is no noise here but a
fault. Any fault reported of them, and any verdict but accept, is a false alarm.

## What came out

Of {everything} faults {noticed} were noticed ({_percent(noticed, everything)}) and {named} named rightly
({_percent(named, everything)}); of those not noticed {doubted} were doubted, rejected or refused all the same. Numbers far
off were accepted {harm} times, {unseen} times without a word. Of {len(cleans)} sound campaigns {len(alarms)} gave a false
alarm.

{table(head, rows)}

What was said where a fault was not named rightly, most often first:

{_missed(sorted_out)}

False alarms:

{_alarms(cleans)}

Every fault that was not named, and every false alarm, is in [faults.json](faults.json).

## To run it again

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
    return table(["fault", "missed", "said instead"], rows) if rows else "Nothing was missed."


def _alarms(cleans: Sequence[Clean]) -> str:
    def rows() -> Iterator[list[str]]:
        for kind in dict.fromkeys(one.kind for one in cleans):
            each = [one for one in cleans if one.kind == kind]
            said = Counter(f"{_codes(one)}: {one.verdict}" for one in each if one.alarm)
            text = "; ".join(f"{count} × {what}" for what, count in said.most_common(4)) or "-"
            yield [kind, f"{len(each)}", f"{sum(said.values())}", text]

    return table(["noise", "campaigns", "false alarms", "said"], rows())


def _codes(one: Clean | Outcome) -> str:
    return ", ".join(sorted({said.split(" ")[0] for said in one.said})) or "nothing"


if __name__ == "__main__":
    main()

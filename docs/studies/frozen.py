"""Freeze what the program makes of thirty campaigns, or compare the program with what was frozen.

Run with `python docs/studies/frozen.py --write` before a change of structure and `python docs/studies/frozen.py` after it; the
exit status is 1 where anything differs of which no other result is wanted (`WANTED` in frozen_campaigns.py says of which, and
why). `--only TEXT` takes the campaigns whose name holds the text.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import json
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from frozen_campaigns import FROZEN, WANTED, FrozenCampaign

import sprung

FILE = Path(__file__).with_name("frozen.json")

RELATIVE, STANDARD_ERRORS = 1e-6, 0.02
"""Largest difference of a value or a standard error: as a part of it where the fit is linear, else in standard errors."""


@dataclass(frozen=True)
class Frozen:
    """What was made of one campaign.

    Attributes
    ----------
    verdict
        State of the verdict.
    model
        Terms beside the springs and dampers, and whether tracks are shared.
    faults
        Code and place of each, sorted.
    parameters
        Value and standard error by name, SI; None where nothing is stated.
    """

    verdict: str
    model: list[str]
    faults: list[str]
    parameters: dict[str, list[float | None]]


def freeze(result: sprung.Result) -> Frozen:
    """Return what is compared of a result."""
    return Frozen(
        verdict=result.verdict.state,
        model=[*result.fit.model, result.fit.tracks],
        faults=sorted(f"{fault.code}: {fault.where}" for fault in result.faults),
        parameters={name: [one.value, one.std] for name, one in result.parameters.items()},
    )


def identify(number: int) -> tuple[str, Frozen, float]:
    """Identify one of the campaigns; its name, what was made of it, and the processor time it took, s."""
    campaign, begun = FROZEN[number], time.process_time()
    return campaign.name, freeze(campaign.identify()), time.process_time() - begun


def differences(campaign: FrozenCampaign, then: Frozen, now: Frozen) -> Iterator[str]:
    """Return every quantity in which two programs differ by more than the tolerance."""
    for what in ("verdict", "model", "faults"):
        before, after = getattr(then, what), getattr(now, what)
        if before != after:
            yield f"{what}: {before} was frozen, now {after}"
    for name in sorted(then.parameters.keys() | now.parameters.keys()):
        old, new = then.parameters.get(name), now.parameters.get(name)
        if old is None or new is None or (old[0] is None) != (new[0] is None):
            yield f"{name}: {old} was frozen, now {new}"
        elif (distance := distance_of(campaign, old, new)) > 1:
            was, now_ = (f"{value:.9g} ± {std:.4g}" for value, std in (old, new))
            yield f"{name}: {was} was frozen, now {now_}; {distance:.2g} times too far"


def distance_of(campaign: FrozenCampaign, old: Sequence[float | None], new: Sequence[float | None]) -> float:
    """Return how far a value and its standard error have moved, over what they may; 0 where nothing is stated."""
    if old[0] is None or old[1] is None or new[0] is None or new[1] is None:
        return 0.0
    linear = campaign.agreement == "linear" or old[1] == 0
    allowed = [RELATIVE * abs(one) if linear else STANDARD_ERRORS * old[1] for one in (old[0], old[1])]
    moved = [abs(after - before) for before, after in ((old[0], new[0]), (old[1], new[1]))]
    return max(0.0 if by <= limit else by / max(limit, 1e-300) for by, limit in zip(moved, allowed, strict=True))


def largest_shift(then: Frozen, now: Frozen) -> float:
    """Return the largest difference of a value, in standard errors; 0 where none is stated."""
    shifts = [0.0]
    for name in then.parameters.keys() & now.parameters.keys():
        (before, std), (after, _) = then.parameters[name], now.parameters[name]
        if before is not None and after is not None and std:
            shifts.append(abs(after - before) / std)
    return max(shifts)


def chosen(text: str) -> list[int]:
    """Return the numbers of the campaigns whose name holds a text."""
    return [i for i, one in enumerate(FROZEN) if text in one.name]


def main() -> int:
    """Freeze or compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="freeze what the program does now")
    parser.add_argument("--only", default="", metavar="TEXT", help="campaigns whose name holds this text")
    parser.add_argument("--processes", type=int, default=1)
    options = parser.parse_args()
    stored: dict[str, Mapping[str, Any]] = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    found, found_differences = dict(stored), dict[str, list[str]]()
    largest = 0.0
    with ProcessPoolExecutor(options.processes) as pool:
        for name, now, seconds in pool.map(identify, chosen(options.only)):
            campaign = next(one for one in FROZEN if one.name == name)
            sys.stdout.write(
                f"{name}: {now.verdict}, {', '.join(now.model)}, {len(now.faults)} faults, {seconds:.1f} s\n"
            )
            if options.write or name not in stored:
                found[name] = asdict(now)
                continue
            then = Frozen(**stored[name])
            found_differences[name] = list(differences(campaign, then, now))
            sys.stdout.writelines(f"    {line}\n" for line in found_differences[name])
            if name not in WANTED:
                largest = max(largest, largest_shift(then, now))
            sys.stdout.flush()
    if options.write:
        FILE.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    unwanted = sum(len(lines) for name, lines in found_differences.items() if name not in WANTED)
    for name in (name for name, lines in found_differences.items() if lines and name in WANTED):
        sys.stdout.write(f"wanted, {name}: {WANTED[name]}\n")
    others = sum(name not in WANTED for name in found_differences)
    sys.stdout.write(
        f"{len(found_differences)} campaigns; {unwanted} differences in the {others} of which none is wanted; their values "
        f"differ by {largest:.2g} of a standard error at the most\n"
    )
    return 1 if unwanted else 0


if __name__ == "__main__":
    sys.exit(main())

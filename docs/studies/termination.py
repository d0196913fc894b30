"""What does SIGTERM at a random moment leave? Whole files or none, and the user's own files byte for byte as they were.

Run with `python docs/studies/termination.py --moments 20`, or for some commands with `--commands identify new`. Each command is
run once undisturbed, to know how long it takes, and then in fresh folders with the signal sent at moments drawn uniformly
over that time; every other time an earlier result or campaign of sprung's lies there already. Prints for every command how the
runs ended and what they left, and every breach; exit status 1 if there is any.
"""

from __future__ import annotations

import argparse
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random

from car import CAR

import sprung
from sprung.errors import InputError
from sprung.files.ownership import MANIFEST

MINE = {"notes.txt": b"written by the user\n", "results/report.pdf": b"printed by the user\n"}
"""Files of the user's, in the folder that a command writes into and in the one for results."""

ORDERLY = {0, 3, 128 + signal.SIGTERM, -signal.SIGTERM}
"""Finished, or terminated: by sprung's own handler, or before Python had come as far as that."""


@dataclass(frozen=True)
class Command:
    """A command that writes.

    Attributes
    ----------
    arguments
        Of `sprung`, run in the folder.
    prepare
        Puts into an empty folder what the command reads.
    wholes
        Groups of files that are there together or not at all, from the folder's names after an undisturbed run.
    """

    arguments: tuple[str, ...]
    prepare: Callable[[Path], None]
    wholes: Callable[[set[str]], list[set[str]]]


def _campaign(folder: Path) -> None:
    (folder / "car.toml").write_text(CAR)
    sprung.write(sprung.simulate(folder / "car.toml", seed=1), folder / "campaign")


def _vehicle(folder: Path) -> None:
    (folder / "car.toml").write_text(CAR)


def _recordings(folder: Path) -> None:
    _campaign(folder)
    for path in (folder / "campaign").glob("*.csv"):
        shutil.move(path, folder / path.name)
    shutil.rmtree(folder / "campaign")


def _nothing(folder: Path) -> None:
    """Need nothing."""


def _results(names: set[str]) -> list[set[str]]:
    return [{name for name in names if name.endswith(("results.json", "series.npz"))}]


def _written(names: set[str]) -> list[set[str]]:
    return [{name for name in names if name.endswith((".csv", "campaign.toml", ".schema.json"))}, *_results(names)]


COMMANDS = {
    "identify": Command(("identify", "campaign", "-o", "results"), _campaign, _results),
    "demo": Command(("demo", "."), _nothing, _written),
    "simulate": Command(("simulate", "car.toml", "-o", "."), _vehicle, _written),
    "new": Command(("new", "."), _recordings, lambda _: [{"campaign.toml", "campaign.schema.json"}]),
}


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below a folder, by its name."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def run(command: Command, folder: Path, after: float | None = None) -> tuple[int, str, float]:
    """Run a command, send SIGTERM after some seconds, and return its status, what it said on errors, and how long it took."""
    began = time.monotonic()
    with subprocess.Popen(  # noqa: S603 (our own command)
        [sys.executable, "-m", "sprung", *command.arguments],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    ) as running:
        try:
            _, said = running.communicate(timeout=after)
        except subprocess.TimeoutExpired:
            running.send_signal(signal.SIGTERM)
            _, said = running.communicate()
    return running.returncode, said, time.monotonic() - began


def breaches(command: Command, before: dict[str, bytes], folder: Path, whole: set[str], said: str) -> Iterator[str]:
    """Return the faults of a terminated run."""
    after = contents(folder)
    own = (MANIFEST, "report.html", *set().union(*command.wholes(whole)))
    yield from (
        f"{name} is not as it was" for name in before if not name.endswith(own) and after.get(name) != before[name]
    )
    for group in command.wholes(whole):
        there = group & after.keys()
        if there not in (set(), group):
            yield f"only {', '.join(sorted(there))} of {', '.join(sorted(group))}"
    left = [name for name in after if Path(name).name.startswith(".") and Path(name).name != MANIFEST]
    if left:
        yield f"hidden files are left: {', '.join(left)}"
    if "Traceback" in said:
        yield f"a traceback: {said}"
    yield from _unreadable(command, folder, after)


def _unreadable(command: Command, folder: Path, after: dict[str, bytes]) -> Iterator[str]:
    """Return the files that exist and cannot be read."""
    try:
        if "results/results.json" in after:
            sprung.load(folder / "results")
        if "campaign.toml" in after and command.arguments[0] != "new":
            sprung.read(folder)
    except InputError as error:
        yield f"what is there cannot be read: {error}"


def main() -> int:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("--moments", type=int, default=20, help="of each command")
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=list(COMMANDS))
    parser.add_argument("--seed", type=int, default=1, help="of the moments")
    given = parser.parse_args()
    failed = False
    for name in given.commands:
        command, chance, ends, found = COMMANDS[name], Random(given.seed), Counter[str](), list[str]()  # noqa: S311
        with tempfile.TemporaryDirectory() as place:
            fresh, done = Path(place) / "fresh", Path(place) / "done"
            fresh.mkdir()
            command.prepare(fresh)
            for file, content in MINE.items():
                (fresh / file).parent.mkdir(exist_ok=True)
                (fresh / file).write_bytes(content)
            shutil.copytree(fresh, done)
            status, said, seconds = run(command, done)
            if status not in {0, 3}:
                raise SystemExit(f"{name}, undisturbed: {said}")
            whole = set(contents(done)) - set(contents(fresh))
            for moment in range(given.moments):
                again = moment % 2 == 1 and name != "new"  # which never writes twice
                folder = Path(place) / str(moment)
                shutil.copytree(done if again else fresh, folder)
                before = contents(folder)
                after = chance.uniform(0.0, seconds)
                status, said, _ = run(command, folder, after)
                bad = list(breaches(command, before, folder, whole, said))
                if status not in ORDERLY:
                    bad.append(f"exit status {status}: {said}")
                found += [f"{after:.2f} s of {seconds:.2f} s: {one}" for one in bad]
                new = {file for file, content in contents(folder).items() if before.get(file) != content}
                group = max(command.wholes(whole), key=len)
                ends[f"status {status}, {'written' if new & group else 'nothing written'}"] += 1
                shutil.rmtree(folder)
        print(f"{name}: {given.moments} moments in {seconds:.1f} s, {len(found)} breaches")  # noqa: T201
        for end, count in sorted(ends.items()):
            print(f"  {count:3d}  {end}")  # noqa: T201
        for one in found:
            print(f"  !!   {one}")  # noqa: T201
        failed = failed or bool(found)
    return int(failed)


if __name__ == "__main__":
    raise SystemExit(main())

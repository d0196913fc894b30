"""Does any file at all bring a reader to more than a result or a refusal? Spoils sound files, guided by what is reached.

Run with `python docs/studies/fuzz.py --minutes 10`, or for some readers with `--readers csv mat5`. A spoilt file that
takes a reader along lines that no other had reached in that order is kept, and spoilt again. Every reader is tried in a
process of its own: one that dies or does not come back is a finding like any other. Prints for every reader how many
files it was given, how many of them were kept, and what failed; those that failed stay in the folder that it names.
"""

from __future__ import annotations

import argparse
import hashlib
import resource
import selectors
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from random import Random
from types import CodeType, FrameType
from typing import Any, TypeAlias

from damage import spoilt
from readers import LONGEST, READERS, Broken, Reader, sound_files, tried

import sprung
from sprung.formats.reading_errors import memory_limit

Arc: TypeAlias = tuple[CodeType, int, int]

MEMORY = 4 << 30
"""Bytes that the process of a reader may address."""


class Followed:
    """The lines that follow one another in the code of some packages.

    Parameters
    ----------
    packages
        Their names.
    """

    def __init__(self, *packages: str) -> None:
        found = (find_spec(name) for name in packages)
        self._folders = tuple(str(folder) for spec in found if spec for folder in spec.submodule_search_locations or ())
        self._known: set[Arc] = set()
        self._now: set[Arc] = set()

    def __enter__(self) -> None:
        self._now = set()
        sys.settrace(self._frame)

    def __exit__(self, *_: object) -> None:
        sys.settrace(None)

    def new(self) -> bool:
        """Whether the last run executed new lines, which are then recorded."""
        before = len(self._known)
        self._known |= self._now
        return len(self._known) > before

    def _frame(self, frame: FrameType, _: str, __: Any) -> Any:
        code, last = frame.f_code, frame.f_lineno
        if not code.co_filename.startswith(self._folders):
            return None
        reached = self._now

        def line(frame: FrameType, event: str, _: Any) -> Any:
            nonlocal last
            if event == "line":
                reached.add((code, last, frame.f_lineno))
                last = frame.f_lineno
            return line

        return line


def fuzz(reader: Reader, folder: Path, seconds: float, seed: int) -> None:
    """Try a reader in this process, and say on standard output how it goes, line by line.

    Parameters
    ----------
    reader
        What is tried.
    folder
        Holds the files that are kept, and the one that is being read.
    seconds
        How long.
    seed
        Of the damage.
    """
    random = Random(seed)  # noqa: S311 (nothing is kept secret)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    files = sound_files(reader)
    end = time.monotonic() + seconds
    following = Followed("sprung", *reader.needs)
    place = folder / "place"
    place.mkdir(exist_ok=True)
    ahead = [*files, *(path.read_bytes() for path in sorted(folder.glob("*.kept")))]
    for number in range(sys.maxsize):
        if time.monotonic() > end:
            return
        known = number < len(ahead)
        data = ahead[number] if known else spoilt([random.choice(files), random.choice(files[-30:])], random)
        (folder / "current").write_bytes(data)
        peak = _resident()
        try:
            with following:
                read = tried(reader, place, data)
            grown = _resident() - peak
            if number > len(ahead) and grown > memory_limit(len(data)):
                raise Broken(f"{grown / 1e6:.0f} MB outside of Python for a file of {len(data)} bytes")
        except Broken as broken:
            _say("broken", _keep(folder, data, "broken"), f"{_where(broken)}: {broken}")
        else:
            _say("read" if read else "refused")
        if following.new() and not known:
            _say("kept", _keep(folder, data, "kept"))
            files.append(data)
        elif known and number >= len(files):
            files.append(data)


def _resident() -> int:
    """Return the peak memory of this process, bytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def _keep(folder: Path, data: bytes, why: str) -> str:
    path = folder / f"{hashlib.sha256(data).hexdigest()[:12]}.{why}"
    path.write_bytes(data)
    return path.name


def _where(broken: Broken) -> str:
    """Return the last line of this package, and the last line at all, in the traceback of an error."""
    if broken.__cause__ is None:
        return ""
    frames = traceback.extract_tb(broken.__cause__.__traceback__)
    own = [frame for frame in frames if "sprung" in Path(frame.filename).parts] or frames
    return " <- ".join(dict.fromkeys(f"{Path(frame.filename).name}:{frame.lineno}" for frame in (own[-1], frames[-1])))


def _say(*words: str) -> None:
    sys.stdout.write("\t".join(" ".join(word.split()) for word in words) + "\n")
    sys.stdout.flush()


@dataclass
class ReaderOutcomes:
    """What came of one reader: how often what was said, and the first file of every failure by its reason."""

    counts: dict[str, int] = field(default_factory=lambda: dict.fromkeys(("read", "refused", "kept", "broken"), 0))
    failures: dict[str, list[str]] = field(default_factory=dict)

    def add(self, words: list[str]) -> None:
        """Take up a line that the process of a reader said."""
        self.counts[words[0]] += 1
        if words[0] == "broken":
            self.failures.setdefault(words[2][:120], []).append(words[1])


def watch(name: str, folder: Path, seconds: float, seed: int) -> ReaderOutcomes:
    """Try a reader in processes of their own, one after another where they die."""
    folder.mkdir(parents=True)
    tally, end = ReaderOutcomes(), time.monotonic() + seconds
    for again in range(sys.maxsize):
        left = end - time.monotonic()
        if left < 1 and again:
            return tally
        given = ("--reader", name, "--seconds", f"{left}", "--folder", str(folder), "--seed", f"{seed + again}")
        with subprocess.Popen([sys.executable, __file__, *given], stdout=subprocess.PIPE) as process:  # noqa: S603
            for line in _lines(process, 4 * LONGEST):
                tally.add(line)
            status = process.wait()
        if status > 0:
            raise RuntimeError(f"the process of {name} failed by itself")
        if status < 0:
            why = "did not come back" if status == -signal.SIGKILL else f"ended by {signal.Signals(-status).name}"
            tally.add(["broken", _keep(folder, (folder / "current").read_bytes(), "broken"), why])
    return tally


def _lines(process: subprocess.Popen[bytes], longest: float) -> Iterator[list[str]]:
    """Yield the lines that a process prints; it is terminated after a long silence."""
    assert process.stdout is not None  # noqa: S101 (it has a pipe; for the type checker)
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        held = b""
        while True:
            if not selector.select(longest):
                process.kill()
                return
            data = process.stdout.read1()  # type: ignore[attr-defined]
            if not data:
                return
            *lines, held = (held + data).split(b"\n")
            for line in lines:
                yield line.decode().split("\t")


def main() -> int:
    """Take the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--readers", nargs="+", choices=READERS, default=list(READERS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder", type=Path, help="where files are kept; a temporary folder if not given")
    parser.add_argument("--reader", help=argparse.SUPPRESS)
    parser.add_argument("--seconds", type=float, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.reader:
        fuzz(READERS[given.reader], given.folder, given.seconds, given.seed)
        return 0
    folder = given.folder or Path(tempfile.mkdtemp(prefix="sprung-fuzz-"))
    names = [name for name in given.readers if not READERS[name].missing]
    failed = False
    sys.stdout.write(f"sprung {sprung.__version__}\n{'':10}{'files':>9}{'read':>9}{'kept':>7}{'failed':>8}\n")
    for name in names:
        tally = watch(name, folder / name, 60 * given.minutes / len(names), given.seed)
        counts = tally.counts
        files = counts["read"] + counts["refused"] + counts["broken"]
        sys.stdout.write(f"{name:10}{files:9}{counts['read']:9}{counts['kept']:7}{counts['broken']:8}\n")
        for why, which in tally.failures.items():
            sys.stdout.write(f"    {len(which):5} times {why}\n        {folder / name / which[0]}\n")
        sys.stdout.flush()
        failed |= bool(tally.failures)
    sys.stdout.write(f"In {folder}\n")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())

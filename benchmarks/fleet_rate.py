"""Do two workers identify a fleet twice as fast as one? Writes fleet-rate.md beside this file.

Run with `python benchmarks/fleet_rate.py` on a machine that does nothing else: these are seconds, no ratios of two programs.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import sprung
from sprung.batch import read_rows
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Vehicle

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[0] / "tests"))

from served import memory_of  # noqa: E402 (the path above)

PART = 5
"""One worker identifies every fifth campaign."""

SETTLED = 0.1
"""Part of the campaigns after which the rate is measured: before, workers are starting."""

WANTED = 0.9
"""Least rate of two workers over twice that of one, by the issue."""

SPREAD = 0.03
"""Standard deviation of masses, inertias and rates between vehicles, relative."""

DROPS = [
    {"wheels": wheels}
    for wheels in (
        ("fl", "fr", "rl", "rr"),
        ("fl", "fr"),
        ("rl", "rr"),
        ("fl", "rl"),
        ("fr", "rr"),
        ("fl", "rr"),
    )
]

RATE, DURATION, REST, WEIGHED = 250.0, 1.2, 0.2, 3.0
"""Hz, s after and before the release, and standard uncertainty of the mass, kg."""

_PAGE = """\
# Rate of a fleet

`python benchmarks/fleet_rate.py --campaigns {campaigns}` simulates {campaigns} campaigns of linear vehicles of one type:
{drops} drops, eight accelerometers, {duration:g} s at {rate:g} Hz. `sprung fleet` identifies {part} of them with one worker,
and all of them with two, on {processors} processors. The rate is that after the first {settled:.0f} % of the campaigns, when
all workers run; the whole time is that of the command with its start, and with the comparison of the vehicles and their page
at the end.

| workers | campaigns | rate, 1/s | identification, s | whole, s | driver, MB | comparison and page, MB | a worker, MB |
|---|---:|---:|---:|---:|---:|---:|---:|
{rows}

The rate of two workers is {ratio:.3f} of twice that of one; {wanted:g} are required: {met}. There are {count} rows of
{distinct} campaigns: {statuses}.
"""


@dataclass(frozen=True)
class Timed:
    """A run of the command.

    Attributes
    ----------
    workers, campaigns
        How many.
    rate
        Campaigns per second, once all workers run.
    identification, whole
        Time until the last campaign was identified, and until the command ended, s.
    driver, comparison, worker
        Most memory in use of the command until the last campaign was identified, and until its end, and of one of its
        workers, MB.
    """

    workers: int
    campaigns: int
    rate: float
    identification: float
    whole: float
    driver: float
    comparison: float
    worker: float


def write_campaigns(folder: Path, count: int) -> list[Path]:
    """Simulate the campaigns that are not in a folder yet, and return all of them."""
    return [_written(folder, number) for number in range(1, count + 1)]


def _written(folder: Path, number: int) -> Path:
    own = folder / f"{number:05d}"
    if (own / "campaign.toml").exists():
        return own / "campaign.toml"
    random = np.random.default_rng(number)
    lengths = ("a", "b", "t_f", "t_r")
    vehicle = Vehicle(
        {
            name: value * (1 if name in lengths else float(np.exp(SPREAD * random.standard_normal())))
            for name, value in TABLE_1_CAR.parameters.items()
        },
        name=TABLE_1_CAR.name,
    )
    campaign = sprung.simulate(
        vehicle,
        drops=DROPS,
        rate=RATE,
        duration=DURATION,
        rest=REST,
        seed=number,
        known={"total_mass": KnownValue(vehicle.total_mass + WEIGHED * random.standard_normal(), WEIGHED)},
    )
    return sprung.write(replace(campaign, identification=f"{number:05d}"), own)


def timed(campaigns: Sequence[Path], output: Path, workers: int) -> Timed:
    """Run the command on campaigns with so many workers, in an output folder that is new."""
    output.mkdir(parents=True)
    listed = output.with_suffix(".txt")
    listed.write_text("".join(f"{path}\n" for path in campaigns), encoding="utf-8")
    command = [sys.executable, "-m", "sprung", "fleet", str(listed), "-o", str(output), "--workers", str(workers)]
    begun = time.perf_counter()
    with (
        subprocess.Popen(  # noqa: S603 (our own command)
            [*command, "--json"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        ) as process,
        _Memory(process.pid) as memory,
    ):
        assert process.stderr is not None
        finished, driver = [(0.0, 0)], 0.0
        for line in process.stderr:
            counts = json.loads(line)
            finished.append((time.perf_counter() - begun, counts["done"] + counts["failed"]))
            driver = memory.most_driver
    whole = time.perf_counter() - begun
    if process.returncode or finished[-1][1] != len(campaigns):
        raise SystemExit(
            f"{' '.join(command)} ended with status {process.returncode} after {finished[-1][1]} campaigns"
        )
    return Timed(
        workers,
        len(campaigns),
        settled_rate(finished),
        finished[-1][0],
        whole,
        driver,
        memory.most_driver,
        memory.most_worker,
    )


def settled_rate(finished: Sequence[tuple[float, int]]) -> float:
    """Return the rate at which campaigns are finished once all workers run, 1/s.

    Parameters
    ----------
    finished
        Time, s, and how many were finished, one after the other; the last one has all of them.
    """
    end, total = finished[-1]
    start, before = next(one for one in finished if one[1] >= SETTLED * total)
    return (total - before) / (end - start)


class _Memory:
    """Watches the memory of a process and of the processes that it has started."""

    def __init__(self, process: int) -> None:
        self._process, self._ended = process, threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self.most_driver = self.most_worker = 0.0

    def __enter__(self) -> _Memory:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def _watch(self) -> None:
        while not self._ended.wait(0.25):
            self.most_driver = max(self.most_driver, _memory(self._process))
            self.most_worker = max(self.most_worker, *(_memory(one) for one in _children(self._process)), 0.0)


def _memory(process: int) -> float:
    try:
        return memory_of(process)
    except OSError:
        return 0.0


def _children(process: int) -> Iterator[int]:
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(path.read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
        if parent == process:
            yield int(path.parent.name)


def page(one: Timed, two: Timed, rows: Sequence[Mapping[str, object]]) -> str:
    """Write the page."""
    ratio = two.rate / (2 * one.rate)
    statuses = Counter(str(row["status"]) for row in rows)
    return _PAGE.format(
        campaigns=two.campaigns,
        part=one.campaigns,
        drops=len(DROPS),
        duration=DURATION,
        rate=RATE,
        processors=len(os.sched_getaffinity(0)),
        settled=100 * SETTLED,
        rows="\n".join(
            f"| {run.workers} | {run.campaigns} | {run.rate:.2f} | {run.identification:.0f} | {run.whole:.0f} "
            f"| {run.driver:.0f} | {run.comparison:.0f} | {run.worker:.0f} |"
            for run in (one, two)
        ),
        ratio=ratio,
        wanted=WANTED,
        met="met" if ratio >= WANTED else "not met",
        count=len(rows),
        distinct=len({row["campaign"] for row in rows}),
        statuses=", ".join(f"{count} {status}" for status, count in sorted(statuses.items())),
    )


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description="Rate of sprung fleet with one worker and with two.")
    parser.add_argument("--campaigns", type=int, default=2000, help="how many (default %(default)s)")
    parser.add_argument("--keep", type=Path, help="folder in which the campaigns are kept for the next run")
    parser.add_argument("--to", type=Path, default=HERE, help="folder of the page")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        campaigns = write_campaigns(options.keep or Path(temporary) / "campaigns", options.campaigns)
        sys.stderr.write(f"{len(campaigns)} campaigns simulated\n")
        one = timed(campaigns[::PART], Path(temporary) / "one", 1)
        sys.stderr.write(f"{one}\n")
        two = timed(campaigns, Path(temporary) / "two", 2)
        sys.stderr.write(f"{two}\n")
        text = page(one, two, list(read_rows(Path(temporary) / "two", ("campaign", "status"))))
    (options.to / "fleet-rate.md").write_text(text, encoding="utf-8")
    sys.stdout.write(text)


if __name__ == "__main__":
    main()

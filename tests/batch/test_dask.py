"""An existing Dask cluster: started with its own command line, one of its workers killed, its scheduler silent or gone."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

import batch_work
from sprung.batch import BatchStep, DaskWorkers, Task, content_key, folder_lock, read_rows, run_batch
from sprung.errors import InputError
from sprung.progress import Step

pytest.importorskip("distributed")
pytestmark = [
    # The libraries of the cluster leave sockets to the garbage collector, and use what Python deprecates.
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


def test_a_silent_scheduler(tmp_path: Path) -> None:
    address = f"tcp://127.0.0.1:{free_port()}"
    with pytest.raises(InputError, match=f"{address}: found no answer within 0.5 s") as raised:
        DaskWorkers(batch_work.square, address, timeout=0.5)
    assert "Check the address and that `dask scheduler` runs there" in str(raised.value)
    assert list(tmp_path.iterdir()) == []


Cluster = tuple[str, list["subprocess.Popen[bytes]"]]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[[int], Cluster]]:
    """Start a scheduler and so many workers from the command line of Dask; the scheduler is the first process."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "OMP_NUM_THREADS": "1"}
    with ExitStack() as stack:

        def run(*arguments: str) -> subprocess.Popen[bytes]:
            log = stack.enter_context((tmp_path / f"{arguments[0]}.log").open("ab"))
            command = [sys.executable, "-m", "distributed.cli.dask_" + arguments[0], *arguments[1:]]
            process = subprocess.Popen(command, stdout=log, stderr=log, env=environment, cwd=tmp_path)  # noqa: S603 (our own)
            stack.callback(process.wait)
            stack.callback(process.kill)
            return process

        def cluster(workers: int) -> Cluster:
            port = free_port()
            address = f"tcp://127.0.0.1:{port}"
            processes = [run("scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")]
            processes += [
                run("worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard") for _ in range(workers)
            ]
            return address, processes

        yield cluster


def squares(folder: Path, address: str, count: int, progress: Callable[[Step], None]) -> dict[int, float]:
    given = (Task(str(i), content_key([str(i)]), (i, 0.02)) for i in range(count))
    with folder_lock(folder):
        executor = DaskWorkers(batch_work.slow_square, address, timeout=60)
        run_batch(given, executor, folder, batch_work.COLUMNS, "squares", total=count, progress=progress)
    found = list(read_rows(folder, ("campaign", "status", "square")))
    assert {row["status"] for row in found} == {"done"}
    assert len({row["campaign"] for row in found}) == len(found)
    return {int(row["campaign"]): row["square"] for row in found}


@pytest.mark.long
def test_four_workers_one_of_them_killed(tmp_path: Path, start: Callable[[int], Cluster]) -> None:
    address, processes = start(4)
    killed: list[int] = []

    def kill(step: Step) -> None:
        if isinstance(step, BatchStep) and step.counts.done > 100 and not killed:
            killed.append(step.counts.done)
            processes[2].send_signal(signal.SIGKILL)

    assert squares(tmp_path / "out", address, 600, kill) == {i: i**2 for i in range(600)}
    assert killed
    assert processes[2].wait() == -signal.SIGKILL


@pytest.mark.long
def test_a_scheduler_that_ends_loses_nothing(tmp_path: Path, start: Callable[[int], Cluster]) -> None:
    address, processes = start(2)

    def kill(step: Step) -> None:
        if isinstance(step, BatchStep) and step.counts.done > 20 and processes[0].poll() is None:
            processes[0].send_signal(signal.SIGKILL)

    began = time.monotonic()
    with pytest.raises(InputError, match="a scheduler that does not answer any more"):
        squares(tmp_path / "out", address, 2000, kill)
    assert time.monotonic() - began < 120
    kept = sum(1 for _ in read_rows(tmp_path / "out", ("campaign",)))
    assert 20 < kept < 2000
    address, _ = start(2)
    assert squares(tmp_path / "out", address, 400, lambda _: None).keys() >= set(range(400))


@pytest.mark.long
def test_a_cluster_without_workers(start: Callable[[int], Cluster]) -> None:
    address, _ = start(0)
    time.sleep(5)
    with pytest.raises(InputError, match="found a scheduler without workers; expected one worker or more"):
        DaskWorkers(batch_work.square, address, timeout=8)

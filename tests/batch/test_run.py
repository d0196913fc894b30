"""A batch: every task has one row, whatever its work does; what is done is not done again; nothing is lost."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import batch_work
from sprung.batch import (
    BatchStep,
    BatchSummary,
    LocalWorkers,
    Task,
    Work,
    choose_executor,
    content_key,
    folder_lock,
    read_rows,
    run_batch,
)
from sprung.errors import InputError
from sprung.progress import Step

Row = dict[str, Any]


def same(number: int) -> Any:
    return number


def tasks(count: int, argument: Callable[[int], Any] = same, edition: str = "") -> Iterator[Task]:
    for i in range(count):
        yield Task(str(i), content_key([edition, str(i)]), argument(i))


def do(folder: Path, work: Work, given: Iterator[Task], count: int, workers: int = 2, **options: Any) -> BatchSummary:
    with folder_lock(folder):
        executor = LocalWorkers(work, workers)
        return run_batch(given, executor, folder, batch_work.COLUMNS, "squares", total=count, **options)


def rows(folder: Path) -> dict[int, Row]:
    found = list(read_rows(folder, ("campaign", "key", "status", "message", "square", "process")))
    numbers = [int(row["campaign"]) for row in found]
    assert len(set(numbers)) == len(numbers), "a row is there twice"
    return dict(zip(numbers, found, strict=True))


def test_every_task_has_its_row(tmp_path: Path) -> None:
    steps: list[Step] = []
    summary = do(tmp_path, batch_work.square, tasks(700), 700, progress=steps.append)
    assert (summary.counts.done, summary.counts.failed, summary.counts.left, summary.computed) == (700, 0, 0, 700)
    assert {number: row["square"] for number, row in rows(tmp_path).items()} == {i: i**2 for i in range(700)}
    assert len({row["process"] for row in rows(tmp_path).values()} - {os.getpid()}) == 2
    assert isinstance(steps[-1], BatchStep)
    assert steps[-1].counts == summary.counts
    assert "700 done, 0 failed, 0 left" in steps[-1]
    assert len(list(tmp_path.glob("*.parquet"))) == 2  # 500 rows in the first file


def test_what_is_done_is_not_done_again_and_what_changed_is(tmp_path: Path) -> None:
    do(tmp_path, batch_work.square, tasks(600), 600)
    again = do(tmp_path, batch_work.square, tasks(600), 600)
    assert (again.computed, again.counts.done) == (0, 600)
    # Ten campaigns have another content, one is new, and ten are not given any more.
    changed = [
        Task(task.campaign, "other", task.argument + 1000) for task in tasks(600) if 495 <= int(task.campaign) < 505
    ]
    kept = [task for task in tasks(601) if not 485 <= int(task.campaign) < 505]
    third = do(tmp_path, batch_work.square, iter([*changed, *kept]), 591)
    assert third.computed == 11
    assert sorted(map(int, third.gone)) == list(range(485, 495))
    squares = {number: row["square"] for number, row in rows(tmp_path).items()}
    assert squares == {i: (i + 1000 * (495 <= i < 505)) ** 2 for i in range(601)}


def test_a_campaign_that_is_named_twice_is_done_once(tmp_path: Path) -> None:
    assert do(tmp_path, batch_work.square, iter([*tasks(3), *tasks(3)]), 3).computed == 3
    assert len(rows(tmp_path)) == 3


def test_failures_are_rows_with_their_message(tmp_path: Path) -> None:
    summary = do(tmp_path, batch_work.refuse_odd, tasks(20), 20)
    assert (summary.counts.done, summary.counts.failed) == (10, 10)
    assert rows(tmp_path)[3]["status"] == "input"
    assert rows(tmp_path)[3]["message"] == "x: found odd; expected even. Add one."
    assert do(tmp_path, batch_work.refuse_odd, tasks(20), 20).computed == 0
    assert do(tmp_path, batch_work.refuse_odd, tasks(20), 20, retry=True).computed == 10


def test_a_defect_is_a_row_that_names_the_error(tmp_path: Path) -> None:
    do(tmp_path, batch_work.divide, tasks(3), 3)
    assert rows(tmp_path)[0]["status"] == "defect"
    assert rows(tmp_path)[0]["message"].startswith("ZeroDivisionError: division by zero (divide, line ")
    assert rows(tmp_path)[2]["square"] == 0.5


def test_a_task_that_kills_its_worker_twice_is_a_failure_and_is_tried_by_the_next_run(tmp_path: Path) -> None:
    summary = do(tmp_path, batch_work.die_on_13, tasks(40), 40)
    assert (summary.counts.done, summary.counts.failed) == (39, 1)
    assert rows(tmp_path)[13]["status"] == "worker"
    assert rows(tmp_path)[13]["message"] == "ended its worker process 2 times (signal 9, SIGKILL)."
    assert do(tmp_path, batch_work.square, tasks(40), 40).computed == 1
    assert rows(tmp_path)[13]["square"] == 169


def test_a_task_that_kills_its_worker_once_is_done_by_another(tmp_path: Path) -> None:
    mark = str(tmp_path / "died")
    summary = do(tmp_path / "out", batch_work.die_once, tasks(40, lambda i: (i, mark)), 40)
    assert Path(mark).exists()
    assert (summary.counts.done, summary.counts.failed) == (40, 0)


def test_what_work_prints_disturbs_nothing(tmp_path: Path) -> None:
    assert do(tmp_path, batch_work.printing, tasks(20), 20).counts.done == 20


def test_workers_that_cannot_start_end_the_batch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(RuntimeError, match="worker processes end when they start"):
        do(tmp_path, batch_work.square, tasks(5), 5)


def test_two_drivers_are_told_apart(tmp_path: Path) -> None:
    with (
        folder_lock(tmp_path),
        pytest.raises(InputError, match=f"another run that writes here .process {os.getpid()} "),
    ):
        do(tmp_path, batch_work.square, tasks(5), 5)
    do(tmp_path, batch_work.square, tasks(5), 5)


def test_the_lock_ends_with_its_process(tmp_path: Path) -> None:
    code = f"""
        import time
        from sprung.batch import folder_lock
        with folder_lock({str(tmp_path)!r}):
            print("locked", flush=True)
            time.sleep(60)
    """
    holder = subprocess.Popen([sys.executable, "-c", textwrap.dedent(code)], stdout=subprocess.PIPE)  # noqa: S603 (our own)
    try:
        assert holder.stdout is not None
        holder.stdout.readline()
        with pytest.raises(InputError, match=f"process {holder.pid} "):
            do(tmp_path, batch_work.square, tasks(5), 5)
    finally:
        holder.kill()
        holder.wait()
        if holder.stdout is not None:
            holder.stdout.close()
    assert do(tmp_path, batch_work.square, tasks(5), 5).counts.done == 5


def test_an_interrupted_batch_keeps_what_is_finished(tmp_path: Path) -> None:
    def interrupt(step: Step) -> None:
        if isinstance(step, BatchStep) and step.counts.done >= 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        do(tmp_path, batch_work.slow_square, tasks(1000, lambda i: (i, 0.02)), 1000, progress=interrupt)
    kept = len(rows(tmp_path))
    assert 3 <= kept < 1000
    assert do(tmp_path, batch_work.square, tasks(1000), 1000).computed == 1000 - kept


@pytest.mark.slow
def test_a_full_disk_is_said_and_loses_nothing(tmp_path: Path) -> None:
    """A process that may write no file much larger than the present one: the error of the system is a real one."""
    do(tmp_path, batch_work.square, tasks(30), 30)
    before = rows(tmp_path)
    most = (tmp_path / "rows-00001.parquet").stat().st_size + 500
    code = f"""
        import resource, sys
        import batch_work
        from sprung.batch import *
        from sprung.errors import InputError
        resource.setrlimit(resource.RLIMIT_FSIZE, ({most}, {most}))
        tasks = [Task(str(i), content_key(["", str(i)]), i) for i in range(480)]
        try:
            with folder_lock({str(tmp_path)!r}):
                workers = LocalWorkers(batch_work.square, 1)
                run_batch(tasks, workers, {str(tmp_path)!r}, batch_work.COLUMNS, "squares", total=480)
        except InputError as error:
            print(error)
    """
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(  # noqa: S603 (our own)
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, check=False, env=environment
    )
    assert (
        "found no space for more rows; expected a place to write to. Make room, and start the command again"
        in done.stdout
    )
    assert rows(tmp_path).items() >= before.items()
    assert [path.name for path in tmp_path.iterdir() if path.name.endswith(".new")] == []
    left = 480 - len(rows(tmp_path))
    assert left > 0
    assert do(tmp_path, batch_work.square, tasks(480), 480).computed == left


def test_other_files_and_other_content_are_refused(tmp_path: Path) -> None:
    do(tmp_path, batch_work.square, tasks(5), 5)
    with folder_lock(tmp_path), pytest.raises(InputError, match="found rows of squares; expected rows of cubes"):
        run_batch(tasks(5), LocalWorkers(batch_work.square, 1), tmp_path, batch_work.COLUMNS, "cubes", total=5)
    first = tmp_path / "rows-00001.parquet"
    (tmp_path / "rows-00002.parquet").write_bytes(first.read_bytes())
    with pytest.raises(InputError, match="a second row of "):
        do(tmp_path, batch_work.square, tasks(5), 5)
    (tmp_path / "rows-00002.parquet").write_bytes(first.read_bytes()[:-20])
    with pytest.raises(InputError, match="found no readable rows"):
        do(tmp_path, batch_work.square, tasks(5), 5)


def test_arguments_of_the_executor() -> None:
    with pytest.raises(InputError, match="one of the two"):
        choose_executor(batch_work.square, 2, "tcp://127.0.0.1:1")
    with pytest.raises(InputError, match="found 0; expected 1 or more"):
        choose_executor(batch_work.square, 0)


DRIVER = """
    import sys
    import batch_work
    from sprung.batch import *
    folder, count, seconds = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
    tasks = (Task(str(i), content_key(["", str(i)]), (i, seconds)) for i in range(count))
    with folder_lock(folder):
        executor = LocalWorkers(batch_work.slow_square, 2)
        print(*executor.process_ids, flush=True)
        run_batch(tasks, executor, folder, batch_work.COLUMNS, "squares", total=count)
"""


def drive(folder: Path, count: int, seconds: float, delay: float, victim: str) -> int:
    """Start a driver, kill it or one of its workers after a time, and return its exit status."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-c", textwrap.dedent(DRIVER), str(folder), str(count), str(seconds)]
    driver = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)  # noqa: S603 (our own)
    assert driver.stdout is not None
    workers = [int(number) for number in driver.stdout.readline().split()]
    killer = threading.Timer(delay, os.kill, (driver.pid if victim == "driver" else workers[0], signal.SIGKILL))
    killer.start()
    status = driver.wait(timeout=120)
    killer.cancel()
    driver.stdout.close()
    for number in workers if victim == "driver" else ():
        for _ in range(100):  # workers end with their driver
            if not Path(f"/proc/{number}").exists():
                break
            time.sleep(0.05)
        else:
            pytest.fail(f"worker {number} outlived its driver")
    return status


@pytest.mark.long
@pytest.mark.parametrize("victim", ["driver", "worker"])
def test_killed_at_ten_random_moments(tmp_path: Path, victim: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """SIGKILL of driver or worker and another start: the rows of an undisturbed run, none twice, none lost, no half file."""
    import random  # noqa: PLC0415

    count, seconds = 1500, 0.004
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    moments = random.Random(19)  # noqa: S311 (no secret)
    statuses = [drive(tmp_path, count, seconds, moments.uniform(0.05, 2.0), victim) for _ in range(10)]
    if victim == "driver":
        assert -signal.SIGKILL in statuses
    assert drive(tmp_path, count, seconds, 100.0, victim) == 0
    assert {number: row["square"] for number, row in rows(tmp_path).items()} == {i: i**2 for i in range(count)}
    assert all(row["status"] == "done" for row in rows(tmp_path).values())
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        ".sprung-lock",
        *(f"rows-{number:05d}.parquet" for number in (1, 2, 3)),
    ]

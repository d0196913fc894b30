"""A batch: tasks that are not done yet go to the workers, their rows into the folder."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from sprung.batch.counts import BatchCounts, Counter
from sprung.batch.executor import Executor
from sprung.batch.shards import ShardFolder
from sprung.batch.task import Columns, Failure, Row, Task
from sprung.display import shown
from sprung.progress import Progress, silent

DONE = "done"
"""Status of a row with a result; that of others is the reason of the failure."""

_ROWS, _SECONDS = 250, 15.0
"""Finished rows, and seconds since the last write, after which rows are written: what a killed driver has to do again."""

_POLL = 0.5
"""Longest time to wait for an outcome before progress is reported, s."""


@shown
@dataclass(frozen=True, slots=True)
class BatchSummary:
    """What came of a batch.

    Attributes
    ----------
    folder
        With the rows.
    counts
        Campaigns of this batch: done, failed, none left.
    computed
        Number of campaigns that this run did; the others were there.
    gone
        Campaigns with a row in the folder that are not among the tasks.
    """

    folder: Path
    counts: BatchCounts
    computed: int
    gone: tuple[str, ...]


def run_batch(
    tasks: Iterable[Task],
    executor: Executor,
    folder: str | os.PathLike[str],
    columns: Columns,
    content: str,
    *,
    total: int,
    retry: bool = False,
    progress: Progress = silent,
) -> BatchSummary:
    """Do the tasks whose rows are not in a folder yet, and write a row for each.

    Parameters
    ----------
    tasks
        One for each campaign; taken one after the other, when workers need them.
    executor
        Does the work; closed at the end.
    folder
        Locked by the caller (`folder_lock`).
    columns
        Of the rows that the work returns.
    content
        What the rows are of, in a few words; the folder may not contain other rows.
    total
        Number of tasks, for progress.
    retry
        Whether campaigns whose row is a failure are done again, also those that are unchanged. Those that lost their worker
        are in any case.
    progress
        Called with a `BatchStep`, at most a few times per second.

    Returns
    -------
    BatchSummary

    Raises
    ------
    InputError
        If rows cannot be written or the folder has other Parquet files, a campaign occurs twice, or a cluster is
        lost. Rows that were finished before are written.
    """
    with closing(executor):
        shards = ShardFolder(folder, columns, content)
        counter = Counter(total, progress)
        writer = _Writer(shards)
        seen: set[str] = set()
        under_way: set[str] = set()
        waiting = iter(tasks)
        more = True
        try:
            while more or under_way:
                while more and len(under_way) < executor.capacity:
                    task = next(waiting, None)
                    if task is None:
                        more = False
                    elif task.campaign not in seen:
                        seen.add(task.campaign)
                        entry = shards.index.get(task.campaign)
                        if entry is not None and entry.key == task.key and not _again(entry.status, retry):
                            counter.skip(entry.status != DONE)
                            continue
                        counter.start_clock()
                        executor.submit(task)
                        under_way.add(task.campaign)
                if under_way:
                    for task, outcome in executor.collect(_POLL):
                        under_way.remove(task.campaign)
                        writer.add(_row(task, outcome))
                        counter.add(isinstance(outcome, Failure))
                    writer.write_if_due()
                    counter.report()
        finally:
            # What is finished is written, whatever ended the batch.
            writer.write()
        counter.report(last=True)
    gone = tuple(campaign for campaign in shards.index if campaign not in seen)
    return BatchSummary(Path(folder), counter.counts, counter.computed, gone)


def _again(status: str, retry: bool) -> bool:
    return status == "worker" or (retry and status != DONE)


def _row(task: Task, outcome: Row | Failure) -> Row:
    own: Row = {"campaign": task.campaign, "key": task.key}
    if isinstance(outcome, Failure):
        return {**own, "status": outcome.reason, "message": outcome.message}
    return {**outcome, **own, "status": DONE}


class _Writer:
    """Collects rows and writes several at a time."""

    def __init__(self, shards: ShardFolder) -> None:
        self._shards = shards
        self._rows: list[Row] = []
        self._since = time.monotonic()

    def add(self, row: Row) -> None:
        if not self._rows:
            self._since = time.monotonic()
        self._rows.append(row)

    def write_if_due(self) -> None:
        if len(self._rows) >= _ROWS or (self._rows and time.monotonic() - self._since > _SECONDS):
            self.write()

    def write(self) -> None:
        rows: Sequence[Row] = self._rows
        if rows:
            self._shards.write(rows)
            self._rows = []

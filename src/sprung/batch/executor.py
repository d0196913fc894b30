"""Where the tasks of a batch are done: on this machine, or on an existing cluster."""

from __future__ import annotations

from typing import Protocol

from sprung.batch.dask_workers import DaskWorkers
from sprung.batch.local_workers import LocalWorkers
from sprung.batch.task import Failure, Row, Task, Work
from sprung.errors import InputError, Problem


class Executor(Protocol):
    """What does the tasks of a batch."""

    @property
    def capacity(self) -> int:
        """Number of tasks that it takes at a time."""

    def submit(self, task: Task) -> None:
        """Hand over a task.

        Parameters
        ----------
        task
            Its outcome comes from `collect`.
        """

    def collect(self, timeout: float) -> list[tuple[Task, Row | Failure]]:
        """Return what is finished.

        Parameters
        ----------
        timeout
            Longest time to wait for the first outcome, s.
        """

    def close(self) -> None:
        """Release processes and connections."""


def choose_executor(work: Work, workers: int | None = None, scheduler: str | None = None) -> Executor:
    """Return the workers for a batch.

    Parameters
    ----------
    work
        Function of a module, done for the argument of each task.
    workers
        Number of processes on this machine; None for one for each processor.
    scheduler
        Address of the scheduler of a Dask cluster, such as ``tcp://10.0.0.7:8786``; None for this machine.

    Returns
    -------
    Executor

    Raises
    ------
    InputError
        If both are given, the number is not positive, or the cluster cannot be used.
    """
    if workers is not None and scheduler is not None:
        found = f"{workers} workers and the scheduler {scheduler}"
        do = "A cluster has its own workers: leave the number out."
        raise InputError([Problem("workers", found, "one of the two", do)])
    if workers is not None and workers < 1:
        raise InputError([Problem("workers", str(workers), "1 or more", "Leave it out for one per processor.")])
    return LocalWorkers(work, workers) if scheduler is None else DaskWorkers(work, scheduler)

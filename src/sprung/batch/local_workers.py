"""Worker processes on this machine; one that is killed is replaced, and its task is tried again."""

from __future__ import annotations

import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from collections import Counter, deque
from contextlib import suppress
from dataclasses import dataclass, field
from typing import IO, Any

from sprung.batch.task import Failure, Row, Task, Work
from sprung.batch.worker import receive, send

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Environment variables with the number of threads of NumPy's libraries: one for each worker, as matrices are small."""

_COMMAND = "from sprung.batch.worker import main; main()"

_AHEAD = 2
"""Tasks that a worker has at a time: the one it does, and the next."""

MOST_DEATHS = 2
"""Number of workers that a task may cost."""

_MOST_STARTS = 3
"""Number of workers that may end, one after the other, before they are ready."""

_TOLD = 600
"""Last characters of a worker's standard error that a message contains."""


@dataclass(eq=False)
class _Process:
    """A worker process, and the tasks that it has, the one it does first."""

    popen: subprocess.Popen[bytes]
    errors: IO[bytes]
    tasks: deque[Task] = field(default_factory=deque)
    ready: bool = False

    def end(self) -> None:
        for stream in (self.popen.stdin, self.popen.stdout, self.errors):
            if stream is not None:
                with suppress(OSError):
                    stream.close()


class LocalWorkers:
    """Worker processes on this machine.

    Parameters
    ----------
    work
        Function of a module, done for the argument of each task.
    count
        Number of processes; None for one for each processor.
    """

    def __init__(self, work: Work, count: int | None = None) -> None:
        self._work = work
        self._events: queue.SimpleQueue[tuple[_Process, Any]] = queue.SimpleQueue()
        self._deaths: Counter[str] = Counter()
        self._failed_starts = 0
        self._processes = [self._start() for _ in range(count or available_processors())]

    @property
    def capacity(self) -> int:
        """Number of tasks that it takes at a time."""
        return _AHEAD * len(self._processes)

    @property
    def process_ids(self) -> tuple[int, ...]:
        """Numbers of the worker processes that run."""
        return tuple(process.popen.pid for process in self._processes)

    def submit(self, task: Task) -> None:
        """Hand over a task.

        Parameters
        ----------
        task
            Its outcome comes from `collect`.
        """
        process = min(self._processes, key=lambda process: len(process.tasks))
        process.tasks.append(task)
        # A process that is gone takes no task: its end is found in `collect`, which hands its tasks over again.
        with suppress(OSError, ValueError):
            assert process.popen.stdin is not None  # noqa: S101 (a pipe; for the type checker)
            send(process.popen.stdin, task.argument)  # type: ignore[arg-type]

    def collect(self, timeout: float) -> list[tuple[Task, Row | Failure]]:
        """Return what is finished.

        Parameters
        ----------
        timeout
            Longest time to wait for the first outcome, s.

        Returns
        -------
        list
            Tasks and their outcomes.

        Raises
        ------
        RuntimeError
            If no worker process can be started.
        """
        found: list[tuple[Task, Row | Failure]] = []
        with suppress(queue.Empty):
            event = self._events.get(timeout=timeout)
            while True:
                found += self._handled(*event)
                event = self._events.get_nowait()
        return found

    def close(self) -> None:
        """End all worker processes."""
        for process in self._processes:
            process.popen.kill()
            process.popen.wait()
            process.end()

    def _start(self) -> _Process:
        # It lives as long as its process and is closed with it.
        errors = tempfile.TemporaryFile()  # noqa: SIM115
        environment = {**os.environ, **{name: os.environ.get(name, "1") for name in _THREADS}}
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, sys.path))
        popen = subprocess.Popen(  # noqa: S603 (our own interpreter and text)
            [sys.executable, "-c", _COMMAND],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
            env=environment,
        )
        process = _Process(popen, errors)
        with suppress(OSError):
            assert popen.stdin is not None  # noqa: S101 (a pipe; for the type checker)
            send(popen.stdin, list(sys.path))  # type: ignore[arg-type]
            send(popen.stdin, self._work)  # type: ignore[arg-type]
        threading.Thread(target=self._listen, args=(process,), daemon=True).start()
        return process

    def _listen(self, process: _Process) -> None:
        """Pass on what a process sends, and None when it has ended."""
        assert process.popen.stdout is not None  # noqa: S101 (a pipe; for the type checker)
        try:
            while True:
                self._events.put((process, receive(process.popen.stdout)))  # type: ignore[arg-type]
        except (EOFError, OSError, ValueError):
            self._events.put((process, None))

    def _handled(self, process: _Process, message: Any) -> list[tuple[Task, Row | Failure]]:
        if message == "ready":
            process.ready, self._failed_starts = True, 0
            return []
        if message is not None:
            return [(process.tasks.popleft(), message)]
        return self._replace(process) if process in self._processes else []

    def _replace(self, process: _Process) -> list[tuple[Task, Row | Failure]]:
        """Start another process in place of one that has ended, with its tasks."""
        status = process.popen.wait()
        if not process.ready:
            self._failed_starts += 1
            if self._failed_starts >= _MOST_STARTS:
                raise RuntimeError(f"worker processes end when they start ({_ended(status)}): {_last_words(process)}")
        found: list[tuple[Task, Row | Failure]] = []
        tasks = process.tasks
        if process.ready and tasks:
            self._deaths[tasks[0].campaign] += 1
            if self._deaths[tasks[0].campaign] >= MOST_DEATHS:
                message = f"ended its worker process {MOST_DEATHS} times ({_ended(status)}). {_last_words(process)}"
                found.append((tasks.popleft(), Failure("worker", message.strip())))
        process.end()
        self._processes[self._processes.index(process)] = self._start()
        for task in tasks:
            self.submit(task)
        return found


def available_processors() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _ended(status: int) -> str:
    if status >= 0:
        return f"exit status {status}"
    with suppress(ValueError):
        return f"signal {-status}, {signal.Signals(-status).name}"
    return f"signal {-status}"


def _last_words(process: _Process) -> str:
    """Return the end of what a process wrote to standard error, on one line."""
    with suppress(OSError, ValueError):
        process.errors.seek(0, os.SEEK_END)
        process.errors.seek(max(process.errors.tell() - _TOLD, 0))
        return " ".join(process.errors.read().decode("utf-8", "replace").split())
    return ""

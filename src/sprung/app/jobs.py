"""Commands that run for the page: at most two at a time, each in a process of its own that can be stopped."""

from __future__ import annotations

import itertools
import json
import os
import queue
import secrets
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, Any, Literal

from sprung.errors import SprungError

AT_ONCE = 2
"""Number of jobs that run at the same time."""

WAITING = 50
"""Most jobs that wait."""

_KEPT = 50
"""Number of finished jobs that are remembered."""

_LARGEST_OUTPUT = 2_000_000
"""Most characters of the output of a job that are kept; the longest document of a command is a tenth of it."""

_STEPS = 200
"""Number of steps of a job that are remembered: the last ones."""

_GRACE = 5.0
"""Time that a stopped process has to end by itself, s."""

State = Literal["waiting", "running", "done", "failed", "cancelled"]


class TooManyJobsError(SprungError):
    """More jobs than may wait."""


@dataclass(frozen=True, slots=True)
class JobStep:
    """A step that a job began.

    Attributes
    ----------
    text
        The step, as a terminal shows it.
    stage
        The stage to which it belongs.
    step, of
        Its number in the stage and their number, where they are counted.
    done
        Part of the stage that is done, 0 to 1, where it is known.
    at
        Time since the job began, s.
    """

    text: str
    stage: str
    step: int | None
    of: int | None
    done: float | None
    at: float


@dataclass(frozen=True, slots=True)
class Job:
    """A command of sprung, as far as it has come.

    Attributes
    ----------
    id
        Random.
    title
        What it does, for people.
    arguments
        Of the command ``sprung``, in its folder.
    folder
        Working folder of the process.
    state
        ``done`` if the command ended with status 0, or 3 (identified, but rejected).
    steps
        The last steps that began.
    output, messages
        Standard output, and standard error without the steps.
    status
        Exit status of the command, once it has ended by itself.
    began, ended
        Times, s since 1970.
    change
        Number of the last change of this job, counted over all jobs.
    """

    id: str
    title: str
    arguments: tuple[str, ...]
    folder: Path
    state: State = "waiting"
    steps: tuple[JobStep, ...] = ()
    output: str = ""
    messages: str = ""
    status: int | None = None
    began: float | None = None
    ended: float | None = None
    change: int = 0

    @property
    def is_over(self) -> bool:
        """Whether nothing of it will change any more."""
        return self.state in {"done", "failed", "cancelled"}

    def document(self) -> dict[str, Any]:
        """Return the state for a page, without output and earlier steps."""
        last = self.steps[-1] if self.steps else None
        now = time.time() if self.ended is None else self.ended
        return {
            "id": self.id,
            "title": self.title,
            "state": self.state,
            "status": self.status,
            "step": None if last is None else last.text,
            "stage": None if last is None else last.stage,
            "done": None if last is None else last.done,
            "elapsed": None if self.began is None else now - self.began,
        }


class Jobs:
    """The jobs of one server.

    Parameters
    ----------
    memory
        Most memory of each process in bytes, where the system can limit it; None for half of the machine's.

    Attributes
    ----------
    is_closing
        Whether the server is about to end.
    """

    def __init__(self, memory: int | None = None) -> None:
        self._memory = memory
        self._jobs: dict[str, Job] = {}
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._queue: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._lock = threading.RLock()
        self._changes = itertools.count(1)
        self._listeners: set[Callable[[], object]] = set()
        self._threads: list[threading.Thread] = []
        self.is_closing = False

    def start(self, arguments: Sequence[str], folder: Path, title: str) -> Job:
        """Start a command, or let it wait for its turn.

        Parameters
        ----------
        arguments
            Of the command ``sprung``.
        folder
            Working folder.
        title
            What it does, for people.

        Returns
        -------
        Job
            The one that already waits or runs, if it has the same arguments: a button pressed in two tabs starts one job.

        Raises
        ------
        TooManyJobsError
            If too many jobs wait already.
        """
        wanted = tuple(arguments)
        with self._lock:
            unfinished = [job for job in self._jobs.values() if not job.is_over]
            for job in unfinished:
                if (job.arguments, job.folder) == (wanted, folder):
                    return job
            if self.is_closing or len(unfinished) >= WAITING:
                raise TooManyJobsError(f"{len(unfinished)} jobs are waiting or running. Cancel some, or wait.")
            job = self._put(Job(secrets.token_urlsafe(9), title, wanted, folder))
            self._forget_oldest()
            if len(self._threads) < AT_ONCE:
                self._threads.append(threading.Thread(target=self._work, daemon=True, name=f"job {len(self._threads)}"))
                self._threads[-1].start()
        self._queue.put(job.id)
        return job

    def get(self, id: str) -> Job:  # noqa: A002 (name of the field)
        """Return a job.

        Raises
        ------
        KeyError
            If there is none with this id.
        """
        with self._lock:
            return self._jobs[id]

    def all(self) -> tuple[Job, ...]:
        """Return all jobs, the newest first."""
        with self._lock:
            return tuple(reversed(self._jobs.values()))

    def changed_since(self, change: int) -> tuple[Job, ...]:
        """Return the jobs that changed after a change, in the order of their changes."""
        with self._lock:
            return tuple(
                sorted((job for job in self._jobs.values() if job.change > change), key=lambda job: job.change)
            )

    def cancel(self, id: str) -> Job:  # noqa: A002
        """Stop a job; one that is over remains as it is.

        Raises
        ------
        KeyError
            If there is none with this id.
        """
        with self._lock:
            job = self._jobs[id]
            if not job.is_over:
                job = self._put(replace(job, state="cancelled", ended=time.time()))
                process = self._processes.get(id)
                if process is not None:
                    threading.Thread(target=_stop, args=(process,), daemon=True).start()
            return job

    def listen(self, listener: Callable[[], object]) -> Callable[[], None]:
        """Call a function, from any thread, after every change; return the function that ends this."""
        with self._lock:
            self._listeners.add(listener)
        return lambda: self._listeners.discard(listener)

    def refuse_more(self) -> None:
        """Accept no further jobs; the listeners are called, so that streams of events can end."""
        self.is_closing = True
        self._notify()

    def _notify(self) -> None:
        for listener in tuple(self._listeners):
            with suppress(RuntimeError):  # its event loop is closed
                listener()

    def close(self) -> None:
        """Stop everything, and wait until it has ended."""
        self.refuse_more()
        with self._lock:
            for job in tuple(self._jobs.values()):
                if not job.is_over:
                    self.cancel(job.id)
        for _ in self._threads:
            self._queue.put(None)
        for thread in self._threads:
            thread.join(_GRACE + 2)

    def _put(self, job: Job) -> Job:
        """Remember a new state of a job. The lock is held."""
        job = replace(job, change=next(self._changes))
        self._jobs[job.id] = job
        self._notify()
        return job

    def _update(self, id: str, **changes: Any) -> Job:  # noqa: A002
        with self._lock:
            job = self._jobs[id]
            return job if job.is_over else self._put(replace(job, **changes))

    def _forget_oldest(self) -> None:
        over = [job.id for job in self._jobs.values() if job.is_over]
        for id_ in over[: max(0, len(over) - _KEPT)]:
            del self._jobs[id_]

    def _work(self) -> None:
        """Run jobs, one after the other."""
        while (id_ := self._queue.get()) is not None:
            try:
                self._run(id_)
            except Exception as error:  # noqa: BLE001 (the thread must go on to the next job)
                self._update(
                    id_, state="failed", messages=f"The process could not be started: {error}", ended=time.time()
                )

    def _run(self, id_: str) -> None:
        with self._lock:
            job = self._jobs[id_]
            if job.is_over:
                return
            process = _process(job, self._memory)
            self._processes[id_] = process
            began = time.time()
            self._put(replace(job, state="running", began=began))
        assert process.stdout is not None  # noqa: S101 (for mypy: it is a pipe)
        assert process.stderr is not None  # noqa: S101
        output: list[str] = []
        reader = threading.Thread(target=_collect, args=(process.stdout, output), daemon=True)
        reader.start()
        messages = self._follow(id_, process.stderr, began)
        status = process.wait()
        reader.join(_GRACE)
        with self._lock:
            del self._processes[id_]
        for pipe in (process.stdin, process.stdout, process.stderr):
            if pipe is not None:
                pipe.close()
        self._update(
            id_,
            state="done" if status in {0, 3} else "failed",
            status=status,
            output="".join(output),
            messages=messages if status >= 0 else f"{messages}{_killed(status)}",
            ended=time.time(),
        )

    def _follow(self, id_: str, pipe: IO[bytes], began: float) -> str:
        """Note the steps that a process reports, and return what else it says."""
        messages: list[str] = []
        while line := pipe.readline(_LARGEST_OUTPUT):
            text = line.decode("utf-8", "replace")
            step = _step(text, time.time() - began)
            if step is None:
                messages = _shortened([*messages, text])
            else:
                self._update(id_, steps=(*self.get(id_).steps[-_STEPS + 1 :], step))
        return "".join(messages)


def _process(job: Job, memory: int | None) -> subprocess.Popen[bytes]:
    """Start the process of a job."""
    limit = [] if memory is None else [f"--memory={memory}"]
    # -P: a numpy.py in the folder of recordings must not be imported.
    command = [sys.executable, "-P", "-m", "sprung.app.job_process", *limit, "--", *job.arguments]
    return subprocess.Popen(  # noqa: S603 (a list of arguments, no shell)
        command,
        cwd=job.folder,
        env={**process_environment(), "SPRUNG_PROGRESS": "json", "COLUMNS": "100"},
        stdin=subprocess.PIPE,  # its end tells the process that the server is gone
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,  # a Ctrl-C in the terminal is the server's
    )


def process_environment() -> dict[str, str]:
    """Return the environment of a process of the server.

    Relative entries of PYTHONPATH refer to the folder in which the server was started, not to that of the process.
    """
    paths = [str(Path(entry).resolve()) for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
    kept = {name: value for name, value in os.environ.items() if name != "FORCE_COLOR"}
    return {**kept, "PYTHONUTF8": "1", "NO_COLOR": "1", "PYTHONPATH": os.pathsep.join(paths)}


def _stop(process: subprocess.Popen[bytes]) -> None:
    """Ask a process and its own processes to end, and end them after a while."""
    for number in (signal.SIGTERM, getattr(signal, "SIGKILL", signal.SIGTERM)):
        with suppress(OSError):
            if hasattr(os, "killpg"):
                os.killpg(process.pid, number)
            else:
                process.terminate()
        with suppress(subprocess.TimeoutExpired):
            process.wait(_GRACE)
            return


def _step(text: str, at: float) -> JobStep | None:
    """Return the step that a line reports; None if it is a message."""
    if not text.startswith('{"progress"'):
        return None
    try:
        step = json.loads(text)["progress"]
        return JobStep(step["text"], step["stage"], step["step"], step["of"], step["done"], at)
    except (ValueError, LookupError, TypeError):
        return None


def _collect(pipe: IO[bytes], into: list[str]) -> None:
    """Read a pipe to its end, and keep the first part of it."""
    kept = 0
    while piece := pipe.read1(1 << 16):  # type: ignore[attr-defined]
        if kept < _LARGEST_OUTPUT:
            into.append(piece.decode("utf-8", "replace"))
            kept += len(piece)


def _shortened(lines: list[str]) -> list[str]:
    """Return the last lines of a long text."""
    while len(lines) > 1 and (sum(map(len, lines)) > 100_000 or len(lines) > 1000):
        lines = lines[len(lines) // 2 :]
    return lines


def _killed(status: int) -> str:
    return f"The process was ended from outside (signal {-status}). Files are complete; start it again.\n"

"""Short questions that need the numerics, answered by processes of their own: the server itself remains small.

A question takes a second at most, after the start of its process; what takes longer is a job.
"""

from __future__ import annotations

import asyncio
import json
import queue
import subprocess
import sys
import threading
from concurrent.futures import Future
from contextlib import suppress
from typing import IO, Any, Literal, TypeAlias, cast

from starlette.requests import Request

from sprung.app.jobs import process_environment
from sprung.errors import InputError, Problem, SprungError

Lane = Literal["form", "recording"]
"""Questions about texts do not wait for those about recordings: each lane has a process."""

PendingAnswer: TypeAlias = "Future[dict[str, Any]]"

LONGEST = 90.0
"""Longest time that an answer may take, s: a recording of 500 MB is read in a part of it."""

WAITING = 100
"""Most questions that wait for one process."""

IDLE = 300.0
"""Time without questions after which a process ends, s."""


class QueryError(SprungError):
    """A question that was not answered."""


class Queries:
    """The processes that answer, started when they are first asked."""

    def __init__(self) -> None:
        self._lanes: dict[Lane, _Lane] = {"form": _Lane(), "recording": _Lane()}

    async def ask(self, lane: Lane, question: str, **arguments: Any) -> Any:
        """Return the answer to a question.

        Parameters
        ----------
        lane
            Which process answers.
        question
            A function of this room as ``module:function``; its arguments and its answer consist of what JSON has.
        **arguments
            Of the function.

        Raises
        ------
        InputError
            As the function does.
        QueryError
            If there is no answer in time, or the process fails.
        """
        request = json.dumps({"question": question, "arguments": arguments})
        answer = await asyncio.wrap_future(self._lanes[lane].submit(request))
        if "problems" in answer:
            raise InputError(Problem(**problem) for problem in answer["problems"])
        if "defect" in answer:
            raise QueryError(f"This is a defect of sprung ({answer['defect']}).")
        return answer["answer"]

    def warm(self, lane: Lane) -> None:
        """Start the process of a lane, if it does not run yet: its first answer then comes sooner."""
        if not self._lanes[lane].is_warm:
            self._lanes[lane].submit(json.dumps(_WARMING))

    def close(self) -> None:
        """End the processes."""
        for lane in self._lanes.values():
            lane.close()


_WARMING = {"question": "form_view:ready", "arguments": {}}


class _Lane:
    """One process, which answers one question at a time, in the order in which they come; a thread waits for it."""

    def __init__(self) -> None:
        self._questions: queue.SimpleQueue[tuple[str, PendingAnswer] | None] = queue.SimpleQueue()
        self._process: subprocess.Popen[bytes] | None = None
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    @property
    def is_warm(self) -> bool:
        """Whether the process runs, or is about to be started."""
        process = self._process
        return (process is not None and process.poll() is None) or not self._questions.empty()

    def submit(self, request: str) -> PendingAnswer:
        """Put a question into the queue; its answer comes later, unless whoever asked has gone meanwhile."""
        if self._questions.qsize() >= WAITING:
            raise QueryError(f"{WAITING} questions wait to be answered. Load the page again in a minute.")
        answer: PendingAnswer = Future()
        self._questions.put((request, answer))
        with self._lock:
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, daemon=True)
                self._thread.start()
        return answer

    def close(self) -> None:
        """End the process and the thread."""
        process, thread = self._process, self._thread
        self._questions.put(None)
        if process is not None:
            process.kill()
        if thread is not None:
            thread.join(5)

    def _work(self) -> None:
        while True:
            try:
                question = self._questions.get(timeout=IDLE)
            except queue.Empty:
                self._end()
                continue
            if question is None:
                self._end()
                return
            request, answer = question
            if answer.set_running_or_notify_cancel():
                try:
                    answer.set_result(self._answer(request))
                except Exception as error:  # noqa: BLE001 (whoever asked has to know it)
                    answer.set_exception(error)

    def _answer(self, request: str) -> dict[str, Any]:
        if self._process is None or self._process.poll() is not None:
            self._end()
            self._process = _start()
        try:
            answer: dict[str, Any] = json.loads(_exchange(self._process, request.encode() + b"\n"))
        except (OSError, ValueError, QueryError):
            self._end()
            raise
        return answer

    def _end(self) -> None:
        """End the process, if there is one."""
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                with suppress(OSError):
                    if pipe is not None:
                        pipe.close()


def _start() -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "sprung.app.query_process"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=process_environment(),
        start_new_session=True,  # a Ctrl-C in the terminal is the server's
    )


def _exchange(process: subprocess.Popen[bytes], line: bytes) -> bytes:
    """Write a question and return the line of the answer."""
    questions, answers = cast("IO[bytes]", process.stdin), cast("IO[bytes]", process.stdout)
    late = threading.Timer(LONGEST, process.kill)
    late.daemon = True
    late.start()
    try:
        questions.write(line)
        questions.flush()
        answer = answers.readline()
    except BrokenPipeError:
        answer = b""
    finally:
        late.cancel()
    if answer.endswith(b"\n"):
        return answer
    raise QueryError(
        f"The process that reads the files ended, for want of memory or because it took longer than {LONGEST:.0f} s. "
        "Use smaller recordings, or the command line."
    )


def queries_of(request: Request) -> Queries:
    """Return the processes of the server that answers a request."""
    found: Queries = request.app.state.queries
    return found

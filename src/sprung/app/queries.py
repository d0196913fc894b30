"""Short questions that need the numerics, answered by processes of their own: the server itself remains small.

A question takes a second at most, after the start of its process; what takes longer is a job.
"""

from __future__ import annotations

import asyncio
import json
import os
import select
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, Literal, cast

from starlette.requests import Request

from sprung.errors import InputError, Problem, SprungError

Lane = Literal["form", "recording"]
"""Questions about texts do not wait for those about recordings: each lane has a process."""

LONGEST = 90.0
"""Longest time that an answer may take, s: a recording of 500 MB is read in a part of it."""

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
        answer = await asyncio.to_thread(self._lanes[lane].ask, request)
        if "problems" in answer:
            raise InputError(Problem(**problem) for problem in answer["problems"])
        if "defect" in answer:
            raise QueryError(f"This is a defect of sprung ({answer['defect']}).")
        return answer["answer"]

    def warm(self, lane: Lane) -> None:
        """Start the process of a lane, if it does not run yet: its first answer then comes sooner."""
        threading.Thread(target=self._lanes[lane].ask, args=(json.dumps(_WARMING),), daemon=True).start()

    def close(self) -> None:
        """End the processes."""
        for lane in self._lanes.values():
            lane.close()


_WARMING = {"question": "form_view:ready", "arguments": {}}


class _Lane:
    """One process, which answers one question at a time."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._last = 0.0

    def ask(self, request: str) -> dict[str, Any]:
        with self._lock:
            if self._process is None or self._process.poll() is not None:
                self._process = _start()
                threading.Thread(target=self._end_when_idle, args=(self._process,), daemon=True).start()
            self._last = time.monotonic()
            try:
                line = _exchange(self._process, request.encode() + b"\n")
            except (OSError, QueryError):
                self._end(self._process)
                raise
            self._last = time.monotonic()
            answer: dict[str, Any] = json.loads(line)
            return answer

    def close(self) -> None:
        process = self._process
        if process is not None:
            self._end(process)

    def _end_when_idle(self, process: subprocess.Popen[bytes]) -> None:
        while process.poll() is None:
            time.sleep(IDLE / 10)
            with self._lock:
                if time.monotonic() - self._last > IDLE:
                    self._end(process)

    def _end(self, process: subprocess.Popen[bytes]) -> None:
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            with suppress(OSError):
                if pipe is not None:
                    pipe.close()


def _start() -> subprocess.Popen[bytes]:
    paths = [str(Path(entry).resolve()) for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "sprung.app.query_process"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONUTF8": "1", "PYTHONPATH": os.pathsep.join(paths)},
        start_new_session=True,  # a Ctrl-C in the terminal is the server's
    )


def _exchange(process: subprocess.Popen[bytes], line: bytes) -> bytes:
    """Write a question and return the line of the answer."""
    questions, answers = cast("IO[bytes]", process.stdin), cast("IO[bytes]", process.stdout)
    questions.write(line)
    questions.flush()
    until, pieces = time.monotonic() + LONGEST, bytearray()
    while not pieces.endswith(b"\n"):
        if not select.select([answers], [], [], max(until - time.monotonic(), 0.0))[0]:
            raise QueryError(
                f"There was no answer within {LONGEST:.0f} s. Use the command line for recordings of this size."
            )
        piece = os.read(answers.fileno(), 1 << 20)
        if not piece:
            raise QueryError(
                "The process that reads the files ended, perhaps for want of memory. Use smaller recordings."
            )
        pieces += piece
    return bytes(pieces)


def queries_of(request: Request) -> Queries:
    """Return the processes of the server that answers a request."""
    state = request.app.state
    if not hasattr(state, "queries"):
        state.queries = Queries()
    found: Queries = state.queries
    return found

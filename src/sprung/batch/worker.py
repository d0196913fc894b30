"""A worker process: reads tasks from standard input, writes outcomes to standard output, ends with its parent.

It is started as a new interpreter, not by `multiprocessing`, which would run the caller's script again: a fleet can be
identified from a script without a main guard, from a notebook and from a console.
"""

from __future__ import annotations

import os
import pickle
import queue
import signal
import struct
import sys
import threading
from typing import Any, BinaryIO

from sprung.batch.task import attempt

_LENGTH = struct.Struct("<Q")


def send(stream: BinaryIO, message: Any) -> None:
    """Write one message to a pipe."""
    content = pickle.dumps(message, protocol=5)
    stream.write(_LENGTH.pack(len(content)))
    stream.write(content)
    stream.flush()


def receive(stream: BinaryIO) -> Any:
    """Return the next message of a pipe.

    Raises
    ------
    EOFError
        If the other end is closed, or its process gone.
    """
    content = _read(stream, _LENGTH.unpack(_read(stream, _LENGTH.size))[0])
    return pickle.loads(content)  # noqa: S301 (from our own parent or child)


def _read(stream: BinaryIO, size: int) -> bytes:
    content = stream.read(size)
    if len(content) < size:
        raise EOFError
    return content


def main() -> None:
    """Work until standard input is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which then closes the pipe
    tasks, outcomes = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever prints must not disturb the outcomes
    sys.path[:] = receive(tasks)
    work = receive(tasks)
    send(outcomes, "ready")
    waiting: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(tasks, waiting), daemon=True).start()
    while True:
        send(outcomes, attempt(work, waiting.get()))


def _listen(tasks: BinaryIO, waiting: queue.SimpleQueue[Any]) -> None:
    """Take tasks as they come; end the process at once when the parent is gone."""
    while True:
        try:
            waiting.put(receive(tasks))
        except (EOFError, OSError):
            os._exit(0)

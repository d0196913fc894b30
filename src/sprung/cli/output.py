"""What the commands say and with which status they leave: results on standard output, everything else on standard error."""

from __future__ import annotations

import io
import json
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

DEFECT = 1
BAD_INPUT = 2
REJECTED = 3
INTERRUPTED = 130
"""Exit statuses; the last is the shell's own for Ctrl-C."""


@contextmanager
def working(first: str) -> Iterator[Callable[[str], None]]:
    """Show what is being done while somebody watches; standard output stays clean."""
    console = Console(stderr=True)
    with console.status(first) as status:
        yield status.update


@contextmanager
def advancing(what: str) -> Iterator[Callable[[float], None]]:
    """Show how far something long has come, while somebody watches; takes the part that is done, 0 to 1."""
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(what, total=1.0)
        yield lambda fraction: bar.update(task, completed=fraction)


def say(text: str) -> None:
    """Print text to standard output; go on without a reader when it has gone, as `| head` does."""
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        # What is left in the buffer would fail again at the end of the program: it goes nowhere instead.
        with suppress(OSError, io.UnsupportedOperation):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def say_json(document: str | Any) -> None:
    """Print one JSON document, in UTF-8 as JSON must be; text counts as JSON already."""
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(encoding="utf-8")
    text = (
        document if isinstance(document, str) else json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)
    )
    say(text.rstrip("\n") + "\n")


def complain(text: str) -> None:
    """Print a message to standard error."""
    with suppress(BrokenPipeError):
        sys.stderr.write(text.rstrip("\n") + "\n")
        sys.stderr.flush()

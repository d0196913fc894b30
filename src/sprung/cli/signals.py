"""Ctrl-C and SIGTERM: both end a command cleanly, with complete files and the status that shells use."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from types import FrameType
from typing import Any

from sprung.cli.output import INTERRUPTED, TERMINATED, complain


class Terminated(KeyboardInterrupt):
    """Raised on SIGTERM, which a batch system or `kill` sends, like KeyboardInterrupt on Ctrl-C."""


@contextmanager
def sigterm_as_exception() -> Iterator[None]:
    """Let SIGTERM raise `Terminated` in the block, unless the parent process has set it to be ignored.

    An exception that is raised in a callback of the interpreter, such as one of the import system, is lost: it is raised again
    a millisecond later.
    """
    before = signal.getsignal(signal.SIGTERM)
    if threading.current_thread() is not threading.main_thread() or before not in {signal.SIG_DFL, _stop}:
        yield
        return
    signal.signal(signal.SIGTERM, _stop)
    hook = sys.unraisablehook
    sys.unraisablehook = partial(_stop_again, hook)
    try:
        yield
    finally:
        sys.unraisablehook = hook
        signal.signal(signal.SIGTERM, before)


def _stop(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 (signature of a handler)
    raise Terminated


def _stop_again(hook: Callable[[Any], object], lost: Any) -> None:
    """Raise a lost KeyboardInterrupt again; pass everything else to the previous hook."""
    if not isinstance(lost.exc_value, KeyboardInterrupt) or not hasattr(signal, "setitimer"):
        hook(lost)
        return
    stop = type(lost.exc_value)

    def again(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 (signature of a handler)
        raise stop

    signal.signal(signal.SIGALRM, again)
    signal.setitimer(signal.ITIMER_REAL, 1e-3)


def report_stop(stopped: KeyboardInterrupt) -> int:
    """Report that a command was stopped, and return its exit status."""
    terminated = isinstance(stopped, Terminated)
    complain("sprung was terminated." if terminated else "sprung was interrupted.")
    return TERMINATED if terminated else INTERRUPTED


def interruption_of(leaving: SystemExit) -> KeyboardInterrupt | None:
    """Return the interruption that caused an exit before the command began; None for another cause."""
    error: BaseException | None = leaving
    while error is not None and not error.__suppress_context__:
        error = error.__cause__ or error.__context__
        if isinstance(error, KeyboardInterrupt):
            return error
    return error.__cause__ if error is not None and isinstance(error.__cause__, KeyboardInterrupt) else None

"""Ctrl-C and SIGTERM: both end a command with complete files on the disk, and with the shell's status."""

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
    """SIGTERM, as sent by a batch system or `kill`: raised like Ctrl-C."""


@contextmanager
def stopping_like_ctrl_c() -> Iterator[None]:
    """Let SIGTERM raise `Terminated` in the block, unless the parent process ignores it.

    A signal that arrives while Python runs a callback of its own, such as one of its import system, raises where nothing can
    pass the exception on: it is raised once more, a millisecond later.
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


def _stop(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 (what a handler takes)
    raise Terminated


def _stop_again(hook: Callable[[Any], object], lost: Any) -> None:
    """Raise an interruption again if it was lost; leave everything else to the previous hook."""
    if not isinstance(lost.exc_value, KeyboardInterrupt) or not hasattr(signal, "setitimer"):
        hook(lost)
        return
    stop = type(lost.exc_value)

    def again(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 (what a handler takes)
        raise stop

    signal.signal(signal.SIGALRM, again)
    signal.setitimer(signal.ITIMER_REAL, 1e-3)


def was_stopped(stopped: KeyboardInterrupt) -> int:
    """Report that a command was stopped, and return its exit status."""
    terminated = isinstance(stopped, Terminated)
    complain("sprung was terminated." if terminated else "sprung was interrupted.")
    return TERMINATED if terminated else INTERRUPTED


def stopped_before(leaving: SystemExit) -> KeyboardInterrupt | None:
    """Return what stopped the program before its command began."""
    error: BaseException | None = leaving
    while error is not None and not error.__suppress_context__:
        error = error.__cause__ or error.__context__
        if isinstance(error, KeyboardInterrupt):
            return error
    return error.__cause__ if error is not None and isinstance(error.__cause__, KeyboardInterrupt) else None

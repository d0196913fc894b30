"""Ctrl-C and SIGTERM: both end a command in order, with what is on the disk whole, and with the shell's own status."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from sprung.cli.output import INTERRUPTED, TERMINATED, complain


class Terminated(KeyboardInterrupt):
    """SIGTERM, as a batch system or `kill` sends it: raised where Ctrl-C would be."""


@contextmanager
def stopping_like_ctrl_c() -> Iterator[None]:
    """Let SIGTERM raise `Terminated` in the block, unless whoever started us wants it to be ignored."""
    before = signal.getsignal(signal.SIGTERM)
    if threading.current_thread() is not threading.main_thread() or before not in {signal.SIG_DFL, _stop}:
        yield
        return
    signal.signal(signal.SIGTERM, _stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _stop(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 (what a handler takes)
    raise Terminated


def was_stopped(stopped: KeyboardInterrupt) -> int:
    """Say that a command was stopped, and return its exit status."""
    terminated = isinstance(stopped, Terminated)
    complain("sprung was terminated." if terminated else "sprung was interrupted.")
    return TERMINATED if terminated else INTERRUPTED


def stopped_before(leaving: SystemExit) -> KeyboardInterrupt | None:
    """Return what stopped the program before it came to its command, while the command line took it for Ctrl-C."""
    error: BaseException | None = leaving
    while error is not None and not error.__suppress_context__:
        error = error.__cause__ or error.__context__
        if isinstance(error, KeyboardInterrupt):
            return error
    return error.__cause__ if error is not None and isinstance(error.__cause__, KeyboardInterrupt) else None

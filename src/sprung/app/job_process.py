"""The process of a job: a command of sprung with a limit of its memory, which ends when the server does.

``python -P -m sprung.app.job_process [--memory=BYTES] -- COMMAND ...``
"""

from __future__ import annotations

import os
import runpy
import signal
import sys
import threading
import time

SHARE = 2
"""The memory of the machine divided by this is the limit of a process."""

LEAST = 1 << 30
"""Least limit, bytes."""

_GRACE = 5.0
"""Time to end after the server has gone, s."""


def main() -> None:
    """Run the command that the arguments state."""
    split = sys.argv.index("--")
    given = [option.removeprefix("--memory=") for option in sys.argv[1:split]]
    limit_memory(int(given[0]) if given else machine_memory() // SHARE)
    if hasattr(os, "nice"):
        os.nice(5)  # the page answers while two jobs compute
    threading.Thread(target=_end_with_server, daemon=True).start()
    sys.argv = ["sprung", *sys.argv[split + 1 :]]
    runpy.run_module("sprung", run_name="__main__", alter_sys=False)


def limit_memory(limit: int) -> None:
    """Limit the memory of this process, at least to `LEAST`; nothing where the system cannot."""
    try:
        import resource  # noqa: PLC0415 (not on Windows)

        resource.setrlimit(resource.RLIMIT_AS, (max(limit, LEAST), resource.RLIM_INFINITY))
    except (ImportError, OSError, ValueError):
        return


def machine_memory() -> int:
    """Return the memory of the machine, bytes; 8 GB where the system does not say."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, OSError, ValueError):
        return 8 << 30


def _end_with_server() -> None:
    """Wait for the end of standard input, which the server holds open, and end this process with all of its own."""
    while os.read(0, 1 << 10):
        pass
    if hasattr(os, "killpg"):
        os.killpg(0, signal.SIGTERM)
    else:
        os._exit(1)
    time.sleep(_GRACE)
    os.killpg(0, signal.SIGKILL)


if __name__ == "__main__":
    main()

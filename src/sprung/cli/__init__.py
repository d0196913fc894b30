"""The command line: arguments, calls, output, exit statuses; no computation."""

from __future__ import annotations

import sys

from sprung.cli.signals import report_stop, sigterm_as_exception


def main() -> None:
    """Run the command line; exit status 0, 1, 2 or 3 as documented, 130 on Ctrl-C, 143 on SIGTERM."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal without ² must still show the numbers
    with sigterm_as_exception():
        try:
            # The commands are imported here: importing them takes long enough to be interrupted.
            from sprung.cli.program import run_program  # noqa: PLC0415

            run_program()
        except KeyboardInterrupt as stopped:
            raise SystemExit(report_stop(stopped)) from None

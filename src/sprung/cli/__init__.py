"""The command line: arguments, calls, output, exit statuses; no computation."""

from __future__ import annotations

import os
import sys
import traceback

from sprung.cli import batches as batches
from sprung.cli import exports as exports
from sprung.cli import identification as identification
from sprung.cli import page as page
from sprung.cli import recordings as recordings
from sprung.cli import riding as riding
from sprung.cli import studies as studies
from sprung.cli.app import app
from sprung.cli.help_text import readable
from sprung.cli.output import BAD_INPUT, DEFECT, INTERRUPTED, complain
from sprung.cli.signals import interruption_of, report_stop, sigterm_as_exception
from sprung.errors import SprungError

_TOO_LARGE = (
    "sprung has not enough memory for this input. Cut the recordings to a few seconds before and after each drop, lower their "
    "sampling rate to 1000 Hz, or use a machine with more memory. Nothing was written."
)

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Environment variables with the number of threads of NumPy's libraries, read when NumPy is imported."""


def main() -> None:
    """Run the command line; exit status 0, 1, 2 or 3 as documented, 130 on Ctrl-C, 143 on SIGTERM."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal without ² must still show the numbers
    with sigterm_as_exception():
        _run()


def _run() -> None:
    for variable in _THREADS:  # matrices are small: more threads are slower
        os.environ.setdefault(variable, "1")
    try:
        app(prog_name="sprung")
    except SystemExit as leaving:
        if leaving.code == INTERRUPTED and (stopped := interruption_of(leaving)) is not None:
            raise SystemExit(report_stop(stopped)) from None
        raise
    except KeyboardInterrupt as stopped:
        raise SystemExit(report_stop(stopped)) from None
    except SprungError as error:
        complain(readable(f"{_headline(error)}\n{error}"))
        raise SystemExit(BAD_INPUT) from None
    except MemoryError:
        complain(readable(_TOO_LARGE))
        raise SystemExit(BAD_INPUT) from None
    except Exception as error:
        complain(f"{traceback.format_exc()}\n{_report(error)}")
        raise SystemExit(DEFECT) from error


def _headline(error: SprungError) -> str:
    problems = getattr(error, "problems", ())
    return (
        "sprung cannot use this input:"
        if len(problems) < 2
        else f"sprung cannot use this input, {len(problems)} faults:"
    )


def _report(error: Exception) -> str:
    return (
        f"This is a defect of sprung, not of your input ({type(error).__name__}). Please report it to the developers with "
        "the lines above, the command and, if possible, the campaign."
    )

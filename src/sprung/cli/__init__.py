"""The command line: parse arguments, call, print, exit status; it computes nothing."""

from __future__ import annotations

import os
import sys
import traceback

from sprung.cli import identifying as identifying
from sprung.cli import measuring as measuring
from sprung.cli.app import app
from sprung.cli.helping import readable
from sprung.cli.output import BAD_INPUT, DEFECT, INTERRUPTED, complain
from sprung.cli.stopping import stopped_before, stopping_like_ctrl_c, was_stopped
from sprung.errors import SprungError

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Environment variables that set the number of threads of NumPy's libraries at import."""


def main() -> None:
    """Run the command line; exit status 0, 1, 2 or 3, 130 on Ctrl-C, 143 on SIGTERM."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal that knows no ² must still get the numbers
    with stopping_like_ctrl_c():
        _run()


def _run() -> None:
    for variable in _THREADS:  # every matrix is small: threads would only wait for each other
        os.environ.setdefault(variable, "1")
    try:
        app(prog_name="sprung")
    except SystemExit as leaving:
        if leaving.code == INTERRUPTED and (stopped := stopped_before(leaving)) is not None:
            raise SystemExit(was_stopped(stopped)) from None
        raise
    except KeyboardInterrupt as stopped:
        raise SystemExit(was_stopped(stopped)) from None
    except SprungError as error:
        complain(readable(f"{_headline(error)}\n{error}"))
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
        "the lines above, the command you gave and, if you may share it, the campaign."
    )

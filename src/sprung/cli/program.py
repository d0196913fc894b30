"""The program: all commands, and the exit statuses of their errors."""

from __future__ import annotations

import os
import traceback

# Importing these adds their commands.
from sprung.cli import batches, exports, identification, page, recordings, riding, studies  # noqa: F401
from sprung.cli.app import app
from sprung.cli.help_text import readable
from sprung.cli.output import BAD_INPUT, DEFECT, INTERRUPTED, REJECTED, complain
from sprung.cli.signals import interruption_of, report_stop
from sprung.errors import RejectedResultError, SprungError

__all__ = ["app", "run_program"]

_TOO_LARGE = (
    "sprung has not enough memory for this input. Cut the recordings to a few seconds before and after each drop, lower their "
    "sampling rate to 1000 Hz, or use a machine with more memory. Nothing was written."
)

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Environment variables with the number of threads of NumPy's libraries, read when NumPy is imported."""


def run_program() -> None:
    """Run the command of the arguments; exit with the status of its error."""
    for variable in _THREADS:  # matrices are small: more threads are slower
        os.environ.setdefault(variable, "1")
    try:
        app(prog_name="sprung")
    except SystemExit as leaving:
        if leaving.code == INTERRUPTED and (stopped := interruption_of(leaving)) is not None:
            raise SystemExit(report_stop(stopped)) from None
        raise
    except RejectedResultError as error:
        complain(readable(f"The result is rejected:\n{error}"))
        raise SystemExit(REJECTED) from None
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

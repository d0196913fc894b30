"""Output and exit statuses of the commands: results on standard output, everything else on standard error."""

from __future__ import annotations

import io
import json
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from sprung.progress import Progress, Step

if TYPE_CHECKING:
    from rich.text import Text

# rich is imported where a terminal shows the progress: without it, an interruption is reported from the first moment on.

DEFECT = 1
BAD_INPUT = 2
REJECTED = 3
INTERRUPTED = 130
TERMINATED = 143
"""Exit statuses; the last two are those of shells for Ctrl-C and SIGTERM."""

PROGRESS_VARIABLE = "SPRUNG_PROGRESS"
"""Environment variable; with the value ``json`` every step is one line of JSON on standard error."""

_SOON = 2.0
"""Time after which the remaining time of a stage is estimated, s."""


@contextmanager
def working(first: str) -> Iterator[Progress]:
    """Show the current step and the elapsed time in one line of a terminal; nothing in a pipe or file, unless it is asked for.

    Parameters
    ----------
    first
        Name of the first step.

    Yields
    ------
    Progress
        To call with each step that begins.
    """
    if os.environ.get(PROGRESS_VARIABLE) == "json":
        _report_step(Step(first))
        yield _report_step
        return
    from rich.console import Console  # noqa: PLC0415 (see above)
    from rich.live import Live  # noqa: PLC0415

    console = Console(stderr=True)
    line = StatusLine(Step(first))
    if not console.is_terminal:
        yield line.show_step
        return
    with Live(
        line, console=console, transient=True, refresh_per_second=4, redirect_stdout=False, redirect_stderr=False
    ):
        yield line.show_step


def _report_step(step: Step) -> None:
    """Print a step for another program."""
    document = {"text": str(step), "stage": step.stage, "step": step.step, "of": step.of, "done": step.done}
    complain(json.dumps({"progress": document}))


class StatusLine:
    """The status line: elapsed time, estimated remaining time of the stage, and current step."""

    def __init__(self, first: Step, clock: Callable[[], float] = time.monotonic) -> None:
        from rich.spinner import Spinner  # noqa: PLC0415 (see above)

        self._clock = clock
        self._began = self._stage_began = clock()
        self._step = first
        self._spinner = Spinner("dots")

    def show_step(self, step: Step) -> None:
        """Begin a step."""
        if step.stage != self._step.stage:
            self._stage_began = self._clock()
        self._step = step

    def text(self) -> str:
        """Return the line without the spinner."""
        now = self._clock()
        elapsed, in_stage, done = _minutes(now - self._began), now - self._stage_began, self._step.done
        if done is None or not 0 < done < 1 or in_stage < _SOON:
            return f"{elapsed} {self._step}"
        return f"{elapsed} (about {_minutes(in_stage * (1 - done) / done)} more) {self._step}"

    def __rich__(self) -> Text:
        from rich.text import Text  # noqa: PLC0415 (see above)

        frames = self._spinner.frames
        frame = frames[int(8 * self._clock()) % len(frames)]
        return Text(f"{frame} {self.text()}", no_wrap=True, overflow="ellipsis")


def _minutes(seconds: float) -> str:
    whole = round(seconds)
    return f"{whole // 60}:{whole % 60:02d}"


def say(text: str) -> None:
    """Print text to standard output; a closed pipe, as with `| head`, is no error."""
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        # The rest of the buffer would fail again at the end of the program: it is discarded.
        with suppress(OSError, io.UnsupportedOperation):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def say_json(document: str | Any) -> None:
    """Print one JSON document in UTF-8; text is printed as it is."""
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

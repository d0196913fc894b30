"""Quick work for tests of batches, importable by worker processes."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

from sprung.batch import Columns
from sprung.errors import InputError, Problem

COLUMNS: Columns = {"square": "number", "names": "texts", "process": "integer"}


def square(argument: float) -> dict[str, Any]:
    return {"square": argument**2, "names": ["a", "b"], "process": os.getpid()}


def slow_square(argument: tuple[float, float]) -> dict[str, Any]:
    number, seconds = argument
    time.sleep(seconds)
    return square(number)


def refuse_odd(argument: int) -> dict[str, Any]:
    if argument % 2:
        raise InputError([Problem("x", "odd", "even", "Add one.")])
    return square(argument)


def divide(argument: float) -> dict[str, Any]:
    return {"square": 1 / argument}


def die_on_13(argument: int) -> dict[str, Any]:
    if argument == 13:
        os.kill(os.getpid(), signal.SIGKILL)
    return square(argument)


def die_once(argument: tuple[int, str]) -> dict[str, Any]:
    number, mark = argument
    if number == 13 and not Path(mark).exists():
        Path(mark).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return square(number)


def printing(argument: int) -> dict[str, Any]:
    print("this must not disturb anything")  # noqa: T201 (that is the test)
    return square(argument)

"""Compilation of loops over time steps (Numba), kept on disk where there is a place for it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

_Function = TypeVar("_Function", bound=Callable[..., Any])

SOURCES = ("compiled_steps", "compiled_slopes", "compiled_changes", "force_laws", "kink_means", "law_table")
RECORDS = ("sensitivities", "stepping")
"""Modules with what is compiled, and with the records that it takes."""


def compiled(function: _Function) -> _Function:
    """Compile a function where it is first called, and keep it for other runs.

    It lets other threads run, divides by zero as NumPy does, and may add products without rounding between.
    """
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}}
    # What is kept is found by this name: Numba itself looks at one file alone, and fails where a record has moved.
    function.__qualname__ = f"{function.__qualname__}_{_digest()}"
    try:
        return cast(_Function, njit(function, cache=True, **options))
    except RuntimeError:  # neither the program's folder nor the user's can be written to
        return cast(_Function, njit(function, **options))


@cache
def _digest() -> str:
    """Return a digest of everything that is compiled, in twelve characters."""
    folder = Path(__file__).parent
    found = blake2b(digest_size=6)
    for path in (folder / f"{name}.py" for name in (*SOURCES, *RECORDS)):
        if path.exists():  # not where a program was packed without its sources
            found.update(path.read_bytes())
    return found.hexdigest()

"""Compilation of loops over time steps (Numba), kept on disk where there is a place for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

_Function = TypeVar("_Function", bound=Callable[..., Any])


def compiled(function: _Function) -> _Function:
    """Compile a function where it is first called, and keep it for other runs.

    It lets other threads run, divides by zero as NumPy does, and may add products without rounding between.
    """
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}}
    try:
        return cast(_Function, njit(function, cache=True, **options))
    except RuntimeError:  # neither the program's folder nor the user's can be written to
        return cast(_Function, njit(function, **options))

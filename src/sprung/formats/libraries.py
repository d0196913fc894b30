"""Libraries that only one format needs: loaded when its file is met, named with their remedy where they are missing."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from sprung.errors import InputError, Problem

if TYPE_CHECKING:
    from pathlib import Path


def load_library(module: str, extra: str, path: Path) -> Any:
    """Load the library that reads a file.

    Parameters
    ----------
    module
        What to import, ``asammdf``.
    extra
        The extra of this package that installs it, ``mdf``.
    path
        The file that was met.

    Returns
    -------
    module

    Raises
    ------
    InputError
        If the library is not installed.
    """
    try:
        return import_module(module)
    except ImportError as error:
        found = f"a file that the library {module.partition('.')[0]} reads, which is not installed ({error})"
        do = f'Install it with: pip install "sprung[{extra}]"'
        raise InputError([Problem(path.name, found, "a file that this installation can read", do)]) from error

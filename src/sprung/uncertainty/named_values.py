"""Quantities by name, with the nearest name in the error for an unknown one."""

from __future__ import annotations

from typing import TypeVar

from sprung.display import shown
from sprung.errors import UnknownNameError

Value = TypeVar("Value")


@shown
class NamedValues(dict[str, Value]):
    """A dictionary by name; an unknown name raises `UnknownNameError`, a `KeyError` that states the nearest name."""

    def __missing__(self, name: object) -> Value:
        raise UnknownNameError(str(name), self)

"""Quantities by name, where a misspelt name is answered with the one that was probably meant."""

from __future__ import annotations

from typing import TypeVar

from sprung.display import shown
from sprung.errors import UnknownNameError

Value = TypeVar("Value")


@shown
class Named(dict[str, Value]):
    """A dictionary by name; a name that is not in it raises `UnknownNameError`, a `KeyError` that says which one is near."""

    def __missing__(self, name: object) -> Value:
        raise UnknownNameError(str(name), self)

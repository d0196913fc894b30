"""Marks of the cases of a test: some run always, the others in the long set."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest
from exported_vehicles import USUAL


def all_the_others_are_long(names: Iterable[str]) -> list[Any]:
    """Return the names of vehicles as parameters of a test, marked as long where they are not among the usual ones."""
    return [name if name in USUAL else pytest.param(name, marks=pytest.mark.long) for name in names]

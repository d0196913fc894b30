"""What an export is asked for: the load, and a vehicle that can be written."""

from __future__ import annotations

from sprung.vehicle import EMPTY, Load


def resolve_load(load: Load | None) -> Load:
    """Return the load that is meant: the empty vehicle where none is given."""
    return EMPTY if load is None else load

"""Decays: the part of each drop in which the free-vibration model holds, and the faults that were met on the way."""

from sprung.prepare.decay import Decay
from sprung.prepare.prepare import Prepared, prepare
from sprung.prepare.release import Rest, no_rest, resolution

__all__ = ["Decay", "Prepared", "Rest", "no_rest", "prepare", "resolution"]

"""What may be wrong with one drop: one hypothesis per file, each held against the vehicle that explains the other drops."""

from sprung.faults.drop.brake import brake
from sprung.faults.drop.channel import channel_of_drop
from sprung.faults.drop.clock import clock
from sprung.faults.drop.columns import exchanged_columns
from sprung.faults.drop.deletion import DropDeletion
from sprung.faults.drop.load import other_load
from sprung.faults.drop.unlike import unlike_repeats

DROP_HYPOTHESES = (other_load, unlike_repeats, brake, clock, channel_of_drop, exchanged_columns)
"""Each takes a `DropDeletion` and yields hypotheses."""

CONTRADICTING = frozenset({"brake", "unlike-repeats"})
"""Codes of drops that are left out because they contradict all others."""

__all__ = ["CONTRADICTING", "DROP_HYPOTHESES", "DropDeletion"]

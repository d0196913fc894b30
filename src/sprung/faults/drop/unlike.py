"""A drop that contradicts all others."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.errors import Fault
from sprung.faults.drop.brake import residual_with_free
from sprung.faults.drop.deletion import DropDeletion
from sprung.faults.hypothesis import Hypothesis


def unlike_repeats(deletion: DropDeletion) -> Iterator[Hypothesis]:
    """Let every parameter be another one in this drop."""
    names = deletion.candidate.fit.names
    yield deletion.left_out(unlike_fault(deletion.name), residual_with_free(deletion, names), len(names))


def unlike_fault(recording: str) -> Fault:
    """Return the fault of a drop that contradicts all others, by its recording."""
    what = "the drop contradicts all other drops, which agree with each other; it is left out"
    do = "Record the drop again; if other drops agree with this one, leave the rest out instead."
    return Fault("unlike-repeats", recording, what, do)

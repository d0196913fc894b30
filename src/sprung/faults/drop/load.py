"""A drop that had another load than is stated."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from sprung.errors import Fault
from sprung.faults.correction import relabel_loads
from sprung.faults.drop.deletion import DropDeletion
from sprung.faults.hypothesis import Hypothesis


def other_load(deletion: DropDeletion) -> Iterator[Hypothesis]:
    """State each other load for the drop."""
    stated = deletion.decay.load
    for load in deletion.candidate.models:
        if load == stated:
            continue
        what = f"the drop moves like one with load '{load}', not '{stated}'; it is taken for one with '{load}'"
        fault = Fault("load-exchanged", deletion.name, what, "Correct load = ... of this drop in the campaign file.")
        residual = deletion.candidate.fit.residual_sums_of([replace(deletion.decay, load=load)])[0]
        correction = relabel_loads({deletion.name: load})
        yield Hypothesis(fault, "corrected", correction, deletion.table(residual), deletion.candidate)

"""A recording in which two channels are exchanged."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from sprung.errors import Fault
from sprung.faults.correction import exchange_columns, with_exchanged
from sprung.faults.drop.deletion import DropDeletion
from sprung.faults.hypothesis import Hypothesis


def exchanged_columns(deletion: DropDeletion) -> Iterator[Hypothesis]:
    """Exchange each two channels of the drop."""
    pairs = list(combinations(np.flatnonzero(deletion.counts).tolist(), 2))
    if not pairs:
        return
    sensors = deletion.base.campaign.sensors
    residuals = deletion.candidate.fit.residual_sums_of([with_exchanged(deletion.decay, *pair) for pair in pairs])
    for pair, residual in zip(pairs, residuals, strict=True):
        names = ", ".join(sensors[channel].channel for channel in pair)
        what = "the two channels are exchanged in this drop, as the other drops show; corrected"
        fault = Fault("exchanged", f"{deletion.name}: {names}", what, "Exchange the two columns of this recording.")
        correction = exchange_columns(*pair, deletion.name)
        yield Hypothesis(fault, "corrected", correction, deletion.table(residual), deletion.candidate)

"""Two channels that are exchanged in all drops."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from sprung.errors import Fault
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.correction import exchange_channels
from sprung.faults.hypothesis import Hypothesis


def exchanged_channels(base: CandidateFit) -> Iterator[Hypothesis]:
    """Exchange each two channels; the residuals follow from a few steps."""
    sensors = base.campaign.sensors
    used = np.flatnonzero(base.table.counts.any(axis=0)).tolist()
    for first, second in combinations(used, 2):
        if sensors[first].on == sensors[second].on != "body":
            continue
        names = f"{sensors[first].channel}, {sensors[second].channel}"
        what = "the two channels are exchanged, as the fit of all channels shows; corrected"
        fault = Fault("exchanged", names, what, "Exchange the two in the campaign file, or their cables.")
        correction = exchange_channels(first, second, sensors)
        candidate = base.estimate(correction)
        yield Hypothesis(fault, "corrected", correction, candidate.table, candidate, is_gross=True)

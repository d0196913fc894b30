"""Loads that are stated for the wrong drops."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from sprung.errors import Fault
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.correction import relabel_loads
from sprung.faults.hypothesis import Hypothesis

_ROUNDS = 4

_DO = "Correct load = ... of these drops in the campaign file."


def exchanged_loads(base: CandidateFit) -> Iterator[Hypothesis]:
    """Exchange the loads of all drops, and those of the drops that another load explains better."""
    stated = {decay.file: decay.load for decay in base.decays}
    loads = sorted(set(stated.values()))
    if len(loads) < 2:
        return
    if len(loads) == 2:
        opposite = dict(zip(loads, loads[::-1], strict=True))
        correction = relabel_loads({file: opposite[load] for file, load in stated.items()})
        # The vehicle becomes another one altogether, to which few steps from the present one or a direct estimate do not lead.
        candidate = base.estimate(correction) if base.is_explained else base.refit(correction)
        what = f"loads '{loads[0]}' and '{loads[1]}' are exchanged in all drops; corrected"
        fault = Fault("load-exchanged", f"all drops, {loads[0]} and {loads[1]}", what, _DO)
        yield Hypothesis(fault, "corrected", correction, candidate.table, candidate)
    labels, candidate = stated, base
    for _ in range(_ROUNDS):
        better = _most_likely_loads(base, candidate, loads)
        if better == labels or len(set(better.values())) < 2:
            break
        labels = better
        candidate = base.step(relabel_loads(labels), candidate.fit)
    moved = {file: load for file, load in labels.items() if load != stated[file]}
    if moved and len(moved) < len(stated):
        yield Hypothesis(loads_fault(moved), "corrected", relabel_loads(moved), candidate.table, candidate)


def loads_fault(recordings: Iterable[str]) -> Fault:
    """Return the fault of drops whose loads are exchanged, by their recordings."""
    what = "these drops move as if their loads were exchanged; corrected"
    return Fault("load-exchanged", ", ".join(recordings), what, _DO)


def _most_likely_loads(base: CandidateFit, candidate: CandidateFit, loads: list[str]) -> dict[str, str]:
    """Return for each drop the load with which this vehicle explains it best."""
    decays, weights = base.decays, candidate.fit.weights
    costs = [
        candidate.fit.residual_sums_of([replace(decay, load=load) for decay in decays]) @ weights for load in loads
    ]
    return {decay.file: loads[int(best)] for decay, best in zip(decays, np.argmin(costs, axis=0), strict=True)}

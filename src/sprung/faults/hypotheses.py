"""Hypotheses: one thing that may be wrong, what would put it right, and what that would leave unexplained."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sprung.errors import Fault
from sprung.faults.bench import CandidateFit
from sprung.faults.changes import Change
from sprung.faults.fault_scores import FaultScore
from sprung.faults.tally import ResidualTable

Remedy = Literal["repaired", "left out", "named"]
"""Put right in the campaign; taken out of it; or nothing of the kind, only told."""


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One thing that may be wrong.

    Attributes
    ----------
    fault
        What it would be called.
    remedy
        What would be done about it.
    change
        Does it to a campaign.
    tally
        What is left of all samples if it holds.
    trial
        The campaign fitted after the change.
    free
        How many numbers it takes from the records.
    drop
        The recording that is left out altogether; None where none is.
    specific
        Whether it says what is wrong, not only that something is.
    settle
        Gives the same with its numbers where the scores of a better fit would have them; None where it has none.
    """

    fault: Fault
    remedy: Remedy
    change: Change
    tally: ResidualTable
    trial: CandidateFit
    free: int = 0
    drop: str | None = None
    specific: bool = True
    settle: Callable[[Sequence[FaultScore]], Hypothesis] | None = None

    def score(self, inflation: float) -> float:
        """Give its cost and what its free numbers cost (Schwarz, Ann. Stat. 6 (1978) 461); the least is the best."""
        return self.tally.cost / inflation + self.free * float(np.log(max(self.tally.counts.sum(), 1.0)))

"""Hypotheses: one thing that may be wrong, what corrects it, and which residuals the correction leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from sprung.errors import Fault
from sprung.estimation import FitResult
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.consistency import SIGNIFICANT
from sprung.faults.correction import Correction
from sprung.faults.fault_scores import FaultScore
from sprung.faults.residual_table import ResidualTable

Remedy = Literal["corrected", "left out", "named"]
"""Corrected in the campaign; left out of it; or only named."""


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One thing that may be wrong.

    Attributes
    ----------
    fault
        What it is called.
    remedy
        What is done about it.
    correction
        Does it to a campaign.
    table
        The residuals of all samples if it holds.
    candidate
        The fit from which they follow.
    free
        How many numbers are estimated from the recordings beside the parameters.
    recording
        The recording that is left out altogether; None where none is.
    is_specific
        Whether it says what is wrong, not only where.
    is_fitted
        Whether the residuals are those of a fit, and not only predicted.
    score_gain
        What a fit gains beyond the residuals of the table by a score test, in twice the log-likelihood.
    is_beyond_prior
        Whether its numbers lie beyond what the campaign states of a sensor with an uncertainty.
    is_sufficient
        Whether it explains the recordings wholly, with those accepted before it: it leaves noise, or something at its own place
        that is perhaps gone once the corrected recordings are preprocessed again; or is gross.
    is_gross
        Whether nothing that a vehicle may have passes for it: it is evident although the model leaves a part of the misfit.
    required
        Gain in twice the log-likelihood that it needs by the error budget.
    is_refuting
        Whether no vehicle recorded all of this if it holds, whatever terms its model has.
    doubt
        What may be wrong instead, where nothing tells which it is, and what follows from that; None where nothing is.
    """

    fault: Fault
    remedy: Remedy
    correction: Correction
    table: ResidualTable
    candidate: CandidateFit
    free: int = 0
    recording: str | None = None
    is_specific: bool = True
    is_fitted: bool = False
    score_gain: float = 0.0
    is_beyond_prior: bool = False
    is_sufficient: bool = False
    is_gross: bool = False
    required: float = SIGNIFICANT
    is_refuting: bool = False
    doubt: Fault | None = None

    @property
    def is_explained(self) -> bool:
        """Whether the residuals are noise alone if it holds."""
        return self.table.is_explained(self.candidate.noise)

    @property
    def remaining_gain(self) -> float:
        """What its own numbers still gain after its fit by their score test, in twice the log-likelihood."""
        return 0.0

    @property
    def first_order(self) -> str:
        """Code of the fault that it is to the first order of its size: its own."""
        return self.fault.code

    @property
    def law(self) -> int:
        """Of several laws that have the same code, which one it is."""
        return 0

    def confirm(self, base: CandidateFit, near: FitResult | None = None) -> tuple[Hypothesis | None, int]:
        """Fit the campaign with the correction.

        Parameters
        ----------
        base
            The fit of the campaign as it is.
        near
            The fit of a campaign that was corrected almost as well, from which some steps are enough.

        Returns
        -------
        hypothesis
            With the residuals of that fit; None where nothing is wrong after all.
        fits
            How many were made.
        """
        if self.remedy != "corrected":
            return self, 0
        candidate, fits = fit_corrected(base, self.correction, self.candidate.fit, near)
        return replace(self, table=candidate.table, candidate=candidate, is_fitted=True, score_gain=0.0), fits

    def settled(self, scores: Sequence[FaultScore]) -> tuple[Hypothesis, Correction] | None:  # noqa: ARG002 (one form for all)
        """Return the hypothesis with its numbers where the scores of a better fit have them, and the correction by the change.

        Parameters
        ----------
        scores
            Of all faults of small size in that fit.

        Returns
        -------
        tuple or None
            None where it has no numbers, or where they are there already.
        """
        return None

    def score(self, overdispersion: float = 1.0) -> float:
        """Return the information criterion (Schwarz, Ann. Stat. 6 (1978) 461); the smallest is the best.

        Parameters
        ----------
        overdispersion
            Factor on every variance, dimensionless.
        """
        cost = self.table.inflated_cost(overdispersion)
        gain = self.score_gain / (1.0 if self.is_beyond_prior else overdispersion)
        # A number with a stated uncertainty is no free one: the samples do not determine it alone.
        free = 0 if self.is_beyond_prior else self.free
        return cost - gain + free * float(np.log(max(self.table.counts.sum(), 1.0)))

    def overlaps(self, other: Hypothesis) -> bool:
        """Whether two hypotheses are about a common drop or channel.

        Parameters
        ----------
        other
            Another hypothesis.
        """
        own, others = (set(each.fault.where.replace(": ", ", ").split(", ")) for each in (self, other))
        return bool(own & others)

    def concerns_same(self, other: Hypothesis) -> bool:
        """Whether two hypotheses are about the same place, or one is among several of which the other says the same."""
        if self.fault.where == other.fault.where:
            return True
        own, others = (frozenset(each.fault.where.split(", ")) for each in (self, other))
        return self.fault.code == other.fault.code and (own <= others or others <= own)


def fit_corrected(
    base: CandidateFit, correction: Correction, start: FitResult, near: FitResult | None
) -> tuple[CandidateFit, int]:
    """Fit a corrected campaign, and say how many fits that were: some steps from a fit near by are none."""
    return (base.refit(correction, start), 1) if near is None else (base.refine(correction, near), 0)


def best_of(hypotheses: Sequence[Hypothesis], alike: float) -> Hypothesis:
    """Return the most likely hypothesis; of those of one place that are alike, the one with the fewest free numbers.

    Parameters
    ----------
    hypotheses
        At least one.
    alike
        Difference in twice the log-likelihood up to which two explain the recordings about as well.
    """
    best = min(hypotheses, key=lambda hypothesis: hypothesis.score())
    same = [
        hypothesis
        for hypothesis in hypotheses
        if hypothesis.fault.where == best.fault.where and hypothesis.score() < best.score() + alike
    ]
    return min(same, key=lambda hypothesis: (hypothesis.free, hypothesis.score()))

"""A drop beside the vehicle that was fitted to all other drops."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.correction import Correction, exclude_drops
from sprung.faults.hypothesis import Hypothesis
from sprung.faults.residual_table import ResidualTable
from sprung.preprocess import FreeDecay

Real = NDArray[np.float64]

DropKind = Callable[["DropDeletion"], Iterator[Hypothesis]]
"""Yields hypotheses about a drop that is left out."""


@dataclass(frozen=True, eq=False)
class DropDeletion:
    """A drop that is left out of a fit.

    Attributes
    ----------
    base
        The fit with it.
    drop
        Index of the drop among the recordings of that fit.
    candidate
        The fit without it.
    kinds
        What yields hypotheses about it.
    """

    base: CandidateFit
    drop: int
    candidate: CandidateFit
    kinds: Sequence[DropKind] = ()

    @property
    def decay(self) -> FreeDecay:
        """Of the drop."""
        return next(decay for decay in self.base.decays if decay.file == self.name)

    @property
    def name(self) -> str:
        """Of the drop's recording."""
        return self.base.recordings[self.drop]

    @property
    def correction(self) -> Correction:
        """Leaves the drop out."""
        return exclude_drops(self.name)

    @property
    def counts(self) -> Real:
        """Samples of the drop by channel; shape (channel,)."""
        counts: Real = self.base.table.counts[self.drop]
        return counts

    @cached_property
    def limit(self) -> ResidualTable:
        """The residuals if the drop leaves as much per sample as the others do."""
        table = self.candidate.table
        variance = table.residual.sum(axis=0) / np.maximum(table.counts.sum(axis=0), 1)
        return self.table(variance * self.counts)

    def hypotheses(self) -> Iterator[Hypothesis]:
        """Yield what may be wrong with the drop, each with the residuals that it predicts.

        None if it is the only one with its load: of that the others say nothing.
        """
        for kind in self.kinds if self.decay.load in self.candidate.models else ():
            yield from kind(self)

    def table(self, residual: Real, counts: Real | None = None) -> ResidualTable:
        """Return the residuals of all drops, given those of this one; both of shape (channel,)."""
        counts = self.counts if counts is None else counts
        known = np.where(counts > 0, residual, 0.0)
        return self.candidate.table.with_part([self.drop], range(len(counts)), known[None], counts[None])

    def left_out(self, fault: Fault, residual: Real, free: int) -> Hypothesis:
        """Return the hypothesis that the drop is left out for a reason with which it would leave these residuals."""
        return Hypothesis(fault, "left out", self.correction, self.table(residual), self.candidate, free, self.name)

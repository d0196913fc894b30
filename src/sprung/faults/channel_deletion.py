"""A channel beside the vehicle that was fitted to all other channels."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.estimation import FitResult
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.channel import CHANNEL_HYPOTHESES, channel_hypotheses
from sprung.faults.channel.hypothesis import ChannelHypothesis, Numbers
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.faults.consistency import NEGLIGIBLE
from sprung.faults.correction import Correction, mask_channel
from sprung.faults.fault_scores import FaultScore
from sprung.faults.hypothesis import Hypothesis, fit_corrected
from sprung.faults.residual_table import ResidualTable

Real = NDArray[np.float64]

_LONGEST_STEP = {"gain": 0.5, "late": 0.01, "position": 1.0, "corner": 1.0}
"""By how much a number changes at once: a relative gain, s, m and Hz."""

_SHARE = 0.5
"""Share of a channel's energy beyond its noise that a hypothesis may leave for the vehicle to be fitted with it."""

_SHIFT = 1.0
"""Shift of a parameter with one standard uncertainty of a number, in its own, from which the channel is left out instead."""

_CONVERGED = 0.1
"""Gain in twice the log-likelihood below which the numbers have converged."""

_HALF = 0.5
"""Share of a misfit that a hypothesis from a score test may leave after its first fit."""

_ROUNDS = 3
"""How often the numbers of a hypothesis follow a score test, and the parameters the numbers by some steps."""


@dataclass(frozen=True, eq=False)
class ChannelDeletion:
    """A channel that is left out of a fit.

    Attributes
    ----------
    base
        The fit with it.
    channel
        Index of the channel.
    candidate
        The fit without it.
    """

    base: CandidateFit
    channel: int
    candidate: CandidateFit

    @property
    def name(self) -> str:
        """Of the channel."""
        return self.base.campaign.sensors[self.channel].channel

    @property
    def correction(self) -> Correction:
        """Leaves the channel out."""
        return mask_channel(self.channel)

    @cached_property
    def prediction(self) -> ChannelPrediction:
        """The channel beside the motion of that vehicle."""
        states = dict(zip((decay.file for decay in self.candidate.decays), self.candidate.fit.states, strict=True))
        decays = [decay for decay in self.base.decays if decay.usable[self.channel] and decay.file in states]
        drifts = bool(self.base.drifting[self.channel])
        return ChannelPrediction(
            self.candidate, self.channel, decays, np.array([states[decay.file] for decay in decays]), drifts
        )

    @cached_property
    def limit(self) -> ResidualTable:
        """The residuals of all channels if this one measures any part of the motion, with any delay, or drifts."""
        moving = self.table(self.prediction.least_residual)
        if not self.prediction.drifts:
            return moving
        residual, _ = self.prediction.drift
        return min(moving, self.table(residual), key=lambda table: table.cost)

    def table(self, residual: Real) -> ResidualTable:
        """Return the residuals of all channels, given those of this one in each of its decays, shape (decay,)."""
        rows = [self.base.recordings.index(decay.file) for decay in self.prediction.decays]
        counts = self.base.table.counts[rows][:, [self.channel]]
        return self.candidate.table.with_part(rows, [self.channel], residual[:, None], counts)

    def recorded_residual(
        self, candidate: CandidateFit, recorded: Callable[[Real, float, Numbers], float], numbers: Numbers
    ) -> Real:
        """Return the residual of the recorded channel, in each drop of a fit of corrected samples, shape (drop, 1)."""
        residual = np.zeros((len(self.base.recordings), 1))
        for decay, record in zip(candidate.decays, candidate.fit.residuals, strict=True):
            if decay.usable[self.channel]:
                drop = self.base.recordings.index(decay.file)
                residual[drop] = recorded(record[self.channel], decay.rate, numbers)
        return residual

    def hypotheses(self) -> Iterator[Hypothesis]:
        """Yield what may be wrong with the channel, each with the residuals that it predicts."""
        noise = float(self.base.noise.level[self.channel])
        for hypothesis in channel_hypotheses(self.prediction, noise):
            if hypothesis.correction is None:
                yield self._left_out(hypothesis)
            elif self._explains_much(hypothesis) and _is_relevant(hypothesis):
                yield ChannelCorrection.of(self, hypothesis, hypothesis.correction, hypothesis.numbers)

    def _explains_much(self, hypothesis: ChannelHypothesis) -> bool:
        """Whether a hypothesis leaves little of what the channel reads beyond its noise."""
        noise = self.base.noise.level[self.channel] ** 2 * self.prediction.record.size
        return bool(hypothesis.residual.sum() - noise < _SHARE * (self.prediction.energy - noise))

    def scored(self, scores: Sequence[FaultScore]) -> Iterator[ChannelCorrection]:
        """Yield the corrections whose numbers follow from score tests at the present fit.

        Parameters
        ----------
        scores
            Of all faults of small size.
        """
        for kind in CHANNEL_HYPOTHESES:
            for hypothesis in kind(self.prediction):
                own = self.scores_of(hypothesis, scores)
                if own and hypothesis.correction is not None and hypothesis.stated:
                    numbers = improved(hypothesis, hypothesis.stated, own)
                    if not hypothesis.allows(numbers):
                        continue
                    correction = ChannelCorrection.of(
                        self, hypothesis, hypothesis.correction, numbers, candidate=self.base
                    )
                    gain = sum(score.gain for score in own)
                    yield replace(
                        correction,
                        table=self.base.table,
                        score_gain=gain,
                        is_beyond_prior=own[0].is_beyond_prior,
                        required=own[0].required,
                    )

    def scores_of(self, hypothesis: ChannelHypothesis, scores: Sequence[FaultScore]) -> list[FaultScore]:
        """Return the scores of the numbers of a hypothesis about the channel, in their order."""
        kind = hypothesis.scored_as, self.name
        return sorted((score for score in scores if (score.kind, score.where) == kind), key=lambda score: score.axis)

    def _left_out(self, hypothesis: ChannelHypothesis) -> Hypothesis:
        fault = with_action(hypothesis.fault((), ()), "it is left out")
        return Hypothesis(
            fault,
            "left out",
            self.correction,
            self.table(hypothesis.residual),
            self.candidate,
            hypothesis.free,
            is_specific=hypothesis.code != "unlike-others",
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class ChannelCorrection(Hypothesis):
    """The hypothesis that a channel is put right by a correction, whose numbers follow from the recordings.

    Attributes
    ----------
    deletion
        The channel left out.
    hypothesis
        What the channel measures.
    correct
        Returns the correction for the numbers.
    numbers
        Their present values.
    """

    deletion: ChannelDeletion
    hypothesis: ChannelHypothesis
    correct: Callable[[Numbers], Correction]
    numbers: Numbers = ()

    @classmethod
    def of(
        cls,
        deletion: ChannelDeletion,
        hypothesis: ChannelHypothesis,
        correct: Callable[[Numbers], Correction],
        numbers: Numbers,
        stds: Numbers = (),
        candidate: CandidateFit | None = None,
        is_fitted: bool = False,
    ) -> ChannelCorrection:
        """Correct a channel; without a candidate fit the residuals are those predicted."""
        if candidate is None:
            table = deletion.table(hypothesis.residual)
        else:
            # The residuals count in the units of the channel as it was recorded.
            rows, counts = range(len(deletion.base.recordings)), candidate.table.counts[:, [deletion.channel]]
            residual = hypothesis.reading(numbers) ** 2 * candidate.table.residual[:, [deletion.channel]]
            if hypothesis.recorded is not None and candidate is not deletion.base:
                residual = deletion.recorded_residual(candidate, hypothesis.recorded, numbers)
            table = candidate.table.with_part(rows, [deletion.channel], residual, counts)
        return cls(
            with_action(hypothesis.fault(numbers, stds), "corrected"),
            "corrected",
            correct(numbers),
            table,
            candidate or deletion.candidate,
            len(numbers),
            is_fitted=is_fitted,
            deletion=deletion,
            hypothesis=hypothesis,
            correct=correct,
            numbers=numbers,
        )

    @property
    def remaining_gain(self) -> float:
        """What its own numbers still gain after its fit by their score test, in twice the log-likelihood."""
        return sum(score.gain for score in self.deletion.scores_of(self.hypothesis, self.candidate.scores))

    @property
    def first_order(self) -> str:
        """Code of the fault that it is to the first order of its size: a low-pass is a delay."""
        return self.hypothesis.scored_as

    @property
    def law(self) -> int:
        """Of several laws that have the same code, which one it is."""
        return self.hypothesis.law

    def confirm(self, base: CandidateFit, near: FitResult | None = None) -> tuple[Hypothesis | None, int]:
        """Fit the campaign with the channel corrected, and its numbers along with it.

        Parameters
        ----------
        base
            The fit of the campaign as it is.
        near
            The fit of a campaign that was corrected almost as well, from which some steps are enough.

        Returns
        -------
        hypothesis
            None where the channel is what is stated; the channel left out where the parameters depend on its numbers.
        fits
            How many were made.
        """
        deletion, hypothesis = self.deletion, self.hypothesis
        numbers, scores = self.numbers, list[FaultScore]()
        candidate, fits = fit_corrected(base, self.correction, self.candidate.fit, near)
        explains = self.is_beyond_prior or candidate.misfit <= _HALF * base.misfit
        if self.score_gain > 0 and not explains:
            return None, fits  # the score test was made too far away
        for _ in range(_ROUNDS if numbers else 0):
            scores = deletion.scores_of(hypothesis, candidate.scores)
            if all(score.gain < _CONVERGED for score in scores):
                break
            before, numbers = numbers, improved(hypothesis, numbers, scores)
            if not hypothesis.allows(numbers):
                return None, fits
            # Where the residuals are noise already, the numbers are settled in the fit of all drops.
            if candidate.is_explained or numbers == before:
                break
            candidate = base.refine(self.correct(numbers), candidate.fit)
        if not _is_relevant(hypothesis, numbers) or not hypothesis.allows(numbers):
            return None, fits
        stds = tuple(score.std for score in scores)
        confirmed = replace(
            ChannelCorrection.of(deletion, hypothesis, self.correct, numbers, stds, candidate, is_fitted=True),
            is_beyond_prior=self.is_beyond_prior,
            required=self.required,
        )
        if max((score.max_parameter_shift for score in scores), default=0.0) < _SHIFT:
            return confirmed, fits
        fault = with_action(hypothesis.fault(numbers, stds), "it is left out")
        return Hypothesis(
            fault,
            "left out",
            deletion.correction,
            confirmed.table,
            deletion.candidate,
            len(numbers),
            is_fitted=True,
        ), fits

    def settled(self, scores: Sequence[FaultScore]) -> tuple[Hypothesis, Correction] | None:
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
        own = self.deletion.scores_of(self.hypothesis, scores) if self.numbers else []
        if all(score.gain < _CONVERGED for score in own):
            return None
        numbers = improved(self.hypothesis, self.numbers, own)
        if not self.hypothesis.allows(numbers):
            return None
        stds = tuple(score.std for score in own)
        better = ChannelCorrection.of(self.deletion, self.hypothesis, self.correct, numbers, stds, self.candidate)
        if self.hypothesis.change is not None:
            return better, self.hypothesis.change(self.numbers, numbers)
        return better, self.correct(_change(self.hypothesis.code, self.numbers, numbers))


def _change(code: str, before: Numbers, after: Numbers) -> Numbers:
    """Return the numbers of a correction that leads from one with certain numbers to one with others."""
    if code == "gain":
        return (after[0] / before[0],)
    return (after[0] - before[0],) if code == "late" else after


def improved(hypothesis: ChannelHypothesis, numbers: Numbers, scores: Sequence[FaultScore]) -> Numbers:
    """Return the numbers of a hypothesis after one step by their scores."""
    values = {score.axis: score.value for score in scores}
    longest = _LONGEST_STEP.get(hypothesis.scored_as, 0.0)
    steps = tuple(float(np.clip(values.get(axis, 0.0), -longest, longest)) for axis in range(len(numbers)))
    if hypothesis.improve is not None:
        return hypothesis.improve(numbers, steps)
    unit = numbers[0] if hypothesis.code == "gain" else 1.0  # a score is of the gain that remains
    lowest = 0.0 if hypothesis.code == "corner" else -np.inf
    return tuple(max(number + unit * step, lowest) for number, step in zip(numbers, steps, strict=True))


def with_action(fault: Fault, action: str) -> Fault:
    """Return a fault with what was done about it."""
    return replace(fault, what=f"{fault.what}; {action}")


def _is_relevant(hypothesis: ChannelHypothesis, numbers: Numbers | None = None) -> bool:
    """Whether the numbers differ from the stated ones by more than is negligible."""
    if not hypothesis.stated:
        return True
    distance = np.abs(np.subtract(hypothesis.numbers if numbers is None else numbers, hypothesis.stated))
    return float(distance.max()) >= NEGLIGIBLE.get(hypothesis.code, 0.0)

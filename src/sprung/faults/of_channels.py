"""What is the matter with one channel: the vehicle fitted without it, and then with it as what it may be."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.faults.bench import Bench, CandidateFit
from sprung.faults.changes import Change, exchanged, silenced
from sprung.faults.fault_scores import FaultScore
from sprung.faults.heard import ChannelPrediction
from sprung.faults.hypotheses import Hypothesis
from sprung.faults.measured import ChannelFaultHypothesis, Numbers, meanings
from sprung.faults.suspicion import MATTERS
from sprung.faults.suspicion import scores as scores_of
from sprung.faults.tally import ResidualTable
from sprung.preprocess import FreeDecay

Real = NDArray[np.float64]

_ROUNDS = 4
"""Fits in which the numbers of a meaning settle."""

_SETTLED = 0.1
"""Gain in twice the log-likelihood below which they have settled."""

_PULLS = 1.0
"""Standard uncertainties by which a number may move a parameter with one of its own, for it to be taken from the records."""

_FARTHEST = {"gain": 0.5, "late": 0.01, "position": 1.0, "corner": 1.0}
"""By how much a number changes at once: a part, s, m and Hz."""

_TRIED = 3
"""Pairs of channels of which it is seen to the end whether they were exchanged."""

_PART = 0.5
"""Part of a channel's energy that a meaning may leave for it to be fitted."""


@dataclass(frozen=True, eq=False)
class WithoutChannel:
    """A channel left out.

    Attributes
    ----------
    channel
        Its position.
    trial
        The fit without it.
    heard
        The channel beside that vehicle's motion.
    """

    channel: int
    trial: CandidateFit
    heard: ChannelPrediction

    @classmethod
    def of(cls, bench: Bench, channel: int) -> WithoutChannel:
        """Fit without it."""
        silent = tuple(without(decay, channel) for decay in bench.decays)
        trial = bench.fit(silenced(channel)(bench.campaign), decays=tuple(one for one in silent if one.usable.any()))
        states = dict(zip((decay.file for decay in trial.decays), trial.optimum.states, strict=True))
        decays = [decay for decay in bench.decays if decay.usable[channel] and decay.file in states]
        return cls(
            channel, trial, ChannelPrediction(trial, channel, decays, np.array([states[one.file] for one in decays]))
        )

    def bound(self, bench: Bench) -> ResidualTable:
        """Tell what is left of everything, if the channel measures any part of the motion, or that late."""
        return self._tally(bench, self.heard.best)

    def hypotheses(self, bench: Bench) -> Iterator[Hypothesis]:
        """List what may be the matter with it."""
        out = silenced(self.channel)
        which = [bench.files.index(decay.file) for decay in self.heard.decays]
        walks = bench.base.tally.residual[which, self.channel] if bench.base.walking[self.channel] else None
        for one in meanings(self.heard, float(bench.noise.level[self.channel]), walks):
            if one.put_right is None:
                tally = self._tally(bench, one.residual)
                fault = _done(one.say((), ()), one.done)
                yield Hypothesis(fault, "left out", out, tally, self.trial, one.free, specific=one.code == "flat")
            elif one.residual.sum() < _PART * self.heard.energy:
                yield from self._with(bench, one, one.put_right)

    def _tally(self, bench: Bench, residual: Real) -> ResidualTable:
        """Tell what is left of everything, given what is left of the channel in each of its decays."""
        which = [bench.files.index(decay.file) for decay in self.heard.decays]
        counts = bench.base.tally.counts[which][:, [self.channel]]
        return self.trial.tally.of(which, [self.channel], residual[:, None], counts)

    def _with(
        self, bench: Bench, meaning: ChannelFaultHypothesis, put_right: Callable[[Numbers], Change]
    ) -> Iterator[Hypothesis]:
        """Fit the vehicle with the channel as what it may be, and its numbers along with it."""
        numbers, name = meaning.numbers, self.heard.sensor.channel
        trial = bench.fit(put_right(numbers)(bench.campaign), self.trial.optimum.parameters)
        mine: list[FaultScore] = []
        for _ in range(_ROUNDS if numbers else 0):
            listed = scores(trial)
            mine = [one for one in listed if (one.kind, one.where) == (meaning.code, name)]
            if all(one.gain < _SETTLED for one in mine):
                break
            numbers = moved(meaning.code, name, numbers, listed)
            trial = bench.fit(put_right(numbers)(bench.campaign), trial.optimum.parameters)
        away = np.abs(np.subtract(numbers, meaning.stated)) if meaning.stated else np.full(1, np.inf)
        if away.max() < MATTERS.get(meaning.code, 0.0):
            return
        rows, counts = range(len(bench.files)), trial.tally.counts[:, [self.channel]]
        residual = meaning.size(numbers) ** 2 * trial.tally.residual[:, [self.channel]]
        tally = trial.tally.of(rows, [self.channel], residual, counts)
        if max((one.pull for one in mine), default=0.0) < _PULLS:
            yield _repaired(meaning, put_right, numbers, mine, name, tally, trial)
        else:
            out, gone = silenced(self.channel), _done(meaning.say(numbers, _stds(mine)), "it is left out")
            yield Hypothesis(gone, "left out", out, tally, self.trial, len(numbers))


def moved(code: str, channel: str, numbers: Numbers, listed: Sequence[FaultScore]) -> Numbers:
    """Move a gain, a delay, a place or a corner to where its scores would have it."""
    steps = {one.axis: one.value for one in listed if (one.kind, one.where) == (code, channel)}
    unit = numbers[0] if code == "gain" else 1.0  # scores are of what is left of it
    most = _FARTHEST.get(code, 0.0)
    return tuple(
        number + unit * float(np.clip(steps.get(axis, 0.0), -most, most)) for axis, number in enumerate(numbers)
    )


def _stds(listed: Sequence[FaultScore]) -> Numbers:
    return tuple(one.std for one in sorted(listed, key=lambda one: one.axis))


def _repaired(
    meaning: ChannelFaultHypothesis,
    put_right: Callable[[Numbers], Change],
    numbers: Numbers,
    mine: Sequence[FaultScore],
    name: str,
    tally: ResidualTable,
    trial: CandidateFit,
) -> Hypothesis:
    def settle(listed: Sequence[FaultScore]) -> Hypothesis:
        of_it = [one for one in listed if (one.kind, one.where) == (meaning.code, name)]
        there = moved(meaning.code, name, numbers, listed)
        return _repaired(meaning, put_right, there, of_it or mine, name, tally, trial)

    fault, free = _done(meaning.say(numbers, _stds(mine)), meaning.done), len(numbers)
    again = settle if numbers else None
    return Hypothesis(fault, "repaired", put_right(numbers), tally, trial, free, settle=again)


def exchanges(bench: Bench) -> Iterator[Hypothesis]:
    """Exchange two channels, and fit those pairs to the end that explain most at once."""
    there = np.flatnonzero(bench.base.tally.counts.any(axis=0)).tolist()
    pairs = list(combinations(there, 2))
    rough = [bench.fit(exchanged(*pair)(bench.campaign), roughly=True).unexplained for pair in pairs]
    for i in np.argsort(rough, kind="stable")[:_TRIED].tolist():
        fault = Fault(
            "exchanged",
            ", ".join(bench.campaign.sensors[channel].channel for channel in pairs[i]),
            "changed about, they fit the vehicle and the other channels, which as recorded they do not; that was done",
            "Exchange the two in the campaign file, or their cables.",
        )
        change = exchanged(*pairs[i])
        trial = bench.fit(change(bench.campaign))
        yield Hypothesis(fault, "repaired", change, trial.tally, trial)


def scores(trial: CandidateFit) -> tuple[FaultScore, ...]:
    """List everything that may be a little otherwise where a trial ended, what would gain most first."""
    return scores_of(trial.campaign, trial.decays, trial.optimum)


def without(decay: FreeDecay, channel: int) -> FreeDecay:
    """Leave a channel out of a decay."""
    values = decay.values.copy()
    values[channel] = np.nan
    return replace(decay, values=values)


def _done(fault: Fault, done: str) -> Fault:
    return replace(fault, what=f"{fault.what}; {done}")

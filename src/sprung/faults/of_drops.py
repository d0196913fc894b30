"""What is the matter with one drop: held against a vehicle that was fitted without it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.estimation import NEAR, fit_linear
from sprung.faults.bench import Bench, CandidateFit
from sprung.faults.changes import exchanged, relabelled, silenced, without_drops
from sprung.faults.heard import ChannelPrediction
from sprung.faults.hypotheses import Hypothesis
from sprung.faults.measured import meanings
from sprung.faults.of_channels import without
from sprung.faults.tally import ResidualTable
from sprung.preprocess import FreeDecay
from sprung.uncertainty import KnownValue

Real = NDArray[np.float64]

_CLOCKS = np.linspace(-0.08, 0.08, 33)
"""Parts by which a clock may run fast."""

_CLOCK_MATTERS = 0.002

_AXLES = {"f": "front", "r": "rear"}


@dataclass(frozen=True, eq=False)
class WithoutDrop:
    """A drop left out.

    Attributes
    ----------
    drop
        Its position.
    trial
        The fit without it.
    decay
        The drop.
    """

    drop: int
    trial: CandidateFit
    decay: FreeDecay

    @classmethod
    def of(cls, bench: Bench, drop: int) -> WithoutDrop:
        """Fit without it."""
        file = bench.files[drop]
        others = tuple(one for one in bench.decays if one.file != file)
        trial = bench.fit(without_drops(file)(bench.campaign), decays=others)
        return cls(drop, trial, next(one for one in bench.decays if one.file == file))

    def bound(self, bench: Bench) -> ResidualTable:
        """Tell what is left of everything, if the drop leaves what the others do."""
        noise = self.trial.tally.residual.sum(axis=0) / np.maximum(self.trial.tally.counts.sum(axis=0), 1)
        return self._tally(bench, noise * bench.base.tally.counts[self.drop])

    def _tally(self, bench: Bench, residual: Real, there: Real | None = None) -> ResidualTable:
        """Tell what is left of everything, given what is left of the drop; both of shape (channel,)."""
        counts = bench.base.tally.counts[self.drop] if there is None else there
        known = np.where(counts > 0, residual, 0.0)
        return self.trial.tally.of([self.drop], range(len(counts)), known[None], counts[None])

    def hypotheses(self, bench: Bench) -> Iterator[Hypothesis]:
        """List what may be the matter with it."""
        yield from self._other_load(bench)
        out, file = without_drops(self.decay.file), self.decay.file
        for fault, left, free in (*self._other_vehicle(bench), *self._other_clock(bench)):
            yield Hypothesis(fault, "left out", out, self._tally(bench, left), self.trial, free, file)
        yield from self._one_channel(bench)
        yield from self._exchanges(bench)

    def _other_load(self, bench: Bench) -> Iterator[Hypothesis]:
        file = self.decay.file
        for load in self.trial.models:
            if load != self.decay.load:
                what = f"it moves like a drop with the load '{load}', not '{self.decay.load}'; it was taken for one"
                fault = Fault("load-exchanged", file, what, "Correct load = ... of this drop in the campaign file.")
                tally = self._tally(bench, self.trial.optimum.residual_sums_of([replace(self.decay, load=load)])[0])
                yield Hypothesis(fault, "repaired", relabelled({file: load}), tally, self.trial)

    def _other_vehicle(self, bench: Bench) -> Iterator[tuple[Fault, Real, int]]:
        file, names = self.decay.file, self.trial.optimum.names
        what = "it contradicts all other drops, which agree with each other; it is left out"
        do = "Record the drop again; if others are like it, leave the rest out instead."
        yield Fault("unlike-repeats", file, what, do), self._fitted(bench, names), len(names)
        for axle, name in _AXLES.items():
            what = f"its {name} suspension is another one than in all other drops, as if the brake had been on; it is left out"
            do = "Release the brakes, put the gear in neutral and record the drop again."
            yield Fault("brake", file, what, do), self._fitted(bench, (f"k_s{axle}", f"c_s{axle}")), 2

    def _fitted(self, bench: Bench, free: tuple[str, ...]) -> Real:
        """Give what is left of the drop by itself where some parameters may be others, shape (channel,)."""
        values = self.trial.optimum.parameters
        known = {name: KnownValue(value) for name, value in values.items() if name not in free}
        optimum = fit_linear([self.decay], self.trial.models, bench.campaign.sensors, known, start=values, enough=NEAR)
        left: Real = optimum.residual_sums[0]
        return left

    def _other_clock(self, bench: Bench) -> Iterator[tuple[Fault, Real, int]]:
        counts = bench.base.tally.counts[self.drop]
        there = counts > 0

        def left(by: list[float]) -> Real:
            return self.trial.optimum.residual_sums_of(
                [replace(self.decay, rate=self.decay.rate * (1 + one)) for one in by]
            )

        by, step = 0.0, _CLOCKS
        for _ in range(3):  # each time more finely
            tried = by + step
            costs = np.log(np.maximum(left(tried.tolist())[:, there], 1e-300)) @ counts[there]
            by, step = float(tried[np.argmin(costs)]), step / (len(step) / 4)
        if abs(by) > _CLOCK_MATTERS:
            way = "fast" if by > 0 else "slow"
            what = f"its clock runs {100 * abs(by):.1f} % too {way} compared with the other drops; it is left out"
            yield Fault("clock", self.decay.file, what, "Check the rate of this recording."), left([by])[0], 1

    def _one_channel(self, bench: Bench) -> Iterator[Hypothesis]:
        counts, file = bench.base.tally.counts[self.drop], self.decay.file
        channels = np.flatnonzero(counts).tolist()
        silent = [without(self.decay, channel) for channel in channels]
        states, left = self.trial.optimum.states_of(silent), self.trial.optimum.residual_sums_of(silent)
        for channel, rest, state in zip(channels, left, states, strict=True):
            there = counts.copy()
            there[channel] = 0
            tally = self._tally(bench, rest, there)
            if not tally.explained(bench.noise):
                continue
            heard = ChannelPrediction(self.trial, channel, [self.decay], state[None])
            for one in meanings(heard, float(bench.noise.level[channel])):
                fault = one.say(one.numbers, ())
                whole = tally.of([self.drop], [channel], one.residual[:, None], counts[[channel]][None])
                fault = replace(
                    fault, where=f"{file}: {fault.where}", what=f"{fault.what}; it is left out of this drop"
                )
                free = one.free + len(one.numbers)
                change = silenced(channel, file)
                yield Hypothesis(
                    fault, "left out", change, whole, self.trial, free, specific=one.code != "unlike-others"
                )

    def _exchanges(self, bench: Bench) -> Iterator[Hypothesis]:
        file, sensors = self.decay.file, bench.campaign.sensors
        pairs = list(combinations(np.flatnonzero(bench.base.tally.counts[self.drop]).tolist(), 2))
        swapped = [_swapped(self.decay, *pair) for pair in pairs]
        for pair, left in zip(pairs, self.trial.optimum.residual_sums_of(swapped) if pairs else (), strict=True):
            names = ", ".join(sensors[channel].channel for channel in pair)
            what = "the two are exchanged in this drop, as all other drops show; they were changed about"
            fault = Fault("exchanged", f"{file}: {names}", what, "Exchange the two columns of this recording.")
            change = exchanged(*pair, file)
            yield Hypothesis(fault, "repaired", change, self._tally(bench, left), self.trial)


def _swapped(decay: FreeDecay, one: int, other: int) -> FreeDecay:
    values = decay.values.copy()
    values[[one, other]] = values[[other, one]]
    return replace(decay, values=values)

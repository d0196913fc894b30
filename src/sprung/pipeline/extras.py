"""Which extras the records ask for: the shortest list that explains them, and the way there.

Linear extras are fitted and weighed one by one, as that is quick. Nonlinear ones are scored where the linear vehicle was
fitted; those that promise something are fitted together, and whatever is not missed is left out again. An extra is taken
if it gains more than the Bayesian information criterion asks for its parameters (Schwarz, Ann. Stat. 6 (1978) 461), the
residuals' colour and the drops' disagreement allowed for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.identification import (
    NEAR,
    Summit,
    ascend,
    expected_gain,
    force_scores,
    inflation_of,
    lost_without,
    prospects,
)
from sprung.pipeline.candidates import (
    ENGINE,
    SEPARATE,
    brought,
    carried_over,
    decided,
    fit_from,
    neutral,
    neutral_start,
    places_of_stops,
    possible,
    size_of,
    thinned,
    variants,
    without,
)
from sprung.pipeline.choice import Choice
from sprung.prepare import Decay
from sprung.vehicle import EXTRAS, LINEAR_EXTRAS, separate_names

Real = NDArray[np.float64]

STOPS = "bump-stop"

_WHOLLY = frozenset({"asymmetry", "rigid-axle", "engine"})
"""Extras that look like many a mistake with sensors and loads: they explain the records wholly, or they are not there."""

_UNLIKELY = 0.25
"""Part of the gain that is asked of a larger model below which it is not even fitted."""

_ERRS = 2.0
"""Inflation from which the model errs, and not only the sensors."""

_MATTERS = 0.03
"""Size of an extra, as a part, below which it may be what is left of a model error."""

_STILL, _STILL_AT_FIRST = 0.3, 0.7
"""Part of what a linear vehicle leaves unexplained that may be left by one with forces beside it, and after its first steps."""

_MUCH = 0.2
"""Part of the sensors' variance that a model may leave unexplained beside it."""

_FIRST = 8
"""Steps after which a fit has to promise something."""

_LOOKS_LIKE = 0.05
"""Part of what another extra promises above which friction may be what it promises it for."""

_MORE = 2
"""How many times further extras are looked for where the first ones have been found."""


@dataclass(frozen=True)
class Attempt:
    """One step of the way to the model.

    Attributes
    ----------
    extra
        What was tried.
    gain
        In twice the log-likelihood, over the inflation; expected where it was not fitted, lost where it was left out again.
    asked
        What the Bayesian information criterion asks for its parameters.
    fitted
        Whether it was fitted, or only scored.
    taken
        Whether it stayed.
    against
        Why it did not, where it gained enough.
    """

    extra: str
    gain: float
    asked: float
    fitted: bool
    taken: bool
    against: str = ""

    @property
    def text(self) -> str:
        """The attempt in words."""
        verb = "gains" if self.fitted else "would gain"
        but = f", but {self.against}" if self.against else ""
        return f"{self.extra} ({verb} {max(self.gain, 0.0):.0f} of {self.asked:.0f} asked{but})"


@dataclass(frozen=True, eq=False)
class Way:
    """Where the choice of extras stands.

    Attributes
    ----------
    choice, summit
        The model, and where its fit ended.
    decays
        What is fitted.
    path
        What was tried.
    progress
        Told in words what is being done.
    """

    choice: Choice
    summit: Summit
    decays: Sequence[Decay]
    path: tuple[Attempt, ...] = ()
    progress: Callable[[str], None] = lambda _: None

    def _asked(self, extra: str) -> float:
        """Give what is asked of an extra."""
        return len(brought(extra, self.choice.tracks)) * self._each

    @property
    def _each(self) -> float:
        """What is asked of one parameter."""
        return float(np.log(sum(decay.usable.sum() * decay.samples for decay in self.decays)))

    def _open(self, among: Sequence[str]) -> list[str]:
        """Give what may be tried and is not in the model."""
        tracks = [SEPARATE] if self.choice.open and self.choice.tracks == "shared" else []
        free = [extra for extra in self.choice.free if extra not in self.choice.extras]
        return [extra for extra in (*tracks, *free) if extra in among]

    def _with(self, extras: Sequence[str]) -> Choice:
        """Give the model with more extras."""
        added = tuple(extra for extra in extras if extra != SEPARATE)
        return self.choice.having((*self.choice.extras, *added), "separate" if SEPARATE in extras else None)

    def _noted(self, gains: Mapping[str, float], fitted: bool, taken: bool, against: str = "") -> Way:
        """Give the same with attempts noted, by extra and gain."""
        notes = [Attempt(extra, gain, self._asked(extra), fitted, taken, against) for extra, gain in gains.items()]
        return replace(self, path=(*self.path, *notes))

    def carried(self) -> Way:
        """Let the records decide at which of two heights the body is carried, where they may."""
        if not self.choice.heights.undecided:
            return self
        other = replace(self.choice, carried_at="roll axis")
        summit = fit_from(other, self.decays, self.summit, NEAR, self.progress)
        better = summit.loglikelihood > self.summit.loglikelihood
        return replace(self, choice=other, summit=summit) if better else self

    def linear(self) -> Way:
        """Try the extras that matrices carry, the most promising first, until none gains what is asked."""
        way = self
        refused: set[str] = set()
        while True:
            still = [extra for extra in way._open([SEPARATE, *LINEAR_EXTRAS]) if extra not in refused]
            promised = {extra: way._promised(extra) for extra in still}
            hopeful = [extra for extra, gain in promised.items() if gain > _UNLIKELY * way._asked(extra)]
            way = way._noted({extra: gain for extra, gain in promised.items() if extra not in hopeful}, False, False)
            if not hopeful:
                return way
            extra = max(hopeful, key=promised.__getitem__)
            refused |= (promised.keys() - set(hopeful)) | {extra}
            tried = way._trying(extra)
            gain = 2 * (tried.summit.loglikelihood - way.summit.loglikelihood) / tried.summit.disagreement
            against = (
                tried._against(extra, tried._inflation) if tried.summit.converged else "the fit with it did not settle"
            )
            enough = gain > way._asked(extra)
            larger = tried._noted({extra: gain}, True, True)
            if enough and not against and extra in _WHOLLY and tried._errs:
                larger = larger.linear()
                against = (
                    "it does not explain all of it, as it would if it were what is the matter" if larger._errs else ""
                )
            if enough and not against:
                way = larger
                refused.clear()
            else:
                way = way._noted({extra: gain}, True, False, against if enough else "")
                way = replace(way, choice=replace(way.choice, mounted=tried.choice.mounted))

    def wanting(self, extras: Sequence[str]) -> Way:
        """Fit linear extras that are wanted, whatever they gain."""
        way = self
        for extra in extras:
            way = way._trying(extra)
        return way

    def _promised(self, extra: str) -> float:
        """Give what a linear extra would gain, begun where it would gain most."""
        sensors, own = self.choice.campaign.sensors, self.summit.parameters
        larger = variants(extra, self._with([extra]), own)
        gains = [expected_gain(self.decays, one.models, sensors, one.known, neutral_start(one, own)) for one in larger]
        return max(gains) / self.summit.disagreement

    def _trying(self, extra: str) -> Way:
        """Fit a linear extra, from wherever it may begin; an engine, without which all may be wrong, from nothing as well."""
        self.progress(f"with {extra}")
        larger = self._with([extra])
        ends = [
            replace(self, choice=one, summit=fit_from(one, self.decays, self.summit, NEAR, self.progress))
            for one in variants(extra, larger, self.summit.parameters)
        ]
        if extra == ENGINE:
            sensors, known = larger.campaign.sensors, larger.known
            anew = ascend(self.decays, larger.models, sensors, known, enough=NEAR, progress=self.progress)
            ends.append(replace(self, choice=larger, summit=anew.after(self.summit)))
        return max(ends, key=lambda end: (end.summit.converged, end.summit.loglikelihood))

    def nonlinear(self, plain: Choice) -> Way:
        """Fit the extras with laws of their own that promise something together, and leave out what is not missed.

        Parameters
        ----------
        plain
            The model without anything that the records have asked for: whatever a linear vehicle took up of a nonlinear
            one's motion is nothing to start from.
        """
        nonlinear = [extra for extra in self.choice.free if extra not in LINEAR_EXTRAS]
        if not nonlinear or any(decay.clocks for decay in self.decays):
            return self
        self.progress("scoring " + ", ".join(nonlinear))
        start, hopeful = self._hopeful(nonlinear)
        if not hopeful:
            return start
        plain, path, best = replace(plain, met=start.choice.met, mounted=start.choice.mounted), start.path, start
        for base in start._bases(plain):
            found = replace(base, path=path)._found(hopeful)
            path = found.path
            best = found if found._worth(self) > best._worth(self) else best
            if best.choice.nonlinear and not best._errs:
                break
        return replace(best, path=path).tilted() if best.choice.nonlinear else replace(self, path=path)

    def _hopeful(self, among: Sequence[str]) -> tuple[Way, list[str]]:
        """Score extras with laws of their own, and give those that promise something, in the order in which to try them."""
        tried = self._open(among)
        way, promised = self._scored(tried)
        hopeful = [extra for extra in tried if promised[extra] > self._asked(extra)]
        way = way._noted({extra: promised[extra] for extra in tried if extra not in hopeful}, False, False)
        return way, _in_order({extra: promised[extra] / self._asked(extra) for extra in hopeful})

    def _bases(self, plain: Choice) -> Iterator[Way]:
        """Give linear vehicles beside which there may be forces, the simplest first."""
        simplest = self._parted(plain)
        yield simplest
        if plain.names != self.choice.names:
            yield self
        if any(one.extra == ENGINE and one.fitted and one.gain > one.asked and not one.taken for one in self.path):
            yield simplest._trying(ENGINE)

    def _parted(self, choice: Choice) -> Way:
        """Go on from another linear model."""
        if choice.names == self.choice.names:
            return self
        return replace(self, choice=choice, summit=fit_from(choice, self.decays, self.summit, NEAR, self.progress))

    def _found(self, hopeful: Sequence[str]) -> Way:
        """Fit what promises something, the first alone, and look for more until nothing does."""
        found = self._together(hopeful[:1])
        if not found.choice.nonlinear and len(hopeful) > 1:
            found = self._together(hopeful)
        for _ in range(_MORE):
            if not found.choice.nonlinear:
                break
            if found._inflation > _ERRS and not found._errs:
                break  # what is left is small and no noise: anything would seem to explain some of it
            refused = {one.extra for one in found.path[len(self.path) :] if one.fitted and not one.taken}
            tried = [extra for extra in found._open([SEPARATE, *EXTRAS]) if extra not in refused]
            promised = found._prospects(tried) if tried else {}
            more = [extra for extra in tried if promised[extra] / found._inflation > self._asked(extra)]
            larger = found._together(more) if more else found
            if larger.choice.names == found.choice.names:
                break
            found = larger
        return found

    @cached_property
    def _inflation(self) -> float:
        """By how much the records tell less than white residuals of drops that agree would."""
        return inflation_of(self.summit, self.decays)

    @cached_property
    def _rest(self) -> Real:
        """Variance of each channel while the vehicle stood on its blocks, (m/s²)²; 0 where nobody knows; shape (channel,)."""
        rests = [decay.rest.noise for decay in self.decays if decay.rest.noise.shape[1]]
        variances = [np.nan_to_num(noise.var(axis=1)) for noise in rests] or [np.zeros_like(self.summit.noise)]
        rest: Real = np.mean(variances, axis=0)
        return rest

    @property
    def _errs(self) -> bool:
        """Whether the model leaves much beside the sensors' noise."""
        known = self._rest > 0
        return bool(known.any()) and float(np.mean(self.summit.noise[known] ** 2 / self._rest[known])) > 1 + _MUCH

    def _worth(self, than: Way) -> float:
        """Give what it gains over another way, in twice the log-likelihood, beyond what is asked of its parameters."""
        gain = 2 * (self.summit.loglikelihood - than.summit.loglikelihood) / self._inflation
        return gain - (len(self.choice.names) - len(than.choice.names)) * self._each

    def with_forces(self, wanted: Choice) -> Way:
        """Fit the model that is wanted, whatever it gains."""
        choice = self.choice.having(wanted.extras)
        summit = fit_from(choice, self.decays, self.summit, NEAR, self.progress)
        return replace(self, choice=choice, summit=summit).tilted()

    def tilted(self) -> Way:
        """Let the sensors feel less of gravity where they turn with the body, if the records say that they do."""
        choice = replace(self.choice, tilting=True)
        summit = fit_from(choice, self.decays, self.summit, NEAR, self.progress)
        gain = 2 * (summit.loglikelihood - self.summit.loglikelihood) / inflation_of(summit, self.decays)
        return replace(self, choice=choice, summit=summit) if gain > self._each else self

    @property
    def why(self) -> str:
        """What decided on the model, in words."""
        choice = self.choice
        if not (choice.open or choice.free):
            return f"half-distances {choice.tracks}, as the campaign says or what is known implies"
        last = {one.extra: one for one in self.path}
        taken = ", ".join(one.text for one in last.values() if one.taken and one.extra in decided(choice))
        refused = ", ".join(one.text for one in last.values() if one.extra not in decided(choice))
        return f"the records ask for {taken or 'nothing more'}" + (f"; not for {refused}" if refused else "")

    def _explains_little(self, begun: Summit, part: float) -> bool:
        """Say whether more than a part of what the linear vehicle leaves is left still: then something else is the matter."""
        before, after = (np.maximum(one.noise**2 - self._rest, 0.0) for one in (self.summit, begun))
        much = before > self._rest
        return bool(much.any()) and float(np.mean(after[much] / before[much])) > part

    def _against(self, extra: str, inflation: float) -> str:
        """Say what speaks against an extra, whatever it gains; nothing where nothing does."""
        if not possible(extra, self.summit):
            return "it would have to be less than nothing"
        if inflation > _ERRS and size_of(extra, self.summit.parameters) < _MATTERS:
            return "it is so small that it may be another error of the model"
        return ""

    def _together(self, hopeful: Sequence[str]) -> Way:
        """Fit extras together, and leave out again what is not missed, the least missed first."""
        larger = self._with(hopeful)
        begun = fit_from(larger, self.decays, self.summit, NEAR, self.progress, begun=True, most=_FIRST)
        promising = not self._explains_little(begun, _STILL_AT_FIRST)
        if promising and not begun.converged:
            begun = fit_from(larger, self.decays, begun, NEAR, self.progress, begun=True)
        if not promising or self._explains_little(begun, _STILL):
            return self._noted(dict.fromkeys(hopeful, 0.0), True, False)
        summit = fit_from(larger, self.decays, begun, NEAR, self.progress)
        inflation = inflation_of(summit, self.decays)
        gain = 2 * (summit.loglikelihood - self.summit.loglikelihood) / inflation
        if not summit.converged or gain < sum(map(self._asked, hopeful)):
            return self._noted(dict.fromkeys(hopeful, gain), True, False)
        way = replace(self, choice=larger, summit=summit)
        for _ in range(len(EXTRAS)):
            lost = {
                extra: lost_without(way.summit, neutral(extra, way.choice.tracks)) / inflation
                for extra in decided(way.choice)
            }
            vain = [extra for extra in lost if way._against(extra, inflation)]
            lost |= dict.fromkeys(vain, 0.0)
            least = min(lost, key=lambda extra: lost[extra] / way._asked(extra), default=None)
            if least is None or lost[least] > way._asked(least):
                break
            way = replace(way._noted({least: lost[least]}, True, False), choice=without(way.choice, least))
            way = replace(way, summit=fit_from(way.choice, self.decays, way.summit, NEAR, self.progress))
        return way._noted({extra: lost[extra] for extra in decided(way.choice)}, True, True)

    def _scores(self, extras: Sequence[str]) -> dict[str, float]:
        """Score extras with laws of their own from where a linear fit is."""
        larger = self._with(extras)
        start = neutral_start(larger, self.summit.parameters)
        candidates = {extra: brought(extra, larger.tracks) for extra in extras}
        return force_scores(self.summit, self.decays, larger.stepped, start, candidates)

    def _scored(self, extras: Sequence[str]) -> tuple[Way, dict[str, float]]:
        """Score extras, stops where they would explain most; and go on with stops there."""
        places = places_of_stops(self.choice, self.summit, self.decays) if STOPS in extras else []
        first, *others = [replace(self, choice=replace(self.choice, met=met)) for met in places] or [self]
        promised = first._scores(extras)
        if promised.get(STOPS, 0.0) < self._asked(STOPS) * self.summit.disagreement:
            return first, promised
        scores = [promised[STOPS], *(way._scores([STOPS])[STOPS] for way in others)]
        best = int(np.argmax(scores))
        return (first, *others)[best], promised | {STOPS: scores[best]}

    def _prospects(self, extras: Sequence[str]) -> dict[str, float]:
        """Score any extras from where a fit with forces is."""
        largest = self._with(extras)
        names, own = largest.names, self.summit.parameters
        parted = largest.tracks != self.choice.tracks
        decays, share = thinned(self.decays)
        found = prospects(
            decays,
            largest.stepped,
            self.choice.campaign.sensors,
            largest.known,
            values=neutral_start(largest, own),
            states=carried_over(self.summit.states, self.summit.names, names),
            together=[separate_names(name) if parted else (name,) for name in own],
            candidates={extra: [(name,) for name in brought(extra, largest.tracks)] for extra in extras},
            tilting=self.choice.tilting,
        )
        return {extra: gain / share for extra, gain in found.items()}


def _in_order(promised: Mapping[str, float]) -> list[str]:
    """Give extras in the order in which to try them: what promises most for each parameter, unless it may be friction.

    Nearly every suspension rubs, and what rubs looks like everything else.
    """
    rubs = promised.get("friction", 0.0) > _LOOKS_LIKE * max(promised.values(), default=0.0)
    return sorted(promised, key=lambda extra: (rubs and extra == "friction", promised[extra]), reverse=True)

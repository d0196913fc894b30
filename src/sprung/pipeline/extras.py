"""Which extras the records ask for: the shortest list that explains them, and the way there.

Linear extras are fitted and weighed one by one, as that is quick. Nonlinear ones are scored where the linear vehicle was
fitted; those that promise something are fitted together, and whatever is not missed is left out again. An extra is taken
if it gains more than the Bayesian information criterion asks for its parameters (Schwarz, Ann. Stat. 6 (1978) 461), the
residuals' colour and the drops' disagreement allowed for.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.identification import (
    NEAR,
    Summit,
    ascend,
    ascend_stepped,
    expected_gain,
    force_scores,
    inflation_of,
    lost_without,
    prospects,
)
from sprung.pipeline.choice import Choice
from sprung.prepare import Decay
from sprung.vehicle import EXTRA_PARAMETERS, EXTRAS, LINEAR_EXTRAS, NEUTRAL, separate_names, separated

Real = NDArray[np.float64]

SEPARATE = "tracks apart"
"""Springs and dampers at half-distances of their own, as one candidate among the extras."""

_UNLIKELY = 0.25
"""Part of the gain that is asked of a larger model below which it is not even fitted."""

_TRAVEL = 0.002
"""m of travel at which a spring's force is the size of the friction from which a fit starts."""

_STIFFER = 10.0
"""How many times stiffer than the spring a friction is before it slides, at the start of a fit."""

_NOT_NEGATIVE = frozenset(name for name, value in NEUTRAL.items() if value == 0) - {"w_h", "p_f", "p_r"}
"""Parameters of extras that cannot be below zero."""

_BY_CHANCE = 4.0
"""Likelihood ratio that a parameter below zero may have by chance: two standard errors, squared."""

_ERRS = 2.0
"""Inflation from which the model errs, and not only the sensors."""

_MATTERS = 0.03
"""Size of an extra, as a part, below which it may be what is left of a model error."""

_STROKE = 0.05
"""m of travel over which a progressive spring is judged."""

_STILL = 0.3
"""Part of what a linear vehicle leaves unexplained that may be left by one with forces beside it."""

_MORE = 2
"""How many times further extras are looked for where the first ones have been found."""

_ENOUGH = 250.0
"""Samples per second, at least, that tell what an extra promises."""

_LONG_ENOUGH = 3.0
"""s of each decay that tell it."""


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
    """

    extra: str
    gain: float
    asked: float
    fitted: bool
    taken: bool

    @property
    def text(self) -> str:
        """The attempt in words."""
        verb = "gains" if self.fitted else "would gain"
        return f"{self.extra} ({verb} {max(self.gain, 0.0):.0f} of {self.asked:.0f} asked)"


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
        return (2 if extra == SEPARATE else len(EXTRA_PARAMETERS[extra])) * self._each

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

    def _noted(self, extra: str, gain: float, fitted: bool, taken: bool) -> Way:
        return replace(self, path=(*self.path, Attempt(extra, gain, self._asked(extra), fitted, taken)))

    def linear(self) -> Way:
        """Try the extras that matrices carry, the most promising first, until none gains what is asked."""
        campaign, way = self.choice.campaign, self
        refused: set[str] = set()
        while True:
            promised = {}
            for extra in way._open([SEPARATE, *LINEAR_EXTRAS]):
                if extra in refused:
                    continue
                larger = way._with([extra])
                start = _neutral_start(larger.names, way.summit.parameters)
                gain = expected_gain(self.decays, larger.models, campaign.sensors, larger.known, start)
                promised[extra] = gain / way.summit.disagreement
            hopeful = [extra for extra, gain in promised.items() if gain > _UNLIKELY * way._asked(extra)]
            for extra in promised.keys() - set(hopeful):
                way = way._noted(extra, promised[extra], False, False)
            if not hopeful:
                return way
            extra = max(hopeful, key=promised.__getitem__)
            refused |= (promised.keys() - set(hopeful)) | {extra}
            larger = way._with([extra])
            self.progress(f"with {extra}")
            start = _neutral_start(larger.names, way.summit.parameters)
            models, sensors, known = larger.models, campaign.sensors, larger.known
            summit = ascend(self.decays, models, sensors, known, start=start, enough=NEAR).after(way.summit)
            gain = 2 * (summit.loglikelihood - way.summit.loglikelihood) / summit.disagreement
            inflation, tried = inflation_of(summit, self.decays), replace(way, choice=larger, summit=summit)
            sound = summit.converged and _possible(extra, summit) and not tried._feigned(extra, inflation)
            if gain > way._asked(extra) and sound:
                way = replace(way._noted(extra, gain, True, True), choice=larger, summit=summit)
                refused.clear()
            else:
                way = way._noted(extra, gain, True, False)

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
        tried = self._open(nonlinear)
        self.progress("scoring " + ", ".join(tried))
        promised = self._scores(tried)
        hopeful = [extra for extra in tried if promised[extra] > self._asked(extra)]
        scored = [Attempt(one, promised[one], self._asked(one), False, False) for one in tried if one not in hopeful]
        if not hopeful:
            return replace(self, path=(*self.path, *scored))
        start = replace(self, path=(*self.path, *scored))
        if plain.names != self.choice.names:
            start = replace(start, choice=plain, summit=fit_from(plain, self.decays, self.summit, NEAR, self.progress))
        # Nearly every suspension rubs, and what rubs looks like everything else: friction is fitted first, and alone.
        found = start._together([extra for extra in hopeful if extra == "friction"] or hopeful)
        if not found.choice.nonlinear and hopeful != ["friction"]:
            found = start._together(hopeful)
        for _ in range(_MORE):
            if not found.choice.nonlinear:
                break
            refused = {one.extra for one in found.path[len(start.path) :] if one.fitted and not one.taken}
            tried = [extra for extra in found._open([SEPARATE, *EXTRAS]) if extra not in refused]
            promised = found._prospects(tried) if tried else {}
            inflation = inflation_of(found.summit, self.decays)
            more = [extra for extra in tried if promised[extra] / inflation > self._asked(extra)]
            larger = found._together(more) if more else found
            if larger.choice.names == found.choice.names:
                break
            found = larger
        inflation = inflation_of(found.summit, self.decays)
        gain = 2 * (found.summit.loglikelihood - self.summit.loglikelihood) / inflation
        parameters = len(found.choice.names) - len(self.choice.names)
        if found.choice.nonlinear and gain > parameters * self._each:
            return found.tilted()
        return replace(self, path=found.path)

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
        taken = ", ".join(one.text for one in last.values() if one.taken and one.extra in _decided(choice))
        refused = ", ".join(one.text for one in last.values() if one.extra not in _decided(choice))
        return f"the records ask for {taken or 'nothing more'}" + (f"; not for {refused}" if refused else "")

    def _explains_little(self, begun: Summit) -> bool:
        """Say whether much of what the linear vehicle leaves is left still: then something else is the matter."""
        rests = [decay.rest.noise for decay in self.decays if decay.rest.noise.shape[1]]
        rest = np.mean([np.nan_to_num(noise.var(axis=1)) for noise in rests], axis=0) if rests else 0.0
        before, after = (np.maximum(one.noise**2 - rest, 0.0) for one in (self.summit, begun))
        much = before > rest
        return bool(much.any()) and float(np.mean(after[much] / before[much])) > _STILL

    def _feigned(self, extra: str, inflation: float) -> bool:
        """Say whether an extra may be a model error in disguise: where there is one, what is small counts for nothing."""
        return inflation > _ERRS and _size(extra, self.summit.parameters) < _MATTERS

    def _together(self, hopeful: Sequence[str]) -> Way:
        """Fit extras together, and leave out again what is not missed, the least missed first."""
        larger = self._with(hopeful)
        begun = fit_from(larger, self.decays, self.summit, NEAR, self.progress, begun=True)
        if self._explains_little(begun):
            notes = [Attempt(extra, 0.0, self._asked(extra), True, False) for extra in hopeful]
            return replace(self, path=(*self.path, *notes))
        summit = fit_from(larger, self.decays, begun, NEAR, self.progress)
        inflation = inflation_of(summit, self.decays)
        gain = 2 * (summit.loglikelihood - self.summit.loglikelihood) / inflation
        if not summit.converged or gain < sum(map(self._asked, hopeful)):
            notes = [Attempt(extra, gain, self._asked(extra), True, False) for extra in hopeful]
            return replace(self, path=(*self.path, *notes))
        way = replace(self, choice=larger, summit=summit)
        for _ in range(len(EXTRA_PARAMETERS)):
            lost = {extra: lost_without(way.summit, _neutral(extra)) / inflation for extra in _decided(way.choice)}
            vain = [extra for extra in lost if not _possible(extra, way.summit) or way._feigned(extra, inflation)]
            lost |= dict.fromkeys(vain, 0.0)
            least = min(lost, key=lambda extra: lost[extra] / way._asked(extra), default=None)
            if least is None or lost[least] > way._asked(least):
                break
            way = replace(way._noted(least, lost[least], True, False), choice=_without(way.choice, least))
            way = replace(way, summit=fit_from(way.choice, self.decays, way.summit, NEAR, self.progress))
        taken = [Attempt(extra, lost[extra], self._asked(extra), True, True) for extra in _decided(way.choice)]
        return replace(way, path=(*way.path, *taken))

    def _scores(self, extras: Sequence[str]) -> dict[str, float]:
        """Score extras with laws of their own from where a linear fit is."""
        larger = self._with(extras)
        start = _neutral_start(larger.names, self.summit.parameters)
        return force_scores(self.summit, self.decays, larger.stepped, start, {one: _brought(one) for one in extras})

    def _prospects(self, extras: Sequence[str]) -> dict[str, float]:
        """Score any extras from where a fit with forces is."""
        largest = self._with(extras)
        names, own = largest.names, self.summit.parameters
        parted = largest.tracks != self.choice.tracks
        decays, share = _thinned(self.decays)
        found = prospects(
            decays,
            largest.stepped,
            self.choice.campaign.sensors,
            largest.known,
            values=_neutral_start(names, own),
            states=self.summit.states,
            together=[separate_names(name) if parted else (name,) for name in own],
            candidates={extra: [(name,) for name in _brought(extra)] for extra in extras},
            tilting=self.choice.tilting,
        )
        return {extra: one.gain / share for extra, one in found.items()}


def fit_from(
    choice: Choice,
    decays: Sequence[Decay],
    before: Summit,
    enough: float,
    progress: Callable[[str], None],
    states: Real | None = None,
    begun: bool = False,
) -> Summit:
    """Fit a model from where another one's fit ended.

    Parameters
    ----------
    choice
        The model.
    decays
        The decays.
    before
        Where the other fit of these decays ended.
    enough
        Expected gain in log-likelihood at which to stop.
    progress
        Told in words what is being done.
    states
        {X, Ẋ} of each drop at its first sample, (drop, 14), where these decays begin elsewhere than those.
    begun
        Whether their beginnings will do.
    """
    states = before.states if states is None else states
    sensors, known = choice.campaign.sensors, choice.known
    start = _start(choice.names, before.parameters)
    if not choice.nonlinear:
        found = ascend(decays, choice.models, sensors, known, start=start, enough=enough)
    else:
        found = ascend_stepped(
            decays,
            choice.stepped,
            sensors,
            known,
            start=start,
            states=states,
            enough=enough,
            near=states.shape[1] > 14,
            begun=begun,
            tilting=choice.tilting,
            progress=progress,
        )
    return found.after(before)


def _decided(choice: Choice) -> list[str]:
    """Give what the records brought into the model."""
    tracks = [SEPARATE] if choice.open and choice.tracks == "separate" else []
    return [*tracks, *(extra for extra in choice.extras if extra in choice.free)]


def _without(choice: Choice, extra: str) -> Choice:
    if extra == SEPARATE:
        return choice.having(choice.extras, "shared")
    return choice.having(tuple(one for one in choice.extras if one != extra))


def _size(extra: str, p: Mapping[str, float]) -> float:
    """Give what an extra matters beside what it is an extra to, as a part."""
    parts = {
        SEPARATE: lambda axle: p[f"t_{axle}1"] / p[f"t_{axle}2"] - 1,
        "anti-roll": lambda axle: p[f"k_a{axle}"] / p[f"k_s{axle}"],
        "tyre-damping": lambda axle: p[f"c_t{axle}"] / p[f"c_s{axle}"],
        "gravity": lambda axle: p["w_h"] / p[f"k_s{axle}"],
        "friction": lambda axle: p[f"F_{axle}"] / (_TRAVEL * p[f"k_s{axle}"]),
        "rebound": lambda axle: p[f"r_{axle}"] - 1,
        "progressive": lambda axle: _STROKE * p[f"p_{axle}"],
    }
    return max(abs(parts[extra](axle)) for axle in "fr")


def _possible(extra: str, summit: Summit) -> bool:
    """Say whether an extra's parameters are what they can be: friction that drives is none, nor is a damper that does."""
    below = [name for name in EXTRA_PARAMETERS.get(extra, ()) if name in _NOT_NEGATIVE and summit.parameters[name] < 0]
    return not any(lost_without(summit, [(name, 0.0)]) > _BY_CHANCE for name in below)


def _brought(extra: str) -> tuple[str, ...]:
    """Name the parameters that move on their own in the larger model only."""
    return ("t_f1", "t_r1") if extra == SEPARATE else EXTRA_PARAMETERS[extra]


def _neutral(extra: str) -> list[tuple[str, str | float]]:
    """Give what each parameter would have to be for the extra not to be there: a value, or another parameter."""
    if extra == SEPARATE:
        return [("t_f1", "t_f2"), ("t_r1", "t_r2")]
    return [(name, NEUTRAL[name]) for name in EXTRA_PARAMETERS[extra] if name in NEUTRAL]


def _neutral_start(names: Sequence[str], own: Mapping[str, float]) -> dict[str, float]:
    """Give the same vehicle by the names of a larger model."""
    own = {**own, **separated(own), **{name: own[f"{name}2"] for name in ("t_f", "t_r") if f"{name}2" in own}}
    stiff = {f"s_{axle}": _STIFFER * own[f"k_s{axle}"] for axle in "fr"}
    return {name: own.get(name, {**NEUTRAL, **stiff}.get(name, 0.0)) for name in names}


def _start(names: Sequence[str], own: Mapping[str, float]) -> dict[str, float]:
    """Give where to start a model from: friction that is not there yet starts with some."""
    slid = {f"F_{axle}": _TRAVEL * own[f"k_s{axle}"] for axle in "fr" if f"F_{axle}" not in own}
    start = _neutral_start(names, own)
    return {name: slid.get(name, value) for name, value in start.items()}


def _thinned(decays: Sequence[Decay]) -> tuple[list[Decay], float]:
    """Take as many samples as tell what an extra promises, and give the part of all that they are."""
    thin = []
    for decay in decays:
        every = max(int(decay.rate / _ENOUGH), 1)
        values = decay.values[:, : int(_LONG_ENOUGH * decay.rate) : every]
        thin.append(replace(decay, values=values, rate=decay.rate / every))
    return thin, sum(decay.samples for decay in thin) / sum(decay.samples for decay in decays)

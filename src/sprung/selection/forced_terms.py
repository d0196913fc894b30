"""Extras with laws of force of their own: scored beside the linear vehicle, and fitted together where they promise something.

Whatever is not missed is left out again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sprung.estimation import NEAR, score_nonlinear_terms, score_stepped_terms, wald_test
from sprung.progress import Step
from sprung.selection.linear_terms import fit_term
from sprung.selection.search import ERRS, ModelSearch
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import (
    ENGINE,
    SEPARATE,
    brought,
    carried_over,
    decided,
    fit_structure,
    neutral,
    neutral_start,
    places_of_stops,
    thinned,
    without,
)
from sprung.vehicle import EXTRAS, LINEAR_EXTRAS, separate_track_names

STOPS = "bump-stop"

_STILL, _STILL_AT_FIRST = 0.3, 0.7
"""Part of what a linear vehicle leaves unexplained that may be left by one with forces beside it, and after its first steps."""

_FIRST = 8
"""Steps after which a fit has to promise something."""

_LOOKS_LIKE = 0.05
"""Part of what another extra promises above which friction may be what it promises it for."""

_MORE = 2
"""How many times further extras are looked for where the first ones have been found."""


def fit_forced_terms(way: ModelSearch, wanted: ModelStructure) -> ModelSearch:
    """Fit the model that is wanted, whatever it gains."""
    return select_gravity_leakage(way.refit(way.structure.with_terms(wanted.terms)))


def select_gravity_leakage(way: ModelSearch) -> ModelSearch:
    """Let the sensors feel less of gravity where they turn with the body, if the records say that they do."""
    other = way.refit(replace(way.structure, gravity_leakage=True))
    gain = 2 * (other.fit.loglikelihood - way.fit.loglikelihood) / other.inflation
    return other if gain > way.each else way


def select_nonlinear_terms(way: ModelSearch, plain: ModelStructure) -> ModelSearch:
    """Fit the extras with laws of their own that promise something together, and leave out what is not missed.

    Parameters
    ----------
    way
        Where the choice stands once the linear extras are decided.
    plain
        The model without anything that the records have asked for: whatever a linear vehicle took up of a nonlinear
        one's motion is nothing to start from.
    """
    nonlinear = [extra for extra in way.structure.open_terms if extra not in LINEAR_EXTRAS]
    if not nonlinear or any(decay.clocks for decay in way.decays):
        return way
    way.progress(Step(f"scoring {', '.join(nonlinear)}"))
    start, hopeful = _hopeful(way, nonlinear)
    if not hopeful:
        return start
    plain, path, best = (
        replace(plain, stop_gap=start.structure.stop_gap, engine_mounting=start.structure.engine_mounting),
        start.steps,
        start,
    )
    for base in _bases(start, plain):
        found = _found(replace(base, steps=path), hopeful)
        path = found.steps
        best = found if found.worth(way) > best.worth(way) else best
        if best.structure.is_nonlinear and not best.errs:
            break
    return (
        select_gravity_leakage(replace(best, steps=path)) if best.structure.is_nonlinear else replace(way, steps=path)
    )


def _hopeful(way: ModelSearch, among: Sequence[str]) -> tuple[ModelSearch, list[str]]:
    """Score extras with laws of their own, and give those that promise something, in the order in which to try them."""
    tried = way.open_among(among)
    way, promised = _scored(way, tried)
    hopeful = [extra for extra in tried if promised[extra] > way.asked(extra)]
    way = way.noted({extra: promised[extra] for extra in tried if extra not in hopeful}, False, False)
    return way, _in_order({extra: promised[extra] / way.asked(extra) for extra in hopeful})


def _bases(way: ModelSearch, plain: ModelStructure) -> Iterator[ModelSearch]:
    """Give linear vehicles beside which there may be forces, the simplest first."""
    simplest = _parted(way, plain)
    yield simplest
    if plain.names != way.structure.names:
        yield way
    if any(one.extra == ENGINE and one.fitted and one.gain > one.asked and not one.taken for one in way.steps):
        yield fit_term(simplest, ENGINE)


def _parted(way: ModelSearch, choice: ModelStructure) -> ModelSearch:
    """Go on from another linear model."""
    return way if choice.names == way.structure.names else way.refit(choice)


def _found(way: ModelSearch, hopeful: Sequence[str]) -> ModelSearch:
    """Fit what promises something, the first alone, and look for more until nothing does."""
    found = _together(way, hopeful[:1])
    if not found.structure.is_nonlinear and len(hopeful) > 1:
        found = _together(way, hopeful)
    for _ in range(_MORE):
        if not found.structure.is_nonlinear:
            break
        if found.inflation > ERRS and not found.errs:
            break  # what is left is small and no noise: anything would seem to explain some of it
        refused = {one.extra for one in found.steps[len(way.steps) :] if one.fitted and not one.taken}
        tried = [extra for extra in found.open_among([SEPARATE, *EXTRAS]) if extra not in refused]
        promised = _prospects(found, tried) if tried else {}
        more = [extra for extra in tried if promised[extra] / found.inflation > way.asked(extra)]
        larger = _together(found, more) if more else found
        if larger.structure.names == found.structure.names:
            break
        found = larger
    return found


def _together(way: ModelSearch, hopeful: Sequence[str]) -> ModelSearch:
    """Fit extras together, and leave out again what is not missed, the least missed first."""
    larger = way.larger(hopeful)
    begun = fit_structure(larger, way.decays, way.fit, NEAR, way.progress, begun=True, most=_FIRST)
    promising = not way.explains_little(begun, _STILL_AT_FIRST)
    if promising and not begun.converged:
        begun = fit_structure(larger, way.decays, begun, NEAR, way.progress, begun=True)
    if not promising or way.explains_little(begun, _STILL):
        return way.noted(dict.fromkeys(hopeful, 0.0), True, False)
    tried = replace(way, fit=begun).refit(larger)
    gain, inflation = 2 * (tried.fit.loglikelihood - way.fit.loglikelihood) / tried.inflation, tried.inflation
    if not tried.fit.converged or gain < sum(map(way.asked, hopeful)):
        return way.noted(dict.fromkeys(hopeful, gain), True, False)
    way = tried
    for _ in range(len(EXTRAS)):
        lost = {
            extra: wald_test(way.fit, neutral(extra, way.structure.tracks)) / inflation
            for extra in decided(way.structure)
        }
        vain = [extra for extra in lost if way.against(extra, inflation)]
        lost |= dict.fromkeys(vain, 0.0)
        least = min(lost, key=lambda extra: lost[extra] / way.asked(extra), default=None)
        if least is None or lost[least] > way.asked(least):
            break
        way = way.noted({least: lost[least]}, True, False).refit(without(way.structure, least))
    return way.noted({extra: lost[extra] for extra in decided(way.structure)}, True, True)


def _scores(way: ModelSearch, extras: Sequence[str]) -> dict[str, float]:
    """Score extras with laws of their own from where a linear fit is."""
    larger = way.larger(extras)
    start = neutral_start(larger, way.fit.parameters)
    candidates = {extra: brought(extra, larger.tracks) for extra in extras}
    return score_nonlinear_terms(way.fit, larger.nonlinear_models, start, candidates)


def _scored(way: ModelSearch, extras: Sequence[str]) -> tuple[ModelSearch, dict[str, float]]:
    """Score extras, stops where they would explain most; and go on with stops there."""
    places = places_of_stops(way.structure, way.fit, way.decays) if STOPS in extras else []
    first, *others = [replace(way, structure=replace(way.structure, stop_gap=met)) for met in places] or [way]
    promised = _scores(first, extras)
    if promised.get(STOPS, 0.0) < way.asked(STOPS) * way.fit.disagreement:
        return first, promised
    scores = [promised[STOPS], *(_scores(way, [STOPS])[STOPS] for way in others)]
    best = int(np.argmax(scores))
    return (first, *others)[best], promised | {STOPS: scores[best]}


def _prospects(way: ModelSearch, extras: Sequence[str]) -> dict[str, float]:
    """Score any extras from where a fit with forces is."""
    largest = way.larger(extras)
    names, own = largest.names, way.fit.parameters
    parted = largest.tracks != way.structure.tracks
    decays, share = thinned(way.decays)
    found = score_stepped_terms(
        decays,
        largest.nonlinear_models,
        way.structure.campaign.sensors,
        largest.known,
        values=neutral_start(largest, own),
        states=carried_over(way.fit.states, way.fit.names, names),
        together=[separate_track_names(name) if parted else (name,) for name in own],
        candidates={extra: [(name,) for name in brought(extra, largest.tracks)] for extra in extras},
        tilting=way.structure.gravity_leakage,
    )
    return {extra: gain / share for extra, gain in found.items()}


def _in_order(promised: Mapping[str, float]) -> list[str]:
    """Give extras in the order in which to try them: what promises most for each parameter, unless it may be friction.

    Nearly every suspension rubs, and what rubs looks like everything else.
    """
    rubs = promised.get("friction", 0.0) > _LOOKS_LIKE * max(promised.values(), default=0.0)
    return sorted(promised, key=lambda extra: (rubs and extra == "friction", promised[extra]), reverse=True)

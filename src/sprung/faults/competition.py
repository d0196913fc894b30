"""The competition: which one thing, being otherwise, explains the records, and then which next one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from sprung.faults.bench import Bench
from sprung.faults.changes import nothing
from sprung.faults.coupled import coupled_otherwise
from sprung.faults.hypotheses import Hypothesis
from sprung.faults.of_all import exchanged_loads, misplaced_loads, twist
from sprung.faults.of_channels import WithoutChannel, exchanges, scores
from sprung.faults.of_drops import WithoutDrop
from sprung.faults.suspicion import MOST_OF_IT, SURE
from sprung.progress import Progress, counted, silent

_PROMISING = 0.85
"""Part of what is unexplained that may be left for a first fault to be believed in while a second is looked for."""

_WORTH_IT = 0.3
"""Part of the most that leaving something out may gain, from which it is looked at."""

_MOST_FAULTS = 3


def diagnose(bench: Bench, progress: Progress = silent) -> tuple[Hypothesis, ...]:
    """Find what is wrong.

    Parameters
    ----------
    bench
        The campaign.
    progress
        Called with each step that begins.

    Returns
    -------
    tuple of Hypothesis
        What has to be done about it, one after the other; none where nothing explains the records.
    """
    found: list[Hypothesis] = []
    first, before, settled = bench, bench.base.unexplained, 0
    while len(found) < _MOST_FAULTS:
        best = compete(bench, progress)
        if best is None or (not best.specific and any(not one.specific for one in found)):
            break
        found.append(best)
        if best.trial.explained or best.trial.unexplained < MOST_OF_IT * before:
            settled = len(found)
        if best.trial.explained or best.remedy == "named":
            break
        bench = bench.after(best.trial)
    taken = tuple(found[:settled])
    if not first.base.explained and all(not one.specific for one in taken):
        fault = twist(first)
        if fault is not None:
            return (Hypothesis(fault, "named", nothing, first.base.tally, first.base),)
    return taken


def compete(bench: Bench, progress: Progress = silent) -> Hypothesis | None:
    """Let all hypotheses compete.

    Parameters
    ----------
    bench
        The campaign.
    progress
        Called with each step that begins.

    Returns
    -------
    Hypothesis or None
        The best one, if it explains much; where another one does so about as well, it is only named, and that one with it.
    """
    base = bench.base
    pool = [*_of_parts(bench, progress), *misplaced_loads(bench), *coupled_otherwise(bench)]
    for more in (exchanged_loads, exchanges):
        if not any(one.tally.explained(bench.noise) or (one.trial.explained and not one.specific) for one in pool):
            pool += more(bench)
    best = _convincing(bench, pool) or _left_over(bench, pool)
    if best is None:
        return None
    trial, inflation = best.trial, best.trial.inflation
    most = np.inf if base.explained else max(MOST_OF_IT * base.unexplained, trial.unexplained)
    rivals = [
        one
        for one in pool
        if not _of_one_thing(one, best)
        and one.score(inflation) < best.score(inflation) + SURE
        and one.trial.unexplained <= most
    ]
    if not rivals:
        return best
    rival = min(rivals, key=lambda one: one.score(inflation))
    what = f"{best.fault.what}; or {rival.fault.where}: {rival.fault.what}"
    fault = replace(best.fault, what=what)
    return replace(best, fault=fault, remedy="named", change=nothing, drop=None, specific=False)


def _of_one_thing(one: Hypothesis, other: Hypothesis) -> bool:
    """Say whether two hypotheses are about the same thing, or one has it among several of which it says the same."""
    if one.fault.where == other.fault.where:
        return True
    named, by_other = (set(each.fault.where.split(", ")) for each in (one, other))
    return one.fault.code == other.fault.code and (named <= by_other or by_other <= named)


def _convincing(bench: Bench, pool: Sequence[Hypothesis]) -> Hypothesis | None:
    """Give the best one, if it explains much, and more than chance may."""
    specific = [one for one in pool if one.specific]
    if not specific:
        return None
    base, best = bench.base, _simplest(specific)
    if best.remedy == "repaired":
        best = replace(best, trial=bench.fit(best.change(bench.campaign), best.trial.optimum.parameters))
    trial, inflation = best.trial, best.trial.inflation
    gain = base.tally.cost / inflation - best.score(inflation)
    enough = max(SURE, MOST_OF_IT * base.unexplained / inflation if base.explained else 0.0)
    promising = base.explained or trial.unexplained < _PROMISING * base.unexplained
    # What nobody can name may yet be far from the best name there is.
    beaten = any(one.score(inflation) < best.score(inflation) - SURE for one in pool if not one.specific)
    return best if gain > enough and promising and not beaten else None


def _left_over(bench: Bench, pool: Sequence[Hypothesis]) -> Hypothesis | None:
    """Give what, left out, leaves nothing unexplained, though nobody can say what it is."""
    if bench.base.explained:
        return None
    alone = [one for one in pool if not one.specific and one.trial.explained]
    return min(alone, key=lambda one: one.score(1.0), default=None)


def _simplest(pool: Sequence[Hypothesis]) -> Hypothesis:
    """Give the best one; of what is said of one thing, and explains the records about as well, what takes least from them."""
    best = min(pool, key=lambda one: one.score(1.0))
    alike = [one for one in pool if one.fault.where == best.fault.where and one.score(1.0) < best.score(1.0) + SURE]
    return min(alike, key=lambda one: (one.free, one.score(1.0)))


def _of_parts(bench: Bench, progress: Progress) -> Iterator[Hypothesis]:
    """Leave out each channel and each drop, and look at those for which that is worth it."""
    counts = bench.base.tally.counts
    channels, drops = (np.flatnonzero(counts.any(axis=axis)).tolist() for axis in (0, 1))
    parts: list[WithoutChannel | WithoutDrop] = []
    if len(channels) > 1:
        parts += [WithoutChannel.of(bench, channel) for channel in channels]
    if len(drops) > 1:
        parts += [WithoutDrop.of(bench, drop) for drop in drops]
    gains = [bench.base.tally.cost - part.bound(bench).cost for part in parts]
    best = max(gains, default=0.0)
    near: dict[str | None, float] = {
        one.where: one.gain for one in reversed(scores(bench.base)) if one.kind != "load-position"
    }
    chosen: list[WithoutChannel | WithoutDrop] = []
    odd = np.flatnonzero(~bench.base.tally.explained_in(bench.noise))
    for part, gain in zip(parts, gains, strict=True):
        named = bench.campaign.sensors[part.channel].channel if isinstance(part, WithoutChannel) else None
        alone = isinstance(part, WithoutChannel) and odd.tolist() == [part.channel]
        if alone or max(gain, near.get(named, 0.0)) > max(_WORTH_IT * best, SURE):
            chosen.append(part)
    for part in counted(progress, "looking for what is wrong, without one channel or drop", chosen):
        yield from part.hypotheses(bench)

"""Isolation of faults: all hypotheses ranked by what they predict, the best few fitted, the most likely one accepted."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from sprung.estimation import FitResult
from sprung.faults.campaign import (
    exchanged_channels,
    exchanged_loads,
    high_passes,
    load_position,
    several_vehicles,
    torsion_test,
)
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.channel_deletion import ChannelDeletion
from sprung.faults.consistency import SHARE, SIGNIFICANT
from sprung.faults.correction import Correction, exclude_drops, mask_channel
from sprung.faults.drop import DROP_HYPOTHESES
from sprung.faults.drop.deletion import DropDeletion
from sprung.faults.hypothesis import Hypothesis, best_of
from sprung.faults.residual_table import residual_table
from sprung.faults.wrong_statement import WHOLLY, wrong_statement
from sprung.progress import Progress, Step, silent
from sprung.selection import FLEXIBLE_BODIES, WORTH_A_FIT, ModelSearch, fit_flexible_bodies

_FEW = 0.85
"""Share of a misfit that a first fault may leave while a second one is looked for."""

_RIVALS = 0.9
"""Share of the largest possible gain by leaving out a part, from which that part is examined although another one explains
everything."""

_MOST_PARTS, _MOST_FITS, _MOST_FAULTS = 3, 3, 3
"""Parts that are left out by a fit, fits of hypotheses for each fault, and faults of a campaign."""


def isolate(base: CandidateFit, progress: Progress = silent) -> tuple[tuple[Hypothesis, ...], int]:
    """Isolate what is wrong, one fault after the other.

    Parameters
    ----------
    base
        The fit that is inconsistent with its campaign.
    progress
        Called with each step that begins.

    Returns
    -------
    hypotheses
        One after the other; empty where nothing explains the recordings. They explain them wholly where the last one is
        sufficient.
    fits
        How many fits were made.
    """
    first, fits = base, 0
    accepted: list[Hypothesis] = []
    sufficient = 0
    while len(accepted) < _MOST_FAULTS:
        best, more = most_likely(base, progress)
        fits += more
        if base is first and (best is None or not _explains(first, best)):
            mixed = several_vehicles(first)
            if mixed is not None:
                return (mixed,), fits
        if best is None or (not best.is_specific and any(not one.is_specific for one in accepted)):
            break
        if not best.is_specific and best.candidate.is_explained and any(one.overlaps(best) for one in accepted):
            # What is left at the place of a correction may be gone once the recordings are corrected and preprocessed again.
            return (*accepted[:-1], replace(accepted[-1], is_sufficient=True)), fits
        accepted.append(replace(best, is_sufficient=_explains(first, best)))
        if best.is_gross or best.candidate.is_explained or best.candidate.misfit < SHARE * first.misfit:
            sufficient = len(accepted)
        if best.candidate.is_explained or best.remedy == "named":
            break
        base = best.candidate
    hypotheses = tuple(accepted[:sufficient])
    if not first.is_explained and all(not hypothesis.is_specific for hypothesis in hypotheses):
        fault = torsion_test(first)
        if fault is not None:
            return (Hypothesis(fault, "named", Correction(), first.table, first),), fits
    return hypotheses, fits


def _explains(first: CandidateFit, best: Hypothesis) -> bool:
    """Whether a hypothesis, with those before it, explains the recordings wholly, or is gross.

    What is left of a small misfit may be within the limits of noise, and yet be a good part of it: a vehicle that has what the
    model has not is explained so far by many faults.
    """
    left = best.candidate
    return best.is_gross or (left.is_explained and (first.is_explained or left.misfit <= WHOLLY * first.misfit))


def most_likely(base: CandidateFit, progress: Progress = silent) -> tuple[Hypothesis | None, int]:
    """Return the most likely hypothesis, and how many fits were made; None where none is convincing.

    Where another hypothesis explains the recordings about as well, the best one is only named, and the other one with it.

    Parameters
    ----------
    base, progress
        As for `isolate`.
    """
    progress(Step("testing the statements about loads and masses"))
    best, fits = wrong_statement(base)
    if best is not None:
        return best, fits
    is_near = base.is_explained
    ranked = [*_by_scores(base), *load_position(base), *high_passes(base)]
    deletions = () if is_near else _deletions(base, progress)
    limit = deletions[0].limit.cost if deletions else np.inf
    # Where the fit is far away, score tests are not to be trusted: only what explains everything counts, and more than any
    # channel or drop would that is left out.
    if is_near or min((one.score() for one in ranked), default=np.inf) < limit:
        best, ranked, more = _confirm_best(base, ranked, _MOST_FITS if is_near else 1)
        fits += more
        if best is not None and (is_near or best.candidate.is_explained):
            return _with_rival(base, best, ranked), fits
    left, more = (np.inf, 0) if is_near else _left_by_flexible_body(base)
    fits += more
    if left == 0:
        return None, fits
    best = None
    for hypotheses, made in _groups(base, deletions, progress):
        other, ranked, more = _confirm_best(base, [*ranked, *hypotheses])
        fits += made + more
        if other is not None and other.is_gross and other.candidate.misfit > left:
            continue
        if other is not None and (best is None or other.score() < best.score()):
            best = other
        if best is not None and best.candidate.is_explained:
            break
    best = best or _left_over(base, ranked)
    return (None if best is None else _with_rival(base, best, ranked)), fits


def _left_by_flexible_body(base: CandidateFit) -> tuple[float, int]:
    """Return the misfit that an ordinary vehicle with a body that twists or bends leaves, and how many were fitted.

    No sensor of such a body moves as the other ones say it should, which two exchanged ones seem to explain.
    """
    search = ModelSearch(base.structure, base.fit, base.decays)
    if not search.is_misfit_large or {*FLEXIBLE_BODIES} & {*base.structure.terms}:
        return np.inf, 0
    # A body of any mass and damping explains whatever is wrong with one sensor on it, and is none that the records need.
    bodies = fit_flexible_bodies(search, FLEXIBLE_BODIES)
    needed = [body for term, body in bodies.items() if body.needs(term)]
    tables = [residual_table(base.recordings, base.decays, body.fit) for body in needed]
    return min((table.misfit(base.noise) for table in tables), default=np.inf), len(bodies)


def _groups(
    base: CandidateFit, deletions: Sequence[ChannelDeletion | DropDeletion], progress: Progress
) -> Iterator[tuple[list[Hypothesis], int]]:
    """Yield hypotheses about single channels and drops, and those about exchanged ones; and how many fits each group took.

    The group that is predicted to explain the recordings better comes first. Nothing that is exchanged is a small fault.
    """
    if base.is_explained:
        yield _of_parts(base, _deletions(base, progress), progress)
        return
    limit = deletions[0].limit if deletions else base.table
    one_explains = limit.is_explained(base.noise)
    if one_explains:
        yield _of_parts(base, deletions, progress)
    progress(Step("testing for exchanged loads and channels"))
    exchanges = _with_refined(base, [*exchanged_loads(base), *exchanged_channels(base)])
    is_likelier = min((one.score() for one in exchanges), default=np.inf) < limit.cost
    anew = int(len({decay.load for decay in base.decays}) == 2)
    if is_likelier or one_explains:
        yield exchanges, anew
    # Where the body twists, each of its sensors contradicts the others: no part is to be examined.
    if not one_explains and torsion_test(base) is None:
        yield _of_parts(base, deletions, progress)
    if not (is_likelier or one_explains):
        yield exchanges, anew


def _by_scores(base: CandidateFit) -> list[Hypothesis]:
    """Return the channel hypotheses of small size that gain by their score tests."""
    hypotheses: list[Hypothesis] = []
    for channel, sensor in enumerate(base.campaign.sensors):
        own = [score for score in base.scores if score.where == sensor.channel]
        if any(score.gain > score.required for score in own):
            hypotheses += ChannelDeletion(base, channel, base).scored(own)
    return hypotheses


def largest_gain_by_steps(base: CandidateFit) -> float:
    """Return what the likeliest faults of small size gain, by some steps with each of the best few.

    Parameters
    ----------
    base
        The fit of the campaign as it is.

    Returns
    -------
    float
        In twice the log-likelihood; 0 where none explains much.
    """
    laws = {(one.fault.where, one.first_order): one for one in _by_scores(base) if one.fault.code == one.first_order}
    likeliest = sorted(laws.values(), key=lambda one: one.score())[:_MOST_FITS]
    return max((base.table.cost - one.score() for one in _near(base, likeliest, base.fit)), default=0.0)


def _deletions(base: CandidateFit, progress: Progress) -> list[ChannelDeletion | DropDeletion]:
    """Return each channel and each drop left out, by a few steps; first the one whose deletion gains most."""
    progress(Step("leaving out each channel and each drop"))
    table = base.table
    channels, drops = (np.flatnonzero(table.counts.any(axis=axis)).tolist() for axis in (0, 1))
    deletions: list[ChannelDeletion | DropDeletion] = []
    for channel in channels if len(channels) > 1 else ():
        deletions.append(ChannelDeletion(base, channel, base.estimate(mask_channel(channel))))
    for drop in drops if len(drops) > 1 else ():
        candidate = base.estimate(exclude_drops(base.recordings[drop]))
        deletions.append(DropDeletion(base, drop, candidate, DROP_HYPOTHESES))
    return sorted(deletions, key=lambda deletion: deletion.limit.cost)


def _of_parts(
    base: CandidateFit, deletions: Sequence[ChannelDeletion | DropDeletion], progress: Progress
) -> tuple[list[Hypothesis], int]:
    """Return the hypotheses about the channels and drops whose deletion gains most, and how many fits were made."""
    gains = [base.table.cost - deletion.limit.cost for deletion in deletions]
    hypotheses: list[Hypothesis] = []
    fits, is_found = 0, False
    for gain, deletion in list(zip(gains, deletions, strict=True))[:_MOST_PARTS]:
        if gain <= SIGNIFICANT or (is_found and gain < _RIVALS * gains[0]):
            break
        progress(Step(f"fitting without {deletion.name}"))
        candidate = base.refit(deletion.correction)
        hypotheses += replace(deletion, candidate=candidate).hypotheses()
        fits += 1
        # Once it is known what, left out, leaves noise alone, only what was expected to gain as much is another cause.
        is_named = any(one.is_specific and one.is_explained for one in hypotheses)
        is_found = is_named if base.is_explained else is_found or candidate.is_explained
    return hypotheses, fits


def _with_refined(base: CandidateFit, hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Return hypotheses of which one step from far away tells the residuals, the best few after some steps more."""
    ranked = sorted(hypotheses, key=lambda hypothesis: hypothesis.score())
    candidates = (base.refine(one.correction, one.candidate.fit) for one in ranked[:_MOST_FITS])
    refined = [replace(one, table=new.table, candidate=new) for one, new in zip(ranked, candidates, strict=False)]
    return [*refined, *ranked[_MOST_FITS:]]


def _confirm_best(
    base: CandidateFit, hypotheses: Sequence[Hypothesis], most: int = _MOST_FITS
) -> tuple[Hypothesis | None, list[Hypothesis], int]:
    """Fit the most likely specific hypotheses, one after the other, until one is convincing.

    Returns
    -------
    hypothesis
        The convincing one; None where none is.
    hypotheses
        All of them, those that were fitted with their fits.
    fits
        How many were made.
    """
    remaining, rest, fits = [one for one in hypotheses if _is_promising(base, one)], list(hypotheses), 0
    while remaining and fits < most:
        best = best_of(remaining, SIGNIFICANT)
        remaining.remove(best)
        rest.remove(best)
        confirmed, made = best.confirm(base)
        fits += made
        if confirmed is None:
            continue
        rest.append(confirmed)
        if _is_convincing(base, confirmed, rest):
            limit = confirmed.score() + SIGNIFICANT * confirmed.candidate.fit.overdispersion
            alike = [
                one
                for one in remaining
                if one.concerns_same(best) and (one.first_order == best.first_order or one.score() < limit)
            ]
            likeliest = _likeliest_alike(base, confirmed, alike)
            return likeliest, [*rest, likeliest], fits
    return None, rest, fits


def _likeliest_alike(base: CandidateFit, confirmed: Hypothesis, alike: Sequence[Hypothesis]) -> Hypothesis:
    """Return what a convincing hypothesis means: the likeliest of each law about the same place, by some steps from its fit.

    What all are to the first order, a delay instead of a low-pass, stays unless another one is significantly more likely, all
    with their numbers where they gain most.
    """
    laws = {(one.fault.code, one.law) for one in alike} - {(confirmed.fault.code, confirmed.law)}
    rivals = [
        min((one for one in alike if (one.fault.code, one.law) == law), key=lambda one: one.score())
        for law in sorted(laws)
    ]
    found = [confirmed, *_near(base, rivals, confirmed.candidate.fit)]
    # Much of what tells laws apart is fast, and fades soon after the landing.
    whole = [] if base.whole is None else _near(base.whole, found, confirmed.candidate.fit)
    judged = whole if len(whole) == len(found) else found
    scores = [one.score() - one.remaining_gain for one in judged]
    likeliest = int(np.argmin(scores))
    limit = scores[likeliest] + SIGNIFICANT * judged[likeliest].candidate.fit.overdispersion
    plain = [
        one for one, score in zip(found, scores, strict=True) if one.fault.code == one.first_order and score < limit
    ]
    return plain[0] if plain else found[likeliest]


def _near(base: CandidateFit, hypotheses: Sequence[Hypothesis], fit: FitResult) -> list[Hypothesis]:
    """Return those of some hypotheses about the same place that hold, by some steps from the fit of one of them."""
    return [one for one in (hypothesis.confirm(base, fit)[0] for hypothesis in hypotheses) if one is not None]


def _is_promising(base: CandidateFit, hypothesis: Hypothesis) -> bool:
    """Whether a fit of a hypothesis may be convincing, by what it predicts."""
    gain = base.table.cost - hypothesis.score()
    # Where what is left is noise, a small fault has to stand out from its colour, as far as its score may understate it.
    expected = WORTH_A_FIT * gain / base.fit.overdispersion if base.is_explained else gain
    explains = base.is_explained or hypothesis.is_beyond_prior or gain > (1 - _FEW) * base.misfit
    return (
        hypothesis.is_specific and not hypothesis.is_fitted and explains and min(gain, expected) > hypothesis.required
    )


def _is_convincing(base: CandidateFit, hypothesis: Hypothesis, others: Sequence[Hypothesis]) -> bool:
    """Whether a hypothesis explains much of the misfit, and more than chance does."""
    overdispersion = hypothesis.candidate.fit.overdispersion
    gain = base.table.inflated_cost(overdispersion) - hypothesis.score(overdispersion)
    required = max(hypothesis.required, SHARE * base.misfit / overdispersion if base.is_explained else 0.0)
    explains = base.is_explained or hypothesis.candidate.misfit < _FEW * base.misfit
    # What cannot be named may be much more likely than the best name there is.
    limit = hypothesis.score(overdispersion) - SIGNIFICANT
    is_beaten = any(other.score(overdispersion) < limit for other in others if not other.is_specific)
    return gain > required and explains and not is_beaten


def _left_over(base: CandidateFit, hypotheses: Sequence[Hypothesis]) -> Hypothesis | None:
    """Return what, left out, leaves noise alone, though nothing tells what is wrong with it."""
    if base.is_explained:
        return None
    unnamed = [one for one in hypotheses if not one.is_specific and one.candidate.is_explained]
    return min(unnamed, key=lambda hypothesis: hypothesis.score(), default=None)


def _with_rival(base: CandidateFit, best: Hypothesis, hypotheses: Sequence[Hypothesis]) -> Hypothesis:
    """Return the best hypothesis; only named, and together with another one that explains the recordings about as well."""
    overdispersion = best.candidate.fit.overdispersion
    limit = best.score(overdispersion) + best.required
    largest = np.inf if base.is_explained else max(SHARE * base.misfit, best.candidate.misfit)
    rivals = [
        other
        for other in hypotheses
        if not other.concerns_same(best) and other.score(overdispersion) < limit and other.candidate.misfit <= largest
    ]
    if not rivals:
        return best
    rival = min(rivals, key=lambda hypothesis: hypothesis.score(overdispersion))
    what = f"{_without_remedy(best)}; or {rival.fault.where}: {_without_remedy(rival)}"
    fault = replace(best.fault, what=f"{what}. The recordings do not tell which of the two it is; nothing was changed")
    return Hypothesis(fault, "named", Correction(), best.table, best.candidate, best.free, is_specific=False)


def _without_remedy(hypothesis: Hypothesis) -> str:
    """Return what is wrong in words, without what is done about it, which comes last."""
    what, done = hypothesis.fault.what, hypothesis.remedy != "named"
    return what.rpartition("; ")[0] if done and "; " in what else what

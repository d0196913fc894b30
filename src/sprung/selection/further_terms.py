"""Further terms beside nonlinear ones, and a low-pass of the loggers, until the records show no other one.

Every fit is slow here: scores and first steps decide what is fitted, in the beginnings of the decays first.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from sprung.estimation import beginning_of
from sprung.preprocess import FreeDecay
from sprung.selection.contact import from_contact, without_landings
from sprung.selection.evident_faults import with_evident_fault
from sprung.selection.low_pass import confirm_low_pass, select_low_pass
from sprung.selection.scoring import most_promising
from sprung.selection.search import ModelSearch
from sprung.selection.stepwise import try_likeliest, try_term
from sprung.selection.structure import ModelStructure
from sprung.selection.term_fits import take_first_step
from sprung.selection.terms import TERMS

_MUCH_LEFT = 0.5
"""Part of the model error that a term leaves at the most beside which terms are tried again that were refused without it."""

_FURTHER_ROUNDS, _TRIED_BESIDE = 8, 2
"""How many times terms are looked for beside nonlinear ones, and how many are fitted each time until one is accepted."""

_RIVALLING = 0.5
"""Part of what a low-pass gains that a term has to gain by its first steps to be fitted in its place."""


def select_terms_beside(search: ModelSearch) -> ModelSearch:
    """Return the search after terms of any kind, and a low-pass of the loggers, have been tried beside its nonlinear ones.

    Where much is missing, every fit is slow. What the beginnings of the decays show is found there first; the whole decays
    then have little more to show.

    Parameters
    ----------
    search
        The present model and its fit, of the decays or of their beginnings.

    Returns
    -------
    ModelSearch
        As given where a sensor or drops are at fault, with what is wrong with them.
    """
    search = with_evident_fault(search)
    if search.fault is not None:
        return search
    beginnings = [beginning_of(decay) for decay in search.decays]
    early = from_contact(replace(search, decays=beginnings), on_the_way=True)
    return select_terms_in_whole(select_further_terms(early, whole=False), search.decays)


def select_terms_in_whole(early: ModelSearch, decays: Sequence[FreeDecay]) -> ModelSearch:
    """Return the search after terms and a low-pass have been tried in whole decays, once their beginnings have decided.

    Parameters
    ----------
    early
        A nonlinear model and its fit to the beginnings.
    decays
        As they began before that.

    Returns
    -------
    ModelSearch
    """
    whole = [
        decay.shifted(decay.samples_to(beginning.start)) for decay, beginning in zip(decays, early.decays, strict=True)
    ]
    search = from_contact(replace(early, decays=whole), on_the_way=True)
    # What leaves so much is not the vehicle: another base may lead to it, and further terms beside this one would be slow.
    if early.lacks_something:
        return search
    return select_further_terms(search, whole=True, decided=search.structure if early.is_overdispersed else None)


def select_further_terms(search: ModelSearch, whole: bool, decided: ModelStructure | None = None) -> ModelSearch:
    """Try terms and a low-pass round after round, until none is accepted.

    Parameters
    ----------
    search
        The present model and its fit.
    whole
        Whether these are whole decays, not their beginnings.
    decided
        Model beside which what shows in no score was tried in the beginnings, where knees are passed and friction turns round
        most often: only scores are looked at, until they show another term.

    Returns
    -------
    ModelSearch
    """
    tried: frozenset[str] = frozenset()
    for _ in range(_FURTHER_ROUNDS):
        if not search.structure.is_nonlinear:
            break
        before = search
        search, fitted = _try_scored(search, tried)
        tried |= {*fitted}
        if search.structure is before.structure:
            if search.structure is decided or (whole and not search.is_overdispersed):
                break
            # What a wheel does that is still in the air would hide what shows in no score.
            search = without_landings(search)
            untried = _untried(search, tried)
            search = _accept_low_pass(search, _rivals(untried), _hidden(untried), _usual(untried))
            if search.structure is before.structure and not search.is_overdispersed:
                break
        if search.structure is before.structure:
            search = _accept_unscored(search, tried, with_parts=not whole and search.lacks_something)
        is_another = search.structure != before.structure
        # Decays that only begin some samples later may leave less of what was much, and always a little less of little.
        may_explain = is_another or before.leaves_misfit(before.fit, _MUCH_LEFT)
        explains_much = may_explain and not before.leaves_misfit(search.fit, _MUCH_LEFT)
        if explains_much or _hidden(search.structure.terms) != _hidden(before.structure.terms):
            # What was refused without it may be needed beside it.
            tried = frozenset()
        if not (is_another or explains_much):
            break
    return search


def laws_of_part(term: str, terms: Sequence[str]) -> list[str]:
    """Return a term and those of others that are laws of the same part.

    Parameters
    ----------
    term
        Of them one.
    terms
        Open terms.

    Returns
    -------
    list of str
        The given one first.
    """
    part = TERMS[term].part
    return [term, *(other for other in terms if other != term and part and TERMS[other].part == part)]


def _try_scored(search: ModelSearch, tried: Collection[str]) -> tuple[ModelSearch, list[str]]:
    """Try open terms by their scores until one is accepted, but for those that no score tells from others; name the best."""
    untried = _untried(search, tried)
    rivals = _rivals(untried)
    terms = [term for term in untried if term not in rivals]
    fitted: list[str] = []
    for term, promised in most_promising(search, terms, _TRIED_BESIDE).items():
        if term in fitted:
            continue
        first = None
        if not search.is_overdispersed or promised <= 1:
            # Scores of a part of the decays hold for all of them if they are more than chance: a step in all of them tells.
            stepped, gain = take_first_step(search, term)
            is_converged = stepped is not search and stepped.fit.converged
            against = stepped.veto(term) if is_converged else ""
            if against or gain < search.required(term):
                search, fitted = search.recorded({term: gain}, bool(against), False, against), [*fitted, term]
                continue
            first = stepped.fit if is_converged else None
        laws = laws_of_part(term, untried)
        fitted += laws
        tested = try_term(search, term, first=first) if laws == [term] else try_likeliest(search, laws)
        if tested.structure is not search.structure:
            return confirm_low_pass(tested), fitted
        search = tested
    return search, fitted


def _untried(search: ModelSearch, tried: Collection[str]) -> list[str]:
    """Return the open terms that are still to be tried."""
    return [term for term in search.open_terms(tuple(TERMS)) if term not in tried]


def _accept_rival(search: ModelSearch, terms: Sequence[str], least: float = 0.0) -> ModelSearch:
    """Fit terms that no score tells from each other, and accept the likeliest if it is needed and may gain so much."""
    found = try_likeliest(search, terms, least) if terms else search
    return found if found.structure is search.structure else confirm_low_pass(found)


def _accept_unscored(search: ModelSearch, tried: Collection[str], with_parts: bool) -> ModelSearch:
    """Accept what no score shows: a term among those that refine the same, a friction, or a part that vibrates by itself."""
    # What the likeliest of each kind beats may be needed beside it: it is tried again in the next round.
    for kind in (_usual, _rivals, _hidden, *([_parts] if with_parts else [])):
        found = _accept_rival(search, kind(_untried(search, tried)))
        if found.structure is not search.structure:
            return found
        search = found
    return search


def _accept_low_pass(search: ModelSearch, *rivals: Sequence[str]) -> ModelSearch:
    """Accept a low-pass of the loggers if the recordings support one, unless terms that show in no score explain more.

    A low-pass resembles knees, and so does whatever else is missing: it is looked for once nothing else shows.
    """
    found = select_low_pass(search)
    if found.structure is search.structure:
        return search
    least = _RIVALLING * found.gain_over(search) * found.overdispersion
    others = (_accept_rival(search, terms, least) for terms in rivals)
    return max((found, *others), key=lambda other: other.gain_over(found))


def _hidden(terms: Sequence[str]) -> list[str]:
    """Return the terms that show in no score once a fit of everything at once has lost them, but when the rest is right."""
    return [term for term in terms if TERMS[term].resembles_others]


def _usual(terms: Sequence[str]) -> list[str]:
    """Return the linear terms that most vehicles have: beside curves that make up for them their scores show little of them."""
    return [term for term in terms if TERMS[term].is_linear and TERMS[term].usual is not None]


def _parts(terms: Sequence[str]) -> list[str]:
    """Return the terms that are parts which vibrate by themselves: where they are nothing no score tells their place."""
    return [term for term in terms if TERMS[term].vibrates_by_itself]


def _rivals(terms: Sequence[str]) -> list[str]:
    """Return the terms that are stationary, which no score shows, and those that refine the same."""
    refined = {TERMS[term].refines for term in terms if TERMS[term].is_stationary}
    return [term for term in terms if TERMS[term].refines in refined]

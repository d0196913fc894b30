"""The model terms that are to be tried before faults are isolated or corrected, as they explain more than any of them."""

from __future__ import annotations

from sprung.analysis.analysis import Analysis
from sprung.estimation import NEAR
from sprung.faults import CandidateFit, Consistency, largest_expected_gain, largest_gain_by_steps
from sprung.progress import silent
from sprung.selection import TERMS, ModelSearch, fit_structure, fit_usual_linear_terms, score_terms

_MOST = 0.5
"""Share of a misfit that a model term has to explain by a few steps to be fitted before faults are isolated."""

_STEPS, _TERMS = 3, 3
"""Gauss-Newton steps that are taken with each of so many terms."""

_SEVERAL = 2
"""Faults that together explain the recordings, from which usual terms are tried first that explain more."""


def explaining_term(run: Analysis, consistency: Consistency) -> tuple[str, str] | None:
    """Return the linear term that is to be tried before faults are isolated, and why; None where there is none.

    It explains most of the misfit where there is one, and more than any fault of small size does. The score test ranks the
    terms and the faults; where the fit is far from the recordings, it says little of how much they would gain, so that a few
    Gauss-Newton steps are taken with the best few.

    Parameters
    ----------
    run
        With a model and its fit.
    consistency
        Of that fit.
    """
    if consistency == "consistent" or run.model.structure.is_time_stepped:
        return None
    search, expected = _expected_gains(run.model, linear=True)
    promising = [term for term, gain in expected.items() if gain >= search.required(term)]
    base = CandidateFit.of(run.model.structure, run.decays, run.fit)
    gains: dict[str, float] = {}
    for term in sorted(promising, key=expected.__getitem__, reverse=True)[:_TERMS]:
        fit = fit_structure(search.with_terms([term]), run.decays, run.fit, NEAR, silent, most=_STEPS)
        gains[term] = base.table.cost - CandidateFit.of(run.model.structure, run.decays, fit).table.cost
    if not gains:
        return None
    best = max(gains, key=gains.__getitem__)
    share = gains[best] / max(base.table.explicable(base.noise), 1.0)
    if consistency == "misfit" and share < _MOST:
        return None
    is_misfit = consistency == "misfit"
    fault = largest_gain_by_steps(base) if is_misfit else largest_expected_gain(run.campaign, run.decays, run.fit)
    why = f"{_STEPS} steps with it gain {gains[best]:.0f}, the likeliest fault is expected to gain {fault:.0f}"
    return (best, why) if gains[best] > fault else None


def rivalling_term(run: Analysis) -> tuple[str, str] | None:
    """Return the nonlinear term that may explain more than the faults that were isolated, and why; None where there is none.

    A campaign of few drops, or a small effect beside much noise, seems to have one drop that differs where it moves most.

    Parameters
    ----------
    run
        With faults that explain the recordings wholly.
    """
    if run.model.structure.is_time_stepped:
        return None
    search, expected = _expected_gains(run.model, linear=False)
    best = max(expected, key=expected.__getitem__, default=None)
    if best is None or expected[best] < search.required(best):
        return None
    base = CandidateFit.of(run.model.structure, run.decays, run.fit)
    # Drops that disagree count less against chance only: what the faults gain makes them agree.
    term, fault = expected[best] * run.model.fit.disagreement, base.table.cost - run.found[-1].table.cost
    why = f"it is expected to gain {term:.0f}, the faults {fault:.0f}"
    return (best, why) if term > fault else None


def rivalling_usual_terms(run: Analysis) -> tuple[str, str] | None:
    """Return the usual linear terms that explain more than several faults do, and why they are tried; None where none do.

    That several things are wrong at once is less likely than that a vehicle has what most vehicles have. Where the fit is far
    from the recordings no score shows it.

    Parameters
    ----------
    run
        With faults that explain the recordings wholly.
    """
    if len(run.found) < _SEVERAL or run.model.structure.is_time_stepped:
        return None
    found = fit_usual_linear_terms(run.model)
    with_terms = CandidateFit.of(found.structure, run.decays, found.fit)
    cost = CandidateFit.of(run.model.structure, run.decays, run.fit).table.cost
    gain, by_faults = cost - with_terms.table.cost, cost - run.found[-1].table.cost
    if gain < by_faults or not with_terms.is_explained:
        return None
    terms = ", ".join(term for term in found.structure.terms if term not in run.model.structure.terms)
    return terms, f"an ordinary vehicle with all of them gains {gain:.0f}, {len(run.found)} faults gain {by_faults:.0f}"


def _expected_gains(model: ModelSearch, *, linear: bool) -> tuple[ModelSearch, dict[str, float]]:
    """Return by their scores what open terms, linear ones or the others, gain where drops that disagree count less.

    The search has the starts of these terms where they gain most.
    """
    terms = model.open_terms([name for name, term in TERMS.items() if term.is_linear is linear])
    search, scores = score_terms(model, [term for term in terms if term not in model.refused])
    return search, {term: gain / model.fit.disagreement for term, (gain, _) in scores.items()}

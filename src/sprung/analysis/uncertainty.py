"""The stage that computes the uncertainty of the fit."""

from __future__ import annotations

from dataclasses import replace

from sprung.analysis.analysis import Analysis
from sprung.estimation import FitStatistics, consider_held, escape_local_optimum, uncertainty_of, weigh_statements
from sprung.progress import Progress, Step
from sprung.selection import TERMS, ModelSearch, leave_out_refused, leave_out_undetermined, with_neutral_terms


def estimate_uncertainty(run: Analysis, progress: Progress) -> Analysis:
    """Compute the covariance of the parameters at the highest optimum near by."""
    progress(Step("computing the uncertainties"))
    # A motion that is stepped takes as long to probe as to fit, and its search began from both ends.
    search = run.model
    if not search.structure.is_time_stepped:
        fit = escape_local_optimum(search.fit)
        # At another optimum a term may say something else.
        search = search if fit is search.fit else leave_out_refused(replace(search, fit=fit))
    search = replace(search, fit=weigh_statements(search.fit))
    statistics = uncertainty_of(search.fit)
    if not search.structure.is_time_stepped:
        # Without one term another one may be determined.
        while (determined := leave_out_undetermined(search, statistics)) is not search:
            search = replace(determined, fit=weigh_statements(determined.fit))
            statistics = uncertainty_of(search.fit)
    statistics = _with_usual_but_absent(search, statistics)
    refused = search.steps[len(run.model.steps) :]
    run = replace(run, search=search, statistics=statistics, fits=run.fits + len(refused))
    for step in refused:
        run = run.noted("estimate_uncertainty", f"{step.extra}: left out", step.text)
    what = f"variances are enlarged by {statistics.inflation:.3g}"
    return run.noted("estimate_uncertainty", what, statistics.inflated_by)


def _with_usual_but_absent(search: ModelSearch, statistics: FitStatistics) -> FitStatistics:
    """Count what most vehicles have beside a term of the model, a mount its damping, and the recordings did not show.

    Its absence is no knowledge: it may have its usual size.
    """
    structure = search.structure
    open_terms = (TERMS[term] for term in search.open_terms(tuple(TERMS)))
    absent = [one.name for one in open_terms if one.is_usual_beside(structure.terms) and one.is_linear]
    usual = {
        name: value
        for term in absent
        if (sizes := TERMS[term].usual) is not None
        for name, value in sizes(search.fit.parameters, structure).items()
        if name in TERMS[term].parameters(structure.tracks, structure.layout)
    }
    if not usual:
        return statistics
    larger = with_neutral_terms(search, absent)
    return consider_held(statistics, uncertainty_of(larger.fit), usual)

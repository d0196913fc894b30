"""The stage that computes the uncertainty of the fit."""

from __future__ import annotations

from dataclasses import replace

from sprung.analysis.analysis import Analysis
from sprung.estimation import escape_local_optimum, uncertainty_of, weigh_statements
from sprung.progress import Progress, Step


def estimate_uncertainty(run: Analysis, progress: Progress) -> Analysis:
    """Compute the covariance of the parameters at the highest optimum near by."""
    progress(Step("computing the uncertainties"))
    # A motion that is stepped takes as long to probe as to fit, and its search began from both ends.
    fit = run.fit if run.model.structure.is_time_stepped else escape_local_optimum(run.fit)
    fit = weigh_statements(fit)
    statistics = uncertainty_of(fit)
    run = replace(run, search=replace(run.model, fit=fit), statistics=statistics)
    what = f"variances are enlarged by {statistics.inflation:.3g}"
    return run.noted("estimate_uncertainty", what, statistics.inflated_by)

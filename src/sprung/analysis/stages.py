"""The list of stages, from recordings to a result."""

from __future__ import annotations

from sprung.analysis.all_samples import use_all_samples
from sprung.analysis.analysis import Analysis, AnalysisOptions, Stage
from sprung.analysis.assessment import assess
from sprung.analysis.baseline import fit_baseline
from sprung.analysis.clocks import synchronise
from sprung.analysis.faults import isolate_evident_faults, isolate_faults
from sprung.analysis.flight import use_flight
from sprung.analysis.preparation import preprocess
from sprung.analysis.taking_back import take_back_corrections
from sprung.analysis.terms import (
    select_finite_rotation,
    select_first_term,
    select_linear_terms,
    select_nonlinear_terms,
)
from sprung.analysis.uncertainty import estimate_uncertainty
from sprung.campaign import Campaign
from sprung.progress import Progress, silent

STAGES: tuple[Stage, ...] = (
    preprocess,
    synchronise,
    fit_baseline,
    isolate_evident_faults,
    select_first_term,
    isolate_evident_faults,
    select_linear_terms,
    select_finite_rotation,
    isolate_evident_faults,
    select_nonlinear_terms,
    take_back_corrections,
    isolate_faults,
    use_all_samples,
    estimate_uncertainty,
    use_flight,
    assess,
)
"""In this order; `Analysis.restart` is the only way back."""


def analyse(campaign: Campaign, options: AnalysisOptions, progress: Progress = silent) -> Analysis:
    """Analyse a campaign.

    Parameters
    ----------
    campaign
        The campaign.
    options
        What is asked.
    progress
        Called with each step that begins.

    Returns
    -------
    Analysis
        With its result.
    """
    return Analysis.start(campaign, options, STAGES).run(progress)

"""The analysis of a campaign: one frozen record that goes through a list of stages."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.estimation import FitResult, FitStatistics
from sprung.faults import Hypothesis
from sprung.preprocess import FreeDecay, Prepared
from sprung.progress import Progress, silent
from sprung.results import Result, TraceStep
from sprung.selection import ModelSearch, ModelStructure
from sprung.vehicle import Tracks

Stage: TypeAlias = "Callable[[Analysis, Progress], Analysis]"
"""A function from record to record; its name stands in the trace."""

MOST_RESTARTS = 4
"""Corrections of a campaign, one after the other."""


@dataclass(frozen=True)
class AnalysisOptions:
    """What was asked of an identification.

    Attributes
    ----------
    tracks, terms
        Override the campaign's ``[model]``; None for what it says.
    fall
        Whether drops are used from their release on; None for where that is needed.
    start
        Parameter values of a vehicle near the one that is sought, SI, by name.
    profile
        Quantities whose interval is to follow from the profile of the likelihood.
    texts
        The options as the user gave them, for the result.
    """

    tracks: Tracks | None = None
    terms: tuple[str, ...] | None = None
    fall: bool | None = None
    start: Mapping[str, float] = field(default_factory=dict)
    profile: tuple[str, ...] = ()
    texts: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Analysis:
    """How far the analysis of a campaign has come.

    Attributes
    ----------
    campaign
        With what is wrong corrected or left out, and named.
    options
        What was asked.
    stages
        All of them, in order.
    remaining
        Those that are still to come.
    preprocessed
        The campaign before anything was isolated, what its first motion contradicts corrected; None until then.
    excluded
        Why drops are left out, by the names of their recordings.
    corrected
        The hypotheses that were accepted.
    suspected
        Faults that were found and of which nothing was changed.
    preparation
        The decays as they were found in the recordings; None until the campaign is preprocessed.
    without_wheels
        The decays as they would begin if no wheel sensor showed the landing; None until they are needed.
    clock_fit
        The fit that set the clocks of several loggers; None where there is one clock.
    requested
        The model that is asked for, as far as it is; None until there is a baseline.
    search
        The model so far, its fit and the decays that it uses; None until there is a baseline.
    first_term
        The model term that is tried before all others; None where none is known to explain much.
    isolated
        The fit in which faults were last looked for, and what was found.
    statistics
        Uncertainty of the fit; None until it is computed.
    remarks
        What is to be said of the fit beside the terms of the model.
    result
        None until the fit is assessed.
    trace
        What was done, and why.
    fits, preparations
        How many fits were made, and how often the recordings were preprocessed.
    """

    campaign: Campaign
    options: AnalysisOptions
    stages: tuple[Stage, ...]
    remaining: tuple[Stage, ...]
    preprocessed: Campaign | None = None
    excluded: Mapping[str, Fault] = field(default_factory=dict)
    corrected: tuple[Hypothesis, ...] = ()
    suspected: tuple[Fault, ...] = ()
    preparation: Prepared | None = None
    without_wheels: tuple[FreeDecay, ...] | None = None
    clock_fit: FitResult | None = None
    requested: ModelStructure | None = None
    search: ModelSearch | None = None
    first_term: str | None = None
    isolated: tuple[FitResult, tuple[Hypothesis, ...]] | None = None
    statistics: FitStatistics | None = None
    remarks: tuple[str, ...] = ()
    result: Result | None = None
    trace: tuple[TraceStep, ...] = ()
    fits: int = 0
    preparations: int = 0

    @classmethod
    def start(cls, campaign: Campaign, options: AnalysisOptions, stages: Sequence[Stage]) -> Analysis:
        """Start the analysis of a campaign."""
        return cls(campaign, options, tuple(stages), tuple(stages))

    def run(self, progress: Progress = silent) -> Analysis:
        """Go through all stages that remain.

        Parameters
        ----------
        progress
            Called with each step that begins.
        """
        analysis = self
        while analysis.remaining:
            stage, *remaining = analysis.remaining
            analysis = stage(replace(analysis, remaining=tuple(remaining)), progress)
        return analysis

    def restart(self, campaign: Campaign, hypotheses: Sequence[Hypothesis], stage: str, why: str) -> Analysis:
        """Return to the first stage with a corrected campaign: the only way back.

        Parameters
        ----------
        campaign
            Corrected, and what is wrong with it named.
        hypotheses
            What was accepted.
        stage
            Which stage returns.
        why
            For what reason.
        """
        excluded = {one.recording: one.fault for one in hypotheses if one.recording is not None}
        preparation = self.preparation if len(excluded) == len(hypotheses) else None
        again = replace(
            self,
            campaign=campaign,
            corrected=(*self.corrected, *hypotheses),
            excluded={**self.excluded, **excluded},
            preparation=preparation,
            without_wheels=None,
            search=None,
            clock_fit=None,
            first_term=None,
            isolated=None,
            remaining=self.stages,
        )
        return again.noted(stage, "restart with the corrected campaign", why)

    def noted(self, stage: str, what: str, why: str = "") -> Analysis:
        """Return the same with a step added to the trace."""
        return replace(self, trace=(*self.trace, TraceStep(stage, what, why)))

    @property
    def prepared(self) -> Prepared:
        """The decays; they are there from the first stage on."""
        if self.preparation is None:
            raise RuntimeError("the campaign is preprocessed in the first stage")
        return self.preparation

    @property
    def stated(self) -> Campaign:
        """The campaign before anything was isolated; it is there from the first stage on."""
        if self.preprocessed is None:
            raise RuntimeError("the campaign is preprocessed in the first stage")
        return self.preprocessed

    @property
    def model(self) -> ModelSearch:
        """The model and its fit; they are there from the baseline on."""
        if self.search is None:
            raise RuntimeError("the baseline is fitted before")
        return self.search

    @property
    def found(self) -> tuple[Hypothesis, ...]:
        """What was isolated in the present fit."""
        return self.isolated[1] if self.isolated is not None and self.isolated[0] is self.fit else ()

    @property
    def refuting(self) -> tuple[Fault, ...]:
        """What was isolated last that shows that no vehicle recorded all drops; it holds for later steps of the fit too."""
        return tuple(one.fault for one in self.isolated[1] if one.is_refuting) if self.isolated is not None else ()

    @property
    def fit(self) -> FitResult:
        """Where the last fit ended."""
        return self.model.fit

    @property
    def decays(self) -> tuple[FreeDecay, ...]:
        """What was fitted last."""
        return tuple(self.model.decays)

    @property
    def uncertainty(self) -> FitStatistics:
        """Uncertainty of the fit; it is there from the stage on that computes it."""
        if self.statistics is None:
            raise RuntimeError("the uncertainty is computed before")
        return self.statistics

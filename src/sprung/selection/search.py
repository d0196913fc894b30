"""State of the search for the model: structure and fit so far, every step taken, and what a further term has to gain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.assessment import EXPLAINED, estimate_model_error
from sprung.estimation import NEAR, FitResult, per_total_mass, unexplained_squares, wald_test
from sprung.preprocess import FreeDecay
from sprung.progress import Progress, silent
from sprung.selection.error_budget import (
    HARDLY_EXPLAINED,
    LEAST_SHARE,
    MISFIT_LEFT_AT_FIRST,
    MODEL_ERROR,
    OVERDISPERSED,
    UNEXPLAINED,
    required_gain,
)
from sprung.selection.linear_terms import SEPARATE_TRACKS
from sprung.selection.selection_step import SelectionStep
from sprung.selection.sensor_errors import SensorError
from sprung.selection.starts import fit_structure, states_by_coordinates
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import TERMS
from sprung.selection.unlike_drops import UnlikeDrops
from sprung.vehicle import PARAMETERS

Real = NDArray[np.float64]

_HYPOTHESES = sum(not term.on_request for term in TERMS.values()) + 1
"""Hypotheses that are tried on a campaign: every term, and the leakage of gravity."""

_MATTERS, _BEYOND_NOISE = 0.01, 2.0
"""By how much a term has to move another parameter to be more than negligible: relatively, and in standard errors."""


@dataclass(frozen=True, eq=False)
class ModelSearch:
    """State of the search for the model.

    Attributes
    ----------
    structure, fit
        The model so far, and its fit.
    decays
        What is fitted.
    steps
        What was tried.
    progress
        Called with each step that begins.
    seeks_faults
        Whether faults are looked for beside nonlinear terms.
    fault
        What is wrong with a sensor or with drops; then nothing more is looked for until it is corrected.
    """

    structure: ModelStructure
    fit: FitResult
    decays: Sequence[FreeDecay]
    steps: tuple[SelectionStep, ...] = ()
    progress: Progress = silent
    seeks_faults: bool = False
    fault: SensorError | UnlikeDrops | None = None

    @cached_property
    def samples(self) -> float:
        """Number of samples that are fitted, all channels together."""
        return float(sum(decay.usable.sum() * decay.samples for decay in self.decays))

    def significant(self, term: str) -> float:
        """Gain in twice the log-likelihood from which a term is significant: what a score test has to promise."""
        row = TERMS[term]
        parameters = row.parameters(self.structure.tracks, self.structure.layout)
        # What most vehicles have beside a term of the model, a mount its damping, is no discovery: only chance speaks
        # against it, and without it the other one's parameters are wrong.
        is_usual = row.is_usual_beside(self.structure.terms)
        return required_gain(len(parameters), *((1, 1.0) if is_usual else (_HYPOTHESES, self.samples)))

    def required(self, term: str) -> float:
        """Gain in twice the log-likelihood that is required of a term; where much is left to explain, a part of that."""
        return max(self.significant(term), LEAST_SHARE * self.unexplained_gain)

    @property
    def required_of_switch(self) -> float:
        """Gain that is required of a change of the model without a parameter."""
        return required_gain(0, _HYPOTHESES, self.samples)

    def open_terms(self, among: Sequence[str]) -> list[str]:
        """Terms about which the recordings decide and that the model has not; none that refines a term that is absent.

        Parameters
        ----------
        among
            Only these terms.
        """
        tracks = [SEPARATE_TRACKS] if self.structure.tracks_open and self.structure.tracks == "shared" else []
        present = self.structure.terms
        terms = [
            term
            for term in self.structure.open_terms
            if term not in present
            and not TERMS[term].on_request
            and (not TERMS[term].refines or TERMS[term].refines in present)
        ]
        return [term for term in (*tracks, *terms) if term in among]

    @property
    def refused(self) -> frozenset[str]:
        """Terms that were fitted and not included since the model is what it is."""
        taken = [number for number, step in enumerate(self.steps) if step.taken]
        since = self.steps[taken[-1] + 1 :] if taken else self.steps
        return frozenset(step.extra for step in since if step.fitted)

    @property
    def selected(self) -> list[str]:
        """Terms that the recordings brought into the model."""
        structure = self.structure
        tracks = [SEPARATE_TRACKS] if structure.tracks_open and structure.tracks == "separate" else []
        return [*tracks, *(term for term in structure.terms if term in structure.open_terms)]

    def with_terms(self, terms: Sequence[str]) -> ModelStructure:
        """Return the structure with more terms."""
        added = tuple(term for term in terms if term != SEPARATE_TRACKS)
        tracks = "separate" if SEPARATE_TRACKS in terms else self.structure.tracks
        return self.structure.with_terms((*self.structure.terms, *added), tracks)

    def without(self, *terms: str) -> ModelStructure:
        """Return the structure without some of its terms and what refines them."""
        kept = tuple(other for other in self.structure.terms if not {other, TERMS[other].refines} & {*terms})
        return self.structure.with_terms(kept, "shared" if SEPARATE_TRACKS in terms else None)

    def recorded(self, gains: Mapping[str, float], fitted: bool, taken: bool, against: str = "") -> ModelSearch:
        """Return the search with one step more for each term and its gain.

        Parameters
        ----------
        gains
            Gain in twice the log-likelihood by term.
        fitted, taken
            Whether they were fitted, and whether they stay.
        against
            Why they do not stay although they gain enough.
        """
        more = [
            SelectionStep(term, gain, self.required(term), fitted, taken, against, joint=fitted and number > 0)
            for number, (term, gain) in enumerate(gains.items())
        ]
        return replace(self, steps=(*self.steps, *more))

    def refit(
        self,
        structure: ModelStructure,
        most: int = 100,
        beginning_only: bool = False,
        enough: float | None = None,
        states: Real | None = None,
    ) -> ModelSearch:
        """Fit another structure from here.

        Parameters
        ----------
        structure
            What is fitted.
        most
            Largest number of iterations.
        beginning_only
            Whether the beginnings of the decays are enough; for nonlinear structures.
        enough
            Expected gain in log-likelihood at which to stop; without it, a tenth of a standard error, or one where motions are
            stepped: a term has to gain many times as much.
        states
            {X, Ẋ} and memories of each drop to begin with, SI, shape (drop, state + memory), where these are not the fit's.
        """
        if enough is None:
            enough = self.overdispersion if structure.is_time_stepped else NEAR
        fit = fit_structure(structure, self.decays, self.fit, enough, self.progress, states, beginning_only, most)
        return replace(self, structure=structure, fit=fit)

    def refit_as(self, other: ModelSearch) -> ModelSearch:
        """Fit the model of a later search to the decays of this one, from its parameters.

        Parameters
        ----------
        other
            Of the same drops, whose decays may begin later.
        """
        if not other.structure.is_time_stepped:
            return other
        states = states_by_coordinates(self.fit.states, self.fit.names, other.structure.names)
        fit = fit_structure(other.structure, self.decays, other.fit, other.overdispersion, self.progress, states)
        return replace(other, fit=fit, decays=self.decays)

    @cached_property
    def overdispersion(self) -> float:
        """By how much less the recordings tell than white residuals of drops that agree would: a factor on variances."""
        return self.fit.overdispersion

    @cached_property
    def sensor_noise(self) -> Real:
        """Variance of each channel by its noise at rest and its resolution, (m/s²)²; 0 where unknown; shape (channel,).

        A vehicle may still swing on its blocks: what neighbouring samples share at rest is left out.
        """
        noise = self.fit.sensor_noise
        white = np.clip(noise.variance - noise.neighbour, 0.0, noise.variance)
        return np.where(noise.samples > 0, white + noise.added, 0.0)

    @cached_property
    def has_model_error(self) -> bool:
        """Whether the model leaves much more than the noise of the sensors."""
        known = self.sensor_noise > 0
        ratio = self.fit.noise[known] ** 2 / self.sensor_noise[known]
        return bool(known.any()) and float(ratio.mean()) > 1 + MODEL_ERROR

    @cached_property
    def excess_over_noise(self) -> Real:
        """Variance that the model leaves beyond the noise of each sensor, over that; 0 where unknown; shape (channel,)."""
        variance, _, _ = self.fit.residual_moments
        ratio = np.maximum(variance, self.sensor_noise) / np.where(self.sensor_noise > 0, self.sensor_noise, np.inf)
        return np.maximum(ratio - 1.0, 0.0)

    @cached_property
    def unexplained_gain(self) -> float:
        """Gain in twice the log-likelihood, over the overdispersion, if only the noise of the sensors were left."""
        if not self.has_model_error:
            return 0.0
        _, _, samples = self.fit.residual_moments
        return float(np.sum(samples * np.log1p(self.excess_over_noise))) / self.overdispersion

    @cached_property
    def is_misfit_large(self) -> bool:
        """Whether the model error is so large a part of the signal that the parameters cannot be trusted.

        In one channel alone it is its sensor's: whatever a vehicle does, more than one shows it.
        """
        return float(np.sort(self._model_error)[-2:].min()) > UNEXPLAINED

    @cached_property
    def is_doubtful(self) -> bool:
        """Whether the model does not explain what some channel records, so that its parameters would not be accepted."""
        return self.is_overdispersed and float(self._model_error.max()) > EXPLAINED

    @cached_property
    def _model_error(self) -> Real:
        """Of each channel, as a part of its signal."""
        return estimate_model_error(self.fit)[0]

    @property
    def is_overdispersed(self) -> bool:
        """Whether what is left is no noise."""
        return self.overdispersion > OVERDISPERSED

    @property
    def lacks_something(self) -> bool:
        """Whether what is left is no noise, and more than the sensors' own."""
        return self.is_overdispersed and self.has_model_error

    @property
    def is_misfit_small(self) -> bool:
        """Whether what is left is no noise and yet small: any further term would seem to explain some of it."""
        return self.is_overdispersed and not self.has_model_error

    def discount_of(self, fit: FitResult) -> float:
        """Return by how much less a gain counts that is expected of a fit on the way to one with a further term.

        Colour of the residuals may be what the term explains. Where they are as small as noise, it is the noise's own.

        Parameters
        ----------
        fit
            The present one, or one after a step with the term.
        """
        return fit.overdispersion if self.is_misfit_small else fit.disagreement

    def gain_over(self, other: ModelSearch) -> float:
        """Return the gain in twice the log-likelihood over another fit of the same decays, divided by the overdispersion.

        Parameters
        ----------
        other
            Another fit of the same decays. Where one of them has a low-pass of the loggers, what records may show behind it
            whatever the motion counts for neither.
        """
        low_pass = self.structure.low_pass or other.structure.low_pass
        if self.structure.low_pass == other.structure.low_pass:
            return 2 * (self.fit.loglikelihood - other.fit.loglikelihood) / self.overdispersion
        rates = [decay.rate for decay in self.fit.decays]
        (own, samples), (others, _) = (
            unexplained_squares(fit.residuals, rates, low_pass) for fit in (self.fit, other.fit)
        )
        used = own > 0
        return float(samples[used] @ np.log(others[used] / own[used])) / self.overdispersion

    def delta_bic(self, other: ModelSearch) -> float:
        """Return the gain over another model beyond what the Bayesian information criterion asks for the further parameters.

        Parameters
        ----------
        other
            Another fit of the same decays.
        """
        more = len(self.structure.names) - len(other.structure.names)
        return self.gain_over(other) - more * float(np.log(self.samples))

    def wald_gain(self, *terms: str) -> float:
        """Return what twice the log-likelihood would lose without some terms, by a Wald test, divided by the overdispersion.

        Parameters
        ----------
        terms
            Of the model.
        """
        neutral = [
            value for term in terms for value in TERMS[term].neutral(self.structure.tracks, self.structure.layout)
        ]
        return wald_test(self.fit, neutral) / self.overdispersion

    def needs(self, term: str) -> bool:
        """Whether nothing speaks against a term of the model, and twice the log-likelihood would lose enough without it."""
        return not self.veto(term) and self.wald_gain(term) > self.required(term)

    def is_lost(self, term: str) -> bool:
        """Whether a term of the model, or a part of it, is not needed: its size at one of the axles, say."""
        parts = TERMS[term].neutral(self.structure.tracks, self.structure.layout)
        limit = required_gain(1, 1, 1.0, self.overdispersion)
        return not self.needs(term) or any(wald_test(self.fit, [part]) < limit for part in parts)

    def veto(self, term: str, without: ModelSearch | None = None) -> str:
        """Reason against a term of the model, whatever it gains; empty where there is none.

        Parameters
        ----------
        term
            Of the model.
        without
            A model without it, which shows whether the term explains much although the recordings do not determine it, or
            matters although it is small.
        """
        row, parameters = TERMS[term], self.fit.parameters
        limit = required_gain(1, 1, 1.0, self.overdispersion)
        below = [
            name for name in row.not_negative(self.structure.tracks, self.structure.layout) if parameters[name] < 0
        ]
        if any(wald_test(self.fit, [(name, 0.0)]) > limit for name in below):
            return "the estimate is negative, which is not physical"
        undetermined = self.undetermined(term)
        if undetermined and not (without and self.explains_much(term, without)):
            return f"the recordings do not determine {', '.join(undetermined)}"
        if row.is_something_else(parameters):
            return "no part of its kind vibrates, relaxes or has a knee like that"
        size = abs(row.size(parameters))
        if size < row.negligible and not (without and self.moves_others(without)):
            return f"its effect of {100 * size:.2g} % is negligible"
        return ""

    def explains_much(self, term: str, without: ModelSearch) -> bool:
        """Whether a term explains so much that it is there, however little is known of what it is.

        Parameters
        ----------
        term
            Of the model.
        without
            A model without it: what it gains counts by how much the drops contradict each other there.
        """
        gain = 2 * (self.fit.loglikelihood - without.fit.loglikelihood)
        return gain / without.fit.disagreement > self.required(term)

    def moves_others(self, without: ModelSearch) -> bool:
        """Whether a positive parameter of a smaller model has another value in this one, to anybody who uses it.

        Beside the total mass, by more than a percent and more than the records leave open in the smaller model. Where that
        one leaves a misfit, whatever is added moves parameters, which says nothing.

        Parameters
        ----------
        without
            The smaller model.
        """
        if without.is_overdispersed:
            return False
        names, own = without.fit.names, dict(zip(self.fit.names, self.fit.iterate.u.tolist(), strict=True))
        before = without.fit.iterate.u
        steps = np.array([own.get(name, there) for name, there in zip(names, before.tolist(), strict=True)]) - before
        moved = np.abs(per_total_mass(without.fit, np.eye(len(names))) @ steps)
        least = np.maximum(_MATTERS, _BEYOND_NOISE * np.sqrt(without.relative_variances))
        positive = np.array([name in PARAMETERS and PARAMETERS[name].positive for name in names])
        return bool(np.any((moved > least) & positive))

    def undetermined(self, term: str) -> list[str]:
        """Return the positive parameters of a term of the model that are not known to a factor of e beside the total mass."""
        names = TERMS[term].parameters(self.structure.tracks, self.structure.layout)
        places = {name: self.fit.names.index(name) for name in names if PARAMETERS[name].positive}
        return [name for name, at in places.items() if not self.relative_variances[at] < 1]

    @cached_property
    def relative_variances(self) -> Real:
        """Variance of each coordinate of the fit beside the total mass, of the logarithm where positive; shape (coordinate,).

        Infinite where the records tell nothing.
        """
        equations = self.fit.problem.normal_equations(self.fit.iterate)
        along = per_total_mass(self.fit, np.eye(len(self.fit.names))) @ equations.directions
        variances = np.einsum("ud,du->u", along, np.linalg.solve(equations.information, along.T)) * self.overdispersion
        # A direction without information is not among those of the equations at all.
        seen = np.sum(equations.directions**2, axis=1) > 0.5
        return np.where(seen, variances, np.inf)

    def leaves_misfit(self, fit: FitResult, part: float) -> bool:
        """Whether another fit, of the decays or their beginnings, leaves more than a part of this one's model error there."""
        before, after = self._much_left(fit)
        # Of a motion without bounds the part is no number.
        return bool(before.size) and not float(after.sum()) <= part * float(before.sum())

    def leaves_most(self, fit: FitResult) -> bool:
        """Whether another fit, on its way, leaves most of this one's model error: of all channels together, and in their mean.

        What one sensor shows above all others, a wheel what its tyre does, may be what a further term explains, unless it is
        most of what that sensor shows.
        """
        before, after = self._much_left(fit)
        if not before.size or after.sum() <= MISFIT_LEFT_AT_FIRST * before.sum():
            return False
        in_mean = (after / before).mean() <= MISFIT_LEFT_AT_FIRST
        return not (in_mean and estimate_model_error(fit)[0].max() < HARDLY_EXPLAINED)

    def _much_left(self, fit: FitResult) -> tuple[Real, Real]:
        """Return what this fit and another one leave, over the noise, in the channels in which this one leaves much."""
        before, after = self._model_errors(fit)
        much = (self.sensor_noise > 0) & (before > self.sensor_noise)
        return before[much] / self.sensor_noise[much], after[much] / self.sensor_noise[much]

    def is_better_than(self, fit: FitResult) -> bool:
        """Whether another fit, of the decays or their beginnings, leaves more in some channel there, by more than the noise."""
        before, after = self._model_errors(fit)
        return bool(np.any(~(after <= before + self.sensor_noise)[self.sensor_noise > 0]))

    def _model_errors(self, fit: FitResult) -> tuple[Real, Real]:
        """Return the variances beyond noise that this fit and another one leave where both fitted, (m/s²)², (channel,) each."""
        lengths = [residual.shape[1] for residual in fit.residuals]
        own = [residual[:, :length] for residual, length in zip(self.fit.residuals, lengths, strict=True)]
        before, after = (
            np.maximum(_mean_squares(np.concatenate(residuals, axis=1)) - self.sensor_noise, 0.0)
            for residuals in (own, fit.residuals)
        )
        return before, after

    @property
    def reason(self) -> str:
        """What decided on the model, in words."""
        if not (self.structure.tracks_open or self.structure.open_terms):
            return f"half-distances {self.structure.tracks}, as the campaign says or what is known implies"
        last = {step.extra: step for step in self.steps}
        taken = ", ".join(step.text for step in last.values() if step.taken and step.extra in self.selected)
        refused = ", ".join(step.text for step in last.values() if step.extra not in self.selected)
        decided = f"supported by the data: {taken}" if taken else ""
        return (f"model terms {decided}" if decided else "no further model term is supported by the data") + (
            f"; not supported: {refused}" if refused else ""
        )


def _mean_squares(residuals: Real) -> Real:
    """Return the mean square of each channel over the samples that are numbers, shape (channel,); NaN where none is."""
    is_number = ~np.isnan(residuals)
    with np.errstate(over="ignore"):  # of a motion without bounds
        sums, counts = np.sum(np.where(is_number, residuals, 0.0) ** 2, axis=1), is_number.sum(axis=1)
    means: Real = np.divide(sums, counts, out=np.full(len(sums), np.nan), where=counts > 0)
    return means

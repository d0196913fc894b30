"""Where the choice of extras stands: the model and its fit, what was tried, and what anything further has to gain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.estimation import NEAR, FitResult, overdispersion_of
from sprung.preprocess import FreeDecay
from sprung.progress import Progress, silent
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import SEPARATE, brought, decided, fit_structure, possible, size_of

Real = NDArray[np.float64]

ERRS = 2.0
"""Inflation from which the model errs, and not only the sensors."""

_MATTERS = 0.03
"""Size of an extra, as a part, below which it may be what is left of a model error."""

_MUCH = 0.2
"""Part of the sensors' variance that a model may leave unexplained beside it."""


@shown
@dataclass(frozen=True)
class SelectionStep:
    """One step of the way to the model.

    Attributes
    ----------
    extra
        What was tried.
    gain
        In twice the log-likelihood, over the inflation; expected where it was not fitted, lost where it was left out again.
    asked
        What the Bayesian information criterion asks for its parameters.
    fitted
        Whether it was fitted, or only scored.
    taken
        Whether it stayed.
    against
        Why it did not, where it gained enough.
    """

    extra: str
    gain: float
    asked: float
    fitted: bool
    taken: bool
    against: str = ""

    @property
    def text(self) -> str:
        """The attempt in words."""
        but = f", but {self.against}" if self.against else ""
        return f"{self.extra} (Δ2lnL = {max(self.gain, 0.0):.0f}, required {self.asked:.0f}{but})"


@dataclass(frozen=True, eq=False)
class ModelSearch:
    """Where the choice of extras stands.

    Attributes
    ----------
    structure, fit
        The model, and where its fit ended.
    decays
        What is fitted.
    steps
        What was tried.
    progress
        Called with each step that begins.
    """

    structure: ModelStructure
    fit: FitResult
    decays: Sequence[FreeDecay]
    steps: tuple[SelectionStep, ...] = ()
    progress: Progress = silent

    def asked(self, extra: str) -> float:
        """Give what is asked of an extra."""
        return len(brought(extra, self.structure.tracks)) * self.each

    @property
    def each(self) -> float:
        """What is asked of one parameter."""
        return float(np.log(sum(decay.usable.sum() * decay.samples for decay in self.decays)))

    def open_among(self, among: Sequence[str]) -> list[str]:
        """Give what may be tried and is not in the model."""
        tracks = [SEPARATE] if self.structure.tracks_open and self.structure.tracks == "shared" else []
        free = [extra for extra in self.structure.open_terms if extra not in self.structure.terms]
        return [extra for extra in (*tracks, *free) if extra in among]

    def larger(self, extras: Sequence[str]) -> ModelStructure:
        """Give the model with more extras."""
        added = tuple(extra for extra in extras if extra != SEPARATE)
        return self.structure.with_terms((*self.structure.terms, *added), "separate" if SEPARATE in extras else None)

    def noted(self, gains: Mapping[str, float], fitted: bool, taken: bool, against: str = "") -> ModelSearch:
        """Give the same with attempts noted, by extra and gain."""
        notes = [SelectionStep(extra, gain, self.asked(extra), fitted, taken, against) for extra, gain in gains.items()]
        return replace(self, steps=(*self.steps, *notes))

    def refit(self, choice: ModelStructure) -> ModelSearch:
        """Fit another model from here."""
        return replace(self, structure=choice, fit=fit_structure(choice, self.decays, self.fit, NEAR, self.progress))

    @cached_property
    def inflation(self) -> float:
        """By how much the records tell less than white residuals of drops that agree would."""
        return overdispersion_of(self.fit)

    @cached_property
    def _rest(self) -> Real:
        """Variance of each channel while the vehicle stood on its blocks, (m/s²)²; 0 where nobody knows; shape (channel,)."""
        rests = [decay.rest.noise for decay in self.decays if decay.rest.noise.shape[1]]
        variances = [np.nan_to_num(noise.var(axis=1)) for noise in rests] or [np.zeros_like(self.fit.noise)]
        rest: Real = np.mean(variances, axis=0)
        return rest

    @property
    def errs(self) -> bool:
        """Whether the model leaves much beside the sensors' noise."""
        known = self._rest > 0
        return bool(known.any()) and float(np.mean(self.fit.noise[known] ** 2 / self._rest[known])) > 1 + _MUCH

    def worth(self, than: ModelSearch) -> float:
        """Give what it gains over another way, in twice the log-likelihood, beyond what is asked of its parameters."""
        gain = 2 * (self.fit.loglikelihood - than.fit.loglikelihood) / self.inflation
        return gain - (len(self.structure.names) - len(than.structure.names)) * self.each

    def against(self, extra: str, inflation: float) -> str:
        """Say what speaks against an extra, whatever it gains; nothing where nothing does."""
        if not possible(extra, self.fit):
            return "the estimate is negative, which is not physical"
        if inflation > ERRS and size_of(extra, self.fit.parameters) < _MATTERS:
            return "it is too small to be told from other errors of the model"
        return ""

    def explains_little(self, begun: FitResult, part: float) -> bool:
        """Say whether more than a part of what the linear vehicle leaves is left still: then something else is the matter."""
        before, after = (np.maximum(one.noise**2 - self._rest, 0.0) for one in (self.fit, begun))
        much = before > self._rest
        return bool(much.any()) and float(np.mean(after[much] / before[much])) > part

    @property
    def reason(self) -> str:
        """What decided on the model, in words."""
        choice = self.structure
        if not (choice.tracks_open or choice.open_terms):
            return f"half-distances {choice.tracks}, as the campaign says or what is known implies"
        last = {one.extra: one for one in self.steps}
        taken = ", ".join(one.text for one in last.values() if one.taken and one.extra in decided(choice))
        refused = ", ".join(one.text for one in last.values() if one.extra not in decided(choice))
        said = (
            f"model terms supported by the data: {taken}" if taken else "no further model term is supported by the data"
        )
        return said + (f"; not supported: {refused}" if refused else "")

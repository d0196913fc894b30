"""Fits of a campaign as it is and as it would be corrected: what each leaves of the recordings.

All hypotheses are compared on the same samples. Decays are corrected directly; no campaign is preprocessed again here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign
from sprung.estimation import MOST_STEPS, NEAR, FitResult, fit_linear
from sprung.faults.consistency import score_faults_of
from sprung.faults.correction import Correction, mask_channel
from sprung.faults.fault_scores import FaultScore
from sprung.faults.residual_table import ResidualTable, reference_noise, residual_table
from sprung.preprocess import FreeDecay, SensorNoise, prepare
from sprung.selection import ModelStructure
from sprung.vehicle import LinearModel

Real = NDArray[np.float64]

DRIFT_SPAN = 0.5
"""s over which a drift is constant, unlike a vibration."""

_DRIFT_SHARE = 0.75
"""Share of a residual's energy that means over this span keep if it is a drift."""

_STEPS = 3
"""Gauss-Newton steps of a deletion or an exchange where the fit of everything may be far away."""

_STARTS = 2
"""Starts of a fit without a channel or drop, of which no vehicle is known."""


@dataclass(frozen=True, eq=False)
class CandidateFit:
    """The fit of a campaign as it is, as it was corrected, or of a part of it.

    Attributes
    ----------
    structure
        The model.
    recordings
        Names of all recordings, in order: the rows of every residual table.
    decays
        What was fitted.
    fit
        Where the fit ended.
    table
        Its residuals by the drops and channels of the whole campaign.
    noise
        What the sensors read at rest.
    whole
        The same model with the decays from the landing on, where these begin later; else None.
    """

    structure: ModelStructure
    recordings: tuple[str, ...]
    decays: tuple[FreeDecay, ...]
    fit: FitResult
    table: ResidualTable
    noise: SensorNoise
    whole: CandidateFit | None = None

    @classmethod
    def of(cls, structure: ModelStructure, decays: Sequence[FreeDecay], fit: FitResult | None = None) -> CandidateFit:
        """Take up a model of a campaign, its decays and their fit; without a fit they are fitted.

        Parameters
        ----------
        structure
            The model, with its campaign.
        decays
            Of all drops that can be used.
        fit
            Of them.
        """
        fit = _fitted(structure, decays) if fit is None else fit
        return _candidate(structure, tuple(decay.file for decay in decays), decays, fit)

    @property
    def campaign(self) -> Campaign:
        """What was fitted."""
        return self.structure.campaign

    @property
    def models(self) -> Mapping[str, LinearModel]:
        """Equations of motion by load name."""
        return self.structure.linear_models

    @property
    def is_explained(self) -> bool:
        """Whether the residuals are noise alone."""
        return self.table.is_explained(self.noise)

    @property
    def misfit(self) -> float:
        """What the residuals are beyond noise, in twice the log-likelihood."""
        return self.table.misfit(self.noise)

    @cached_property
    def drifting(self) -> NDArray[np.bool_]:
        """Of which channels the residual is a drift: means over half a second keep most of it; shape (channel,)."""
        kept = energy = np.zeros(len(self.campaign.sensors))
        for record, decay in zip(self.fit.residuals, self.decays, strict=True):
            length = max(int(DRIFT_SPAN * decay.rate), 1)
            count = decay.samples // length
            batches = np.nan_to_num(record[:, : count * length]).reshape(len(record), count, length)
            kept = kept + length * np.sum(batches.mean(axis=2) ** 2, axis=1)
            energy = energy + np.sum(batches**2, axis=(1, 2))
        excess = energy - self.noise.level**2 * self.table.counts.sum(axis=0)
        return np.asarray(kept > _DRIFT_SHARE * np.maximum(excess, np.finfo(float).tiny))

    @cached_property
    def scores(self) -> tuple[FaultScore, ...]:
        """Scores of all faults of small size, the largest gain first."""
        return score_faults_of(self.campaign, self.decays, self.fit)

    def refit(self, correction: Correction, start: FitResult | None = None) -> CandidateFit:
        """Fit the corrected campaign.

        Parameters
        ----------
        correction
            Of the campaign.
        start
            A fit near by; without one the search begins anew.
        """
        return self._corrected(correction, start, MOST_STEPS)

    def step(self, correction: Correction, start: FitResult | None = None) -> CandidateFit:
        """Fit the corrected campaign by one Gauss-Newton step from a fit, or without one from the direct estimate.

        One step tells which of many deletions changes a fit most (Pregibon, Ann. Stat. 9 (1981) 705).

        Parameters
        ----------
        correction
            Of the campaign.
        start
            A fit near by.
        """
        return self._corrected(correction, start, 1)

    def refine(self, correction: Correction, start: FitResult) -> CandidateFit:
        """Continue a Gauss-Newton step by a few more.

        Parameters
        ----------
        correction
            Of the campaign.
        start
            Where the step ended.
        """
        return self._corrected(correction, start, _STEPS)

    def estimate(self, correction: Correction) -> CandidateFit:
        """Estimate the fit of the corrected campaign, by a few Gauss-Newton steps.

        Where the campaign is described but for a small fault, one step from its fit tells what a correction gains. Where it is
        not, the fit may be far away: then the better one of a few steps and of the direct estimate counts. That one knows no
        further terms of a model.

        Parameters
        ----------
        correction
            Leaves a channel or drop out, or exchanges two.
        """
        if self.is_explained:
            return self.step(correction, self.fit)
        near, anew = self.refine(correction, self.fit), self.step(correction)
        return min(near, anew, key=lambda candidate: candidate.table.cost)

    def _corrected(self, correction: Correction, start: FitResult | None, most: int) -> CandidateFit:
        campaign, before = correction.of_campaign(self.campaign), self.structure
        decays = correction.of_decays(campaign, self.decays)
        structure = replace(ModelStructure.decided(campaign, before.tracks, before.terms), carried_at=before.carried_at)
        start = self.fit if start is None and structure.needs_start else start
        candidate = _candidate(structure, self.recordings, decays, _fitted(structure, decays, start, most))
        is_same = correction.samples is None and not correction.corners
        noise = (
            self.noise if is_same else candidate.noise.where(np.asarray(candidate.table.counts.any(axis=0)), self.noise)
        )
        return replace(candidate, noise=noise)


def _fitted(
    structure: ModelStructure, decays: Sequence[FreeDecay], start: FitResult | None = None, most: int = MOST_STEPS
) -> FitResult:
    return fit_linear(
        decays,
        structure.linear_models,
        structure.sensors,
        structure.known,
        start=None if start is None else start.parameters,
        starts=_STARTS if most > 1 else 1,
        enough=NEAR,
        most=most,
    )


def _candidate(
    structure: ModelStructure, recordings: tuple[str, ...], decays: Sequence[FreeDecay], fit: FitResult
) -> CandidateFit:
    table, noise = residual_table(recordings, decays, fit), reference_noise(decays, fit)
    return CandidateFit(structure, recordings, tuple(decays), fit, table, noise)


def decays_without_wheel_sensors(campaign: Campaign, decays: Sequence[FreeDecay]) -> tuple[FreeDecay, ...]:
    """Let every decay begin where it would if no wheel sensor showed the landing, as one of them may be at fault.

    Parameters
    ----------
    campaign
        The campaign.
    decays
        As they were found.

    Returns
    -------
    tuple of FreeDecay
    """
    masked = campaign
    for channel, sensor in enumerate(campaign.sensors):
        if sensor.on != "body":
            masked = mask_channel(channel).of_campaign(masked)
    starts = {decay.file: decay.start for decay in prepare(masked).decays}
    moved = []
    for decay in decays:
        start = starts.get(decay.file, decay.start)
        is_moved = decay.samples_to(start) < decay.samples / 2 and not decay.is_driven
        moved.append(decay.starting_at(start) if is_moved else decay)
    return tuple(moved)

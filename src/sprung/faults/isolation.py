"""Fault isolation: the fit that does not explain the recordings, and what other fits of corrected campaigns make of them.

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
from sprung.faults.residual_table import ReferenceNoise, ResidualTable, reference_noise, residual_table
from sprung.preprocess import FreeDecay, prepare
from sprung.selection import choose_structure
from sprung.vehicle import LinearModel, Tracks

Real = NDArray[np.float64]

_DRIFT_SPAN, _DRIFT_SHARE = 0.5, 0.75
"""s over which a drift is constant, unlike a vibration; and the share of a residual's energy that means over it then keep."""

_STEPS = 3
"""Gauss-Newton steps of a deletion where the fit of everything may be far away."""

_STARTS = 2
"""Starts of a fit without a channel or drop, of which no vehicle is known."""


@dataclass(frozen=True, eq=False)
class CandidateFit:
    """The fit of a campaign that was corrected, or of a part of it.

    Attributes
    ----------
    campaign
        What was fitted.
    decays
        Its decays.
    models
        Equations of motion by load name.
    fit
        Where the fit ended.
    table
        Its residuals by the drops and channels of the whole campaign.
    noise
        What the sensors read at rest.
    """

    campaign: Campaign
    decays: tuple[FreeDecay, ...]
    models: Mapping[str, LinearModel]
    fit: FitResult
    table: ResidualTable
    noise: ReferenceNoise

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
            length = max(int(_DRIFT_SPAN * decay.rate), 1)
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


@dataclass(frozen=True, eq=False)
class FaultIsolation:
    """A campaign with a fit that does not explain it.

    Attributes
    ----------
    base
        The fit.
    recordings
        Names of all recordings, in order: the rows of every residual table.
    tracks, extras
        Of the model, which stays the same in all candidate fits.
    """

    base: CandidateFit
    recordings: tuple[str, ...]
    tracks: Tracks
    extras: tuple[str, ...]

    @classmethod
    def of(
        cls,
        campaign: Campaign,
        decays: Sequence[FreeDecay],
        fit: FitResult | None,
        tracks: Tracks,
        extras: tuple[str, ...],
    ) -> FaultIsolation:
        """Take up a campaign, its decays and their fit; without a fit they are fitted."""
        recordings = tuple(decay.file for decay in decays)
        structure = choose_structure(campaign, tracks, extras)
        if fit is None:
            fit = fit_linear(
                decays, structure.linear_models, structure.sensors, structure.known, starts=_STARTS, enough=NEAR
            )
        table, noise = residual_table(recordings, decays, fit), reference_noise(decays, fit)
        base = CandidateFit(campaign, tuple(decays), structure.linear_models, fit, table, noise)
        return cls(base, recordings, tracks, extras)

    @property
    def campaign(self) -> Campaign:
        """The campaign as it is."""
        return self.base.campaign

    @property
    def decays(self) -> tuple[FreeDecay, ...]:
        """Its decays."""
        return self.base.decays

    @property
    def noise(self) -> ReferenceNoise:
        """What the sensors read at rest."""
        return self.base.noise

    def fit(self, correction: Correction, start: FitResult | None = None) -> CandidateFit:
        """Fit the corrected campaign.

        Parameters
        ----------
        correction
            Of the campaign.
        start
            A fit near by; without one the search begins anew.
        """
        return self._fit(correction, start, MOST_STEPS)

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
        return self._fit(correction, start, 1)

    def delete(self, correction: Correction) -> CandidateFit:
        """Estimate the fit without a channel or drop, by a few Gauss-Newton steps.

        Where the campaign is described but for a small fault, one step from its fit tells what the deletion gains. Where it is
        not, the fit may be far away: then the better one of a few steps and of the direct estimate counts.

        Parameters
        ----------
        correction
            Leaves the channel or drop out.
        """
        if self.base.is_explained:
            return self.step(correction, self.base.fit)
        near, anew = self._fit(correction, self.base.fit, _STEPS), self._fit(correction, None, 1)
        return min(near, anew, key=lambda candidate: candidate.table.cost)

    def after(self, candidate: CandidateFit) -> FaultIsolation:
        """Return the isolation of what is still wrong with a corrected campaign."""
        return replace(self, base=candidate)

    def _fit(self, correction: Correction, start: FitResult | None, most: int) -> CandidateFit:
        campaign = correction.of_campaign(self.campaign)
        decays = correction.of_decays(campaign, self.decays)
        structure = choose_structure(campaign, self.tracks, self.extras)
        fit = fit_linear(
            decays,
            structure.linear_models,
            structure.sensors,
            structure.known,
            start=None if start is None else start.parameters,
            starts=_STARTS if most > 1 else 1,
            enough=NEAR,
            most=most,
        )
        table = residual_table(self.recordings, decays, fit)
        is_same = correction.samples is None and not correction.corners
        noise = self.noise if is_same else reference_noise(decays, fit).of_present(table, self.noise)
        return CandidateFit(campaign, decays, structure.linear_models, fit, table, noise)


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
        shift = round((starts.get(decay.file, decay.start) - decay.start) * decay.rate)
        moved.append(decay.shifted(max(shift, -decay.earlier.shape[1])) if shift < decay.samples / 2 else decay)
    return tuple(moved)

"""The bench: a campaign whose every drop is cut to one length, on which whatever may be wrong is tried by a fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign
from sprung.estimation import (
    NEAR,
    FitResult,
    autocorrelation_inflation,
    fit_linear,
)
from sprung.faults.changes import silenced, without_drops
from sprung.faults.tally import Noise, ResidualTable, noise_of, tally_of
from sprung.preprocess import FreeDecay, prepare
from sprung.selection import choose_structure
from sprung.vehicle import LinearModel, Tracks

Real = NDArray[np.float64]

Span = tuple[float, float]
"""First and last sample of a decay, s on the file's own clock."""

_SLOWLY, _WALKS = 0.5, 0.75
"""s over which what drifts stays what it is, unlike what vibrates; and the part of it that means over that time keep."""

_STARTS = 2
"""Starts of a fit whose vehicle nobody knows yet."""


@dataclass(frozen=True, eq=False)
class CandidateFit:
    """A campaign fitted, or a part of it.

    Attributes
    ----------
    campaign
        What was fitted; every drop has its start and end.
    decays
        Its decays.
    models
        Equations of motion by load name.
    summit
        Where the fit ended.
    tally
        What it left, by the drops and channels of the whole campaign.
    noise
        What its sensors do at rest.
    """

    campaign: Campaign
    decays: tuple[FreeDecay, ...]
    models: Mapping[str, LinearModel]
    optimum: FitResult
    tally: ResidualTable
    noise: Noise

    @property
    def explained(self) -> bool:
        """Whether it leaves nothing but noise."""
        return self.tally.explained(self.noise)

    @property
    def unexplained(self) -> float:
        """What it leaves that is more than noise, in twice the log-likelihood."""
        return self.tally.unexplained(self.noise)

    @cached_property
    def walking(self) -> NDArray[np.bool_]:
        """Of which channels what is left walks slowly, shape (channel,): means over some time keep most of it."""
        kept = energy = np.zeros(len(self.campaign.sensors))
        for record, decay in zip(self.optimum.residuals, self.decays, strict=True):
            length = max(int(_SLOWLY * decay.rate), 1)
            count = decay.samples // length
            left = np.nan_to_num(record[:, : count * length]).reshape(len(record), count, length)
            kept = kept + length * np.sum(left.mean(axis=2) ** 2, axis=1)
            energy = energy + np.sum(left**2, axis=(1, 2))
        excess = energy - self.noise.level**2 * self.tally.counts.sum(axis=0)
        return np.asarray(kept > _WALKS * np.maximum(excess, np.finfo(float).tiny))

    @cached_property
    def inflation(self) -> float:
        """By how much its records tell less than white ones."""
        return max(colour_left(self.optimum), self.optimum.disagreement)


@dataclass(frozen=True, eq=False)
class Bench:
    """A campaign whose every drop is cut to one length for good, so that whatever is tried is tried on the same samples.

    Attributes
    ----------
    campaign
        With the start and the end of every drop.
    decays
        Its decays.
    files
        The recordings, in order.
    tracks, extras
        Of the model.
    """

    campaign: Campaign
    decays: tuple[FreeDecay, ...]
    files: tuple[str, ...]
    tracks: Tracks
    extras: tuple[str, ...]

    @classmethod
    def of(cls, campaign: Campaign, decays: Sequence[FreeDecay], tracks: Tracks, extras: tuple[str, ...]) -> Bench:
        """Cut a campaign to its decays."""
        cut = _cut(campaign, {decay.file: (decay.start, decay.end) for decay in decays})
        return cls(cut, tuple(decays), tuple(recording.name for recording in cut.recordings), tracks, extras)

    @cached_property
    def base(self) -> CandidateFit:
        """The campaign fitted as it is."""
        return self.fit(self.campaign)

    @property
    def noise(self) -> Noise:
        """What the sensors do at rest."""
        return self.base.noise

    def fit(
        self,
        campaign: Campaign,
        start: Mapping[str, float] | None = None,
        decays: tuple[FreeDecay, ...] | None = None,
        roughly: bool = False,
    ) -> CandidateFit:
        """Fit the campaign otherwise.

        Parameters
        ----------
        campaign
            As it may be.
        start
            Parameter values, SI, to start from.
        decays
            Its decays, where they are at hand already.
        roughly
            Whether one step from the direct start will do.
        """
        decays = self._decays(campaign) if decays is None else decays
        choice = choose_structure(campaign, self.tracks, self.extras)
        sensors, known = campaign.sensors, choice.known
        starts, enough = (1, np.inf) if roughly else (_STARTS, NEAR)
        optimum = fit_linear(decays, choice.linear_models, sensors, known, start=start, starts=starts, enough=enough)
        noise = (
            self.base.noise if self._as_recorded(campaign) and "base" in self.__dict__ else noise_of(decays, optimum)
        )
        return CandidateFit(
            campaign, decays, choice.linear_models, optimum, tally_of(self.files, decays, optimum), noise
        )

    def after(self, trial: CandidateFit) -> Bench:
        """Give the bench on which what was tried is the campaign."""
        return replace(self, campaign=trial.campaign, decays=trial.decays)

    def _as_recorded(self, campaign: Campaign) -> bool:
        """Say whether a campaign's samples are what they were."""
        before, after = ([one.high_pass for one in each.sensors] for each in (self.campaign, campaign))
        return campaign.recordings == self.campaign.recordings and before == after

    def _decays(self, campaign: Campaign) -> tuple[FreeDecay, ...]:
        """Give the decays of a campaign that was changed: the same samples, as long as nobody has touched them."""
        if not self._as_recorded(campaign):
            return prepare(campaign).decays
        loads = {drop.recording.name: drop.load for drop in campaign.drops}
        return tuple(replace(decay, load=loads[decay.file]) for decay in self.decays)


def colour_left(optimum: FitResult) -> float:
    """Give by how much the residuals of a fit tell less than white ones."""
    return float(autocorrelation_inflation(optimum.residuals, [decay.rate for decay in optimum.decays]).max())


def without_looking_at_wheels(campaign: Campaign, decays: Sequence[FreeDecay]) -> tuple[FreeDecay, ...]:
    """Let every decay begin where it would if no sensor told of the landing: one of them may have told something wrong.

    Parameters
    ----------
    campaign
        The campaign.
    decays
        As they were found.
    """
    blind = campaign
    for channel, sensor in enumerate(campaign.sensors):
        if sensor.on != "body":
            blind = silenced(channel)(blind)
    starts = {decay.file: decay.start for decay in prepare(blind).decays}
    if not any(decay.clocks for decay in decays):
        ends = {decay.file: decay.end for decay in decays}
        spans = {file: (starts[file], ends[file]) for file in starts if file in ends}
        return prepare(_cut(campaign, spans)).decays or tuple(decays)
    # The clocks of several loggers have been set in these, and only in these.
    shifts = [round((starts.get(one.file, one.start) - one.start) * one.rate) for one in decays]
    return tuple(
        one.shifted(max(shift, -one.earlier.shape[1])) if shift < one.samples / 2 else one
        for one, shift in zip(decays, shifts, strict=True)
    )


def _cut(campaign: Campaign, spans: Mapping[str, Span]) -> Campaign:
    campaign = without_drops(*(one.name for one in campaign.recordings if one.name not in spans))(campaign)
    drops = [
        replace(drop, start=spans[drop.recording.name][0], end=spans[drop.recording.name][1]) for drop in campaign.drops
    ]
    return replace(campaign, drops=tuple(drops))

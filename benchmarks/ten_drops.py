"""The ten-drop campaign: the paper's car, empty and with ballast, eight channels, decays of 1500 samples."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

import sprung
from sprung.estimation import FitResult, FitStatistics, fit_jointly, fit_linear, fit_nonlinear
from sprung.preprocess import FreeDecay, Prepared, prepare
from sprung.selection.structure import choose_structure
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, LinearModel, NonlinearModel, Sensor, Vehicle

Real = NDArray[np.float64]

RATE = 500.0
SAMPLES = 1500

_LOAD = {
    "name": "ballast",
    "items": [
        {"mass": 140.0, "position": (-1.0, 0.0, 0.55), "inertia": (10.0, 80.0)},
        {"mass": 60.0, "position": (-2.9, 0.0, 0.55), "inertia": (5.0, 5.0)},
    ],
}
_RECORDED = 3.4
"""s after the release: of it, 3 s of free vibration are left."""


@dataclass(frozen=True, eq=False)
class Task:
    """What every contestant is given.

    Attributes
    ----------
    campaign
        As recorded: where the decays begin is not said.
    decays, models, sensors, known
        As for `sprung.estimation.fit_jointly`.
    """

    campaign: sprung.Campaign
    decays: tuple[FreeDecay, ...]
    models: Mapping[str, LinearModel]
    sensors: tuple[Sensor, ...]
    known: Mapping[str, KnownValue]

    @property
    def nbytes(self) -> int:
        """Size of the records, bytes."""
        return sum(decay.values.nbytes for decay in self.decays)

    @property
    def stacked(self) -> Real:
        """All records below each other, shape (drop · channel, time)."""
        return np.concatenate([decay.values for decay in self.decays])

    def fit(self, starts: int) -> FitStatistics:
        """FitStatistics as `sprung` does: from starts of its own, to the error bars."""
        return fit_jointly(self.decays, self.models, self.sensors, self.known, starts=starts)


def ten_drops(times: int = 1) -> Task:
    """Simulate the campaign, sampled so many times as often: 1500 samples in each decay, times that."""
    campaign = _simulated(times)
    choice = choose_structure(campaign)
    # Everybody fits from where free vibration begins, as found in a campaign of the usual rate; all samples are used, where
    # the preparation would thin them out.
    decays = []
    for decay, recording in zip(_usual().decays, campaign.recordings, strict=True):
        first = round((decay.start - recording.start) * recording.rate)
        values = np.ascontiguousarray(recording.values[:, first : first + times * SAMPLES])
        decays.append(replace(decay, values=values, rate=times * RATE))
    if {decay.values.shape for decay in decays} != {(8, times * SAMPLES)}:
        raise ValueError(f"decays of {[decay.values.shape for decay in decays]}; record for longer")
    return Task(campaign, tuple(decays), choice.linear_models, tuple(campaign.sensors), choice.known)


def _simulated(times: int) -> sprung.Campaign:
    return sprung.simulate(TABLE_1_CAR, loads=[_LOAD], rate=times * RATE, noise=0.02, seed=1, duration=_RECORDED)


@cache
def _usual() -> Prepared:
    return prepare(_simulated(1))


@dataclass(frozen=True, eq=False)
class FrictionTask:
    """The same drops of the same car with dry friction.

    Attributes
    ----------
    campaign, decays, models, sensors, known
        As of `Task`, the models with friction.
    linear
        Where the linear fit ended, from which the other one starts.
    found
        Where our fit with friction ends.
    """

    campaign: sprung.Campaign
    decays: tuple[FreeDecay, ...]
    models: Mapping[str, NonlinearModel]
    sensors: tuple[Sensor, ...]
    known: Mapping[str, KnownValue]
    linear: FitResult

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters."""
        return next(iter(self.models.values())).names

    def fit(self) -> FitResult:
        """FitStatistics as `sprung` does, from the linear fit on."""
        start = self.linear.parameters
        start |= {f"F_{axle}": 0.002 * start[f"k_s{axle}"] for axle in "fr"}
        start |= {f"s_{axle}": 10 * start[f"k_s{axle}"] for axle in "fr"}
        return fit_nonlinear(self.decays, self.models, self.sensors, self.known, start=start, states=self.linear.states)

    @cached_property
    def found(self) -> FitResult:
        """Where it ends."""
        return self.fit()


def ten_rubbing_drops() -> FrictionTask:
    """Simulate the campaign with 100 N of dry friction at each wheel: 1500 samples in each decay."""
    friction = {"F_f": 100.0, "F_r": 100.0, "s_f": 2e5, "s_r": 2e5}
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | friction, name="rubbing car")
    campaign = sprung.simulate(car, loads=[_LOAD], rate=RATE, duration=_RECORDED, noise=0.02, seed=1)
    choice = choose_structure(campaign, "shared", ("friction",))
    plain = choice.with_terms(())
    decays = tuple(replace(decay, values=decay.values[:, :SAMPLES]) for decay in prepare(campaign).decays)
    linear = fit_linear(decays, plain.linear_models, campaign.sensors, plain.known)
    return FrictionTask(campaign, decays, choice.nonlinear_models, campaign.sensors, choice.known, linear)

"""Corner frequencies of high-passes: their score test for every sensor that may be AC-coupled, all of them together.

The samples are linear in a corner frequency: its derivative is the integral of the reading. So what it changes of a fit
follows from one more solution of the amplitudes for each channel, at the fitted parameters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.estimation import FitResult, score_added
from sprung.faults.fault_scores import FaultScore
from sprung.preprocess import FreeDecay, differentiate_by_cutoff
from sprung.uncertainty import round_by_uncertainty
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

NEGLIGIBLE = 0.004
"""Hz below which a corner is not reported: the error in phase of a body mode is then smaller than that of its gain may be."""

_HIGHEST = 4 * np.pi
"""rad/s: standard uncertainty of a corner before any recording; nobody measures vehicles through one above 2 Hz."""


@dataclass(frozen=True, eq=False)
class CornerScores:
    """Scores of corner frequencies beside the parameters of a fit, both free.

    Attributes
    ----------
    channels
        Those that may be AC-coupled.
    scores, informations
        Of their corners in each drop, s and s², shapes (drop, corner) and (drop, corner, corner).
    score, information
        Of all drops, the parameters eliminated; shapes (corner,) and (corner, corner).
    shifts
        By how many of its standard uncertainties each direction of the parameters shifts with each corner, s, shape
        (direction, corner).
    ramps
        What ramps and random walks add to the variance of the score of each corner, over that of white noise, shape (corner,).

    Notes
    -----
    Where a high-pass was undone, an error of the level at rest has become a ramp, another one in every drop; how large it is
    follows from the noise at rest. By how much the drops differ in what they say of a corner enlarges its variance (White,
    Econometrica 48 (1980) 817), which few drops show by chance only.
    """

    channels: tuple[str, ...]
    scores: Real
    informations: Real
    score: Real
    information: Real
    shifts: Real
    ramps: Real

    def single(self) -> Iterator[FaultScore]:
        """Yield the score of each corner as if it were the only one; values in Hz."""
        own = np.diag(self.information)
        stds = np.sqrt(self._overdispersion / own)
        pulls = np.abs(self.shifts).max(axis=0, initial=0.0) * stds
        for channel, step, std, pull in zip(
            self.channels, (self.score / own).tolist(), stds.tolist(), pulls.tolist(), strict=True
        ):
            yield FaultScore("corner", channel, 0, 0, step / (2 * np.pi), std / (2 * np.pi), pull)

    @cached_property
    def step(self) -> Real:
        """The change of all corners together, Hz, shape (corner,)."""
        return np.asarray(self._white @ self.score / (2 * np.pi), dtype=np.float64)

    @cached_property
    def covariance(self) -> Real:
        """Covariance of the step, Hz², shape (corner, corner)."""
        apart = self._white @ self._apart @ self._white
        larger = np.sqrt(np.maximum(np.diag(apart) / np.diag(self._white), self._overdispersion))
        covariance: Real = self._white * np.outer(larger, larger) / (2 * np.pi) ** 2
        return covariance

    @property
    def raw_gain(self) -> float:
        """Gain of the step in twice the log-likelihood."""
        step = 2 * np.pi * self.step
        return float(step @ np.linalg.solve(self._white, step))

    @property
    def gain(self) -> float:
        """Wald statistic of the step, the differences between the drops allowed for."""
        step, raw = 2 * np.pi * self.step, self.raw_gain
        if raw == 0:  # the recordings determine no corner at all
            return 0.0
        return raw / max(float(step @ self._apart @ step) / raw, float(self._overdispersion.min()))

    @property
    def is_relevant(self) -> bool:
        """Whether any corner changes by more than is negligible."""
        return bool(np.abs(self.step).max() > NEGLIGIBLE)

    @property
    def pull(self) -> float:
        """Largest shift of a parameter with one of all of them, in its standard uncertainties."""
        spread = (2 * np.pi) ** 2 * np.einsum("pc,cd,pd->p", self.shifts, self.covariance, self.shifts)
        return float(np.sqrt(spread.max(initial=0.0)))

    @cached_property
    def _overdispersion(self) -> Real:
        """Overdispersion of the scores between the drops, of each corner and at least that of all, shape (corner,)."""
        own = np.einsum("dcc->dc", self.informations)
        left = self.scores - own * self.scores.sum(axis=0) / own.sum(axis=0)
        each = self._per_drop * np.sum(left**2, axis=0) / own.sum(axis=0)
        inflation: Real = np.maximum(np.maximum(each, 1.0 + self.ramps), float(each.mean()))
        return inflation

    @property
    def _per_drop(self) -> float:
        """Correction of the variance between drops for the corners that are estimated from it."""
        return len(self.scores) / max(len(self.scores) - 1, 1)

    @cached_property
    def _white(self) -> Real:
        """Covariance of all corners in white noise, (rad/s)², shape (corner, corner)."""
        own = self.information + np.eye(len(self.score)) / _HIGHEST**2
        return np.asarray(np.linalg.inv(own), dtype=np.float64)

    @cached_property
    def _apart(self) -> Real:
        """Covariance of the score from its differences between the drops, s², shape (corner, corner)."""
        left = self.scores - self.informations @ (2 * np.pi * self.step)
        apart: Real = self._per_drop * left.T @ left
        return apart


def score_corners(decays: Sequence[FreeDecay], optimum: FitResult, sensors: Sequence[Sensor]) -> CornerScores | None:
    """Return the score test of the corner frequencies at a fit.

    Parameters
    ----------
    decays
        What was fitted.
    optimum
        Where that ended.
    sensors
        One for each channel.

    Returns
    -------
    CornerScores or None
        None where no sensor may be AC-coupled, or where the vehicle has forces that are not linear.
    """
    changes = [differentiate_by_cutoff(decay) for decay in decays]
    coupled = [sensor.reads_gravity or sensor.high_pass is not None for sensor in sensors]
    open_ = np.flatnonzero(np.any([change.any(axis=1) for change in changes], axis=0) & coupled).tolist()
    if not open_ or not optimum.is_reversible:
        return None
    at, weights = optimum.iterate.at, optimum.weights
    parameters, drops, count = len(optimum.names), len(decays), len(open_)
    information, gradient = np.zeros((parameters + count,) * 2), np.zeros(parameters + count)
    information[:parameters, :parameters], gradient[:parameters] = at.information, at.gradient
    scores, alone = np.zeros((drops, count)), np.zeros((drops, count, count))
    ramps, levels = np.zeros(count), _level_errors(decays, optimum)
    for i, channel in enumerate(open_):
        changed = [_changed(decay, change, channel) for decay, change in zip(decays, changes, strict=True)]
        there = optimum.problem.objective.with_decays(changed).at(optimum.values, weights)
        # A corner changes the records, not the model: its derivative of the residual has the other sign.
        information[:parameters, parameters + i] = at.gradient - there.gradient
        for drop, (decay, record, residual, change) in enumerate(
            zip(changed, there.fitted, optimum.residuals, changes, strict=True)
        ):
            moved = decay.values - record
            grown = np.nan_to_num(moved - moved.mean(axis=1, keepdims=True) - residual)
            alone[drop, i] = weights[open_] * np.einsum("ct,ct->c", grown[open_], change[open_])
            scores[drop, i] = -weights[channel] * np.nan_to_num(residual[channel]) @ change[channel]
            ramps[i] += _variance_by_undoing(
                weights[channel] * grown[channel], decay, channel, weights[channel], levels
            )
    information[parameters:, :parameters] = information[:parameters, parameters:].T
    information[parameters:, parameters:], gradient[parameters:] = alone.sum(axis=0), scores.sum(axis=0)
    test = score_added(optimum, gradient, information)
    score, left = determined(test.score, test.information)
    channels = tuple(sensors[channel].channel for channel in open_)
    own = np.einsum("dcc->c", alone)
    chance = np.divide(ramps, own, out=np.zeros(count), where=own > 0)
    return CornerScores(channels, scores, alone, score, left, test.shifts, chance)


def _level_errors(decays: Sequence[FreeDecay], optimum: FitResult) -> Real:
    """Return the standard uncertainty of a level at rest of each channel, m/s², shape (channel,); 0 without a rest."""
    noise = optimum.sensor_noise
    rested = np.mean([decay.rest.noise.shape[1] for decay in decays])
    errors: Real = np.sqrt(noise.variance * noise.per_independent_mean / max(float(rested), 1.0))
    return errors


def _variance_by_undoing(along: Real, decay: FreeDecay, channel: int, weight: float, levels: Real) -> float:
    """Return what undoing a high-pass adds to the variance of a score.

    Parameters
    ----------
    along
        Derivative of the score by the samples, shape (time,).
    decay, channel
        Where it is.
    weight
        1/σ² of the noise, s⁴/m².
    levels
        Standard uncertainty of the level at rest of each channel, m/s², shape (channel,).

    Notes
    -----
    With the cut-off ω an error ε of the level is the ramp ω t ε, and noise has its integral times ω added, a random walk.
    """
    cutoff = 2 * np.pi * decay.high_pass[channel] / decay.rate if decay.high_pass else 0.0
    later = np.cumsum(along[::-1])[::-1]  # every sample of noise goes on in all later ones
    of_noise = float(np.sum((along + cutoff * later) ** 2 - along**2)) / weight
    return of_noise + float(cutoff * np.arange(len(along)) @ along * levels[channel]) ** 2


def determined(score: Real, information: Real) -> tuple[Real, Real]:
    """Restrict score and information to the directions that the recordings determine beside the parameters.

    The information that is left beside the parameters is a difference of two matrices. In a direction that the parameters
    imitate, as all corners together may be, it is rounding of either sign: no variance follows from that.

    Parameters
    ----------
    score
        s, shape (corner,).
    information
        s², shape (corner, corner).

    Returns
    -------
    score, information
        Of the same shapes; the information is symmetric and has no negative eigenvalue.
    """
    values, vectors = np.linalg.eigh((information + information.T) / 2)
    kept = values > 1 / _HIGHEST**2  # less than this is known without any record
    vectors = vectors[:, kept]
    return vectors @ (vectors.T @ score), (vectors * values[kept]) @ vectors.T


def _changed(decay: FreeDecay, change: Real, channel: int) -> FreeDecay:
    values = decay.values.copy()
    values[channel] += change[channel]
    return replace(decay, values=values)


def stated_corner(corner: float) -> float | None:
    """Return what to state of a high-pass with a corner, Hz: None where it is all but 0."""
    return corner if corner > NEGLIGIBLE else None


def corner_fault(sensors: Sequence[Sensor], corners: Sequence[float], stds: Sequence[float]) -> Fault:
    """Return the fault of sensors whose high-pass has another corner than is stated.

    Parameters
    ----------
    sensors
        As they are stated.
    corners, stds
        Their corners and standard uncertainties of these, Hz; no uncertainties where these are not known.
    """
    if len(sensors) > 1:
        values = ", ".join(
            f"{sensor.channel} {_with_std(*value)}" for sensor, *value in zip(sensors, corners, stds, strict=True)
        )
        what = f"the high-passes have other corner frequencies than is stated, as all channels together show: {values}"
        do = "Set high_pass = ..., in Hz, for each of them in the campaign file; see the data sheets of sensors and logger."
        return Fault("corner", ", ".join(sensor.channel for sensor in sensors), what, do)
    (sensor,), (corner,) = sensors, corners
    size = _with_std(corner, *stds)
    do = f"Set high_pass = {corner:.2g} for it in the campaign file, or what its data sheet says."
    if corner < NEGLIGIBLE:
        what, do = "the channel has no high-pass", "Remove high_pass of this sensor from the campaign file."
    elif sensor.high_pass is None:
        what = f"the channel is AC-coupled with a corner frequency of {size}; none is stated"
    else:
        what = f"the high-pass has a corner frequency of {size}, not of {sensor.high_pass:g} Hz"
    return Fault("corner", sensor.channel, f"{what}, compared with the other channels", do)


def _with_std(corner: float, std: float = 0.0) -> str:
    value, error = round_by_uncertainty(corner, std) if std else (f"{corner:.2g}", "")
    return f"{value} ± {error} Hz" if error else f"{value} Hz"

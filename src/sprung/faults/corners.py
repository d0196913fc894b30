"""Corners: what the records say of the high-pass of every sensor that may be AC-coupled, all of them together.

A corner changes the record, not the vehicle, and in proportion: by the integral of what was read. So what it would change of
the fit follows from one more solution of the amplitudes for each channel, at the parameters that were fitted.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import FitResult, score_added
from sprung.faults.fault_scores import FaultScore
from sprung.preprocess import FreeDecay, differentiate_by_cutoff
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

MATTERS = 0.004
"""Hz below which nobody needs to be told: the phase of a body mode is then wrong by less than its gain may be."""

_HIGHEST = 4 * np.pi
"""rad/s: what corners are without any record, as a standard uncertainty; nobody measures vehicles above 2 Hz."""


@dataclass(frozen=True, eq=False)
class Corners:
    """Corners beside the parameters of a fit, both free.

    Attributes
    ----------
    channels
        Those that may be AC-coupled.
    scores, informations
        What each drop says of their corners, s and s², shapes (drop, corner) and (drop, corner, corner).
    score, information
        What all of them say, the parameters' share taken off; shapes (corner,) and (corner, corner).
    moves
        By how many of its standard uncertainties each direction of the parameters moves with each corner, s, shape
        (direction, corner).

    Notes
    -----
    Where a high-pass was undone, an error of the level at rest has become a ramp, another one in every drop. By how much the
    drops differ in what they say of a corner enlarges its variance (White, Econometrica 48 (1980) 817).
    """

    channels: tuple[str, ...]
    scores: Real
    informations: Real
    score: Real
    information: Real
    moves: Real

    def each(self) -> Iterator[FaultScore]:
        """List them as suspects, each as if it were the only one; values in Hz."""
        own = np.diag(self.information)
        stds = np.sqrt(self._inflation / own)
        pulls = np.abs(self.moves).max(axis=0, initial=0.0) * stds
        for channel, step, std, pull in zip(
            self.channels, (self.score / own).tolist(), stds.tolist(), pulls.tolist(), strict=True
        ):
            yield FaultScore("corner", channel, 0, 0, step / (2 * np.pi), std / (2 * np.pi), pull)

    @cached_property
    def step(self) -> Real:
        """By how much all of them would be otherwise, Hz, shape (corner,)."""
        return np.asarray(self._white @ self.score / (2 * np.pi), dtype=np.float64)

    @cached_property
    def covariance(self) -> Real:
        """Of that, Hz², shape (corner, corner)."""
        apart = self._white @ self._apart @ self._white
        larger = np.sqrt(np.maximum(np.diag(apart) / np.diag(self._white), self._inflation))
        covariance: Real = self._white * np.outer(larger, larger) / (2 * np.pi) ** 2
        return covariance

    @property
    def worth(self) -> float:
        """What twice the log-likelihood would gain by that."""
        step = 2 * np.pi * self.step
        return float(step @ np.linalg.solve(self._white, step))

    @property
    def gain(self) -> float:
        """What it would gain if it knew that drops differ: standard errors by which all corners are otherwise, squared."""
        step, worth = 2 * np.pi * self.step, self.worth
        if worth == 0:  # the records determine no corner at all
            return 0.0
        return worth / max(float(step @ self._apart @ step) / worth, float(self._inflation.min()))

    @property
    def matter(self) -> bool:
        """Whether any of them would be otherwise by more than nobody needs to be told."""
        return bool(np.abs(self.step).max() > MATTERS)

    @property
    def pull(self) -> float:
        """By how many of its standard uncertainties a parameter moves with one of them all, the most of all parameters."""
        spread = (2 * np.pi) ** 2 * np.einsum("pc,cd,pd->p", self.moves, self.covariance, self.moves)
        return float(np.sqrt(spread.max(initial=0.0)))

    @cached_property
    def _inflation(self) -> Real:
        """By how much drops differ beyond white noise in what they say of each corner, and of all of them, shape (corner,)."""
        own = np.einsum("dcc->dc", self.informations)
        left = self.scores - own * self.scores.sum(axis=0) / own.sum(axis=0)
        each = self._per_drop * np.sum(left**2, axis=0) / own.sum(axis=0)
        inflation: Real = np.maximum(each, max(float(each.mean()), 1.0))
        return inflation

    @property
    def _per_drop(self) -> float:
        """What estimating the corners has taken from the differences between the drops."""
        return len(self.scores) / max(len(self.scores) - 1, 1)

    @cached_property
    def _white(self) -> Real:
        """Covariance of all corners together in white noise, (rad/s)²."""
        own = self.information + np.eye(len(self.score)) / _HIGHEST**2
        return np.asarray(np.linalg.inv(own), dtype=np.float64)

    @cached_property
    def _apart(self) -> Real:
        """Covariance of the score, as the drops differ in it, s²."""
        left = self.scores - self.informations @ (2 * np.pi * self.step)
        apart: Real = self._per_drop * left.T @ left
        return apart


def corners(decays: Sequence[FreeDecay], optimum: FitResult, sensors: Sequence[Sensor]) -> Corners | None:
    """Tell what the records say of corners where a fit ended.

    Parameters
    ----------
    decays
        What was fitted.
    summit
        Where that ended.
    sensors
        One for each channel.

    Returns
    -------
    Corners or None
        None where no sensor may be AC-coupled, or where the vehicle has forces that are not linear.
    """
    changes = [differentiate_by_cutoff(decay) for decay in decays]
    open_ = np.flatnonzero(np.any([change.any(axis=1) for change in changes], axis=0)).tolist()
    if not open_ or not optimum.is_reversible:
        return None
    at, weights = optimum.iterate.at, optimum.weights
    parameters, drops, count = len(optimum.names), len(decays), len(open_)
    information, gradient = np.zeros((parameters + count,) * 2), np.zeros(parameters + count)
    information[:parameters, :parameters], gradient[:parameters] = at.information, at.gradient
    scores, alone = np.zeros((drops, count)), np.zeros((drops, count, count))
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
    information[parameters:, :parameters] = information[:parameters, parameters:].T
    information[parameters:, parameters:], gradient[parameters:] = alone.sum(axis=0), scores.sum(axis=0)
    test = score_added(optimum, gradient, information)
    score, left = determined(test.score, test.information)
    channels = tuple(sensors[channel].channel for channel in open_)
    return Corners(channels, scores, alone, score, left, test.shifts)


def determined(score: Real, information: Real) -> tuple[Real, Real]:
    """Restrict score and information to the directions that the records determine beside the parameters.

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

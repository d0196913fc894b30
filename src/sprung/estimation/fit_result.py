"""Where the fit of some decays ended, and everything that follows from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.objective import ObjectiveAt
from sprung.estimation.overdispersion import (
    autocorrelation_inflation,
    birge_ratio,
    drop_corrections,
    independent_records,
)
from sprung.estimation.problem import EstimationProblem, Iterate
from sprung.preprocess import FreeDecay, Moments, SensorNoise, estimate_sensor_noise, pool_moments
from sprung.vehicle import is_of_sensor

Real = NDArray[np.float64]

Inflater = Literal["nothing", "coloured residuals", "drops that disagree", "large and small motions that disagree"]
"""What shows that the records have less information than white residuals would."""


@dataclass(frozen=True, eq=False)
class FitResult:
    """Where the fit of some decays ended.

    Attributes
    ----------
    problem
        The likelihood, and what is known beforehand.
    iterate
        The last point.
    steps
        Steps taken from the winning start.
    converged
        Whether no further gain is expected.
    starts, starts_agreeing
        How many starts were refined, and how many of them ended here.
    """

    problem: EstimationProblem
    iterate: Iterate
    steps: int
    converged: bool
    starts: int
    starts_agreeing: int

    @property
    def decays(self) -> Sequence[FreeDecay]:
        """What was fitted."""
        return self.problem.objective.decays

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters."""
        return self.problem.priors.coordinates.names

    @cached_property
    def values(self) -> Real:
        """Parameter values, SI, shape (parameter,)."""
        return self.problem.priors.coordinates.values(self.iterate.u)

    @property
    def parameters(self) -> dict[str, float]:
        """Parameter values, SI, by name."""
        return dict(zip(self.names, self.values.tolist(), strict=True))

    @property
    def weights(self) -> Real:
        """1/σ² of each channel with which the states and the derivatives were computed, s⁴/m², shape (channel,)."""
        return self.iterate.at.weights

    @property
    def residual_sums(self) -> Real:
        """Residual sums of squares, (m/s²)², shape (drop, channel); 0 for channels that are left out."""
        return self.iterate.at.residual_sums

    @cached_property
    def noise(self) -> Real:
        """Noise level of each channel, m/s², shape (channel,)."""
        noise: Real = np.sqrt(self.problem.noise_variance(self.residual_sums, self.iterate.at))
        return noise

    @property
    def fitted(self) -> tuple[Real, ...]:
        """Modelled records, their means subtracted, m/s²; one array of shape (channel, time) per drop."""
        return self.iterate.at.fitted

    @cached_property
    def residuals(self) -> tuple[Real, ...]:
        """Measured minus modelled, m/s²: one array of shape (channel, time) per drop, NaN for channels that are left out."""
        # A modelled record is released once its residual is known: all of them would be another copy of the recordings.
        records = list(self.fitted)
        return tuple(_centred(decay.values - records.pop(0)) for decay in self.decays)

    @property
    def sensor_penalty(self) -> float:
        """How far the sensors are from what is stated of them, in standard uncertainties, squared and summed."""
        statements, found = self.problem.priors.statements, self.parameters
        return float(
            sum(
                ((found[name] - stated.value) / stated.std) ** 2
                for name, stated in statements.items()
                if is_of_sensor(name)
            )
        )

    @cached_property
    def residual_moments(self) -> Moments:
        """Variance and covariance of neighbours of the residuals of each channel; see `pool_moments`."""
        return pool_moments(self.residuals)

    @cached_property
    def sensor_noise(self) -> SensorNoise:
        """Noise of the sensors without any motion, from the rests of the decays and from the residuals."""
        return estimate_sensor_noise(self.decays, self.residual_moments)

    @cached_property
    def loglikelihood(self) -> float:
        """Up to a constant; minus infinity for a motion without bounds."""
        cost = self.problem.cost(self.iterate)
        return -0.5 * cost if np.isfinite(cost) else -np.inf

    @cached_property
    def remaining_gain(self) -> float:
        """What one more Newton step is expected to gain in twice the log-likelihood; nearly 0 at an optimum."""
        return self.problem.normal_equations(self.iterate).step()[1]

    @cached_property
    def expected_shift(self) -> float:
        """How far a Newton step would take the parameter that it takes furthest, in standard errors."""
        equations = self.problem.normal_equations(self.iterate)
        along = equations.directions @ np.linalg.inv(equations.information)
        variance, step = np.einsum("ud,ud->u", along, equations.directions), along @ equations.gradient
        return float(
            np.max(np.divide(step**2, variance, out=np.zeros(len(step)), where=variance > 0), initial=0.0) ** 0.5
        )

    @property
    def absolute_loglikelihood(self) -> float:
        """Natural logarithm of the likelihood, with its constant: -½ Σ (ln 2πσ² + r²/σ²), and the priors."""
        observations = self.problem.objective.observations.sum(axis=0)
        squares = self.residual_sums.sum(axis=0) / self.noise**2
        return self.loglikelihood - 0.5 * float(
            observations.sum() * np.log(2 * np.pi) + squares[observations > 0].sum()
        )

    @property
    def unknowns(self) -> int:
        """Numbers that the samples had to determine: parameters, noise levels, initial states, offsets and clocks."""
        observations = self.problem.objective.observations > 0
        directions = self.problem.priors.null_space(self.iterate.u).shape[1]
        eliminated = round(float(self.iterate.at.leverage.sum()))
        counted: int = directions + int(observations.any(axis=0).sum()) + int(observations.sum()) + eliminated
        return counted

    @cached_property
    def autocorrelation_inflation(self) -> Real:
        """Factor by which autocorrelated residuals inflate variances, shape (channel,); 1 where not significantly."""
        decays, observations = self.decays, self.problem.objective.observations
        # Samples that were interpolated are correlated, but counted for no more than those that were taken. Of a record on pads
        # the lines are used up to a frequency, and among these noise is what it is among all.
        samples = [
            counts if decay.pads else decay.usable * decay.samples
            for decay, counts in zip(decays, observations, strict=True)
        ]
        counted = observations.sum(axis=0) / np.maximum(np.sum(samples, axis=0), 1)
        rates = [decay.rate for decay in decays]
        return autocorrelation_inflation(self.residuals, rates, counted=counted, least=self.problem.least_variance)

    @cached_property
    def disagreement(self) -> float:
        """Factor by which drops that contradict each other inflate variances; 1 where not significantly."""
        return birge_ratio(*self._scores_by_drop)

    @cached_property
    def disagreement_in_time(self) -> float:
        """Factor by which large and small motions that contradict each other inflate variances; 1 where not significantly."""
        windows = self.iterate.at.by_window
        return 1.0 if windows is None else birge_ratio(*self.problem.in_null_space(self.iterate, *windows))

    @cached_property
    def overdispersion(self) -> float:
        """Factor on every variance: the largest of the three, 1 where none is significant."""
        return max(float(self.autocorrelation_inflation.max()), self.disagreement, self.disagreement_in_time)

    @cached_property
    def inflation(self) -> tuple[float, Inflater]:
        """Factor on the variance of every estimate, and what it is due to: overdispersion, where repeated drops count once.

        The search for a model does not count so: what repeats is what further terms may explain.
        """
        if self.overdispersion == 1:
            return 1.0, "nothing"
        coloured, disagreement = float(self.autocorrelation_inflation.max()), self.disagreement
        if len({decay.rate for decay in self.decays}) == 1:
            count = independent_records(self.residuals, self.fitted, self.weights, coloured) / len(self.decays)
            coloured = coloured / count if coloured > 1 else 1.0
            disagreement = max(disagreement, birge_ratio(*self._scores_by_drop, count))
        by_reason: dict[Inflater, float] = {
            "coloured residuals": coloured,
            "drops that disagree": disagreement,
            "large and small motions that disagree": self.disagreement_in_time,
        }
        reason = max(by_reason, key=lambda reason: by_reason[reason])
        return by_reason[reason], reason

    @property
    def drop_corrections(self) -> tuple[Real, NDArray[np.int64]]:
        """Each drop's own correction to the joint estimate.

        In units of its standard errors, squared and summed, shape (drop,); and in how many directions it has information.
        """
        return drop_corrections(*self._scores_by_drop)

    @cached_property
    def _scores_by_drop(self) -> tuple[Real, Real]:
        """Gradient and information of each drop in the null space of the constraints."""
        return self.problem.by_drop(self.iterate)

    @cached_property
    def states(self) -> Real:
        """{X, Ẋ} of each drop at the start of its decay, SI, shape (drop, state)."""
        return self.iterate.at.states

    @property
    def is_reversible(self) -> bool:
        """Whether the motion can be followed backward in time."""
        return self.iterate.at.is_reversible

    def motion(self, drop: int, before: int, after: int) -> Real:
        """Return the motion of a drop around the start of its decay.

        Parameters
        ----------
        drop
            Its position.
        before, after
            How many samples before the first one, and how many from it on.

        Returns
        -------
        ndarray
            {X, Ẋ}, with forces that have a memory their memories too, SI, shape (state, time); NaN before the first sample
            where motion cannot be followed backward.
        """
        return self.iterate.at.motion(drop, before, after)

    def residual_sums_of(self, decays: Sequence[FreeDecay]) -> Real:
        """Residual sums of squares on other decays, initial states eliminated, (m/s²)², shape as that of `residual_sums`."""
        return self._of(decays).residual_sums

    def states_of(self, decays: Sequence[FreeDecay]) -> Real:
        """{X, Ẋ} of this vehicle at the start of other decays, SI, shape (drop, state)."""
        return self._of(decays).states

    def _of(self, decays: Sequence[FreeDecay]) -> ObjectiveAt:
        objective = self.problem.objective.with_decays(decays)
        return objective.at(self.values, self.weights).with_optimal_states()

    def clock_delays(self, covariance: Real) -> dict[int, tuple[Real, Real]]:
        """Return the estimated delays of the loggers' clocks.

        Parameters
        ----------
        covariance
            Of the parameters, SI, shape (parameter, parameter).

        Returns
        -------
        dict
            By the position of the drop the delays, s, shape (logger,), and their covariance; drops of one logger are not
            in it.
        """
        modal = self.iterate.at.modal
        return {} if modal is None else modal.clock_delays(covariance)

    def most_likely_delays(self, decays: Sequence[FreeDecay], shifts: Real) -> dict[int, Real]:
        """Search for the delays of clocks that are hardly known, of decays with more channels than were fitted.

        Parameters
        ----------
        decays
            Of several loggers.
        shifts
            What is tried beside what is expected of each clock, s, shape (shift,).

        Returns
        -------
        dict
            By the position of the drop the delays of its loggers, s, shape (logger,).
        """
        modal = self.problem.objective.with_decays(decays).at(self.values, 1 / self.noise**2).modal
        return {} if modal is None else modal.most_likely_delays(shifts)

    def after(self, before: FitResult) -> FitResult:
        """Return this fit with the history of the one before, from which it was reached."""
        steps = before.steps + self.steps
        return replace(self, steps=steps, starts=before.starts, starts_agreeing=before.starts_agreeing)


def _centred(record: Real) -> Real:
    centred: Real = record - record.mean(axis=1, keepdims=True)
    return centred

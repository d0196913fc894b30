"""The likelihood of a linear vehicle by matrix exponentials, sample by sample, without modes.

At critical damping two modes meet in one shape and modal coordinates cease to exist, though nothing happens to the motion.
There, and only there, this form is used: a hundred times slower, and indifferent to the eigenvalues.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sprung.estimation.objective import Objective, ObjectiveAt
from sprung.estimation.projected_response import initial_state_prior_std
from sprung.estimation.records import channel_rate_ratios
from sprung.preprocess import FreeDecay
from sprung.vehicle import LinearModel, Readout, affine_response, highest_derivatives, state_matrix

Real = NDArray[np.float64]

_FARTHEST = 1e100
"""Beyond this a motion that is followed backward counts as having no bounds."""


@dataclass(frozen=True, eq=False)
class MatrixExponentialAt:
    """A likelihood at parameter values and noise levels.

    Attributes
    ----------
    objective
        The likelihood.
    models
        Equations of motion by load name.
    sensors
        The sensors.
    values
        Parameters, SI, shape (parameter,).
    weights
        1/σ² of each channel, s⁴/m², shape (channel,).
    """

    objective: Objective
    models: Mapping[str, LinearModel]
    sensors: Readout
    values: Real
    weights: Real

    is_reversible = True
    by_window = None
    coupling = None
    modal = None

    def reweighted(self, weights: Real) -> MatrixExponentialAt:
        """Return the likelihood with other weights."""
        return replace(self, weights=weights)

    def damped(self, _damping: float, /) -> tuple[Real, Real, float]:
        """Return information and gradient, whatever `_damping`: what is eliminated is at its maximum."""
        return self.information, self.gradient, 0.0

    def moved(self, values: Real, _damping: float = 0.0, /) -> ObjectiveAt:
        """Return the likelihood at other parameter values, SI, shape (parameter,)."""
        return self.objective.at(values, self.weights)

    def with_larger_model(
        self, _models: Mapping[str, LinearModel], _sensors: Readout, _ways: Sequence[tuple[Real, Real]], /
    ) -> None:
        """Return None: without modes, changes of the response have no closed form."""

    def with_optimal_states(self) -> MatrixExponentialAt:
        """Return the likelihood itself: initial states are eliminated."""
        return self

    def of_drop(self, drop: int) -> ObjectiveAt:
        """Return the likelihood of one drop alone, by its position."""
        return self.objective.with_decays([self.objective.decays[drop]]).at(self.values, self.weights)

    @cached_property
    def _weights(self) -> list[Real]:
        """1/σ² of each channel of every drop, zero for those that are left out."""
        return [self.weights * decay.usable * channel_rate_ratios(decay) for decay in self.objective.decays]

    @cached_property
    def _solved(self) -> list[tuple[Real, Real, Real, Real]]:
        """Readings of unit initial states, their orthonormal basis, the initial state, and the residual, of every drop."""
        drops = zip(self.objective.decays, self._weights, strict=True)
        return [self._solve(decay, weights) for decay, weights in drops]

    def _solve(self, decay: FreeDecay, weights: Real) -> tuple[Real, Real, Real, Real]:
        highest, _ = self.models[decay.load].accelerations(self.values)
        massive = self.models[decay.load].massive
        A = state_matrix(highest, massive)
        readings = (self.sensors.at(self.values) @ self.sensors.observed_of_states(highest, massive))[None]
        propagator = expm(A / decay.rate)
        while len(readings) < decay.samples:
            readings = np.concatenate([readings, readings @ propagator])
            propagator = propagator @ propagator
        readings = readings[: decay.samples].transpose(2, 1, 0)
        bounded = np.vstack(
            [_weighted(readings, weights).T, np.diag(1 / initial_state_prior_std(len(highest), len(A)))]
        )
        sizes = np.linalg.norm(bounded, axis=0)
        basis, triangle = np.linalg.qr(bounded / sizes)
        target = np.append(_weighted(np.nan_to_num(decay.values), weights), np.zeros(len(A)))
        state = np.linalg.solve(triangle, basis.T @ target) / sizes
        return readings, basis, state, target - basis @ (basis.T @ target)

    @cached_property
    def by_drop(self) -> tuple[Real, Real]:
        """Gradient and information of each drop; shapes (drop, parameter) and (drop, parameter, parameter)."""
        gradients, informations = [], []
        for decay, weights, solved in zip(self.objective.decays, self._weights, self._solved, strict=True):
            _, basis, state, residual = solved
            jacobian = self._jacobian(decay, weights, state)
            jacobian = jacobian - basis @ (basis.T @ jacobian)
            gradients.append(jacobian.T @ residual)
            informations.append(jacobian.T @ jacobian)
        return np.array(gradients), np.array(informations)

    def _jacobian(self, decay: FreeDecay, weights: Real, state: Real) -> Real:
        """Weighted derivatives of a drop's readings from an initial state, those of its prior below; (row, parameter)."""
        highest, by_parameter = self.models[decay.load].accelerations(self.values)
        massive, S = self.models[decay.load].massive, self.sensors.at(self.values)
        A, (n, size) = state_matrix(highest, massive), highest.shape
        observed, directly = self.sensors.observed_of_states(highest, massive), self.sensors.of_accelerations(S)
        changes = []
        # Ẏ' = A Y' + dA Y, both propagated together.
        # The unknowns of the sensors, which are the last, do not change the motion.
        still = np.zeros((len(self.values) - len(by_parameter), n, size))
        by_sensor = np.swapaxes(self.sensors.slopes(self.values), 0, 1)
        for dS, change in zip(by_sensor, np.concatenate([by_parameter, still]), strict=True):
            dA = np.zeros_like(A)
            dA[highest_derivatives(n, massive)] = change
            both = np.block([[A, np.zeros_like(A)], [dA, A]])
            start = np.append(state, np.zeros(size))
            motion = affine_response(both, np.zeros(2 * size), start, 1 / decay.rate, decay.samples)
            changes.append((dS @ observed + directly @ change) @ motion[:size] + S @ observed @ motion[size:])
        return np.vstack([_weighted(np.array(changes), weights).T, np.zeros((size, len(changes)))])

    @property
    def gradient(self) -> Real:
        """Of the log-likelihood by the parameters, per SI unit, shape (parameter,)."""
        return np.asarray(self.by_drop[0].sum(axis=0))

    @property
    def information(self) -> Real:
        """Fisher information of the parameters, shape (parameter, parameter)."""
        return np.asarray(self.by_drop[1].sum(axis=0))

    @cached_property
    def residual_sums(self) -> Real:
        """Residual sums of squares, (m/s²)², shape (drop, channel)."""
        drops = zip(self.objective.decays, self.fitted, strict=True)
        sums = [
            channel_rate_ratios(decay) * np.sum((_centred(np.nan_to_num(decay.values)) - record) ** 2, axis=1)
            for decay, record in drops
        ]
        return np.array(sums)

    @property
    def penalty(self) -> float:
        """There are no eliminated unknowns with a prior of their own."""
        return 0.0

    @property
    def leverage(self) -> Real:
        """Number of eliminated unknowns that each channel determines, shape (channel,)."""
        channels, leverage = len(self.weights), np.zeros(len(self.weights))
        for _, basis, state, _ in self._solved:
            leverage += np.sum(basis[: -len(state)].reshape(channels, -1) ** 2, axis=1)
        return leverage

    @cached_property
    def fitted(self) -> tuple[Real, ...]:
        """Modelled records, their means subtracted, m/s²; one array of shape (channel, time) per drop."""
        drops = zip(self._weights, self._solved, strict=True)
        return tuple(
            _centred(np.tensordot(state, readings, axes=1)) * (weights > 0)[:, None]
            for weights, (readings, _, state, _) in drops
        )

    @property
    def states(self) -> Real:
        """{X, Ẋ} of each drop at its first sample, SI, shape (drop, state)."""
        return np.array([state for _, _, state, _ in self._solved])

    def motion(self, drop: int, before: int, after: int) -> Real:
        """{X, Ẋ} of a drop from samples before its first to samples from it on, SI, shape (state, time)."""
        decay, state = self.objective.decays[drop], self.states[drop]
        A, nothing = _state_matrix(self.models[decay.load], self.values), np.zeros(len(state))
        forward = affine_response(A, nothing, state, 1 / decay.rate, after)
        backward = affine_response(A, nothing, state, -1 / decay.rate, before + 1)
        return np.clip(np.hstack([backward[:, :0:-1], forward]), -_FARTHEST, _FARTHEST)


def _state_matrix(model: LinearModel, values: Real) -> Real:
    return state_matrix(model.accelerations(values)[0], model.massive)


def _centred(readings: Real) -> Real:
    centred: Real = readings - readings.mean(axis=-1, keepdims=True)
    return centred


def _weighted(readings: Real, weights: Real) -> Real:
    """Return centred readings of shape (..., channel, time) over σ, the channels strung together."""
    flat: Real = (np.sqrt(weights)[:, None] * _centred(readings)).reshape(*readings.shape[:-2], -1)
    return flat

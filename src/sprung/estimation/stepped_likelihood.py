"""The likelihood of stepped motions: initial states are eliminated to second order, and predicted for the next point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.elimination import eliminate, solve_normal_equations
from sprung.estimation.stepped_motion import SteppedMotion
from sprung.vehicle import LinearModel, Readout

if TYPE_CHECKING:
    from sprung.estimation.time_stepping import TimeSteppingObjective

Real = NDArray[np.float64]

_FOLLOWING = 1e-5
"""Damping of initial states that follow parameters, at the most: more would keep them from following at all."""

_STATE_STEPS, _STATE_GAIN = 20, 1e-2
"""Gauss-Newton steps of initial states alone, at the most, and gain in twice the log-likelihood below which they end."""

_DAMPED_AGAIN, _MORE_DAMPED = 3, 100.0
"""How many times a drop whose initial state lost is damped more, and by what factor each time."""

_MOSTLY = 0.8
"""Part of the expected gain that initial states promise, from which a loss is taken for theirs."""


@dataclass(frozen=True, eq=False)
class TimeSteppingAt:
    """Time stepping at parameter values and noise levels.

    Attributes
    ----------
    stepped
        The motion of every drop.
    weights
        1/σ² of each channel, s⁴/m², shape (channel,).
    """

    stepped: SteppedMotion
    weights: Real

    is_reversible = False
    coupling = None
    modal = None

    @property
    def objective(self) -> TimeSteppingObjective:
        """What is fitted, and the equations of motion."""
        return self.stepped.objective

    @property
    def values(self) -> Real:
        """Parameters, SI, shape (parameter,)."""
        return self.stepped.values

    @property
    def residual_sums(self) -> Real:
        """Residual sums of squares, (m/s²)², shape (drop, channel); infinite where the motion has no bounds."""
        return self.stepped.residual_sums

    def reweighted(self, weights: Real) -> TimeSteppingAt:
        """Return the likelihood with other weights; motion and derivatives are the same, and are not computed again."""
        return replace(self, weights=weights)

    def with_larger_model(
        self, _models: Mapping[str, LinearModel], _sensors: Readout, _ways: Sequence[tuple[Real, Real]], /
    ) -> None:
        """Return None: changes of a stepped motion have no closed form."""

    def moved(self, values: Real, damping: float = 0.0, /) -> TimeSteppingAt:
        """Return the likelihood at other parameter values, with the initial states that should explain the records there.

        Along combinations of initial states that the records hardly show, and where friction turns round as it begins to move,
        a whole step may go farther than derivatives tell. A drop that loses by it takes a more damped one.
        """
        information, gradient = self._normal_equations
        parameters = len(self.values)
        change = self.objective.change_between(self.values, values)
        following = self._solved(min(damping, _FOLLOWING), -information[:, parameters:, :parameters] @ change[:, None])
        step = self._solved(damping, gradient[:, parameters:, None])
        whole = self._moved_by(values, following + step)
        if not whole._cost > self._cost:
            return whole
        without, expected = (
            _expected_gain(information, gradient, np.hstack([np.tile(change, (len(step), 1)), states]))
            for states in (following, following + step)
        )
        if (expected - without).sum() < _MOSTLY * expected.sum():
            return whole
        for _ in range(_DAMPED_AGAIN):
            damping = _MORE_DAMPED * max(damping, _FOLLOWING)
            loses = self._costs - whole._costs < np.minimum(without, expected)
            if not loses.any():
                break
            step[loses] = self._solved(damping, gradient[:, parameters:, None])[loses]
            whole = self._moved_by(values, following + step)
        return whole

    def _solved(self, damping: float, right: Real) -> Real:
        """Return what the damped information of the initial states makes of (drop, state, 1), shape (drop, state)."""
        parameters = len(self.values)
        return solve_normal_equations(self._damped(damping)[:, parameters:, parameters:], right)[:, :, 0]

    def _moved_by(self, values: Real, states: Real) -> TimeSteppingAt:
        """Return the likelihood at other parameter values, initial states and memories moved by so much."""
        return self.objective.at_states(values, self.weights, self.stepped.begin + states)

    def with_optimal_states(self, most: int = _STATE_STEPS) -> TimeSteppingAt:
        """Return the likelihood with the initial states that maximise it here, after so many steps at the most."""
        best = self
        for _ in range(most):
            tried = best.moved(self.values)
            gain = best._cost - tried._cost
            best = tried if gain > 0 else best
            if not gain > _STATE_GAIN:
                break
        return best

    @property
    def _cost(self) -> float:
        return float(self._costs.sum())

    @property
    def _costs(self) -> Real:
        """Twice the negative log-likelihood of each drop, up to a constant, shape (drop,)."""
        return np.asarray(self.residual_sums @ self.weights + self._penalties)

    @property
    def _penalties(self) -> Real:
        """Twice the negative log-likelihood of each drop's initial state under its prior, shape (drop,)."""
        return np.asarray(np.sum((self.stepped.begin / self.objective.prior_std) ** 2, axis=1))

    def of_drop(self, drop: int) -> TimeSteppingAt:
        """Return the likelihood of one drop alone, by its position."""
        alone = self.objective.with_decays([self.objective.decays[drop]])
        if alone.every != self.objective.every:  # beside drops of a lower rate it takes shorter steps
            return alone.at_states(self.values, self.weights, self.stepped.begin[[drop]])
        return replace(self, stepped=self.stepped.of_drop(drop, alone))

    @property
    def penalty(self) -> float:
        """Twice the negative log-likelihood of the initial states under their prior."""
        return float(self._penalties.sum())

    @cached_property
    def _normal_equations(self) -> tuple[Real, Real]:
        """Information and gradient of parameters and initial states of each drop, the prior of the states included."""
        parameters = len(self.values)
        whole = np.einsum("c,dcij->dij", self.weights, self.stepped.products, optimize=True)
        information, gradient = whole[:, :-1, :-1], whole[:, :-1, -1]
        precision = self.objective.prior_std**-2
        information[:, parameters:, parameters:] += np.diag(precision)
        gradient[:, parameters:] -= self.stepped.begin * precision
        return information, gradient

    def _damped(self, damping: float) -> Real:
        """Information of parameters and initial states, that of each state alone increased by a part of it."""
        information, parameters = self._normal_equations[0], len(self.values)
        is_state = np.arange(information.shape[1]) >= parameters
        return information * (1.0 + damping * np.diag(is_state))

    def damped(self, damping: float, /) -> tuple[Real, Real, float]:
        """Return information and gradient of the parameters as initial states follow with a damping, and what these gain."""
        (_, gradient), parameters = self._normal_equations, len(self.values)
        visible = self.objective.visible_changes(self.values)
        of_parameters, reduced, _ = eliminate(self._damped(min(damping, _FOLLOWING)), gradient, parameters)
        of_states, own = gradient[:, parameters:], self._damped(damping)[:, parameters:, parameters:]
        step = solve_normal_equations(own, of_states[:, :, None])[:, :, 0]
        return (
            visible.T @ of_parameters.sum(axis=0) @ visible,
            reduced.sum(axis=0) @ visible,
            float(np.sum(of_states * step)),
        )

    @cached_property
    def _eliminated(self) -> tuple[Real, Real, Real]:
        """Information and gradient of each drop without its initial state, and how that follows the parameters."""
        return eliminate(*self._normal_equations, len(self.values))

    @cached_property
    def by_drop(self) -> tuple[Real, Real]:
        """Gradient and information of each drop; shapes (drop, parameter) and (drop, parameter, parameter)."""
        information, gradient, _ = self._eliminated
        visible = self.objective.visible_changes(self.values)
        return gradient @ visible, visible.T @ information @ visible

    @cached_property
    def by_window(self) -> tuple[Real, Real]:
        """Gradient and information of each window of time; shapes (window, parameter) and (window, parameter, parameter)."""
        response = self._eliminated[2]
        # What a change of the parameters is in a drop whose initial state follows it.
        change = np.concatenate([np.tile(np.eye(len(self.values)), (len(response), 1, 1)), response], axis=1)
        change = change @ self.objective.visible_changes(self.values)
        products = np.einsum("c,wdcij->wdij", self.weights, self.stepped.products_by_window, optimize=True)
        gradient = np.einsum("dup,wdu->wp", change, products[..., :-1, -1], optimize=True)
        information = np.einsum("dup,wduv,dvq->wpq", change, products[..., :-1, :-1], change, optimize=True)
        return gradient, information

    @property
    def gradient(self) -> Real:
        """Of the log-likelihood by the parameters, per SI unit, shape (parameter,)."""
        return np.asarray(self.by_drop[0].sum(axis=0))

    @property
    def information(self) -> Real:
        """Fisher information of the parameters, shape (parameter, parameter)."""
        return np.asarray(self.by_drop[1].sum(axis=0))

    @cached_property
    def leverage(self) -> Real:
        """Number of eliminated unknowns that each channel determines, shape (channel,)."""
        parameters = len(self.values)
        products = self.stepped.products[:, :, parameters:-1, parameters:-1]
        own = self._normal_equations[0][:, parameters:, parameters:]
        inverse = solve_normal_equations(own, np.broadcast_to(np.eye(own.shape[-1]), own.shape))
        leverage: Real = self.weights * np.einsum("dij,dcji->c", inverse, products, optimize=True)
        return leverage

    @property
    def fitted(self) -> tuple[Real, ...]:
        """Modelled records, their means subtracted, m/s²; one array of shape (channel, time) per drop."""
        objective = self.objective
        whole = objective.records - self.stepped.residuals
        return tuple(record[:, :samples] for record, samples in zip(whole, objective.samples, strict=True))

    @property
    def states(self) -> Real:
        """{X, Ẋ} and memories of each drop at its first sample, SI, shape (drop, state + memory)."""
        states: Real = self.stepped.begin - self.objective.sag(self.values)
        return states

    def motion(self, drop: int, before: int, after: int) -> Real:
        """{X, Ẋ} and memories of a drop, SI, shape (state + memory, time).

        NaN for the samples before its first: friction cannot be followed backward in time.
        """
        chosen = slice(None, self.objective.every * after, self.objective.every)
        memories = self.stepped.trajectory.memories[chosen, drop]
        whole = (
            np.hstack([self.stepped.trajectory.states[chosen, drop], memories]) - self.objective.sag(self.values)[drop]
        )
        unknown = np.full((whole.shape[1], before), np.nan)
        return np.hstack([unknown, whole.T])


def _expected_gain(information: Real, gradient: Real, change: Real) -> Real:
    """Return what twice the log-likelihood of each drop gains by a change of its unknowns, to the second order, (drop,)."""
    turned = (information @ change[:, :, None])[:, :, 0]
    gain: Real = np.sum((2.0 * gradient - turned) * change, axis=1)
    return gain

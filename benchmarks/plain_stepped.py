"""What somebody would write for a vehicle with dry friction: `solve_ivp` for every drop, finite differences, least squares."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import OptimizeResult, least_squares

from sprung.vehicle import NonlinearModel, sensor_rows
from ten_drops import FrictionTask

Real = NDArray[np.float64]

_STEP = 1e-3
"""Step of the differences, as a part of what is moved: with a shorter one the solver's own error drowns them."""

_SIZES = np.repeat([0.01, 0.1, 1.0], [7, 7, 4])
"""Of an initial state: m, m/s, and memories of friction."""


@dataclass(frozen=True, eq=False)
class PlainSteppedFit:
    """The same sum of squares as ours, over the same samples; parameters, and the initial states of all drops.

    Attributes
    ----------
    task
        What is fitted.
    noise
        m/s² of each channel, as our fit found it, shape (channel,).
    """

    task: FrictionTask
    noise: Real

    @cached_property
    def _models(self) -> dict[str, NonlinearModel]:
        return dict(self.task.models)

    @property
    def unknown(self) -> int:
        """How many unknowns there are."""
        return len(self.task.names) + 18 * len(self.task.decays)

    def start(self, away: float) -> Real:
        """Return a start away from what our fit found by a part: parameters as their logarithms."""
        logs = np.log(np.array(list(self.task.found.parameters.values()))) + away
        return np.concatenate([logs, self.task.found.states.ravel()])

    def residual(self, unknown: Real) -> Real:
        """Return measured minus modelled over the noise, of all drops, one after the other."""
        count = len(self.task.names)
        values = np.exp(unknown[:count])
        starts = unknown[count:].reshape(len(self.task.decays), 18)
        return np.concatenate([self.of_drop(values, start, i) for i, start in enumerate(starts)])

    def of_drop(self, values: Real, start: Real, drop: int) -> Real:
        """Return the same of one drop."""
        decay = self.task.decays[drop]
        model = self._models[decay.load]
        names = self.task.names
        sensors = sensor_rows(self.task.sensors, names).at(values)
        matrices, G = model.linear.matrices(values), model.forces.rows.at(values)
        inverse = np.linalg.inv(matrices.M)
        given = dict(zip(names, values.tolist(), strict=True))
        F = np.array([given["F_f"], given["F_f"], given["F_r"], given["F_r"]])
        s = np.array([given["s_f"], given["s_f"], given["s_r"], given["s_r"]])

        def accelerations(y: Real) -> Real:
            force = (
                matrices.K @ y[:7] + matrices.C @ y[7:14] + G.T @ (F[:, None] * y[14:] if y.ndim > 1 else F * y[14:])
            )
            return np.asarray(-inverse @ force)

        def slope(_: float, y: Real) -> Real:
            rate = G @ y[7:14]
            return np.concatenate([y[7:14], accelerations(y), s / F * (rate - np.abs(rate) * y[14:])])

        times = np.arange(decay.samples) / decay.rate
        found = solve_ivp(slope, (0.0, float(times[-1])), start, "LSODA", t_eval=times, rtol=1e-6, atol=1e-8)
        modelled = sensors @ accelerations(found.y)
        left = decay.values - modelled
        left -= left.mean(axis=1, keepdims=True)
        scaled: Real = (left / self.noise[:, None]).ravel()
        return scaled

    def jacobian(self, unknown: Real) -> Real:
        """Return its derivatives by differences; what one drop's start does to another is known to be nothing."""
        count, size = len(self.task.names), len(self.residual(unknown)) // len(self.task.decays)
        here = self.residual(unknown)
        found = np.zeros((len(here), self.unknown))
        for i in range(count):
            step = np.zeros(self.unknown)
            step[i] = _STEP
            found[:, i] = (self.residual(unknown + step) - here) / _STEP
        values = np.exp(unknown[:count])
        for drop, start in enumerate(unknown[count:].reshape(-1, 18)):
            own = slice(drop * size, (drop + 1) * size)
            for i in range(18):
                moved = start.copy()
                moved[i] += _STEP * _SIZES[i]
                change = self.of_drop(values, moved, drop) - here[own]
                found[own, count + 18 * drop + i] = change / (_STEP * _SIZES[i])
        return found

    def fit(self, away: float = 0.02) -> OptimizeResult:
        """Fit from a start that is away by a part."""
        return least_squares(self.residual, self.start(away), jac=self.jacobian, x_scale="jac")

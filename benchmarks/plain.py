"""The fit that anybody would write first: a library's least squares on the raw records, derivatives by finite differences.

It minimises the same sum of squares over the same parameters, and is given what it would otherwise have to guess: a start near
the truth, the noise levels, and the elimination of initial states and offsets by a linear least squares at every step (left
in the list of unknowns, the 220 of them would cost it far more).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import lmfit  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from sprung.vehicle import TABLE_1_CAR, sensor_rows
from ten_drops import Task

Real = NDArray[np.float64]

_DIFFERENCE = 1e-15
"""Square of lmfit's relative step of finite differences: with its own, half as long, rounding stops it 0.002 of a standard
error away. Everything else, in SciPy too, is left as it comes: tighter tolerances take longer and end no nearer."""


@dataclass(frozen=True, eq=False)
class PlainFit:
    """The sum of squares.

    Attributes
    ----------
    task
        What is fitted.
    wheelbase
        Known exactly, m.
    noise
        Noise level of each channel, m/s², shape (channel,).
    """

    task: Task
    wheelbase: float
    noise: Real

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters."""
        return next(iter(self.task.models.values())).names

    @property
    def start(self) -> Real:
        """Parameter values a fifth beside the truth, SI, shape (parameter,)."""
        return 1.2 * np.array([TABLE_1_CAR.parameters[name] for name in self.names])

    def residuals(self, values: Real) -> Real:
        """Return what the model leaves of all records, in units of their noise; parameter values in SI."""
        sensors = self.task.sensors
        rows = sensor_rows(sensors, self.names)
        left = []
        for decay in self.task.decays:
            A = self.task.models[decay.load].matrices(values).state
            poles, shapes = np.linalg.eig(A)
            keep = poles.imag >= 0
            time = np.arange(decay.samples) / decay.rate
            waves = np.exp(poles[keep, None] * time)
            output = rows.at(values) @ (A @ shapes)[7:, keep]
            columns = (output[:, :, None] * waves).transpose(0, 2, 1).reshape(-1, keep.sum())
            offsets = np.kron(np.eye(len(sensors)), np.ones((decay.samples, 1)))
            weight = np.repeat(1 / self.noise, decay.samples)
            basis = np.hstack([columns.real, columns.imag, offsets]) * weight[:, None]
            target = decay.values.ravel() * weight
            left.append(target - basis @ np.linalg.lstsq(basis, target, rcond=None)[0])
        return np.concatenate(left)

    def by_scipy(self, start: Real | None = None, **options: Any) -> Real:
        """Fit logarithms of the parameters with `scipy.optimize.least_squares`; gives values, SI, shape (parameter,)."""
        a, b = self.names.index("a"), self.names.index("b")
        free = [i for i in range(len(self.names)) if i != b]

        def values_of(x: Real) -> Real:
            values = np.empty(len(self.names))
            values[free] = np.exp(x)
            values[b] = self.wheelbase - values[a]
            return values

        def residuals(x: Real) -> Real:
            return self.residuals(values_of(x))

        first = np.log((self.start if start is None else start)[free])
        return values_of(least_squares(residuals, first, x_scale="jac", **options).x)

    def by_lmfit(self) -> Real:
        """Fit the parameters themselves with `lmfit.minimize`; gives values, SI, shape (parameter,)."""
        parameters = lmfit.Parameters()
        for name, value in zip(self.names, self.start, strict=True):
            if name != "b":
                parameters.add(name, value=value)
        parameters.add("b", expr=f"{self.wheelbase!r} - a")

        def values_of(these: lmfit.Parameters) -> Real:
            return np.array([these[name].value for name in self.names])

        def residuals(these: lmfit.Parameters) -> Real:
            return self.residuals(values_of(these))

        found = lmfit.minimize(residuals, parameters, epsfcn=_DIFFERENCE)
        return values_of(found.params)

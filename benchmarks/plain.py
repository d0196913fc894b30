"""The fit that anybody would write first: SciPy's least squares on the raw records, derivatives by finite differences.

It minimises the same sum of squares over the same parameters, and is given what it would otherwise have to guess: a start near
the truth, the noise levels, and the elimination of initial states and offsets by a linear least squares at every step (left
in the list of unknowns, the 220 of them would cost it another factor of ten).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from sprung.prepare import Decay
from sprung.vehicle import LinearModel, Rows, Sensor

Real = NDArray[np.float64]


def fit_plainly(
    decays: Sequence[Decay],
    models: Mapping[str, LinearModel],
    sensors: Sequence[Sensor],
    wheelbase: float,
    noise: Real,
    start: Real,
) -> tuple[tuple[str, ...], Real]:
    """Fit all decays; gives parameter names and values."""
    names = next(iter(models.values())).names
    rows = Rows.of([sensor.row for sensor in sensors], names)
    a, b = names.index("a"), names.index("b")
    free = [i for i in range(len(names)) if i != b]

    def values_of(x: Real) -> Real:
        values = np.empty(len(names))
        values[free] = np.exp(x)
        values[b] = wheelbase - values[a]
        return values

    def residuals(x: Real) -> Real:
        values = values_of(x)
        left = []
        for decay in decays:
            A = models[decay.load].matrices(values).state
            poles, shapes = np.linalg.eig(A)
            keep = poles.imag >= 0
            time = np.arange(decay.samples) / decay.rate
            waves = np.exp(poles[keep, None] * time)
            output = rows.at(values) @ (A @ shapes)[7:, keep]
            columns = (output[:, :, None] * waves).transpose(0, 2, 1).reshape(-1, keep.sum())
            offsets = np.kron(np.eye(len(sensors)), np.ones((decay.samples, 1)))
            weight = np.repeat(1 / noise, decay.samples)
            basis = np.hstack([columns.real, columns.imag, offsets]) * weight[:, None]
            target = decay.values.ravel() * weight
            left.append(target - basis @ np.linalg.lstsq(basis, target, rcond=None)[0])
        return np.concatenate(left)

    fitted = least_squares(residuals, np.log(start[free]), x_scale="jac", xtol=1e-10, ftol=1e-10)
    return names, values_of(fitted.x)

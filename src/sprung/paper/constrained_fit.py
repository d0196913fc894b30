"""Gauss-Newton for state matrices, with exactly known quantities as equality constraints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space

from sprung.display import shown
from sprung.errors import Problems
from sprung.vehicle import PARAMETERS, LinearModel, evaluate_quantities

Real = NDArray[np.float64]

_ITERATIONS = 60
_UNDETERMINED = 1e-9
"""Relative change of the state matrices below which a direction is undetermined."""


@shown
@dataclass(frozen=True, eq=False)
class StructuredFit:
    """Parameters from state matrices.

    Attributes
    ----------
    names
        The parameters.
    values
        SI, shape (parameter,).
    covariance
        SI, shape (parameter, parameter); zero for what was known.
    misfit
        Root mean square of the weighted residuals: relative to the size of A's rows where no standard deviations
        were given, about 1 where they were given and the model holds.
    converged
        Whether the last step was below the tolerance.
    """

    names: tuple[str, ...]
    values: Real
    covariance: Real
    misfit: float
    converged: bool

    @property
    def parameters(self) -> dict[str, float]:
        """Value of each parameter by name."""
        return dict(zip(self.names, self.values.tolist(), strict=True))


@dataclass(frozen=True, eq=False)
class IdentifiedState:
    """An identified state matrix: model of its load, lower half and weights, (7, 14) each."""

    model: LinearModel
    A: Real
    weight: Real

    def residual(self, values: Real) -> Real:
        """Return weighted differences, model minus identified; shape (98,)."""
        return (self.weight * (self.model.accelerations(values)[0] - self.A)).ravel()

    def jacobian(self, values: Real) -> Real:
        """Return their derivatives, shape (98, parameter)."""
        change = self.model.accelerations(values)[1]
        return (self.weight * change).reshape(len(change), -1).T


def fit_state_matrices(
    start: Real,
    names: tuple[str, ...],
    states: Sequence[IdentifiedState],
    known: Mapping[str, float],
    *,
    relative: bool,
) -> StructuredFit:
    """Minimise the residuals under the constraints by Gauss-Newton steps, halved until they improve the fit.

    Parameters
    ----------
    start
        Start values, SI, shape (parameter,).
    names
        Of the parameters.
    states
        Identified state matrices.
    known
        Exactly known quantities by name, SI.
    relative
        Whether the weights are relative, so that the noise is estimated from the residuals.

    Returns
    -------
    StructuredFit

    Raises
    ------
    InputError
        If a parameter is not determined.
    """
    positive = np.array([PARAMETERS[name].positive for name in names])
    values = start
    for name, value in known.items():
        if name in names:
            values = np.where(np.array(names) == name, value, values)

    def residual(at: Real) -> Real:
        return np.concatenate([state.residual(at) for state in states])

    def constraints(at: Real) -> tuple[Real, Real]:
        found, gradients = evaluate_quantities(tuple(known), tuple(names), at)
        return found - np.array([*known.values()]), gradients

    def merit(at: Real) -> float:
        misses, gradients = constraints(at)
        size = np.abs(gradients) @ np.abs(at) if len(misses) else np.ones(0)
        return float(np.sum(residual(at) ** 2) + np.sum((misses / size) ** 2) * 1e4)

    converged, now = False, merit(values)
    for _ in range(_ITERATIONS):
        J = np.vstack([state.jacobian(values) for state in states])
        misses, gradients = constraints(values)
        step, _ = _step(J, residual(values), gradients, misses, values)
        shrinking = positive & (step < 0)
        length = float(np.min(0.8 * values[shrinking] / -step[shrinking], initial=1.0))
        while length > 1e-10 and not merit(values + length * step) < now:
            length /= 2
        if length <= 1e-10:
            converged = float(np.max(np.abs(step) / np.abs(values))) < 1e-6
            break
        values = values + length * step
        now = merit(values)
    J = np.vstack([state.jacobian(values) for state in states])
    misses, gradients = constraints(values)
    _, free = _step(J, residual(values), gradients, misses, values)
    _refuse_undetermined(J, gradients, values, names)
    residuals = residual(values)
    variance = float(residuals @ residuals) / max(residuals.size - free.shape[1], 1) if relative else 1.0
    inverse = np.linalg.pinv(J @ free)
    return StructuredFit(
        names,
        values,
        variance * free @ (inverse @ inverse.T) @ free.T,
        float(np.sqrt(np.mean(residuals**2))),
        converged,
    )


def _step(J: Real, residual: Real, gradients: Real, misses: Real, values: Real) -> tuple[Real, Real]:
    """Solve the linearised problem under its constraints.

    Returns
    -------
    step
        Shape (parameter,).
    free
        Basis of the null space of the constraints, as columns, scaled to equal derivatives.
    """
    norms = np.linalg.norm(J, axis=0)
    scale = np.where(norms > 0, 1 / np.where(norms > 0, norms, 1.0), np.abs(values))
    design = J * scale
    particular, free = np.zeros(len(values)), np.eye(len(values))
    if len(misses):
        rows = gradients * scale
        sizes = np.linalg.norm(rows, axis=1)
        rows = rows / sizes[:, None]
        particular = np.linalg.lstsq(rows, -misses / sizes, rcond=1e-12)[0]
        free = null_space(rows, rcond=1e-12)
    if not free.shape[1]:
        return scale * particular, scale[:, None] * free
    along = np.linalg.lstsq(design @ free, -residual - design @ particular, rcond=1e-14)[0]
    return scale * (particular + free @ along), scale[:, None] * free


def _refuse_undetermined(J: Real, gradients: Real, values: Real, names: Sequence[str]) -> None:
    # Parameters relative to their size: a column without effect must not be scaled up.
    size = sizes_by_unit(values, names)
    free = np.eye(len(values))
    if len(gradients):
        rows = gradients * size
        free = null_space(rows / np.linalg.norm(rows, axis=1, keepdims=True), rcond=1e-12)
    if not free.shape[1]:
        return
    _, singular, directions = np.linalg.svd(J * size @ free, full_matrices=False)
    if singular[-1] > _UNDETERMINED * singular[0]:
        return
    relative = np.abs(free @ directions[-1])
    at_fault = [name for name, part in zip(names, relative / relative.max(), strict=True) if part > 0.1]
    problems = Problems()
    problems.add(
        "structured: parameters",
        f"{', '.join(at_fault)} can change without changing any state matrix",
        "states or known quantities that determine every parameter",
        "Add another load, or give one of these parameters as known.",
    )
    problems.raise_if_any()


def sizes_by_unit(values: Real, names: Sequence[str]) -> Real:
    """Return for each parameter the largest value of its unit, which is a size also for zero values.

    Parameters
    ----------
    values
        SI, shape (parameter,).
    names
        Of the parameters.
    """
    units = np.array([PARAMETERS[name].unit for name in names])
    sizes: Real = np.max(np.where(units[:, None] == units, np.abs(values), 0.0), axis=1, initial=1e-9)
    return sizes

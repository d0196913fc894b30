"""From state matrices to parameters in one structured least squares, which needs no invertible added mass."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import null_space

from sprung.display import shown
from sprung.errors import Problems, did_you_mean
from sprung.estimation import shape_of
from sprung.vehicle import (
    DERIVED,
    PARAMETERS,
    Heights,
    LinearModel,
    Load,
    Tracks,
    evaluate_quantity,
    parameter_names,
    seven_degrees_of_freedom,
)

Real = NDArray[np.float64]

_ITERATIONS = 60
_UNDETERMINED = 1e-9
"""A direction that changes the state matrices this little, relative to the best one, is not determined."""

_NOTHING_KNOWN: Mapping[str, float] = MappingProxyType({})


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
        Whether the last step changed nothing any more.
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
class _State:
    """One identified state matrix: its load's model, lower half and weights, (7, 14) each."""

    model: LinearModel
    A: Real
    weight: Real

    def residual(self, values: Real) -> Real:
        """Give weighted differences, model minus identified; shape (98,)."""
        return (self.weight * (self.model.accelerations(values)[0] - self.A)).ravel()

    def slopes(self, values: Real) -> Real:
        """Give their derivatives, shape (98, parameter)."""
        change = self.model.accelerations(values)[1]
        return (self.weight * change).reshape(len(change), -1).T


def structured_least_squares(
    states: Sequence[tuple[Load, ArrayLike]],
    *,
    known: Mapping[str, float] = _NOTHING_KNOWN,
    tracks: Tracks = "shared",
    extras: Collection[str] = (),
    cg_height: float | None = None,
    std: Sequence[ArrayLike] | None = None,
) -> StructuredFit:
    """Find the parameters whose state matrices are nearest to identified ones, all loads together.

    Eq. (18) takes M for 49 unknown numbers and needs a load that moves all of them. With M, C and K as functions of the
    parameters, eq. (2), any load that changes the modes gives the scale, and so does any mass or rate known beforehand.
    The start is found too: one state gives the parameters up to a common factor in closed form, the loads or the known
    quantities give the factor; Gauss-Newton does the rest, with known quantities as exact side conditions.

    Parameters
    ----------
    states
        Load and identified state matrix A for {X, Ẋ}, shape (14, 14), 1/s; any number of them;
        only their lower halves are read.
    known
        Parameters, or quantities of `sprung.vehicle.DERIVED`, that are known exactly, SI.
    tracks
        Whether springs and dampers of an axle share their half-distance.
    extras
        Any of `sprung.vehicle.LINEAR_EXTRAS`.
    cg_height
        Height of the empty body's centre of gravity, m; None takes loads as level with it.
    std
        Standard deviation of each entry of the lower halves, shape (7, 14) for each state; unless given, every row of
        A₂₁ and of A₂₂ is taken as known to the same part of its norm.

    Returns
    -------
    StructuredFit

    Raises
    ------
    InputError
        If a name is unknown, a matrix unusable, or the parameters are not determined: without any load or known mass or
        rate the common factor is free.

    Examples
    --------
    >>> from sprung.vehicle import EMPTY, SCHOOL_BUS, Added, Load, Heights
    >>> load = Load(name="on the body", added=Added(mass=470, I_yy=1057.5, I_xx=339.6))
    >>> states = [(load, SCHOOL_BUS.matrices(load).state) for load in (EMPTY, load)]
    >>> fit = structured_least_squares(states, tracks="separate")
    >>> round(fit.parameters["I_xx"], 6)
    3450.0
    """
    names = parameter_names(tracks, tuple(extras))
    _check(states, known, names, std)
    elements = seven_degrees_of_freedom(tracks, extras)
    lower = [np.asarray(A, dtype=float)[7:] for _, A in states]
    models = [LinearModel.of(elements + load.elements(Heights(cg_height)), names) for load, _ in states]
    weights = [_row_weights(A) for A in lower] if std is None else [1 / np.asarray(s, dtype=float) for s in std]
    fitted = [_State(*one) for one in zip(models, lower, weights, strict=True)]

    lightest = min(range(len(states)), key=lambda i: states[i][0].mass)
    shape = shape_of(np.vstack([np.zeros((7, 14)), lower[lightest]]), LinearModel.of(elements, names))
    start = _scaled(_usable(shape, names), names, fitted, known)
    return _gauss_newton(start, names, fitted, known, relative=std is None)


def _check(
    states: Sequence[tuple[Load, ArrayLike]],
    known: Mapping[str, float],
    names: Sequence[str],
    std: Sequence[ArrayLike] | None,
) -> None:
    problems = Problems()
    if not states:
        problems.add("structured: states", "none", "at least one", "Give the state matrix of the empty vehicle.")
    for i, (load, A) in enumerate(states):
        place = f"structured: states[{i}] ({load.name})"
        if np.shape(A) != (14, 14) or not np.isfinite(np.asarray(A, dtype=float)).all():
            found = f"an array of shape {np.shape(A)}, or entries that are not numbers"
            problems.add(place, found, "14 by 14 numbers", "Use eq. (12) on seven coordinates.")
    if std is not None and [np.shape(one) for one in std] != [(7, 14)] * len(states):
        found = f"shapes {[np.shape(one) for one in std]}"
        problems.add("structured: std", found, f"{len(states)} arrays of shape (7, 14)", "Give one for each state.")
    allowed = (*names, *DERIVED)
    for name in known.keys() - set(allowed):
        problems.add("structured: known", f"'{name}'", "a parameter or derived one", did_you_mean(name, allowed))
    if not any(load.mass for load, _ in states) and not any(_gives_scale(name) for name in known):
        found = "no loaded state and no known mass or rate"
        expected = "one of the two: all masses and rates together have a factor that free vibration does not show"
        problems.add("structured: scale", found, expected, "Add a load, or known = {'total_mass': ...}.")
    problems.raise_if_any()


def _gives_scale(name: str) -> bool:
    return PARAMETERS[name].scales if name in PARAMETERS else name != "wheelbase"


def _row_weights(A: Real) -> Real:
    """Give 1 over the norm of each row of A₂₁ and A₂₂, shape (7, 14)."""
    norms = np.stack([np.linalg.norm(block, axis=1) for block in (A[:, :7], A[:, 7:])], axis=1)
    return np.repeat(1 / np.where(norms > 0, norms, 1.0), 7, axis=1)


def _usable(shape: Real, names: Sequence[str]) -> Real:
    """Replace what noise has made negative, or left unknown, by something small and positive of its kind."""
    found = np.nan_to_num(shape)
    positive = np.array([PARAMETERS[name].positive for name in names])
    size = _sizes(found, names)
    return np.where(positive & (found < 1e-3 * size), 0.1 * size, found)


def _sizes(values: Real, names: Sequence[str]) -> Real:
    """Give for each parameter the largest one of its unit: a size also for those that are zero."""
    units = np.array([PARAMETERS[name].unit for name in names])
    sizes: Real = np.max(np.where(units[:, None] == units, np.abs(values), 0.0), axis=1, initial=1e-9)
    return sizes


def _scaled(shape: Real, names: Sequence[str], states: Sequence[_State], known: Mapping[str, float]) -> Real:
    """Give the parameters their scale: from a known quantity, or the one at which the loads fit best."""
    scales = np.array([PARAMETERS[name].scales for name in names])
    for name, value in known.items():
        if _gives_scale(name):
            return np.where(scales, shape * value / evaluate_quantity(name, names, shape)[0], shape)
    candidates = [np.where(scales, shape * factor, shape) for factor in np.geomspace(1e1, 1e6, 101)]
    return min(candidates, key=lambda values: sum(float(np.sum(one.residual(values) ** 2)) for one in states))


def _gauss_newton(
    start: Real, names: tuple[str, ...], states: Sequence[_State], known: Mapping[str, float], *, relative: bool
) -> StructuredFit:
    """Minimise the residuals under the side conditions; steps are halved until they improve the fit."""
    positive = np.array([PARAMETERS[name].positive for name in names])
    values = start
    for name, value in known.items():
        if name in names:
            values = np.where(np.array(names) == name, value, values)

    def residual(at: Real) -> Real:
        return np.concatenate([state.residual(at) for state in states])

    def side_conditions(at: Real) -> tuple[Real, Real]:
        pairs = [(value, *evaluate_quantity(name, names, at)) for name, value in known.items()]
        misses = np.array([now - value for value, now, _ in pairs])
        return misses, np.array([gradient for *_, gradient in pairs]).reshape(len(pairs), len(names))

    def merit(at: Real) -> float:
        misses, gradients = side_conditions(at)
        size = np.abs(gradients) @ np.abs(at) if len(misses) else np.ones(0)
        return float(np.sum(residual(at) ** 2) + np.sum((misses / size) ** 2) * 1e4)

    converged, now = False, merit(values)
    for _ in range(_ITERATIONS):
        J = np.vstack([state.slopes(values) for state in states])
        misses, gradients = side_conditions(values)
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
    J = np.vstack([state.slopes(values) for state in states])
    misses, gradients = side_conditions(values)
    _, free = _step(J, residual(values), gradients, misses, values)
    _refuse_undetermined(J, gradients, values, names)
    left = residual(values)
    variance = float(left @ left) / max(left.size - free.shape[1], 1) if relative else 1.0
    inverse = np.linalg.pinv(J @ free)
    return StructuredFit(
        names, values, variance * free @ (inverse @ inverse.T) @ free.T, float(np.sqrt(np.mean(left**2))), converged
    )


def _step(J: Real, residual: Real, gradients: Real, misses: Real, values: Real) -> tuple[Real, Real]:
    """Solve the linearised problem within its side conditions.

    Returns
    -------
    step
        Shape (parameter,).
    free
        Directions that the side conditions leave free, as columns; the slopes along them are of one size.
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
    # Parameters in parts of their size: a column without effect must not be blown up to look like any other.
    size = _sizes(values, names)
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

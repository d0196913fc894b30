"""Parameters from state matrices by structured least squares, without an invertible added mass."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.errors import Problems, did_you_mean
from sprung.estimation import shape_of
from sprung.paper.constrained_fit import IdentifiedState, StructuredFit, fit_state_matrices, sizes_by_unit
from sprung.vehicle import (
    DERIVED,
    PARAMETERS,
    Heights,
    LinearModel,
    Load,
    Tracks,
    evaluate_quantity,
    linear_elements,
    parameter_names,
)

Real = NDArray[np.float64]

_NOTHING_KNOWN: Mapping[str, float] = MappingProxyType({})


def structured_least_squares(
    states: Sequence[tuple[Load, ArrayLike]],
    *,
    known: Mapping[str, float] = _NOTHING_KNOWN,
    tracks: Tracks = "shared",
    extras: Collection[str] = (),
    cg_height: float | None = None,
    std: Sequence[ArrayLike] | None = None,
) -> StructuredFit:
    """Fit the parameters to identified state matrices of all loads.

    Eq. (18) treats M as 49 unknowns and needs a load on all coordinates. With M, C and K as functions of the parameters,
    eq. (2), any load that changes the modes determines the scale, and so does any known mass or rate. Start values: one state
    matrix determines the parameters up to a common factor in closed form, loads or known quantities determine the factor.
    Gauss-Newton refines them, with known quantities as equality constraints.

    Parameters
    ----------
    states
        Loads and identified state matrices A for {X, Ẋ}, shape (14, 14), 1/s, of which only the lower halves are read.
    known
        Parameters, or quantities of `sprung.vehicle.DERIVED`, that are known exactly, SI.
    tracks
        Whether springs and dampers of an axle share their half-distance.
    extras
        Any of `sprung.vehicle.LINEAR_EXTRAS`.
    cg_height
        Height of the centre of gravity of the empty body, m; None: loads are at that height.
    std
        Standard deviation of each entry of the lower halves, shape (7, 14) for each state; unless given, equal relative to
        the norm of each row of A₂₁ and of A₂₂.

    Returns
    -------
    StructuredFit

    Raises
    ------
    InputError
        If a name is unknown, a matrix unusable, or the parameters are not determined: without a load, a known mass or a known
        rate their common factor is free.

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
    _check_arguments(states, known, names, std)
    elements = linear_elements(tracks, extras)
    lower = [np.asarray(A, dtype=float)[7:] for _, A in states]
    models = [LinearModel.of(elements + load.elements(Heights(cg_height)), names) for load, _ in states]
    weights = [_row_weights(A) for A in lower] if std is None else [1 / np.asarray(s, dtype=float) for s in std]
    fitted = [IdentifiedState(*state) for state in zip(models, lower, weights, strict=True)]

    lightest = min(range(len(states)), key=lambda i: states[i][0].total_mass())
    shape = shape_of(np.vstack([np.zeros((7, 14)), lower[lightest]]), LinearModel.of(elements, names))
    start = _scaled(_usable(shape, names), names, fitted, known)
    return fit_state_matrices(start, names, fitted, known, relative=std is None)


def _check_arguments(
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
    if std is not None and [np.shape(array) for array in std] != [(7, 14)] * len(states):
        found = f"shapes {[np.shape(array) for array in std]}"
        problems.add("structured: std", found, f"{len(states)} arrays of shape (7, 14)", "Give one for each state.")
    allowed = (*names, *DERIVED)
    for name in known.keys() - set(allowed):
        problems.add("structured: known", f"'{name}'", "a parameter or derived one", did_you_mean(name, allowed))
    if not any(load.total_mass() for load, _ in states) and not any(_gives_scale(name) for name in known):
        found = "no loaded state and no known mass or rate"
        expected = "one of the two: free vibration does not determine the common factor of all masses and rates"
        problems.add("structured: scale", found, expected, "Add a load, or known = {'total_mass': ...}.")
    problems.raise_if_any()


def _gives_scale(name: str) -> bool:
    return PARAMETERS[name].scales if name in PARAMETERS else name != "wheelbase"


def _row_weights(A: Real) -> Real:
    """Return 1 over the norm of each row of A₂₁ and A₂₂, shape (7, 14)."""
    norms = np.stack([np.linalg.norm(block, axis=1) for block in (A[:, :7], A[:, 7:])], axis=1)
    return np.repeat(1 / np.where(norms > 0, norms, 1.0), 7, axis=1)


def _usable(shape: Real, names: Sequence[str]) -> Real:
    """Return parameters with negative and unknown values replaced by small positive ones."""
    values = np.nan_to_num(shape)
    positive = np.array([PARAMETERS[name].positive for name in names])
    size = sizes_by_unit(values, names)
    return np.where(positive & (values < 1e-3 * size), 0.1 * size, values)


def _scaled(shape: Real, names: Sequence[str], states: Sequence[IdentifiedState], known: Mapping[str, float]) -> Real:
    """Return the parameters with the scale from a known quantity, or with the scale that fits the loads best."""
    scales = np.array([PARAMETERS[name].scales for name in names])
    for name, value in known.items():
        if _gives_scale(name):
            return np.where(scales, shape * value / evaluate_quantity(name, names, shape)[0], shape)
    candidates = [np.where(scales, shape * factor, shape) for factor in np.geomspace(1e1, 1e6, 101)]
    return min(candidates, key=lambda values: sum(float(np.sum(state.residual(values) ** 2)) for state in states))

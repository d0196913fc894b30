"""Force curves of dampers, springs and tyres, with their standard error and the range that the drops reached."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, ConfigDict, PlainSerializer, SkipValidation

from sprung.display import shown
from sprung.estimation.characteristics import estimate_quantity
from sprung.estimation.fit_result import FitResult
from sprung.estimation.statistics import FitStatistics
from sprung.uncertainty import Estimate
from sprung.vehicle import (
    FORCE_CURVES,
    CurveElements,
    Element,
    NonlinearElement,
    NonlinearModel,
    Row,
    Rows,
)

Real = NDArray[np.float64]

_EXTENSION = 1.5
"""Length of a stored curve to either side, over the largest value that the drops reached."""

_DENSE = 1000
"""Points to either side from which the stored ones are chosen; they are closest at rest, where curves bend most."""

_FORCE_ERROR, _STD_ERROR = 1e-3, 1e-2
"""Relative error of the straight lines between stored points."""

_ROUNDING = 1e-4
"""Part of the largest force, or standard error, that is nothing beside it."""


def _as_array(values: object) -> Real:
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 1:
        raise ValueError("a list of numbers is expected")
    return array


Samples = Annotated[
    SkipValidation[NDArray[np.float64]], BeforeValidator(_as_array), PlainSerializer(lambda values: values.tolist())
]
"""Samples of a curve: an array in memory, a list in results.json."""


class CurvePoint(NamedTuple):
    """The force of a curve somewhere.

    Attributes
    ----------
    force
        N, of the shape of the velocity or travel.
    std
        Its standard error, N, of the same shape.
    """

    force: Real | float
    std: Real | float


@shown
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ForceCurve:
    """The force of a damper against its velocity, of a spring against its travel from rest, of a tyre against its deflection.

    Attributes
    ----------
    x
        Velocity, m/s, or travel, m, positive in rebound, shape (point,); a tyre's travel counts from where it first touches the
        ground, and is negative. Between these points the curve is straight within 0.1 %.
    force, std
        Force, N, positive in rebound and zero where x is, and its standard error, N, shape (point,).
    x_unit, force_unit
        Their units.
    reached
        The lowest and the highest velocity or travel in the fitted drops. Beyond them the curve is what the model extrapolates.
    friction
        Of a damper's curve: the dry friction of the suspension, N, which acts beside the damper and is not part of the curve;
        None where the model has none.
    """

    __pydantic_config__ = ConfigDict(extra="forbid", arbitrary_types_allowed=True)

    x: Samples
    force: Samples
    std: Samples
    x_unit: str
    force_unit: str
    reached: tuple[float, float]
    friction: Estimate | None = None

    def at(self, x: Real | float) -> CurvePoint:
        """Return the force with its standard error.

        Parameters
        ----------
        x
            Velocity, m/s, or travel, m, positive in rebound, of any shape; beyond the stored points along the last line.

        Returns
        -------
        CurvePoint
            Force and standard error, of the shape of `x`.
        """
        force, std = (_along(self.x, samples, np.asarray(x, dtype=float)) for samples in (self.force, self.std))
        return CurvePoint(float(force), float(std)) if np.ndim(x) == 0 else CurvePoint(force, std)


def _along(x: Real, y: Real, at: Real) -> Real:
    """Interpolate along straight lines, the first and the last of which go on."""
    piece = np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2)
    value: Real = y[piece] + (at - x[piece]) * (y[piece + 1] - y[piece]) / (x[piece + 1] - x[piece])
    return value


def force_curves(
    fit: FitStatistics,
    optimum: FitResult,
    models: Mapping[str, NonlinearModel],
    linear: Sequence[Element],
    nonlinear: Sequence[NonlinearElement],
) -> dict[str, ForceCurve]:
    """Return the force curves on whose row the model has a nonlinear law.

    The standard error is that of the gradient under the joint covariance of all parameters.

    Parameters
    ----------
    fit
        Uncertainty of the fit.
    optimum
        The fit.
    models
        Equations of motion of the fitted vehicle by load name.
    linear, nonlinear
        Elements of the empty vehicle.

    Returns
    -------
    dict
        By name, those of `sprung.vehicle.FORCE_CURVES` that the data determine.
    """
    kinds = {name: CurveElements.of(name, linear, nonlinear) for name in FORCE_CURVES}
    kinds = {name: elements for name, elements in kinds.items() if elements.nonlinear}
    rows = [(row, elements.is_of_tyre) for elements in kinds.values() for row in elements.rows]
    reached = _reached(optimum, models, rows)
    found = {}
    for name, elements in kinds.items():
        ranges = [next(reached) for _ in elements.rows]
        which = 1 if elements.law == "damper" else 0
        low, high = min(limits[which][0] for limits in ranges), max(limits[which][1] for limits in ranges)
        curve = _curve(fit, elements, (low, high))
        if curve is not None:
            found[name] = curve
    return found


def _curve(fit: FitStatistics, elements: CurveElements, reached: tuple[float, float]) -> ForceCurve | None:
    """Return one curve; None where it is straight as far as the drops reach, or not determined."""
    if elements.is_of_tyre:
        # A tyre that is off the ground, as in a fit that uses the fall, has no force.
        reached = min(reached[0], 0.0), min(reached[1], 0.0)
    length = _EXTENSION * max(map(abs, reached))
    spacing = np.linspace(-1, 1, 2 * _DENSE + 1)
    x = np.union1d(length * spacing * np.abs(spacing), reached)
    x = x[x <= 0] if elements.is_of_tyre else x
    inside = (x >= reached[0]) & (x <= reached[1])
    if not elements.is_nonlinear(fit.names, fit.values, x[inside]):
        return None
    force, gradient = elements.force(fit.names, fit.values, x)
    std = np.sqrt(np.maximum(np.einsum("xi,ij,xj->x", gradient, fit.covariance, gradient, optimize=True), 0.0))
    largest = int(np.argmax(np.where(inside, np.abs(force), -1.0)))
    if std[largest] > abs(force[largest]):
        return None
    friction = None
    if elements.hysteretic:
        friction = estimate_quantity(fit, *elements.hysteresis(fit.names, fit.values), "N", signed=True)
    kept = _straight_between(x, force, std, [0.0, *reached])
    return ForceCurve(
        x=x[kept],
        force=force[kept],
        std=std[kept],
        x_unit="m/s" if elements.law == "damper" else "m",
        force_unit="N",
        reached=reached,
        friction=friction,
    )


def _straight_between(x: Real, force: Real, std: Real, corners: Sequence[float]) -> list[int]:
    """Return the positions of the fewest points between which force and standard error are straight (Ramer's algorithm)."""
    kept = {0, len(x) - 1, *np.searchsorted(x, corners).tolist()}
    allowed = [
        relative * (np.abs(values) + _ROUNDING * np.abs(values).max() + np.finfo(float).tiny)
        for values, relative in ((force, _FORCE_ERROR), (std, _STD_ERROR))
    ]
    while True:
        chosen = sorted(kept)
        lines = [np.interp(x, x[chosen], values[chosen]) for values in (force, std)]
        missed = np.max(
            [np.abs(line - y) / most for line, y, most in zip(lines, (force, std), allowed, strict=True)], 0
        )
        if (worst := int(missed.argmax())) in kept or missed[worst] <= 1:
            return chosen
        kept.add(worst)


def _reached(
    optimum: FitResult, models: Mapping[str, NonlinearModel], rows: Sequence[tuple[Row, bool]]
) -> Iterator[tuple[tuple[float, float], tuple[float, float]]]:
    """Yield the lowest and the highest travel, m, and rate, m/s, of each row in all drops.

    Rows come with whether their travel counts from the vehicle without gravity.
    """
    if not rows:
        return
    compiled = Rows.of([row for row, _ in rows], optimum.names).at(optimum.values)
    weightless = np.array([is_weightless for _, is_weightless in rows])
    lowest, highest = np.full((2, len(rows)), np.inf), np.full((2, len(rows)), -np.inf)
    for drop, decay in enumerate(optimum.decays):
        motion = optimum.motion(drop, 0, decay.samples)
        model, n = models[decay.load], compiled.shape[1]
        X = motion[:n] + model.sag(optimum.values)[:, None]
        # A coordinate without mass has no velocity in the state, and with a nonlinear law none that is linear in it.
        velocities = np.gradient(X, 1 / decay.rate, axis=1)
        velocities[: model.state_size - n] = motion[n : model.state_size]
        offsets = weightless * (compiled @ model.empty_sag(optimum.values))
        both = np.stack([compiled @ X + offsets[:, None], compiled @ velocities])
        lowest, highest = np.minimum(lowest, both.min(axis=2)), np.maximum(highest, both.max(axis=2))
    for limits in np.stack([lowest, highest]).transpose(2, 1, 0).tolist():
        yield tuple(limits[0]), tuple(limits[1])

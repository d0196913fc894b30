"""Masses, loads, centre of gravity, ride frequencies and damping ratios of the identified vehicle, with their uncertainty."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.estimates import estimate_of
from sprung.estimation.statistics import FitStatistics
from sprung.uncertainty import NORMAL_95, Estimate, KnownValue
from sprung.vehicle import (
    CHARACTERISTICS,
    DERIVED,
    MOTION_RATIOS,
    PARAMETERS,
    STATIONS,
    LinearModel,
    Wheel,
    evaluate_quantity,
    layout_of,
    wheel_loads,
)

Real = NDArray[np.float64]

_ROUNDING = 1e-12
"""Relative standard uncertainty below which a quantity follows exactly from what was known."""

_SIDES = {1.0: ("left",), -1.0: ("right",), 0.0: ()}
_AXLES = {"f": ("front",), "r": ("rear",), "": ()}


def characteristics_of(fit: FitStatistics, known: Mapping[str, KnownValue], empty: LinearModel) -> dict[str, Estimate]:
    """Estimate what follows from the parameters: `CHARACTERISTICS` and the static wheel loads.

    The standard uncertainty is that of the gradient under the joint covariance of all parameters.

    Parameters
    ----------
    fit
        The fit.
    known
        What was known beforehand.
    empty
        Equations of motion of the empty vehicle.

    Returns
    -------
    dict
        By name; without a value where the data do not determine it, such as masses without absolute scale.
    """
    found = {}
    for name, one in CHARACTERISTICS.items():
        if not one.needs <= set(fit.names):
            continue
        if name in DERIVED:
            found[name] = estimate_of(fit, known, name)
        else:
            value, gradient = evaluate_quantity(name, fit.names, fit.values)
            found[name] = estimate_quantity(fit, value, gradient, one.unit, one.signed)
    return found | _wheel_loads(fit, empty)


def rates_at_motion_ratios(fit: FitStatistics, ratios: Mapping[str, KnownValue]) -> dict[str, Estimate]:
    """Estimate the rates of springs and dampers at themselves, not at the wheel.

    Parameters
    ----------
    fit
        The fit.
    ratios
        Travel of the spring or damper per travel of its wheel, dimensionless, by the names of `MOTION_RATIOS`.

    Returns
    -------
    dict
        By name; the standard uncertainty includes that of the ratio.
    """
    found = {}
    for name, ratio in ratios.items():
        parameter, quantity, _ = MOTION_RATIOS[name]
        rate, gradient = evaluate_quantity(parameter, fit.names, fit.values)
        value, square = rate / ratio.value**2, ratio.value**2
        # The ratio was measured apart from everything else: d ln(k / i²) = d ln k - 2 d ln i.
        of_ratio = 2 * value * ratio.std / ratio.value
        found[quantity] = estimate_quantity(fit, value, gradient / square, PARAMETERS[parameter].unit, False, of_ratio)
    return found


def _wheel_loads(fit: FitStatistics, empty: LinearModel) -> dict[str, Estimate]:
    loads, gradients = wheel_loads(empty, fit.values)
    layout = layout_of(fit.names)
    each = dict(zip(layout.wheels, zip(loads.tolist(), gradients, strict=True), strict=True))
    names = {wheel: _wheel_load(wheel, has_sides="y_s" in fit.names) for wheel in layout.wheels}
    # Where left and right are alike the first of both stands for the axle.
    names = {wheel: name for i, (wheel, name) in enumerate(names.items()) if name not in list(names.values())[:i]}
    return {
        name: estimate_quantity(fit, load, gradient, "N", signed=False)
        for station, name in names.items()
        for load, gradient in [each[station]]
    }


def _wheel_load(wheel: Wheel, has_sides: bool) -> str:
    _, axle, side, _ = STATIONS[wheel]
    return "_".join((*_AXLES[axle], *(_SIDES[side] if has_sides else ()), "wheel_load"))


def estimate_quantity(
    fit: FitStatistics, value: float, gradient: Real, unit: str, signed: bool, other_std: float = 0.0
) -> Estimate:
    """Estimate a quantity that follows from the parameters.

    Parameters
    ----------
    fit
        The fit.
    value
        Of the quantity, in the unit.
    gradient
        By each parameter, SI, shape (parameter,).
    unit
        SI.
    signed
        Whether it may be zero or negative.
    other_std
        Standard uncertainty from what is not a parameter of the fit, in the unit.

    Returns
    -------
    Estimate
        Its standard uncertainty is that of the gradient under the joint covariance; without a value where it is not determined.
    """
    # What may be zero counts as determined beside what its parameters would have to be to matter.
    size = max(abs(value), *(abs(slope) * fit.size(name) for name, slope in zip(fit.names, gradient, strict=True)))
    std = fit.spread(gradient * fit.slopes, size if signed else value)
    if std is None:
        return Estimate(None, None, None, unit, "unidentifiable")
    std = math.hypot(std, other_std)
    if std <= _ROUNDING * abs(value):
        return Estimate(value, 0.0, (value, value), unit, "known")
    if signed:
        interval = value - NORMAL_95 * std, value + NORMAL_95 * std
    else:
        factor = float(np.exp(NORMAL_95 * std / value))
        interval = value / factor, value * factor
    return Estimate(value, std, interval, unit, "estimated", "curvature")

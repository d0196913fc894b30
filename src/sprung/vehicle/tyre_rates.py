"""Tyre rates at rest: of a tyre whose rate grows with its deflection, k_t is the rate where it first touches the ground."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle.layout import STATIONS, layout_of
from sprung.vehicle.model import LinearModel

Array = NDArray[np.float64]

_NUDGE = 1e-6
"""Relative change of a parameter over which rates are differentiated."""

_LEAST = 0.04
"""Square of the least ratio of the rate at rest to that at first touch."""


def with_tyre_rates_at_rest(model: LinearModel, values: Sequence[float] | Array) -> Array:
    """Return the parameters of the vehicle that moves as another one does near rest, with linear tyres.

    Parameters
    ----------
    model
        Equations of motion with the load under which it rests.
    values
        Parameters, SI, shape (parameter,).

    Returns
    -------
    ndarray
        The same but for k_t, where the model has tyres whose rate grows: with the static load W, k d (1 + h d/2) = W gives
        the rate k (1 + h d) = k √(1 + 2 h W/k).
    """
    at_rest = np.array(values, dtype=np.float64)
    names = model.names
    layout = layout_of(names)
    if f"h_t{layout.axles[0]}" not in names:
        return at_rest
    matrices = model.matrices(at_rest)
    deflections = matrices.deflection(matrices.M @ model.heave * STANDARD_GRAVITY)[layout.wheels_at]
    axles = [STATIONS[wheel].axle for wheel in layout.wheels]
    for axle in layout.axles:
        own = deflections[[one == axle for one in axles]]
        rate, growth = names.index(f"k_t{axle}"), names.index(f"h_t{axle}")
        at_rest[rate] *= np.sqrt(max(1 + 2 * values[growth] * float(own.mean()), _LEAST))
    return at_rest


def differentiate_tyre_rates_at_rest(model: LinearModel, values: Array) -> Array:
    """Return the derivatives of the parameters at rest by those at first touch.

    Parameters
    ----------
    model, values
        As for `with_tyre_rates_at_rest`.

    Returns
    -------
    ndarray
        Of each parameter in SI by each, shape (parameter, parameter).
    """
    steps = _NUDGE * np.maximum(np.abs(values), _NUDGE)
    if not {"h_tf", "h_t"} & {*model.names}:
        return np.eye(len(values))
    columns = [
        (with_tyre_rates_at_rest(model, values + step) - with_tyre_rates_at_rest(model, values - step))
        / (2 * step.max())
        for step in np.diag(steps)
    ]
    return np.stack(columns, axis=1)

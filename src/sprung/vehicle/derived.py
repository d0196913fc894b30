"""Quantities a user may know beforehand: the parameters themselves, and those that follow from several of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Gradient = dict[str, float]


def _total_mass(p: Mapping[str, float]) -> tuple[float, Gradient]:
    return p["m_s"] + 2 * (p["m_uf"] + p["m_ur"]), {"m_s": 1.0, "m_uf": 2.0, "m_ur": 2.0}


def _wheelbase(p: Mapping[str, float]) -> tuple[float, Gradient]:
    return p["a"] + p["b"], {"a": 1.0, "b": 1.0}


def _front_axle_mass(p: Mapping[str, float]) -> tuple[float, Gradient]:
    wheelbase = p["a"] + p["b"]
    share = p["b"] / wheelbase
    slope = p["m_s"] / wheelbase**2
    return p["m_s"] * share + 2 * p["m_uf"], {"m_s": share, "m_uf": 2.0, "a": -slope * p["b"], "b": slope * p["a"]}


def _rear_axle_mass(p: Mapping[str, float]) -> tuple[float, Gradient]:
    wheelbase = p["a"] + p["b"]
    share = p["a"] / wheelbase
    slope = p["m_s"] / wheelbase**2
    return p["m_s"] * share + 2 * p["m_ur"], {"m_s": share, "m_ur": 2.0, "a": slope * p["b"], "b": -slope * p["a"]}


DERIVED: Mapping[str, Callable[[Mapping[str, float]], tuple[float, Gradient]]] = {
    "total_mass": _total_mass,
    "front_axle_mass": _front_axle_mass,
    "rear_axle_mass": _rear_axle_mass,
    "wheelbase": _wheelbase,
}
"""Derived quantities by the name a campaign gives them: value and gradient from the parameters; the vehicle empty."""


def evaluate_quantity(
    name: str, names: Sequence[str], values: NDArray[np.float64]
) -> tuple[float, NDArray[np.float64]]:
    """Give a parameter or derived quantity and its gradient.

    Parameters
    ----------
    name
        One of `names` or of `DERIVED`.
    names, values
        Parameters, SI; values of shape (parameter,).

    Returns
    -------
    value
        SI.
    gradient
        By each parameter, shape (parameter,).
    """
    gradient = np.zeros(len(names))
    if name in DERIVED:
        value, slopes = DERIVED[name](dict(zip(names, values.tolist(), strict=True)))
        for parameter, slope in slopes.items():
            gradient[names.index(parameter)] = slope
        return value, gradient
    position = names.index(name)
    gradient[position] = 1.0
    return float(values[position]), gradient

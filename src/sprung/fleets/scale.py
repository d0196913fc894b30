"""Vehicles of a type of which none has an absolute scale: their masses, inertias and rates as ratios to the total mass."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.batch import Row
from sprung.vehicle import PARAMETERS, evaluate_quantity

Real = NDArray[np.float64]

PER_TOTAL_MASS = "/total_mass"
"""End of the name of a parameter that is divided by the total mass of its vehicle."""

UNDETERMINED = 1.0
"""Standard uncertainty, relative, from which on a test does not determine a quantity."""

_REST = "m_s"
"""Mass whose ratio to the total mass is left out: those of the unsprung masses state it."""


def without_scale(rows: Sequence[Row]) -> list[Row] | None:
    """Return the rows of vehicles with ratios to the total mass in place of absolute quantities, if none has a scale.

    Parameters
    ----------
    rows
        With estimates: names, coordinates and their covariance matrix.

    Returns
    -------
    list of Row or None
        None where at least one vehicle has an absolute scale, which then is that of the others too.
    """
    if not rows or any(_has_scale(row) for row in rows):
        return None
    return [_per_total_mass(row) for row in rows]


def _has_scale(row: Row) -> bool:
    """Return whether any absolute quantity is determined, or nothing depends on the scale."""
    names, values, slopes, covariance = _arrays(row)
    scaled = [j for j, name in enumerate(names) if PARAMETERS[name].scales]
    relative = np.sqrt(np.diag(covariance)) * slopes / np.maximum(np.abs(values), np.finfo(float).tiny)
    return not scaled or _REST not in names or bool((relative[scaled] < UNDETERMINED).any())


def _arrays(row: Row) -> tuple[list[str], Real, Real, Real]:
    """Return names and values of the estimates, derivatives of the values by the coordinates, and the covariance of these."""
    names = list(row["coordinates"])
    position = np.array(row["position"], dtype=float)
    positive = np.array([PARAMETERS[name].positive for name in names])
    values = np.where(positive, np.exp(np.where(positive, position, 0.0)), position)
    covariance = np.array(row["covariance"], dtype=float).reshape(len(names), len(names))
    return names, values, np.where(positive, values, 1.0), covariance


def _per_total_mass(row: Row) -> Row:
    names, values, slopes, covariance = _arrays(row)
    total, gradient = evaluate_quantity("total_mass", names, values)
    by_coordinates = gradient * slopes / total  # of the logarithm of the total mass
    kept = [j for j, name in enumerate(names) if name != _REST]
    position = np.array(row["position"], dtype=float)
    jacobian = np.eye(len(names))
    for j, name in enumerate(names):
        if not PARAMETERS[name].scales:
            continue
        if PARAMETERS[name].positive:
            position[j] -= np.log(total)
            jacobian[j] -= by_coordinates
        else:
            position[j] /= total
            jacobian[j] = jacobian[j] / total - position[j] * by_coordinates
    jacobian = jacobian[kept]
    return {
        **row,
        "coordinates": [ratio_name(names[j]) for j in kept],
        "position": position[kept],
        "covariance": (jacobian @ covariance @ jacobian.T).ravel(),
    }


def ratio_name(name: str) -> str:
    """Return the name of a parameter of a vehicle without scale: with the total mass where it depends on the scale.

    Parameters
    ----------
    name
        Of a parameter of a vehicle.

    Examples
    --------
    >>> ratio_name("k_sf"), ratio_name("t_f")
    ('k_sf/total_mass', 't_f')
    """
    return f"{name}{PER_TOTAL_MASS}" if PARAMETERS[name].scales else name


def fleet_names() -> Iterator[str]:
    """Yield the names that the parameters of a fleet may have, in their order."""
    for name in PARAMETERS:
        yield name
        if ratio_name(name) != name:
            yield ratio_name(name)

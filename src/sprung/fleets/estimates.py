"""The estimates of several vehicles of one type as arrays: coordinates in which they are normal, with full covariances."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.batch import DONE, Row
from sprung.display import shown
from sprung.fleets.scale import PER_TOTAL_MASS, UNDETERMINED, fleet_names, without_scale
from sprung.vehicle import DERIVED, PARAMETERS, UNITS_PER_MASS

Real = NDArray[np.float64]

_FLOOR = 1e-4
"""Standard deviation that every coordinate is given in addition, relative: exact constraints, such as a measured
wheelbase, would make covariance matrices singular."""

_EXACT = 1e-6
"""Standard deviation below which a coordinate is exact, and difference below which two are equal, relative: rounding errors."""

_ABSENT = 10.0
"""Standard deviation of a coordinate of which a vehicle tells nothing, relative."""

_SHARED = 0.5
"""Part of the vehicles whose models must have a parameter, for it to be one of the type."""

NEEDED = ("campaign", "vehicle", "identification", "date", "verdict", "status", "coordinates", "position", "covariance")
"""Columns of the rows from which they are made."""


WHEELBASE = "wheelbase"
"""Parameter of a fleet in place of b."""


class Quantity(NamedTuple):
    """Unit and kind of a parameter of a fleet.

    Attributes
    ----------
    unit
        SI.
    positive
        Whether its coordinate is the logarithm of the value.
    """

    unit: str
    positive: bool


@shown
@dataclass(frozen=True, eq=False)
class FleetEstimates:
    """Estimates of vehicles of one type, in the order of their tests.

    Attributes
    ----------
    campaigns, labels
        Path of each campaign, and a name for people; shape (vehicle,).
    names
        Parameters; the wheelbase in place of b.
    positive
        Whether the coordinate of a parameter is the logarithm of its value, shape (parameter,); that of the others is
        the value in units of its size.
    sizes
        Size of each parameter, SI, shape (parameter,): 1 where the coordinate is a logarithm.
    positions
        Coordinates, dimensionless, shape (vehicle, parameter).
    covariances
        Of the coordinates of each vehicle, dimensionless, shape (vehicle, parameter, parameter); with a floor of 0.01 %, which
        exact values need to be inverted.
    known
        Whether the model of a vehicle has the parameter, shape (vehicle, parameter).
    exact
        Whether its value was known exactly before the test, shape (vehicle, parameter).
    has_scale
        Whether any vehicle has an absolute scale. Without one, masses, inertias and rates are divided by their vehicle's total
        mass, and have names such as ``k_sf/total_mass``.
    undetermined
        Parameters that are left out because no vehicle's test determines them.
    """

    campaigns: tuple[str, ...]
    labels: tuple[str, ...]
    names: tuple[str, ...]
    positive: NDArray[np.bool_]
    sizes: Real
    positions: Real
    covariances: Real
    known: NDArray[np.bool_]
    exact: NDArray[np.bool_]
    has_scale: bool = True
    undetermined: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        """Number of vehicles."""
        return len(self.campaigns)

    @property
    def own_stds(self) -> Real:
        """Standard uncertainties of the coordinates, 0 where known exactly; dimensionless, shape (vehicle, parameter)."""
        return np.where(self.exact, 0.0, np.sqrt(np.diagonal(self.covariances, axis1=1, axis2=2)))

    @property
    def constant(self) -> NDArray[np.bool_]:
        """Whether every vehicle has one and the same value of a parameter, known exactly; shape (parameter,)."""
        return np.asarray(self.exact.all(axis=0) & (np.ptp(self.positions, axis=0) < _EXACT))

    def only(self, chosen: NDArray[np.bool_]) -> FleetEstimates:
        """Return some of the vehicles.

        Parameters
        ----------
        chosen
            Which ones, shape (vehicle,).
        """
        return replace(
            self,
            campaigns=tuple(np.array(self.campaigns, dtype=object)[chosen]),
            labels=tuple(np.array(self.labels, dtype=object)[chosen]),
            positions=self.positions[chosen],
            covariances=self.covariances[chosen],
            known=self.known[chosen],
            exact=self.exact[chosen],
        )

    def determined(self) -> FleetEstimates:
        """Return the estimates without the parameters that no vehicle's test determines."""
        kept = (self.known & (self.own_stds < UNDETERMINED)).any(axis=0)
        names = np.array(self.names, dtype=object)
        return replace(
            self,
            names=tuple(names[kept]),
            positive=self.positive[kept],
            sizes=self.sizes[kept],
            positions=self.positions[:, kept],
            covariances=self.covariances[:, kept][:, :, kept],
            known=self.known[:, kept],
            exact=self.exact[:, kept],
            undetermined=(*self.undetermined, *names[~kept]),
        )

    def values(self, positions: Real) -> Real:
        """Return the values of coordinates, SI.

        Parameters
        ----------
        positions
            Dimensionless, shape (..., parameter).
        """
        with np.errstate(over="ignore"):
            return np.where(self.positive, np.exp(np.minimum(positions, 700.0)), positions * self.sizes)

    def stds(self, positions: Real, stds: Real) -> Real:
        """Return standard uncertainties of values, SI, from those of coordinates.

        Parameters
        ----------
        positions, stds
            Coordinates and their standard deviations, dimensionless, shape (..., parameter).
        """
        return stds * np.where(self.positive, self.values(positions), self.sizes)


def collect_estimates(rows: Iterable[Row]) -> FleetEstimates | None:
    """Return the estimates of vehicles of one type.

    Parameters
    ----------
    rows
        With the columns of `NEEDED`, in the order of the tests. Those without estimates are left out.

    Returns
    -------
    FleetEstimates or None
        None where there is none.
    """
    usable = [row for row in rows if row["status"] == DONE and row["coordinates"]]
    if not usable:
        return None
    ratios = without_scale(usable)
    usable = usable if ratios is None else ratios
    occurrences: dict[str, int] = {}
    for row in usable:
        for name in row["coordinates"]:
            occurrences[name] = occurrences.get(name, 0) + 1
    names = tuple(name for name in fleet_names() if occurrences.get(name, 0) > _SHARED * len(usable))
    if not names:
        return None
    place = {name: i for i, name in enumerate(names)}
    count, width = len(usable), len(names)
    positions = np.full((count, width), np.nan)
    covariances = np.broadcast_to(_ABSENT**2 * np.eye(width), (count, width, width)).copy()
    for i, row in enumerate(usable):
        own = [(j, place[name]) for j, name in enumerate(row["coordinates"]) if name in place]
        here, there = np.array([j for j, _ in own]), np.array([k for _, k in own])
        size = len(row["coordinates"])
        positions[i, there] = np.array(row["position"])[here]
        matrix = np.array(row["covariance"]).reshape(size, size)
        covariances[i][np.ix_(there, there)] = matrix[np.ix_(here, here)]
    known = np.isfinite(positions)
    positive = np.array([quantity_of(name).positive for name in names])
    middle = np.nanmedian(np.where(known, positions, np.nan), axis=0)
    spread = np.nanmedian(np.abs(np.where(known, positions, np.nan)), axis=0)
    # A coordinate that is no logarithm is measured in units of its size; a logarithm is dimensionless already.
    sizes = np.where(positive, 1.0, np.where(spread > 0, spread, 1.0))
    positions = np.where(known, positions, middle) / sizes
    inside = known[:, :, None] & known[:, None, :]
    covariances = np.where(inside, covariances / np.outer(sizes, sizes), covariances)
    if "a" in place and "b" in place:
        names = tuple(WHEELBASE if name == "b" else name for name in names)
        positions, covariances = _with_wheelbase(positions, covariances, place["a"], place["b"])
    exact = known & (np.diagonal(covariances, axis1=1, axis2=2) < _EXACT**2)
    covariances = (covariances + covariances.transpose(0, 2, 1)) / 2 + _FLOOR**2 * np.eye(width)
    estimates = FleetEstimates(
        campaigns=tuple(row["campaign"] for row in usable),
        labels=label_vehicles(usable),
        names=names,
        positive=positive,
        sizes=sizes,
        positions=positions,
        covariances=covariances,
        known=known,
        exact=exact,
        has_scale=ratios is None,
    ).determined()
    return estimates if estimates.names else None


def _with_wheelbase(positions: Real, covariances: Real, front: int, rear: int) -> tuple[Real, Real]:
    """Return coordinates with the wheelbase in place of b, its distance behind the centre of gravity.

    The wheelbase is that of the type and mostly measured, while the centre of gravity differs between vehicles: a and b do so
    together, a and the wheelbase independently of each other.
    """
    shares = np.exp(positions[:, [front, rear]])
    wheelbases = shares.sum(axis=1)
    moved = positions.copy()
    moved[:, rear] = np.log(wheelbases)
    jacobians = np.broadcast_to(np.eye(positions.shape[1]), covariances.shape).copy()
    jacobians[:, rear, front], jacobians[:, rear, rear] = (shares / wheelbases[:, None]).T
    return moved, jacobians @ covariances @ jacobians.transpose(0, 2, 1)


def quantity_of(name: str) -> Quantity:
    """Return unit and kind of a parameter of a fleet.

    Parameters
    ----------
    name
        A parameter of a vehicle, its ratio to the total mass, or the wheelbase.

    Returns
    -------
    Quantity
    """
    if name == WHEELBASE:
        return Quantity(DERIVED[name].unit, True)
    if name.endswith(PER_TOTAL_MASS):
        own = PARAMETERS[name.removesuffix(PER_TOTAL_MASS)]
        return Quantity(UNITS_PER_MASS[own.unit], own.positive)
    return Quantity(PARAMETERS[name].unit, PARAMETERS[name].positive)


def label_vehicles(rows: Sequence[Row]) -> tuple[str, ...]:
    """Return a label for each vehicle: its identification where every vehicle has its own, else the end of its path.

    Parameters
    ----------
    rows
        With the columns ``identification`` and ``campaign``.

    Returns
    -------
    tuple of str
    """
    identifications = [row["identification"] for row in rows]
    if all(identifications) and len(set(identifications)) == len(identifications):
        return tuple(identifications)
    folders = [row["campaign"].replace("\\", "/").removesuffix("/campaign.toml").split("/") for row in rows]
    shared = 0
    while len(folders) > 1 and all(len(folder) > shared + 1 for folder in folders):
        if len({folder[shared] for folder in folders}) > 1:
            break
        shared += 1
    if len(folders) == 1:
        shared = len(folders[0]) - 1
    return tuple("/".join(folder[shared:]) for folder in folders)

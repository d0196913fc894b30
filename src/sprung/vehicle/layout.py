"""Layouts: the coordinates in which a vehicle moves, and its wheel stations; the whole vehicle, or a part of it.

A part of a vehicle has the same elements in fewer coordinates. In the pitch plane there is one wheel station per axle, in the
roll plane one per side, and a quarter car has one: what belongs to a wheel station counts once for each of them. A parameter
of a vehicle with one axle loses the index of the axle.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Literal, NamedTuple

VehicleModel = Literal["full", "pitch-plane", "roll-plane", "quarter"]
"""Which part of a vehicle is tested."""

Wheel = Literal["fl", "fr", "rl", "rr", "front", "rear", "left", "right", "wheel"]
"""A wheel station: front left, front right, rear left, rear right; front, rear; left, right; the only one."""


class Station(NamedTuple):
    """A wheel station."""

    coordinate: str
    """Of its vertical displacement."""
    axle: str
    """Index of its axle in names of parameters: ``f``, ``r``, or nothing where there is one axle."""
    side: float
    """1 on the left, -1 on the right, 0 where the sides are not told apart."""
    end: float
    """1 at the front, -1 at the rear, 0 where there is one axle."""

    @property
    def suffix(self) -> str:
        """Last part of the names of further coordinates at this wheel: the paper's letter, or the station's name."""
        return self.coordinate.removeprefix("z_u")


STATIONS: Mapping[Wheel, Station] = {
    "fl": Station("z_uA", "f", 1.0, 1.0),
    "fr": Station("z_uB", "f", -1.0, 1.0),
    "rl": Station("z_uC", "r", 1.0, -1.0),
    "rr": Station("z_uD", "r", -1.0, -1.0),
    "front": Station("z_u_front", "f", 0.0, 1.0),
    "rear": Station("z_u_rear", "r", 0.0, -1.0),
    "left": Station("z_u_left", "", 1.0, 0.0),
    "right": Station("z_u_right", "", -1.0, 0.0),
    "wheel": Station("z_u", "", 0.0, 0.0),
}
"""Every wheel station."""


class Layout(NamedTuple):
    """Coordinates and wheel stations of a vehicle."""

    model: VehicleModel
    """Which part of a vehicle it is."""
    body: tuple[str, ...]
    """Coordinates of its rigid body."""
    wheels: tuple[Wheel, ...]
    """Its wheel stations."""

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Coordinates of the rigid body, then of the wheels."""
        return (*self.body, *(STATIONS[wheel].coordinate for wheel in self.wheels))

    @property
    def wheels_at(self) -> slice:
        """Positions of the wheels among the coordinates."""
        return slice(len(self.body), len(self.body) + len(self.wheels))

    @property
    def axles(self) -> tuple[str, ...]:
        """Indices of its axles, front first."""
        return tuple(dict.fromkeys(STATIONS[wheel].axle for wheel in self.wheels))

    @property
    def pairs(self) -> tuple[tuple[Wheel, Wheel], ...]:
        """Left and right wheel of each axle that has both."""
        left, right = ([wheel for wheel in self.wheels if STATIONS[wheel].side == side] for side in (1.0, -1.0))
        return tuple(zip(left, right, strict=True))

    def wheels_of(self, axle: str) -> tuple[Wheel, ...]:
        """Return the wheel stations of an axle, by its index."""
        return tuple(wheel for wheel in self.wheels if STATIONS[wheel].axle == axle)

    @property
    def pitches(self) -> bool:
        """Whether front and rear are told apart."""
        return "theta" in self.body

    @property
    def rolls(self) -> bool:
        """Whether left and right are told apart."""
        return "phi" in self.body


LAYOUTS: Mapping[VehicleModel, Layout] = {
    layout.model: layout
    for layout in (
        Layout("full", ("z_s", "theta", "phi"), ("fl", "fr", "rl", "rr")),
        Layout("pitch-plane", ("z_s", "theta"), ("front", "rear")),
        Layout("roll-plane", ("z_s", "phi"), ("left", "right")),
        Layout("quarter", ("z_s",), ("wheel",)),
    )
}
"""Every layout by the name of the part of the vehicle."""

PART_NAMES: Mapping[VehicleModel, str] = {
    "full": "whole vehicle",
    "pitch-plane": "pitch plane",
    "roll-plane": "roll plane",
    "quarter": "quarter car",
}
"""Parts of a vehicle as texts name them."""

FULL = LAYOUTS["full"]
"""The paper's."""

WHEELS = FULL.wheels
"""Wheel stations of a whole vehicle in the order of the coordinates: A, B, C, D of the paper."""

COORDINATES = FULL.coordinates
"""The paper's coordinates, displacements in m and angles in rad."""


def wheelbase_of(names: Sequence[str], values: Iterable[float]) -> float:
    """Return the wheelbase of a vehicle, m; 0 where front and rear are not told apart.

    Parameters
    ----------
    names, values
        Its parameters; values in SI, shape (parameter,).

    Returns
    -------
    float
    """
    return float(sum(value for name, value in zip(names, values, strict=True) if name in ("a", "b")))


def layout_of(names: Collection[str]) -> Layout:
    """Return the layout of a vehicle with parameters of these names: its masses and inertias tell it; `FULL` without any.

    Parameters
    ----------
    names
        Of the parameters.

    Returns
    -------
    Layout
    """
    if "m_u" in names:
        return LAYOUTS["roll-plane" if "I_xx" in names else "quarter"]
    return LAYOUTS["pitch-plane"] if "m_uf" in names and "I_xx" not in names else FULL


def parameter_name(symbol: str, axle: str, number: str = "") -> str:
    """Return the name of a parameter of an axle.

    Parameters
    ----------
    symbol
        ``k_s`` or ``t``.
    axle
        Index of the axle, or nothing where there is one axle.
    number
        Index behind that of the axle.

    Returns
    -------
    str

    Examples
    --------
    >>> parameter_name("k_s", "f"), parameter_name("t", "r", "2"), parameter_name("F", ""), parameter_name("t", "", "2")
    ('k_sf', 't_r2', 'F', 't_2')
    """
    separated = symbol if "_" in symbol or not axle + number else f"{symbol}_"
    return f"{separated}{axle}{number}"


def rates_of_tyre(station: Wheel, names: Collection[str]) -> dict[int, dict[str, float]]:
    """Return the parameters that make up the rate of a tyre, and its damping.

    Parameters
    ----------
    station
        The wheel station.
    names
        Parameters of the vehicle.

    Returns
    -------
    dict of int to dict
        By the order of the derivative of the deflection, 0 or 1: the factors of the parameters, by name.
    """
    _, axle, side, _ = STATIONS[station]
    parts = {0: {f"k_t{axle}": 1.0, f"d_kt{axle}": side}, 1: {f"c_t{axle}": 1.0}}
    rates = {order: {name: factor for name, factor in own.items() if name in names} for order, own in parts.items()}
    return {order: own for order, own in rates.items() if own}


LinearLaw = Literal["mass", "damper", "spring"]
"""Law of a linear element: the matrix M, C or K that it adds to."""

Tracks = Literal["shared", "separate"]
"""Whether springs and dampers of an axle share their half-distance."""

AXLES = ("f", "r", "")
"""Index of every axle that a vehicle may have: front, rear, the only one."""


def half_distances(tracks: Tracks) -> dict[tuple[str, LinearLaw], str]:
    """Return the names of the half-distances of springs and dampers.

    Parameters
    ----------
    tracks
        ``shared``: one half-distance per axle, t_f and t_r; ``separate``: springs at t_f2 and t_r2, dampers at t_f1 and
        t_r1, as the paper names them.

    Returns
    -------
    dict
        Name by (index of the axle, law).
    """
    return _by_place("t", tracks)


def inboard_shares(tracks: Tracks) -> dict[tuple[str, LinearLaw], str]:
    """Return the names of the places of springs and dampers on a rigid axle, as parts of its wheels' half-distance.

    Parameters
    ----------
    tracks
        As for `half_distances`.

    Returns
    -------
    dict
        Name by (index of the axle, law).
    """
    return _by_place("n", tracks)


def _by_place(symbol: str, tracks: Tracks) -> dict[tuple[str, LinearLaw], str]:
    number: dict[LinearLaw, str] = {"spring": "2", "damper": "1"}
    separate = tracks == "separate"
    return {
        (axle, law): parameter_name(symbol, axle, number[law] if separate else "") for axle in AXLES for law in number
    }

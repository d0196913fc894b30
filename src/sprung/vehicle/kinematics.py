"""Rows: the displacement of an element, a load or a sensor, as a linear function of the vehicle's coordinates.

Coordinates are the paper's, X = [z_s, θ, φ, z_uA, z_uB, z_uC, z_uD]: sprung-mass bounce, pitch (positive nose down),
roll (positive left side up), then the wheels A front left, B front right, C rear left, D rear right; z_e of an engine on
its mounts is one more, which only a vehicle with such an engine has. A row g has the displacement g·X. Every row is
affine in the geometric parameters (a, b and the half-distances), so a row is its constant part and one slope per
parameter; derivatives with respect to geometry need nothing else.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown

Wheel = Literal["fl", "fr", "rl", "rr"]
"""A wheel station: front left, front right, rear left, rear right."""

WHEELS: tuple[Wheel, ...] = ("fl", "fr", "rl", "rr")
"""Wheel stations in the order of the coordinates: A, B, C, D of the paper."""

AXLES: tuple[tuple[Wheel, Wheel], ...] = (("fl", "fr"), ("rl", "rr"))
"""Left and right wheel of each axle, front first."""

COORDINATES = ("z_s", "theta", "phi", "z_uA", "z_uB", "z_uC", "z_uD", "z_e")
"""Coordinates, displacements in m and angles in rad; the last only of a vehicle whose engine moves on its mounts."""

WHEELS_AT = slice(3, 7)
"""Positions of the wheels among the coordinates."""

HEAVE = np.array([1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0])
"""A unit of heave: everything moving up alike, in the coordinates."""

UNCONSTRAINED = ("x", "y", "psi")
"""Displacement of the body's centre of gravity forward and to the left, m, and yaw angle, rad, positive to the left: no force
of the suspension acts on them, so that they follow from the others; see `LinearModel`. In a row they are the last."""

_Z, _THETA, _PHI, *_WHEELS, _ENGINE, _X, _Y, _PSI = np.eye(len(COORDINATES) + len(UNCONSTRAINED))


@shown
@dataclass(frozen=True, eq=False)
class Row:
    """A displacement g·X with g affine in geometric parameters.

    Attributes
    ----------
    constant
        Shape (coordinate,): the part of g that depends on no parameter.
    slopes
        For each geometric parameter the change of g per metre, shape (coordinate,).
    """

    constant: NDArray[np.float64]
    slopes: Mapping[str, NDArray[np.float64]] = field(default_factory=lambda: MappingProxyType({}))

    def __sub__(self, other: Row) -> Row:
        """Return the row of the difference of two displacements."""
        names = self.slopes.keys() | other.slopes.keys()
        zero = np.zeros_like(self.constant)
        return Row(
            self.constant - other.constant,
            {name: self.slopes.get(name, zero) - other.slopes.get(name, zero) for name in names},
        )

    def referred_to_front_axle(self, wheelbase: float) -> Row:
        """Return the row over coordinates with the body's vertical motion above the front axle, not at its centre of gravity.

        The rows of springs, dampers and sensors then do not depend on the centre of gravity, which moves the mass alone.

        Parameters
        ----------
        wheelbase
            a + b, m.
        """
        # z_s is z above the front axle plus a θ, and b is the wheelbase less a.
        zero = np.zeros_like(self.constant)
        by_b = self.slopes.get("b", zero)
        by_a = self.slopes.get("a", zero) + self.constant[0] * _THETA - by_b
        rest = {name: slope for name, slope in self.slopes.items() if name not in ("a", "b")}
        return Row(self.constant + wheelbase * by_b, rest | ({"a": by_a} if by_a.any() else {}))


def coordinates(names: Collection[str]) -> tuple[str, ...]:
    """Return the names of the coordinates of a vehicle.

    Parameters
    ----------
    names
        Its parameters.

    Returns
    -------
    tuple of str
        The paper's seven, and the engine's where it has one that moves on its mounts.
    """
    return COORDINATES if "m_e" in names else COORDINATES[:-1]


def body_point(x: float, y: float) -> Row:
    """Vertical displacement of a point of the body.

    Parameters
    ----------
    x, y
        Position, m: forward of the front axle, left of the centreline. The centre of gravity is at x = -a.
    """
    return Row(_Z - x * _THETA + y * _PHI, {"a": -_THETA})


def pitch() -> Row:
    """Pitch angle of the body, rad."""
    return Row(_THETA)


def roll() -> Row:
    """Roll angle of the body, rad."""
    return Row(_PHI)


def forward(y: float = 0.0, height: float = 0.0) -> Row:
    """Forward displacement of a point of the body.

    Parameters
    ----------
    y, height
        Position, m: left of the centreline, above the centre of gravity.
    """
    return Row(_X - y * _PSI + height * _THETA)


def sideways(x: float, height: float) -> Row:
    """Displacement of a point of the body to the left.

    Parameters
    ----------
    x, height
        Position, m: forward of the front axle, above the centre of gravity.
    """
    return Row(_Y + x * _PSI - height * _PHI, {"a": _PSI})


def sideways_at(axle: str, height: float) -> Row:
    """Displacement to the left of a point of the body over an axle, or over the centre of gravity.

    Parameters
    ----------
    axle
        ``f``, ``r``, or nothing for the centre of gravity.
    height
        Above the centre of gravity, m.
    """
    along = {"f": {"a": _PSI}, "r": {"b": -_PSI}}
    return Row(_Y - height * _PHI, along.get(axle, {}))


def yaw() -> Row:
    """Yaw angle of the body, rad."""
    return Row(_PSI)


def bounce(off_centre: bool = False) -> Row:
    """Vertical displacement of the sprung mass's centre of gravity.

    Parameters
    ----------
    off_centre
        Whether it may be y_s left of the centreline; z_s is then the displacement beside it, on the centreline.
    """
    return Row(_Z, {"y_s": _PHI} if off_centre else {})


def side(station: Wheel) -> float:
    """1 for a wheel on the left, -1 for one on the right."""
    return 1.0 if station[1] == "l" else -1.0


def wheel(station: Wheel) -> Row:
    """Vertical displacement of one wheel."""
    return Row(_WHEELS[WHEELS.index(station)])


def corner(station: Wheel, half_distance: str) -> Row:
    """Vertical displacement of the body above one wheel, at a half-distance from the centreline which is a parameter.

    Parameters
    ----------
    station
        The wheel station.
    half_distance
        Name of the parameter: ``t_f2`` for the front springs.
    """
    along = {"a": -_THETA} if station[0] == "f" else {"b": _THETA}
    return Row(_Z, {**along, half_distance: side(station) * _PHI})


def engine() -> Row:
    """Vertical displacement of an engine on its mounts."""
    return Row(_ENGINE)


def engine_bay() -> Row:
    """Vertical displacement of the body at its engine mounts, on the centreline, x_e forward of the front axle."""
    return Row(_Z, {"a": -_THETA, "x_e": -_THETA})


def on_axle(station: Wheel, share: str) -> Row:
    """Vertical displacement of a point on a rigid axle, between its middle and a wheel.

    Parameters
    ----------
    station
        The wheel on whose side it is.
    share
        Name of the parameter of its place: 0 in the middle, 1 at the wheel.
    """
    left, right = AXLES["fr".index(station[0])]
    middle = 0.5 * (wheel(left).constant + wheel(right).constant)
    return Row(middle, {share: wheel(station).constant - middle})


def travel(station: Wheel, half_distance: str, share: str | None = None) -> Row:
    """Suspension travel at one wheel: body minus what is below it, positive in rebound.

    Parameters
    ----------
    station, half_distance
        As for `corner`.
    share
        As for `on_axle` where the axle is rigid; None for a wheel of its own.
    """
    below = wheel(station) if share is None else on_axle(station, share)
    return corner(station, half_distance) - below

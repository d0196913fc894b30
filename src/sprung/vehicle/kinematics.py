"""Rows: the displacement of an element, a load or a sensor, as a linear function of the vehicle's coordinates.

Coordinates are the paper's, X = [z_s, θ, φ, z_uA, z_uB, z_uC, z_uD]: sprung-mass bounce, pitch (positive nose down),
roll (positive left side up), then the wheels A front left, B front right, C rear left, D rear right. A vehicle that has
more than the paper's has further ones: first those that move a mass, as z_e of an engine on its mounts, or the mean z_o and
half the difference dz_o of people on the left and on the right; then those without mass, as the travel of a damper behind
a rubber mount.
A body that is not rigid has its twist q_w, rad/m, and its bending q_v, 1/m: at x forward of the front axle and y left of
the centreline it rises by y (x + L/2) q_w - x (x + L)/2 q_v with the wheelbase L = a + b. So θ and z_s are those of the
line through both axles, and φ is the roll in the middle between them. No body twists evenly: by the shape parameters u_w and
e_w it turns between the axles, and beyond them, by a parabola and a cubic more, which vanish at both axles.

A row g has the displacement g·X. Every row is affine in the geometric parameters (a, b and the half-distances), so a row is its
constant part and one slope per parameter; derivatives with respect to geometry need nothing else.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from sprung.display import shown
from sprung.vehicle.layout import LAYOUTS, STATIONS, Wheel, layout_of

SEAT_LOADS = ("z_l1", "z_l2", "z_l3", "z_l4")
"""Coordinates of the items of a load on seats: vertical displacements in m. Every load has all, for an item or for none."""

_WITH_MASS: Mapping[str, tuple[str, ...]] = {
    "m_e": ("z_e",),
    "m_o": ("z_o", "dz_o"),
    "I_w": ("q_w",),
    "m_v": ("q_v",),
    "w_l": SEAT_LOADS,
}
"""By parameter: the coordinates with mass that a vehicle with it has beside the paper's."""

_WITHOUT_MASS: Mapping[str, str] = {"k_df": "x_d", "k_d": "x_d", "k_zf": "x_z", "k_z": "x_z"}
"""By parameter: the coordinates without mass, likewise, each without its wheel: travels of dampers on a spring."""

_OF_AXLES: Mapping[str, str] = {"k_xf": "x_if", "k_xr": "x_ir", "k_x": "x_i"}
"""By parameter: the coordinates without mass that an axle has, difference in travel of a damper between its wheels."""

_RISE_AT_SEATS = 0.9
"""What the body under seats rises as it bends, over the rise of its middle: 0.75 to 1 in the middle half of the wheelbase."""

_RISES_IN_HEAVE = frozenset({"z_s", *(station.coordinate for station in STATIONS.values()), "z_e", "z_o", *SEAT_LOADS})
"""Coordinates that are vertical displacements over the ground."""

UNCONSTRAINED = ("x", "y", "psi")
"""Displacement of the body's centre of gravity forward and to the left, m, and yaw angle, rad, positive to the left: no force
of the suspension acts on them, so that they follow from the others; see `LinearModel`."""

Shape = Mapping[str, float]
"""A linear function of the coordinates: the coefficient of each, by its name."""


@shown
@dataclass(frozen=True, eq=False)
class Row:
    """A displacement g·X with g affine in geometric parameters.

    Attributes
    ----------
    constant
        The part of g that depends on no parameter, by coordinate.
    slopes
        For each geometric parameter the change of g per metre, by coordinate.
    """

    constant: Shape
    slopes: Mapping[str, Shape] = field(default_factory=lambda: MappingProxyType({}))

    def __sub__(self, other: Row) -> Row:
        """Return the row of the difference of two displacements."""
        names = list(dict.fromkeys((*self.slopes, *other.slopes)))
        slopes = {name: _combine(self.slopes.get(name, {}), other.slopes.get(name, {}), -1.0) for name in names}
        return Row(_combine(self.constant, other.constant, -1.0), slopes)

    def times(self, name: str, factor: float) -> Row:
        """Return the row, if no parameter is in it, times a parameter and a factor: the force of a spring by its rate.

        Parameters
        ----------
        name
            Of the parameter.
        factor
            Dimensionless.
        """
        return Row({}, {name: {coordinate: factor * value for coordinate, value in self.constant.items()}})

    def referred_to_front_axle(self, wheelbase: float) -> Row:
        """Return the row over coordinates with the body's vertical motion above the front axle, not at its centre of gravity.

        The rows of springs, dampers and sensors then do not depend on the centre of gravity, which moves the mass alone.

        Parameters
        ----------
        wheelbase
            a + b, m.
        """
        # z_s is z above the front axle plus a θ, and b is the wheelbase less a.
        by_b = self.slopes.get("b", {})
        by_a = _combine(self.slopes.get("a", {}), {"theta": self.constant.get("z_s", 0.0)})
        by_a = {name: value for name, value in _combine(by_a, by_b, -1.0).items() if value}
        rest = {name: slope for name, slope in self.slopes.items() if name not in ("a", "b")}
        return Row(_combine(self.constant, by_b, wheelbase), rest | ({"a": by_a} if by_a else {}))


def _combine(one: Shape, other: Shape, factor: float = 1.0) -> dict[str, float]:
    """Return the sum of a linear function and a multiple of another one."""
    return {name: one.get(name, 0.0) + factor * other.get(name, 0.0) for name in dict.fromkeys((*one, *other))}


def coordinates(names: Collection[str]) -> tuple[str, ...]:
    """Return the names of the coordinates of a vehicle.

    Parameters
    ----------
    names
        Its parameters.

    Returns
    -------
    tuple of str
        Those of body and wheels, others that move a mass, then those without mass.
    """
    suffixes = [STATIONS[wheel].suffix for wheel in layout_of(names).wheels]
    travels = [travel for name, travel in _WITHOUT_MASS.items() if name in names]
    of_wheels = (f"{travel}{suffix}" for travel in travels for suffix in suffixes)
    of_axles = (travel for name, travel in _OF_AXLES.items() if name in names)
    return (*massive_coordinates(names), *of_wheels, *of_axles)


def massive_coordinates(names: Collection[str]) -> tuple[str, ...]:
    """Return the names of those coordinates of a vehicle that move a mass; `names` are its parameters."""
    layout = layout_of(names)
    added = (one for name, further in _WITH_MASS.items() if name in names for one in further)
    return (*layout.coordinates, *(one for one in added if layout.rolls or one != "dz_o"))


def state_variables(names: Collection[str]) -> tuple[tuple[str, int], ...]:
    """Return the layout of the state: displacements of all coordinates, then velocities of those that move a mass.

    Where no mass is, the velocity follows from the displacements, and is no state of its own.

    Parameters
    ----------
    names
        Parameters of the vehicle.

    Returns
    -------
    tuple of (str, int)
        For each state variable its coordinate, and 0 for the displacement or 1 for the velocity.
    """
    return (*((name, 0) for name in coordinates(names)), *((name, 1) for name in massive_coordinates(names)))


def heave(names: Collection[str]) -> tuple[float, ...]:
    """Return a unit of heave, everything moving up alike, in the coordinates of a vehicle.

    Parameters
    ----------
    names
        Its parameters.

    Returns
    -------
    tuple of float
        1 for a vertical displacement over the ground, else 0.
    """
    return tuple(float(name in _RISES_IN_HEAVE) for name in coordinates(names))


def unconstrained(names: Collection[str]) -> tuple[str, ...]:
    """Return those of `UNCONSTRAINED` along which the body of a vehicle may move; `names` are its parameters."""
    layout = layout_of(names)
    free = {"x": layout.pitches, "y": layout.rolls, "psi": layout.pitches and layout.rolls}
    return tuple(coordinate for coordinate in UNCONSTRAINED if free[coordinate])


def body_point(x: float, y: float, names: Collection[str] = (), wheelbase: float = 0.0) -> Row:
    """Vertical displacement of a point of the body.

    Parameters
    ----------
    x, y
        Position, m: forward of the front axle, left of the centreline. The centre of gravity is at x = -a.
    names
        Parameters of the vehicle: with u_w and e_w its body twists unevenly.
    wheelbase
        Of a body that twists unevenly, m.

    Returns
    -------
    Row
    """
    bent = {"q_w": y / 2, "q_v": -x / 2}
    constant = {"z_s": 1.0, "theta": -x, "phi": y, "q_w": x * y, "q_v": -x * x / 2}
    slopes = {"a": {"theta": -1.0, **bent}, "b": bent}
    if "u_w" not in names:
        return Row(constant, slopes)
    along = 1 + 2 * x / wheelbase
    uneven = y * wheelbase * (1 - along**2)
    return Row(constant, {**slopes, "u_w": {"q_w": uneven}, "e_w": {"q_w": -uneven * along}})


def body_slopes(x: float, y: float, wheelbase: float = 0.0) -> tuple[Row, Row]:
    """Change of the vertical displacement of a point of the body by a metre forward and by one to the left: how it leans there.

    Parameters
    ----------
    x, y
        Position, m: forward of the front axle, left of the centreline.
    wheelbase
        Of a body that twists or bends, m. Twist counts as even.

    Returns
    -------
    forward, left
    """
    along = x + wheelbase / 2
    return Row({"theta": -1.0, "q_w": y, "q_v": -along}), Row({"phi": 1.0, "q_w": along})


def pitch(wheelbase: float = 0.0) -> Row:
    """Mean pitch angle of the body, rad; of one that bends with the wheelbase, m."""
    return Row({"theta": 1.0}, {"p_v": {"q_v": sag(wheelbase)}})


def roll() -> Row:
    """Mean roll angle of the body, rad."""
    return Row({"phi": 1.0}, {"a_w": {"q_w": 1.0}})


def torsion() -> Row:
    """Torsion of the body, rad/m."""
    return Row({"q_w": 1.0})


def bending() -> Row:
    """Curvature of the bent body, 1/m: positive where its middle is up."""
    return Row({"q_v": 1.0})


def sag(wheelbase: float) -> float:
    """Return the rise of the body's middle above the line through its axles by a unit of curvature, m²; wheelbase in m."""
    return wheelbase**2 / 8


def forward(y: float = 0.0, height: float = 0.0) -> Row:
    """Forward displacement of a point of the body.

    Parameters
    ----------
    y, height
        Position, m: left of the centreline, above the centre of gravity.
    """
    return Row({"x": 1.0, "psi": -y, "theta": height})


def sideways(x: float, height: float) -> Row:
    """Displacement of a point of the body to the left.

    Parameters
    ----------
    x, height
        Position, m: forward of the front axle, above the centre of gravity.
    """
    return Row({"y": 1.0, "psi": x, "phi": -height}, {"a": {"psi": 1.0}})


def sideways_at(axle: str, height: float) -> Row:
    """Displacement to the left of a point of the body over an axle, or over the centre of gravity.

    Parameters
    ----------
    axle
        ``f``, ``r``, or nothing for the centre of gravity.
    height
        Above the centre of gravity, m.
    """
    along: Mapping[str, Mapping[str, Shape]] = {"f": {"a": {"psi": 1.0}}, "r": {"b": {"psi": -1.0}}}
    return Row({"y": 1.0, "psi": 0.0, "phi": -height}, along.get(axle, {}))


def yaw() -> Row:
    """Yaw angle of the body, rad."""
    return Row({"psi": 1.0})


def bounce(off_centre: bool = False, wheelbase: float = 0.0) -> Row:
    """Vertical displacement of the sprung mass's centre of gravity.

    Parameters
    ----------
    off_centre
        Whether it may be y_s left of the centreline; z_s is then the displacement beside it, on the centreline.
    wheelbase
        Of a body that bends, m.
    """
    own = {"y_s": {"phi": 1.0}} if off_centre else {}
    return Row({"z_s": 1.0}, {**own, "b_v": {"q_v": sag(wheelbase)}})


def wheel(station: Wheel) -> Row:
    """Vertical displacement of one wheel."""
    return Row({STATIONS[station].coordinate: 1.0})


def corner(station: Wheel, half_distance: str, wheelbase: float = 0.0) -> Row:
    """Vertical displacement of the body above one wheel, at a half-distance from the centreline which is a parameter.

    Parameters
    ----------
    station
        The wheel station.
    half_distance
        Name of the parameter: ``t_f2`` for the front springs; of no effect where the sides are not told apart.
    wheelbase
        Of a body that twists, m.
    """
    _, _, side, end = STATIONS[station]
    along = {1.0: {"a": {"theta": -1.0}}, -1.0: {"b": {"theta": 1.0}}, 0.0: {}}[end]
    across = {half_distance: {"phi": side, "q_w": side * end * 0.5 * wheelbase}} if side else {}
    return Row({"z_s": 1.0}, {**along, **across})


def engine() -> Row:
    """Vertical displacement of an engine on its mounts."""
    return Row({"z_e": 1.0})


def engine_bay() -> Row:
    """Vertical displacement of the body at its engine mounts, on the centreline, x_e forward of the front axle."""
    return Row({"z_s": 1.0}, {"a": {"theta": -1.0}, "x_e": {"theta": -1.0}})


def occupants(side: float) -> Row:
    """Vertical displacement of people on soft seats: 1 those on the left, -1 those on the right."""
    return Row({"z_o": 1.0, "dz_o": side})


def seats(side: float, wheelbase: float = 0.0) -> Row:
    """Vertical displacement of the body under the seats of the left (1) or of the right (-1).

    They are side by side, t_o from their middle, which is x_o forward of the front axle and y_o left of the centreline.

    Parameters
    ----------
    side
        1 for the left, -1 for the right.
    wheelbase
        Of a body that bends, m: seats are between the axles, where it rises by most of what its middle does.
    """
    constant = {"z_s": 1.0, "q_v": _RISE_AT_SEATS * sag(wheelbase)}
    across = {"y_o": {"phi": 1.0}, "t_o": {"phi": side}} if side else {}
    return Row(constant, {"a": {"theta": -1.0}, "x_o": {"theta": -1.0}, **across})


def on_seat(number: int) -> Row:
    """Vertical displacement of an item of a load on a seat, by its number from 0."""
    return Row({SEAT_LOADS[number]: 1.0})


def on_axle(station: Wheel, share: str) -> Row:
    """Vertical displacement of a point on a rigid axle, between its middle and a wheel.

    Parameters
    ----------
    station
        The wheel on whose side it is.
    share
        Name of the parameter of its place: 0 in the middle, 1 at the wheel.
    """
    own = STATIONS[station].coordinate
    pair = next(pair for layout in LAYOUTS.values() for pair in layout.pairs if station in pair)
    other = next(STATIONS[one].coordinate for one in pair if one != station)
    return Row({own: 0.5, other: 0.5}, {share: {own: 0.5, other: -0.5}})


def behind_mount(station: Wheel) -> Row:
    """Travel of the damper at one wheel that a rubber mount connects to the body."""
    return Row({f"x_d{STATIONS[station].suffix}": 1.0})


def behind_branch(station: Wheel) -> Row:
    """Travel of the damper in the :term:`Zener branch` at one wheel."""
    return Row({f"x_z{STATIONS[station].suffix}": 1.0})


def behind_interconnection(axle: str) -> Row:
    """Difference in travel of what flows between the two sides of an axle, by the index of the axle."""
    return Row({_OF_AXLES[f"k_x{axle}"]: 1.0})


def travel(station: Wheel, half_distance: str, share: str | None = None, wheelbase: float = 0.0) -> Row:
    """Suspension travel at one wheel: body minus what is below it, positive in rebound.

    Parameters
    ----------
    station, half_distance, wheelbase
        As for `corner`.
    share
        As for `on_axle` where the axle is rigid; None for a wheel of its own.
    """
    below = wheel(station) if share is None else on_axle(station, share)
    return corner(station, half_distance, wheelbase) - below

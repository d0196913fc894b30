"""Elements: everything that stores or dissipates energy, as a row and a law.

The equations of motion are nothing but sums over elements: an element with the coefficient κ and the row g adds κ g gᵀ
to M (a mass), C (a damper) or K (a spring). Summed over the elements of `seven_degrees_of_freedom` this is eq. (2) of
the paper, entry by entry and without its misprints.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from sprung.display import shown
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import kinematics
from sprung.vehicle.damper_curve import damper_curve
from sprung.vehicle.force_laws import (
    AIR,
    BUMP_STOP,
    FRICTION,
    GROUND,
    LOAD_FRICTION,
    PROGRESSIVE,
    REBOUND,
    TYRE_CURVE,
    ForceLaw,
)
from sprung.vehicle.heights import LEVEL, Heights
from sprung.vehicle.kinematics import Row, Wheel

LinearLaw = Literal["mass", "damper", "spring"]
"""Law of a linear element: the matrix M, C or K that it adds to."""

Tracks = Literal["shared", "separate"]
"""Whether springs and dampers of an axle share their half-distance."""

Origin = Literal["empty", "loaded", "weightless"]
"""Position from which the travel of an element counts: where the empty or the loaded vehicle rests, or where the empty vehicle
would be without gravity."""

LINEAR_EXTRAS = (
    "anti-roll", "tyre-damping", "gravity", "asymmetry", "rigid-axle", "engine", "damper-mount",
    "mount-damping", "zener",
    "twist", "bending", "occupants", "seat-load",
)  # fmt: skip
"""Extras, by the name used in a campaign's ``[model]``, of the linear model."""

EXTRAS = (
    *LINEAR_EXTRAS, "friction", "load-friction", "rebound", "damper-curve", "rounded-knee", "second-knee", "third-knee",
    "progressive", "air", "levelled-air", "bump-stop", "tyre-curve",
)  # fmt: skip
"""All extras; those beyond the linear ones are nonlinear elements."""

REFINED: Mapping[str, str] = MappingProxyType(
    {
        "rounded-knee": "damper-curve",
        "second-knee": "damper-curve",
        "third-knee": "second-knee",
        "load-friction": "friction",
        "mount-damping": "damper-mount",
    }
)
"""Extras that are nothing without another one, and that other one."""


@shown
@dataclass(frozen=True, slots=True)
class Element:
    """A linear element: a mass, a damper or a spring.

    Attributes
    ----------
    law
        Which matrix it adds to.
    coefficient
        Name of the parameter that multiplies it, or a known number in SI.
    row
        Its displacement.
    factor
        Factor of the coefficient, dimensionless.
    """

    law: LinearLaw
    coefficient: str | float
    row: Row
    factor: float = 1.0


@shown
@dataclass(frozen=True, slots=True)
class NonlinearElement:
    """An element with a nonlinear force law.

    Attributes
    ----------
    law
        Its force law.
    parameters
        Names of the law's parameters, in its order.
    row
        Its travel, on which its force acts.
    origin
        From which position the travel counts.
    weight
        N of the load that the wheel carries, by which the law's force is multiplied; None where it is not.
    """

    law: ForceLaw
    parameters: tuple[str, ...]
    row: Row
    origin: Origin = "empty"
    weight: float | None = None


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
        Name by (axle, law), axle being ``f`` or ``r``.
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
        Name by (axle, law).
    """
    return _by_place("n", tracks)


def _by_place(letter: str, tracks: Tracks) -> dict[tuple[str, LinearLaw], str]:
    suffix = {"spring": "2", "damper": "1"} if tracks == "separate" else {"spring": "", "damper": ""}
    return {(axle, law): f"{letter}_{axle}{suffix[law]}" for axle in "fr" for law in ("spring", "damper")}


def seven_degrees_of_freedom(
    tracks: Tracks = "shared", extras: Collection[str] = (), heights: Heights = LEVEL, wheelbase: float = 0.0
) -> tuple[Element, ...]:
    """Return the linear elements of the paper's seven-degree-of-freedom vehicle.

    Parameters
    ----------
    tracks
        Whether springs and dampers of an axle share their half-distance.
    extras
        Any of `EXTRAS`; only those of `LINEAR_EXTRAS` add elements.
    heights
        Heights, as far as they are known; they add to the inertia and stiffness of roll and pitch.
    wheelbase
        m; for a body that twists or bends.

    Returns
    -------
    tuple of Element
    """
    return (
        *_basic_elements(tracks, extras, wheelbase),
        *_elements_of_the_body(extras, wheelbase),
        *_elements_of_heights(heights, "gravity" in extras),
    )


def nonlinear_elements(
    tracks: Tracks = "shared",
    extras: Collection[str] = (),
    wheelbase: float = 0.0,
    load: tuple[float, float] = (0.0, 0.0),
) -> tuple[NonlinearElement, ...]:
    """Return the nonlinear elements of a vehicle.

    Parameters
    ----------
    tracks
        Whether springs and dampers of an axle share their half-distance; friction acts at the springs.
    extras
        Any of `EXTRAS`; those of `LINEAR_EXTRAS` add none.
    wheelbase
        m; for a body that twists.
    load
        What each front and each rear wheel carries of it, kg.

    Returns
    -------
    tuple of Force
    """
    travel = _travels(tracks, extras, wheelbase)
    elements: list[NonlinearElement] = []
    for station in kinematics.WHEELS:
        axle, spring = station[0], travel(station, "spring")
        elements += _friction_forces(axle, spring, extras, STANDARD_GRAVITY * load["fr".index(axle)])
        elements += _damper_forces(axle, _damper_travel(station, tracks, extras, wheelbase), extras)
        elements += _spring_forces(axle, spring, extras)
        if "tyre-curve" in extras:
            tyre = kinematics.wheel(station)
            elements.append(NonlinearElement(TYRE_CURVE, (f"h_t{axle}", f"k_t{axle}"), tyre, origin="weightless"))
    return tuple(elements)


def _friction_forces(axle: str, travel: Row, extras: Collection[str], weight: float) -> Iterator[NonlinearElement]:
    """Yield the dry friction of a wheel station, which carries a weight of the load, N."""
    if "friction" in extras:
        yield NonlinearElement(FRICTION, (f"F_{axle}", f"s_{axle}"), travel)
        if "load-friction" in extras:
            yield NonlinearElement(LOAD_FRICTION, (f"u_{axle}", f"F_{axle}", f"s_{axle}"), travel, weight=weight)


def _damper_forces(axle: str, travel: Row, extras: Collection[str]) -> Iterator[NonlinearElement]:
    """Yield what a damper adds to the force of one of constant rate."""
    if "rebound" in extras:
        yield NonlinearElement(REBOUND, (f"r_{axle}", f"c_s{axle}"), travel)
    if "damper-curve" in extras:
        rebound, rounded = "rebound" in extras, "rounded-knee" in extras
        before = (f"c_s{axle}", *(f"r_{axle}",) * rebound, *(f"w_k{axle}",) * rounded)
        knots = [f"v_k{axle}", f"q_{axle}"]
        for number in _further_knots(extras):
            knots += [f"v_{number}{axle}", f"q_{number}{axle}"]
        yield NonlinearElement(damper_curve(has_ratio=rebound, is_rounded=rounded), (*before, *knots), travel)


def _spring_forces(axle: str, travel: Row, extras: Collection[str]) -> Iterator[NonlinearElement]:
    """Yield what a spring and its stop add to the force of one of constant rate."""
    if "progressive" in extras:
        yield NonlinearElement(PROGRESSIVE, (f"p_{axle}", f"k_s{axle}"), travel)
    if "air" in extras:
        yield NonlinearElement(AIR, (f"e_{axle}", f"k_s{axle}"), travel)
    if "levelled-air" in extras:
        yield NonlinearElement(AIR, (f"e_l{axle}", f"k_s{axle}"), travel, origin="loaded")
    if "bump-stop" in extras:
        yield NonlinearElement(BUMP_STOP, (f"k_b{axle}", f"x_b{axle}"), travel)


def _further_knots(extras: Collection[str]) -> Iterator[int]:
    """Yield the numbers of the knots that a damper curve has after the first; none without those before it."""
    for number, name in ((2, "second-knee"), (3, "third-knee")):
        if name not in extras:
            return
        yield number


def ground_contact_elements(extras: Collection[str] = ()) -> tuple[NonlinearElement, ...]:
    """Return the elements of unilateral tyre contact: they cancel the tension of the linear tyres.

    Parameters
    ----------
    extras
        Any of `EXTRAS`; with ``tyre-damping`` the tension includes that of the tyre dampers.

    Returns
    -------
    tuple of Force
    """
    damping = "tyre-damping" in extras
    return tuple(
        NonlinearElement(
            GROUND,
            (f"k_t{station[0]}", f"c_t{station[0]}")[: 1 + damping],
            kinematics.wheel(station),
            origin="weightless",
        )
        for station in kinematics.WHEELS
    )


def stiffened_air_springs(
    load: tuple[float, float], tracks: Tracks = "shared", extras: Collection[str] = (), wheelbase: float = 0.0
) -> tuple[Element, ...]:
    """Return what a load adds to the rates of air springs that a valve levels: their pressure carries it.

    Parameters
    ----------
    load
        What each front and each rear wheel carries of it, kg.
    tracks, extras, wheelbase
        As for `nonlinear_elements`.

    Returns
    -------
    tuple of Element
    """
    if "levelled-air" not in extras:
        return ()
    travel = _travels(tracks, extras, wheelbase)
    return tuple(
        Element("spring", f"g_{station[0]}", travel(station, "spring"), load["fr".index(station[0])])
        for station in kinematics.WHEELS
    )


def _travels(tracks: Tracks, extras: Collection[str], wheelbase: float) -> Callable[[Wheel, LinearLaw], Row]:
    """Return the function that gives the travel of the spring or damper at a wheel station."""
    distances = half_distances(tracks)
    shares = inboard_shares(tracks) if "rigid-axle" in extras else {}
    return lambda station, law: kinematics.travel(
        station, distances[station[0], law], shares.get((station[0], law)), wheelbase
    )


def _damper_travel(station: Wheel, tracks: Tracks, extras: Collection[str], wheelbase: float) -> Row:
    """Return the travel of the damper itself at a wheel station: behind a mount it is a coordinate of its own."""
    if "damper-mount" in extras:
        return kinematics.behind_mount(station)
    return _travels(tracks, extras, wheelbase)(station, "damper")


def _basic_elements(tracks: Tracks, extras: Collection[str], wheelbase: float) -> Iterator[Element]:
    asymmetric, travel = "asymmetry" in extras, _travels(tracks, extras, wheelbase)
    yield Element("mass", "m_s", kinematics.bounce(asymmetric, wheelbase))
    yield Element("mass", "I_yy", kinematics.pitch(wheelbase))
    yield Element("mass", "I_xx", kinematics.roll())
    for station in kinematics.WHEELS:
        axle, side = station[0], kinematics.side(station)
        rates: list[tuple[LinearLaw, str, Row]] = [
            ("spring", f"k_s{axle}", travel(station, "spring")),
            ("damper", f"c_s{axle}", _damper_travel(station, tracks, extras, wheelbase)),
            ("spring", f"k_t{axle}", kinematics.wheel(station)),
        ]
        yield Element("mass", f"m_u{axle}", kinematics.wheel(station))
        for law, rate, row in rates:
            yield Element(law, rate, row)
            if asymmetric:
                yield Element(law, f"d_{rate.replace('_', '')}", row, side)
        if "tyre-damping" in extras:
            yield Element("damper", f"c_t{axle}", kinematics.wheel(station))
        if "damper-mount" in extras:
            mount = travel(station, "damper") - kinematics.behind_mount(station)
            yield Element("spring", f"k_d{axle}", mount)
            if "mount-damping" in extras:
                yield Element("damper", f"c_d{axle}", mount)
        if "zener" in extras:
            branch = kinematics.behind_branch(station)
            yield Element("spring", f"k_z{axle}", travel(station, "spring") - branch)
            yield Element("damper", f"c_z{axle}", branch)
    if "gravity" in extras:
        yield Element("spring", "w_h", kinematics.roll(), -1.0)
        yield Element("spring", "w_h", kinematics.pitch(), -1.0)
    yield from _axle_elements(tracks, extras, wheelbase)


def _elements_of_the_body(extras: Collection[str], wheelbase: float) -> Iterator[Element]:
    """Yield the elements of a body that is not one rigid mass."""
    if "engine" in extras:
        yield from _attached_mass("e", kinematics.engine_bay(), kinematics.engine())
    if "occupants" in extras:
        for side in (1.0, -1.0):
            yield from _attached_mass("o", kinematics.seats(side, wheelbase), kinematics.occupants(side), 0.5)
    # Modal masses and rates are those for the angle between the axles and for the rise of the middle.
    for term, mass, index, row, size in (
        ("twist", "I_w", "w", kinematics.torsion(), wheelbase**2),
        ("bending", "m_v", "v", kinematics.bending(), kinematics.sag(wheelbase) ** 2),
    ):
        if term in extras:
            yield Element("mass", mass, row, size)
            yield Element("spring", f"k_{index}", row, size)
            yield Element("damper", f"c_{index}", row, size)


def _attached_mass(index: str, below: Row, own: Row, part: float = 1.0) -> Iterator[Element]:
    """Yield the elements of a mass on a spring and a damper of its own, or of a part of them.

    The sprung mass and its inertias include it: it is taken off the body, where it is attached, and moves by itself.
    """
    yield Element("mass", f"m_{index}", below, -part)
    yield Element("mass", f"m_{index}", own, part)
    yield Element("spring", f"k_{index}", below - own, part)
    yield Element("damper", f"c_{index}", below - own, part)


def _axle_elements(tracks: Tracks, extras: Collection[str], wheelbase: float) -> Iterator[Element]:
    """Yield the elements between the two wheels of an axle."""
    travel = _travels(tracks, extras, wheelbase)
    for left, right in kinematics.AXLES:
        axle = left[0]
        if "anti-roll" in extras:
            yield Element("spring", f"k_a{axle}", travel(left, "spring") - travel(right, "spring"))
        if "rigid-axle" in extras:
            yield Element("mass", f"m_x{axle}", kinematics.wheel(left) - kinematics.wheel(right), 0.5)


def _elements_of_heights(heights: Heights, is_weighed: bool) -> Iterator[Element]:
    """Yield what heights add to a vehicle; `is_weighed` says that the moment of its body's weight is a parameter, w_h."""
    if not heights.has_effect:
        return
    rows, stiffness = (kinematics.roll(), kinematics.pitch()), heights.gravity_stiffness()
    for row in rows:
        yield Element("spring", "m_s", row, heights.sinking_stiffness if is_weighed else -stiffness)
    if heights.is_free:
        yield from _elements_of_lateral_motion(heights)
        return
    yield Element("mass", "m_s", kinematics.roll(), heights.cg_arm**2)
    for row, arm in zip(rows, heights.wheel_arms, strict=True):
        for axle in "fr":
            yield Element("mass", f"m_u{axle}", row, 2.0 * arm**2)


def _elements_of_lateral_motion(heights: Heights) -> Iterator[Element]:
    """Yield the masses of a vehicle that nothing holds sideways, by their horizontal displacements."""
    _, arm = heights.wheel_arms
    yield Element("mass", "m_s", kinematics.forward())
    yield Element("mass", "m_s", kinematics.sideways_at("", 0.0))
    # The yaw inertia of a car is about that of pitch, and little follows from it: only unequal arms of the axles turn it.
    yield Element("mass", "I_yy", kinematics.yaw())
    for axle in "fr":
        yield Element("mass", f"m_u{axle}", kinematics.forward(height=arm), 2.0)
        yield Element("mass", f"m_u{axle}", kinematics.sideways_at(axle, arm), 2.0)

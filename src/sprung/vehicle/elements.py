"""Elements: everything that stores or dissipates energy, as a row and a law.

The equations of motion are nothing but sums over elements: an element with the coefficient κ and the row g adds κ g gᵀ
to M (a mass), C (a damper) or K (a spring). Summed over the elements of `linear_elements` this is eq. (2) of
the paper, entry by entry and without its misprints.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from sprung.display import shown
from sprung.vehicle import kinematics
from sprung.vehicle.heights import LEVEL, Heights
from sprung.vehicle.kinematics import Row
from sprung.vehicle.layout import (
    FULL,
    STATIONS,
    Layout,
    LinearLaw,
    Tracks,
    Wheel,
    half_distances,
    inboard_shares,
    parameter_name,
)

LINEAR_EXTRAS = (
    "anti-roll", "tyre-damping", "gravity", "asymmetry", "rigid-axle", "engine", "damper-mount",
    "mount-damping", "zener", "interconnection",
    "twist", "bending", "occupants", "uneven-occupants", "seat-load",
)  # fmt: skip
"""Extras, by the name used in a campaign's ``[model]``, of the linear model."""

EXTRAS = (
    *LINEAR_EXTRAS, "friction", "load-friction", "uneven-friction", "rebound", "damper-curve", "rebound-knee",
    "rounded-knee", "second-knee", "third-knee", "progressive", "air", "levelled-air", "bump-stop", "tyre-curve",
)  # fmt: skip
"""All extras; those beyond the linear ones are nonlinear elements."""

REFINED: Mapping[str, str] = MappingProxyType(
    {
        "rebound-knee": "damper-curve",
        "rounded-knee": "damper-curve",
        "second-knee": "damper-curve",
        "third-knee": "second-knee",
        "load-friction": "friction",
        "uneven-friction": "friction",
        "mount-damping": "damper-mount",
        "uneven-occupants": "occupants",
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


def linear_elements(
    tracks: Tracks = "shared",
    extras: Collection[str] = (),
    heights: Heights = LEVEL,
    wheelbase: float = 0.0,
    layout: Layout = FULL,
) -> tuple[Element, ...]:
    """Return the linear elements of a vehicle: of the paper's seven degrees of freedom, and of what it has besides.

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
    layout
        Which part of a vehicle it is.

    Returns
    -------
    tuple of Element
    """
    return (
        *_basic_elements(tracks, extras, wheelbase, layout),
        *_elements_of_the_body(extras, wheelbase, layout),
        *_elements_of_heights(heights, "gravity" in extras, layout),
    )


def stiffened_air_springs(
    load: Mapping[str, float],
    tracks: Tracks = "shared",
    extras: Collection[str] = (),
    wheelbase: float = 0.0,
    layout: Layout = FULL,
) -> tuple[Element, ...]:
    """Return what a load adds to the rates of air springs that a valve levels: their pressure carries it.

    Parameters
    ----------
    load
        What each wheel of an axle carries of it, kg, by the index of the axle.
    tracks, extras, wheelbase, layout
        As for `nonlinear_elements`.

    Returns
    -------
    tuple of Element
    """
    if "levelled-air" not in extras:
        return ()
    travel = travels(tracks, extras, wheelbase)
    axles = [STATIONS[station].axle for station in layout.wheels]
    return tuple(
        Element("spring", parameter_name("g", axle), travel(station, "spring"), load[axle])
        for station, axle in zip(layout.wheels, axles, strict=True)
    )


def travels(tracks: Tracks, extras: Collection[str], wheelbase: float) -> Callable[[Wheel, LinearLaw], Row]:
    """Return the function that gives the travel of the spring or damper at a wheel station.

    Parameters
    ----------
    tracks
        Whether springs and dampers of an axle share their half-distance.
    extras
        Any of `EXTRAS`.
    wheelbase
        m; for a body that twists or bends.

    Returns
    -------
    callable
        Of the wheel station and the law, ``spring`` or ``damper``, to the row of the travel, positive in rebound.
    """
    distances = half_distances(tracks)
    shares = inboard_shares(tracks) if "rigid-axle" in extras else {}

    def travel(station: Wheel, law: LinearLaw) -> Row:
        place = (STATIONS[station].axle, law)
        return kinematics.travel(station, distances[place], shares.get(place), wheelbase)

    return travel


def damper_travel(station: Wheel, tracks: Tracks, extras: Collection[str], wheelbase: float) -> Row:
    """Return the travel of the damper itself at a wheel station: behind a mount it is a coordinate of its own."""
    if "damper-mount" in extras:
        return kinematics.behind_mount(station)
    return travels(tracks, extras, wheelbase)(station, "damper")


def _basic_elements(tracks: Tracks, extras: Collection[str], wheelbase: float, layout: Layout) -> Iterator[Element]:
    asymmetric, travel = "asymmetry" in extras, travels(tracks, extras, wheelbase)
    yield Element("mass", "m_s", kinematics.bounce(asymmetric, wheelbase))
    yield from _inertias(layout, wheelbase)
    for station in layout.wheels:
        _, axle, side, _ = STATIONS[station]
        rates: list[tuple[LinearLaw, str, Row]] = [
            ("spring", f"k_s{axle}", travel(station, "spring")),
            ("damper", f"c_s{axle}", damper_travel(station, tracks, extras, wheelbase)),
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
        for row in _angles(layout):
            yield Element("spring", "w_h", row, -1.0)
    yield from _axle_elements(tracks, extras, wheelbase, layout)


def _inertias(layout: Layout, wheelbase: float) -> Iterator[Element]:
    """Yield the inertias of the body."""
    if layout.pitches:
        yield Element("mass", "I_yy", kinematics.pitch(wheelbase))
    if layout.rolls:
        yield Element("mass", "I_xx", kinematics.roll())


def _angles(layout: Layout) -> list[Row]:
    """Return the rows of the angles by which the body turns, roll first."""
    turns = ((layout.rolls, kinematics.roll()), (layout.pitches, kinematics.pitch()))
    return [row for does, row in turns if does]


def _elements_of_the_body(extras: Collection[str], wheelbase: float, layout: Layout) -> Iterator[Element]:
    """Yield the elements of a body that is not one rigid mass."""
    if "engine" in extras:
        yield from _attached_mass(("m_e", "k_e", "c_e"), kinematics.engine_bay(), kinematics.engine())
    if "occupants" in extras:
        sides = (1.0, -1.0) if layout.rolls else (0.0,)
        for side in sides:
            seats, people = kinematics.seats(side, wheelbase), kinematics.occupants(side)
            yield from _attached_mass(("m_o", "k_o", "c_o"), seats, people, 1 / len(sides))
            if "uneven-occupants" in extras:
                yield from _attached_mass(("d_mo", "d_ko", "d_co"), seats, people, side)
    # Modal masses and rates are those for the angle between the axles and for the rise of the middle.
    for term, mass, index, row, size in (
        ("twist", "I_w", "w", kinematics.torsion(), wheelbase**2),
        ("bending", "m_v", "v", kinematics.bending(), kinematics.sag(wheelbase) ** 2),
    ):
        if term in extras:
            yield Element("mass", mass, row, size)
            yield Element("spring", f"k_{index}", row, size)
            yield Element("damper", f"c_{index}", row, size)


def _attached_mass(names: tuple[str, str, str], below: Row, own: Row, part: float = 1.0) -> Iterator[Element]:
    """Yield the elements of a mass on a spring and a damper of its own, or of a part of them, by the names of all three.

    The sprung mass and its inertias include it: it is taken off the body, where it is attached, and moves by itself.
    """
    mass, spring, damper = names
    yield Element("mass", mass, below, -part)
    yield Element("mass", mass, own, part)
    yield Element("spring", spring, below - own, part)
    yield Element("damper", damper, below - own, part)


def _axle_elements(tracks: Tracks, extras: Collection[str], wheelbase: float, layout: Layout) -> Iterator[Element]:
    """Yield the elements between the two wheels of an axle."""
    travel = travels(tracks, extras, wheelbase)
    for left, right in layout.pairs:
        axle = STATIONS[left].axle
        if "anti-roll" in extras:
            yield Element("spring", f"k_a{axle}", travel(left, "spring") - travel(right, "spring"))
        if "interconnection" in extras:
            flow = kinematics.behind_interconnection(axle)
            yield Element("spring", f"k_x{axle}", travel(left, "spring") - travel(right, "spring") - flow)
            yield Element("damper", f"c_x{axle}", flow)
        if "rigid-axle" in extras:
            yield Element("mass", f"m_x{axle}", kinematics.wheel(left) - kinematics.wheel(right), 0.5)


def _elements_of_heights(heights: Heights, is_weighed: bool, layout: Layout) -> Iterator[Element]:
    """Yield what heights add to a vehicle; `is_weighed` says that the moment of its body's weight is a parameter, w_h."""
    if not heights.has_effect:
        return
    stiffness = heights.gravity_stiffness()
    for row in _angles(layout):
        yield Element("spring", "m_s", row, heights.sinking_stiffness if is_weighed else -stiffness)
    if heights.is_free:
        yield from _elements_of_lateral_motion(heights, layout)
        return
    of_roll, of_pitch = heights.wheel_arms
    if layout.rolls:
        yield Element("mass", "m_s", kinematics.roll(), heights.cg_arm**2)
    turns = ((layout.rolls, kinematics.roll(), of_roll), (layout.pitches, kinematics.pitch(), of_pitch))
    for does, row, arm in turns:
        for axle in layout.axles if does else ():
            yield Element("mass", f"m_u{axle}", row, len(layout.wheels_of(axle)) * arm**2)


def _elements_of_lateral_motion(heights: Heights, layout: Layout) -> Iterator[Element]:
    """Yield the masses of a vehicle that nothing holds sideways, by their horizontal displacements."""
    _, arm = heights.wheel_arms
    if layout.pitches:
        yield Element("mass", "m_s", kinematics.forward())
    if layout.rolls:
        yield Element("mass", "m_s", kinematics.sideways_at("", 0.0))
    if layout.pitches and layout.rolls:
        # The yaw inertia of a car is about that of pitch, and little follows from it: only unequal arms of the axles turn it.
        yield Element("mass", "I_yy", kinematics.yaw())
    for axle in layout.axles:
        wheels = float(len(layout.wheels_of(axle)))
        if layout.pitches:
            yield Element("mass", f"m_u{axle}", kinematics.forward(height=arm), wheels)
        if layout.rolls:
            yield Element("mass", f"m_u{axle}", kinematics.sideways_at(axle, arm), wheels)

"""Nonlinear elements: rows with force laws, of springs, dampers, friction, tyres and the ground."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from sprung.display import shown
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import kinematics
from sprung.vehicle.damper_curve import CurveParts, damper_curve
from sprung.vehicle.elements import damper_travel, travels
from sprung.vehicle.force_laws import (
    AIR,
    BUMP_STOP,
    FRICTION,
    GROUND,
    LOAD_FRICTION,
    PROGRESSIVE,
    REBOUND,
    TYRE_CURVE,
    UNEVEN_FRICTION,
    UNEVEN_GROUND,
    ForceLaw,
)
from sprung.vehicle.kinematics import Row
from sprung.vehicle.layout import FULL, STATIONS, Layout, Tracks, parameter_name

Origin = Literal["empty", "loaded", "weightless"]
"""Position from which the travel of an element counts: where the empty or the loaded vehicle rests, or where the empty vehicle
would be without gravity."""


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


def nonlinear_elements(
    tracks: Tracks = "shared",
    extras: Collection[str] = (),
    wheelbase: float = 0.0,
    load: Mapping[str, float] = MappingProxyType({}),
    layout: Layout = FULL,
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
        What each wheel of an axle carries of it, kg, by the index of the axle; nothing unless given.
    layout
        Which part of a vehicle it is.

    Returns
    -------
    tuple of NonlinearElement
    """
    travel = travels(tracks, extras, wheelbase)
    elements: list[NonlinearElement] = []
    for station in layout.wheels:
        axle, spring = STATIONS[station].axle, travel(station, "spring")
        weight = STANDARD_GRAVITY * load.get(axle, 0.0)
        elements += _friction_forces(axle, spring, extras, weight, STATIONS[station].side)
        elements += _damper_forces(axle, damper_travel(station, tracks, extras, wheelbase), extras)
        elements += _spring_forces(axle, spring, extras)
        if "tyre-curve" in extras:
            tyre = kinematics.wheel(station)
            elements.append(NonlinearElement(TYRE_CURVE, (f"h_t{axle}", f"k_t{axle}"), tyre, origin="weightless"))
    return tuple(elements)


def _friction_forces(
    axle: str, travel: Row, extras: Collection[str], weight: float, side: float
) -> Iterator[NonlinearElement]:
    """Yield the dry friction of a wheel station, which carries a weight of the load, N, and is on a side, 1 on the left."""
    if "friction" in extras:
        own = (parameter_name("F", axle), parameter_name("s", axle))
        if "uneven-friction" in extras:
            yield NonlinearElement(UNEVEN_FRICTION[side], (parameter_name("d_F", axle), *own), travel)
        else:
            yield NonlinearElement(FRICTION, own, travel)
        if "load-friction" in extras:
            yield NonlinearElement(LOAD_FRICTION, (parameter_name("u", axle), *own), travel, weight=weight)


def _damper_forces(axle: str, travel: Row, extras: Collection[str]) -> Iterator[NonlinearElement]:
    """Yield what a damper adds to the force of one of constant rate."""
    if "rebound" in extras:
        yield NonlinearElement(REBOUND, (parameter_name("r", axle), f"c_s{axle}"), travel)
    if "damper-curve" in extras:
        parts = CurveParts("rebound" in extras, "rebound-knee" in extras, "rounded-knee" in extras)
        of_parts = zip(
            parts, ((parameter_name("r", axle),), (f"b_k{axle}", f"b_q{axle}"), (f"w_k{axle}",)), strict=True
        )
        before = (f"c_s{axle}", *(name for has_it, names in of_parts if has_it for name in names))
        knots = [f"v_k{axle}", parameter_name("q", axle)]
        for number in _further_knots(extras):
            knots += [f"v_{number}{axle}", f"q_{number}{axle}"]
        yield NonlinearElement(damper_curve(parts), (*before, *knots), travel)


def _spring_forces(axle: str, travel: Row, extras: Collection[str]) -> Iterator[NonlinearElement]:
    """Yield what a spring and its stop add to the force of one of constant rate."""
    if "progressive" in extras:
        yield NonlinearElement(PROGRESSIVE, (parameter_name("p", axle), f"k_s{axle}"), travel)
    if "air" in extras:
        yield NonlinearElement(AIR, (parameter_name("e", axle), f"k_s{axle}"), travel)
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


def ground_contact_elements(extras: Collection[str] = (), layout: Layout = FULL) -> tuple[NonlinearElement, ...]:
    """Return the elements of unilateral tyre contact: they cancel the tension of the linear tyres.

    Parameters
    ----------
    extras
        Any of `EXTRAS`; with ``tyre-damping`` the tension includes that of the tyre dampers, with ``asymmetry`` it is each
        tyre's own.
    layout
        Which part of a vehicle it is.

    Returns
    -------
    tuple of NonlinearElement
    """
    uneven = "asymmetry" in extras
    rates = ("k_t", *(("d_kt",) if uneven else ()), *(("c_t",) if "tyre-damping" in extras else ()))
    return tuple(
        NonlinearElement(
            UNEVEN_GROUND[STATIONS[station].side] if uneven else GROUND,
            tuple(f"{rate}{STATIONS[station].axle}" for rate in rates),
            kinematics.wheel(station),
            origin="weightless",
        )
        for station in layout.wheels
    )

"""Elements: everything that stores, dissipates or carries energy, as a row and a law.

The equations of motion are nothing but sums over elements: an element with the coefficient κ and the row g adds κ g gᵀ
to M (a mass), C (a damper) or K (a spring). Summed over the elements of `seven_degrees_of_freedom` this is eq. (2) of
the paper, entry by entry and without its misprints.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Literal

from sprung.vehicle import rows
from sprung.vehicle.laws import FRICTION, GROUND, PROGRESSIVE, REBOUND, ForceLaw
from sprung.vehicle.rows import Row, Wheel

Law = Literal["mass", "damper", "spring"]
Tracks = Literal["shared", "separate"]

LINEAR_EXTRAS = ("anti-roll", "tyre-damping", "gravity")
"""Extras, by the name used in a campaign's ``[model]``, which the linear model can carry."""

EXTRAS = (*LINEAR_EXTRAS, "friction", "rebound", "progressive")
"""All extras; those beyond the linear ones are forces with laws of their own."""


@dataclass(frozen=True, slots=True)
class Element:
    """One linear force law.

    Attributes
    ----------
    law
        Which matrix it adds to.
    coefficient
        Name of the parameter that multiplies it, or a known number in SI.
    row
        The displacement it feels.
    """

    law: Law
    coefficient: str | float
    row: Row
    factor: float = 1.0


@dataclass(frozen=True, slots=True)
class Force:
    """An element with a law of its own.

    Attributes
    ----------
    law
        What force it makes.
    parameters
        Names of the law's parameters, in its order.
    row
        The travel it feels, and on which it acts.
    weightless
        Whether the travel counts from where the empty vehicle would be without gravity, not from where it rests.
    """

    law: ForceLaw
    parameters: tuple[str, ...]
    row: Row
    weightless: bool = False


def half_distances(tracks: Tracks) -> dict[tuple[str, Law], str]:
    """Name the half-distance of each axle's springs and dampers.

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
    suffix = {"spring": "2", "damper": "1"} if tracks == "separate" else {"spring": "", "damper": ""}
    return {(axle, law): f"t_{axle}{suffix[law]}" for axle in "fr" for law in ("spring", "damper")}


def seven_degrees_of_freedom(tracks: Tracks = "shared", extras: Collection[str] = ()) -> tuple[Element, ...]:
    """List the elements of the paper's seven-degree-of-freedom vehicle.

    Parameters
    ----------
    tracks
        Whether springs and dampers of an axle share their half-distance.
    extras
        Any of `EXTRAS`; only those of `LINEAR_EXTRAS` add elements.

    Returns
    -------
    tuple of Element
    """
    return tuple(_elements(half_distances(tracks), extras))


def forces_beside(tracks: Tracks = "shared", extras: Collection[str] = ()) -> tuple[Force, ...]:
    """List the forces that no matrix carries.

    Parameters
    ----------
    tracks
        Whether springs and dampers of an axle share their half-distance; friction sits at the springs.
    extras
        Any of `EXTRAS`; those of `LINEAR_EXTRAS` add none.

    Returns
    -------
    tuple of Force
    """
    return tuple(_forces(half_distances(tracks), extras))


def ground_forces(extras: Collection[str] = ()) -> tuple[Force, ...]:
    """List what the ground takes off the tyres' forces where they would pull.

    Parameters
    ----------
    extras
        Any of `EXTRAS`; with ``tyre-damping`` it damps too.
    """
    damping = "tyre-damping" in extras
    return tuple(
        Force(GROUND, (f"k_t{station[0]}", f"c_t{station[0]}")[: 1 + damping], rows.wheel(station), weightless=True)
        for station in rows.WHEELS
    )


def _forces(half_distance: dict[tuple[str, Law], str], extras: Collection[str]) -> Iterator[Force]:
    for station in rows.WHEELS:
        axle = station[0]
        at_spring = rows.travel(station, half_distance[axle, "spring"])
        if "friction" in extras:
            yield Force(FRICTION, (f"F_{axle}", f"s_{axle}"), at_spring)
        if "rebound" in extras:
            yield Force(REBOUND, (f"r_{axle}", f"c_s{axle}"), rows.travel(station, half_distance[axle, "damper"]))
        if "progressive" in extras:
            yield Force(PROGRESSIVE, (f"p_{axle}", f"k_s{axle}"), at_spring)


def _elements(half_distance: dict[tuple[str, Law], str], extras: Collection[str]) -> Iterator[Element]:
    yield Element("mass", "m_s", rows.bounce())
    yield Element("mass", "I_yy", rows.pitch())
    yield Element("mass", "I_xx", rows.roll())
    stations: tuple[Wheel, ...] = ("fl", "fr", "rl", "rr")
    for station in stations:
        axle = station[0]
        yield Element("mass", f"m_u{axle}", rows.wheel(station))
        yield Element("spring", f"k_s{axle}", rows.travel(station, half_distance[axle, "spring"]))
        yield Element("damper", f"c_s{axle}", rows.travel(station, half_distance[axle, "damper"]))
        yield Element("spring", f"k_t{axle}", rows.wheel(station))
        if "tyre-damping" in extras:
            yield Element("damper", f"c_t{axle}", rows.wheel(station))
    if "gravity" in extras:
        yield Element("spring", "w_h", rows.roll(), -1.0)
        yield Element("spring", "w_h", rows.pitch(), -1.0)
    if "anti-roll" in extras:
        for axle in "fr":
            left: Wheel = "fl" if axle == "f" else "rl"
            right: Wheel = "fr" if axle == "f" else "rr"
            at = half_distance[axle, "spring"]
            yield Element("spring", f"k_a{axle}", rows.travel(left, at) - rows.travel(right, at))

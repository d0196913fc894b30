"""Elements: everything that stores, dissipates or carries energy, as a row and a law.

The equations of motion are nothing but sums over elements: an element with the coefficient κ and the row g adds κ g gᵀ
to M (a mass), C (a damper) or K (a spring). Summed over the elements of `seven_degrees_of_freedom` this is eq. (2) of
the paper, entry by entry and without its misprints.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Literal

from sprung.display import shown
from sprung.vehicle import kinematics
from sprung.vehicle.force_laws import BUMP_STOP, FRICTION, GROUND, PROGRESSIVE, REBOUND, ForceLaw
from sprung.vehicle.heights import LEVEL, Heights
from sprung.vehicle.kinematics import Row, Wheel

LinearLaw = Literal["mass", "damper", "spring"]
Tracks = Literal["shared", "separate"]
"""Whether springs and dampers of an axle share their half-distance."""

LINEAR_EXTRAS = ("anti-roll", "tyre-damping", "gravity", "asymmetry", "rigid-axle", "engine")
"""Extras, by the name used in a campaign's ``[model]``, which the linear model can carry."""

EXTRAS = (*LINEAR_EXTRAS, "friction", "rebound", "progressive", "bump-stop")
"""All extras; those beyond the linear ones are forces with laws of their own."""


@shown
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
    factor
        By which the coefficient is multiplied, dimensionless.
    """

    law: LinearLaw
    coefficient: str | float
    row: Row
    factor: float = 1.0


@shown
@dataclass(frozen=True, slots=True)
class NonlinearElement:
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


def half_distances(tracks: Tracks) -> dict[tuple[str, LinearLaw], str]:
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
    return _by_place("t", tracks)


def inboard_shares(tracks: Tracks) -> dict[tuple[str, LinearLaw], str]:
    """Name where each axle's springs and dampers stand on a rigid axle, as parts of its wheels' half-distance.

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
    tracks: Tracks = "shared", extras: Collection[str] = (), heights: Heights = LEVEL
) -> tuple[Element, ...]:
    """List the elements of the paper's seven-degree-of-freedom vehicle.

    Parameters
    ----------
    tracks
        Whether springs and dampers of an axle share their half-distance.
    extras
        Any of `EXTRAS`; only those of `LINEAR_EXTRAS` add elements.
    heights
        How high things are, as far as anybody knows; roll and pitch then carry what follows from it.

    Returns
    -------
    tuple of Element
    """
    return (*_elements(_Places(tracks, extras), extras), *_of_heights(heights))


def nonlinear_elements(tracks: Tracks = "shared", extras: Collection[str] = ()) -> tuple[NonlinearElement, ...]:
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
    return tuple(_forces(_Places(tracks, extras), extras))


def ground_contact_elements(extras: Collection[str] = ()) -> tuple[NonlinearElement, ...]:
    """List what the ground takes off the tyres' forces where they would pull.

    Parameters
    ----------
    extras
        Any of `EXTRAS`; with ``tyre-damping`` it damps too.

    Returns
    -------
    tuple of Force
    """
    damping = "tyre-damping" in extras
    return tuple(
        NonlinearElement(
            GROUND, (f"k_t{station[0]}", f"c_t{station[0]}")[: 1 + damping], kinematics.wheel(station), weightless=True
        )
        for station in kinematics.WHEELS
    )


class _Places:
    """Where springs and dampers stand."""

    def __init__(self, tracks: Tracks, extras: Collection[str]) -> None:
        self._half_distance = half_distances(tracks)
        self._share = inboard_shares(tracks) if "rigid-axle" in extras else {}

    def travel(self, station: Wheel, law: LinearLaw) -> Row:
        """Give what a spring or a damper feels."""
        at = station[0], law
        return kinematics.travel(station, self._half_distance[at], self._share.get(at))


def _forces(places: _Places, extras: Collection[str]) -> Iterator[NonlinearElement]:
    for station in kinematics.WHEELS:
        axle = station[0]
        at_spring = places.travel(station, "spring")
        if "friction" in extras:
            yield NonlinearElement(FRICTION, (f"F_{axle}", f"s_{axle}"), at_spring)
        if "rebound" in extras:
            yield NonlinearElement(REBOUND, (f"r_{axle}", f"c_s{axle}"), places.travel(station, "damper"))
        if "progressive" in extras:
            yield NonlinearElement(PROGRESSIVE, (f"p_{axle}", f"k_s{axle}"), at_spring)
        if "bump-stop" in extras:
            yield NonlinearElement(BUMP_STOP, (f"k_b{axle}", f"x_b{axle}"), at_spring)


def _elements(places: _Places, extras: Collection[str]) -> Iterator[Element]:
    uneven = "asymmetry" in extras
    yield Element("mass", "m_s", kinematics.bounce(uneven))
    yield Element("mass", "I_yy", kinematics.pitch())
    yield Element("mass", "I_xx", kinematics.roll())
    for station in kinematics.WHEELS:
        axle, side = station[0], kinematics.side(station)
        rates: list[tuple[LinearLaw, str, Row]] = [
            ("spring", f"k_s{axle}", places.travel(station, "spring")),
            ("damper", f"c_s{axle}", places.travel(station, "damper")),
            ("spring", f"k_t{axle}", kinematics.wheel(station)),
        ]
        yield Element("mass", f"m_u{axle}", kinematics.wheel(station))
        for law, rate, row in rates:
            yield Element(law, rate, row)
            if uneven:
                yield Element(law, f"d_{rate.replace('_', '')}", row, side)
        if "tyre-damping" in extras:
            yield Element("damper", f"c_t{axle}", kinematics.wheel(station))
    if "gravity" in extras:
        yield Element("spring", "w_h", kinematics.roll(), -1.0)
        yield Element("spring", "w_h", kinematics.pitch(), -1.0)
    if "engine" in extras:
        # It is part of the body's mass and inertia, and leaves it where it moves by itself.
        yield Element("mass", "m_e", kinematics.engine_bay(), -1.0)
        yield Element("mass", "m_e", kinematics.engine())
        yield Element("spring", "k_e", kinematics.engine_bay() - kinematics.engine())
        yield Element("damper", "c_e", kinematics.engine_bay() - kinematics.engine())
    for left, right in kinematics.AXLES:
        axle = left[0]
        if "anti-roll" in extras:
            yield Element("spring", f"k_a{axle}", places.travel(left, "spring") - places.travel(right, "spring"))
        if "rigid-axle" in extras:
            yield Element("mass", f"m_x{axle}", kinematics.wheel(left) - kinematics.wheel(right), 0.5)


def _of_heights(heights: Heights) -> Iterator[Element]:
    if not heights.known:
        return
    yield Element("mass", "m_s", kinematics.roll(), heights.cg_arm**2)
    for row, arm in zip((kinematics.roll(), kinematics.pitch()), heights.wheel_arms, strict=True):
        yield Element("spring", "m_s", row, -heights.tipping())
        for axle in "fr":
            yield Element("mass", f"m_u{axle}", row, 2.0 * arm**2)

"""The vehicle's parameters: names, units and meaning, and which of them each model has."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import NamedTuple

from sprung.vehicle.layout import AXLES, FULL, Layout, Tracks, half_distances, inboard_shares, parameter_name


class Parameter(NamedTuple):
    """A parameter of the vehicle."""

    unit: str
    """SI, such as ``N/m``."""
    meaning: str
    """In words."""
    scales: bool
    """Whether it changes in proportion when every mass, rate and force is multiplied by one number."""
    positive: bool = True
    """Whether it must be positive; the others may be zero."""
    signed: bool = False
    """Whether it may be negative."""
    vanishes_at_infinity: bool = False
    """Whether the effect of its term vanishes where it is infinite: the rate of a spring in series, or a modal mass."""
    usual: float = 0.0
    """Mean in vehicles of all kinds, SI, if `usual_std` is not 0."""
    usual_std: float = 0.0
    """Standard deviation in vehicles of all kinds, SI, which counts where nothing is stated; 0 for none."""


_TABLE: Mapping[str, Parameter] = {
    "m_s": Parameter("kg", "sprung mass", True),
    "I_yy": Parameter("kg m^2", "pitch inertia of the sprung mass", True),
    "I_xx": Parameter("kg m^2", "roll inertia of the sprung mass", True),
    "m_u*": Parameter("kg", "unsprung mass, each {} wheel", True),
    "k_s*": Parameter("N/m", "spring rate, each {} wheel", True),
    "k_t*": Parameter("N/m", "tyre rate, each {} wheel", True),
    "c_s*": Parameter("N s/m", "damper rate, each {} wheel", True),
    "a": Parameter("m", "centre of gravity of the sprung mass to front axle", False),
    "b": Parameter("m", "centre of gravity of the sprung mass to rear axle", False),
    "t*": Parameter("m", "half-distance of springs and dampers, {}", False),
    "t*1": Parameter("m", "half-distance of the {} dampers", False),
    "t*2": Parameter("m", "half-distance of the {} springs", False),
    "c_t*": Parameter("N s/m", "tyre damping, each {} wheel", True, False),
    "k_a*": Parameter("N/m", "{} anti-roll bar, per metre of left-right difference in travel", True, False),
    "k_x*": Parameter(
        "N/m", "{} rate between left and right that relaxes, per metre of left-right difference in travel", True, False
    ),
    "c_x*": Parameter("N s/m", "damping in series with the {} rate between left and right that relaxes", True),
    "w_h": Parameter(
        "N m", "weight of the body times the height of its centre of gravity above lateral support", True, False, True
    ),
    "y_s": Parameter("m", "centre of gravity of the sprung mass, left of the centreline", False, False, True),
    "d_ks*": Parameter("N/m", "left {} spring rate above the mean of both", True, False, True),
    "d_kt*": Parameter("N/m", "left {} tyre rate above the mean of both", True, False, True),
    "d_cs*": Parameter("N s/m", "left {} damper rate above the mean of both", True, False, True),
    "n*": Parameter("1", "place of springs and dampers on a rigid {} axle, part of its wheels' half-distance", False),
    "n*1": Parameter("1", "place of the dampers on a rigid {} axle, part of its wheels' half-distance", False),
    "n*2": Parameter("1", "place of the springs on a rigid {} axle, part of its wheels' half-distance", False),
    "m_x*": Parameter(
        "kg", "what rolls with a rigid {} axle beside its unsprung masses, as a mass at each wheel", True, False, True
    ),
    "m_e": Parameter("kg", "engine that moves on its mounts, a part of the sprung mass", True, False),
    "k_e": Parameter("N/m", "engine mounts, all together", True),
    "c_e": Parameter("N s/m", "damping of the engine mounts, all together", True, False),
    "x_e": Parameter("m", "engine, forward of the front axle", False, False, True),
    "k_d*": Parameter(
        "N/m", "rate of the rubber mount in series with the damper, each {} wheel", True, vanishes_at_infinity=True
    ),
    "c_d*": Parameter("N s/m", "damping of the rubber mount of the damper, each {} wheel", True, False),
    "k_z*": Parameter("N/m", "spring rate that relaxes, beside the spring of each {} wheel", True, False),
    "c_z*": Parameter("N s/m", "damping in series with the relaxing spring rate, each {} wheel", True),
    "I_w": Parameter(
        "kg m^2", "modal inertia of the body's twist, for the angle between the axles", True, vanishes_at_infinity=True
    ),
    "k_w": Parameter("N m", "stiffness of the body's twist, for the angle between the axles", True),
    "c_w": Parameter("N m s", "damping of the body's twist, for the angle between the axles", True),
    "a_w": Parameter("m", "node of the body's twist, ahead of the middle between the axles", False, False, True),
    "u_w": Parameter(
        "1",
        "how far the body is turned in the middle between the axles, as it twists, over the twist between them",
        False,
        False,
        True,
        usual_std=0.1,
    ),
    "e_w": Parameter(
        "1",
        "unevenness of the body's twist: more of it near the middle than towards the axles",
        False,
        False,
        True,
        usual_std=0.1,
    ),
    "m_v": Parameter(
        "kg",
        "modal mass of the body's bending, for the rise of its middle above its axles",
        True,
        vanishes_at_infinity=True,
    ),
    "k_v": Parameter("N/m", "stiffness of the body's bending, for the rise of its middle above its axles", True),
    "c_v": Parameter("N s/m", "damping of the body's bending, for the rise of its middle above its axles", True),
    "b_v": Parameter(
        "1",
        "rise of the centre of gravity as the body bends, over that of the middle above its axles",
        False,
        False,
        True,
    ),
    "p_v": Parameter(
        "1/m", "mean pitch of the body as it bends, over the rise of its middle above its axles", False, False, True
    ),
    "m_o": Parameter("kg", "people on soft seats, a part of the sprung mass", True, False),
    "k_o": Parameter("N/m", "seats of these people, all together", True),
    "c_o": Parameter("N s/m", "damping of the seats of these people, all together", True, False),
    "x_o": Parameter("m", "people on soft seats, forward of the front axle", False, False, True),
    "y_o": Parameter("m", "people on soft seats, left of the centreline", False, False, True),
    "t_o": Parameter("m", "half-distance of people on soft seats beside each other", False, usual=0.37, usual_std=0.04),
    "d_mo": Parameter("kg", "people on the left above the mean of both sides", True, False, True),
    "d_ko": Parameter("N/m", "rate of the seats on the left above the mean of both sides", True, False, True),
    "d_co": Parameter("N s/m", "damping of the seats on the left above the mean of both sides", True, False, True),
    "w_l": Parameter(
        "1/s^2", "rate of the seats under a load, over the mass on them", False, vanishes_at_infinity=True
    ),
    "c_l": Parameter("1/s", "damping of the seats under a load, over the mass on them", False, False),
    "F*": Parameter("N", "dry friction, each {} wheel", True, False),
    "s*": Parameter("N/m", "stiffness of the {} friction before it slides, each wheel", True),
    "u*": Parameter("1", "growth of the {} dry friction with the load, over the weight carried", False, False),
    "d_F*": Parameter("N", "left {} dry friction above the mean of both", True, False, True),
    "r*": Parameter("1", "rebound damping over compression damping, {}", False),
    "v_k*": Parameter("m/s", "velocity at which the curve of the {} dampers has its knee", False),
    "q*": Parameter("1", "damping beyond the knee over that before it, {}", False),
    "b_k*": Parameter("1", "velocity of the knees of the {} dampers in rebound over that in compression", False),
    "b_q*": Parameter("1", "part of the {} damping beyond the knee in rebound over that part in compression", False),
    "w_k*": Parameter("m/s", "half the width over which the knee of the {} dampers is rounded", False, False),
    "v_2*": Parameter("m/s", "velocity at which the curve of the {} dampers has its second knee", False),
    "q_2*": Parameter("1", "damping beyond the second knee over that before it, {}", False),
    "v_3*": Parameter("m/s", "velocity at which the curve of the {} dampers has its third knee", False),
    "q_3*": Parameter("1", "damping beyond the third knee over that before it, {}", False),
    "p*": Parameter(
        "1/m", "growth of the {} spring rate with compression, as a part of it per metre", False, False, True
    ),
    "e*": Parameter("1/m", "one over the effective height of the air column in a {} spring", False, False),
    "e_l*": Parameter("1/m", "the same of {} springs that a valve levels under every load", False, False),
    "g*": Parameter("N/(m kg)", "growth of the rate of a levelled {} spring per mass that it carries", False, False),
    "h_t*": Parameter(
        "1/m", "growth of the {} tyre rate with deflection, as a part of k_t per metre", False, False, True
    ),
    "k_b*": Parameter("N/m", "stiffness of the {} bump stops, each wheel", True, False),
    "x_b*": Parameter("m", "compression from rest at which the {} bump stops are met", False),
}
"""Every parameter, in the order in which tables show them; a star stands for the index of the axle, {} for its name."""

_AXLE_NAMES = {"f": "front", "r": "rear", "": ""}


def _expand(pattern: str) -> dict[str, str]:
    """Return the names of a parameter by axle, from one with a star for the index of the axle; one for all without a star."""
    symbol, star, number = pattern.partition("*")
    return {axle: parameter_name(symbol, axle, number) for axle in AXLES} if star else {"": symbol}


def _meaning(template: str, axle: str) -> str:
    words = template.format(_AXLE_NAMES[axle]).split()
    return " ".join(words).removesuffix(",")


UNITS_PER_MASS: Mapping[str, str] = {
    "kg": "1",
    "kg m^2": "m^2",
    "N/m": "1/s^2",
    "N s/m": "1/s",
    "N": "m/s^2",
    "N m": "m^2/s^2",
    "N m s": "m^2/s",
}
"""Unit of a parameter divided by a mass, by its own unit."""

PARAMETERS: Mapping[str, Parameter] = {
    name: about._replace(meaning=_meaning(about.meaning, axle))
    for pattern, about in _TABLE.items()
    for axle, name in _expand(pattern).items()
}
"""Every parameter that the models know, in the order in which tables show them."""

_TERMS: Mapping[str, tuple[str, ...]] = {
    "anti-roll": ("k_a*",),
    "tyre-damping": ("c_t*",),
    "gravity": ("w_h",),
    "engine": ("m_e", "k_e", "c_e", "x_e"),
    "damper-mount": ("k_d*",),
    "mount-damping": ("c_d*",),
    "zener": ("k_z*", "c_z*"),
    "interconnection": ("k_x*", "c_x*"),
    "twist": ("I_w", "k_w", "c_w", "a_w", "u_w", "e_w"),
    "bending": ("m_v", "k_v", "c_v", "b_v", "p_v"),
    "occupants": ("m_o", "k_o", "c_o", "x_o", "y_o", "t_o"),
    "uneven-occupants": ("d_mo", "d_ko", "d_co"),
    "seat-load": ("w_l", "c_l"),
    "friction": ("F*", "s*"),
    "load-friction": ("u*",),
    "uneven-friction": ("d_F*",),
    "rebound": ("r*",),
    "damper-curve": ("v_k*", "q*"),
    "rebound-knee": ("b_k*", "b_q*"),
    "rounded-knee": ("w_k*",),
    "second-knee": ("v_2*", "q_2*"),
    "third-knee": ("v_3*", "q_3*"),
    "progressive": ("p*",),
    "air": ("e*",),
    "levelled-air": ("e_l*", "g*"),
    "tyre-curve": ("h_t*",),
    "bump-stop": ("k_b*", "x_b*"),
    "asymmetry": ("y_s", "d_ks*", "d_kt*", "d_cs*"),
    "rigid-axle": ("n*", "n*1", "n*2", "m_x*"),
}
"""Patterns of the parameters that each extra may add; see `parameters_of_term`."""

_NEEDS: Mapping[str, Callable[[Layout], bool]] = {
    **dict.fromkeys(
        (
            "anti-roll",
            "interconnection",
            "asymmetry",
            "uneven-friction",
            "uneven-occupants",
            "rigid-axle",
            "y_o",
            "t_o",
            "I_xx",
            "t*",
            "t*1",
            "t*2",
        ),
        lambda one: one.rolls,
    ),
    **dict.fromkeys(("bending", "x_e", "x_o", "I_yy", "a", "b"), lambda one: one.pitches),
    "gravity": lambda one: one.rolls or one.pitches,
    "twist": lambda one: one.rolls and one.pitches,
}
"""Which layouts have an extra, or a parameter by its pattern; all have the others."""

_WITHOUT_EFFECT: Mapping[str, float] = {
    **dict.fromkeys(("s*", "k_e", "k_w"), 1e6),
    **dict.fromkeys(("v_k*", "v_2*", "v_3*", "x_b*"), 1.0),
    **dict.fromkeys(("c_e", "x_e", "a_w", "u_w", "e_w", "b_v", "p_v", "c_o", "x_o", "y_o", "c_l"), 0.0),
    **dict.fromkeys(("c_z*", "c_x*", "c_w"), 1e3),
    "k_v": 1e7,
    "c_v": 1e4,
    "k_o": 1e5,
    "t_o": _TABLE["t_o"].usual,
}
"""Parameters of extras without effect where the others of the extra are neutral, and their values in a vehicle without it."""

_FACTORS = frozenset({"r*", "b_k*", "b_q*", "q*", "q_2*", "q_3*", "n*", "n*1", "n*2"})


def _names_of(patterns: Mapping[str, float]) -> dict[str, float]:
    return {name: value for pattern, value in patterns.items() for name in _expand(pattern).values()}


NEUTRAL: Mapping[str, float] = _names_of(
    {
        pattern: math.inf if _TABLE[pattern].vanishes_at_infinity else float(pattern in _FACTORS)
        for patterns in _TERMS.values()
        for pattern in patterns
        if pattern not in _WITHOUT_EFFECT
    }
)
"""Values with which an extra has no effect; the others of its parameters then have none either."""

ABSENT: Mapping[str, float] = {**NEUTRAL, **_names_of(_WITHOUT_EFFECT)}
"""Values of the parameters of every extra in a vehicle without it."""


@cache
def parameter_names(tracks: Tracks = "shared", extras: tuple[str, ...] = (), layout: Layout = FULL) -> tuple[str, ...]:
    """Return the names of the parameters of a model, in the order of `PARAMETERS`.

    Parameters
    ----------
    tracks
        Whether springs and dampers of an axle share their half-distance.
    extras
        Any of `EXTRAS`.
    layout
        Of the vehicle.

    Returns
    -------
    tuple of str
    """
    of_terms = {name for extra in extras for name in parameters_of_term(extra, tracks, layout)}
    basic = [pattern for pattern in _TABLE if not any(pattern in patterns for patterns in _TERMS.values())]
    elsewhere = _places_of_other(tracks)
    own = of_terms.union(*(_own_names(pattern, layout) for pattern in basic)) - elsewhere
    return tuple(name for name in PARAMETERS if name in own)


def _fits(name: str, layout: Layout) -> bool:
    """Return whether a layout has an extra, or a parameter by its pattern."""
    return name not in _NEEDS or _NEEDS[name](layout)


def _own_names(pattern: str, layout: Layout) -> set[str]:
    """Return the names of a parameter in a layout, from its pattern; none where the layout has no such parameter."""
    if not _fits(pattern, layout):
        return set()
    return {name for axle, name in _expand(pattern).items() if "*" not in pattern or axle in layout.axles}


def _places_of_other(tracks: Tracks) -> set[str]:
    other: Tracks = "shared" if tracks == "separate" else "separate"
    return {*half_distances(other).values(), *inboard_shares(other).values()}


@cache
def parameters_of_term(extra: str, tracks: Tracks, layout: Layout = FULL) -> tuple[str, ...]:
    """Return the names of the parameters that an extra adds to a model.

    Parameters
    ----------
    extra
        One of `EXTRAS`.
    tracks
        Whether springs and dampers of an axle share their places.
    layout
        Of the vehicle.

    Returns
    -------
    tuple of str
        None where such a vehicle cannot have it.
    """
    if not _fits(extra, layout):
        return ()
    own = set[str]().union(*(_own_names(pattern, layout) for pattern in _TERMS[extra])) - _places_of_other(tracks)
    return tuple(name for pattern in _TERMS[extra] for name in _expand(pattern).values() if name in own)


def terms_of(layout: Layout) -> tuple[str, ...]:
    """Return the extras that a vehicle of a layout can have.

    Parameters
    ----------
    layout
        Of the vehicle.

    Returns
    -------
    tuple of str
    """
    return tuple(extra for extra in _TERMS if parameters_of_term(extra, "shared", layout))


@cache
def separate_track_names(name: str) -> tuple[str, ...]:
    """Return the names of a parameter in a model with separate half-distances of springs and dampers.

    Parameters
    ----------
    name
        Of any parameter.

    Returns
    -------
    tuple of str
        Two names for a half-distance that springs and dampers share; for any other parameter its own name.

    Examples
    --------
    >>> separate_track_names("t_f"), separate_track_names("k_sf")
    (('t_f1', 't_f2'), ('k_sf',))
    """
    places = [
        (shared, names_of("separate")[place])
        for names_of in (half_distances, inboard_shares)
        for place, shared in names_of("shared").items()
    ]
    return tuple(sorted(separate for shared, separate in places if shared == name)) or (name,)


def mean_of_sides(name: str) -> str | None:
    """Return the name of the mean of left and right above which a parameter is what the left has; None for any other.

    Parameters
    ----------
    name
        Of any parameter.

    Returns
    -------
    str or None

    Examples
    --------
    >>> mean_of_sides("d_ksf"), mean_of_sides("d_mo"), mean_of_sides("k_sf")
    ('k_sf', 'm_o', None)
    """
    return f"{name[2]}_{name[3:]}" if name.startswith("d_") else None


def with_separate_tracks(parameters: Mapping[str, float]) -> dict[str, float]:
    """Return the parameters of the same vehicle in a model with separate half-distances of springs and dampers.

    Parameters
    ----------
    parameters
        Values by name, SI.

    Returns
    -------
    dict
        Values by name, SI.
    """
    return {separate: value for name, value in parameters.items() for separate in separate_track_names(name)}

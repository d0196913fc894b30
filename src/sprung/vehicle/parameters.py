"""The vehicle's parameters: names, units and meaning, and which of them each model has."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from typing import NamedTuple

from sprung.vehicle.elements import Tracks, half_distances, inboard_shares


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


PARAMETERS: Mapping[str, Parameter] = {
    "m_s": Parameter("kg", "sprung mass", True),
    "I_yy": Parameter("kg m^2", "pitch inertia of the sprung mass", True),
    "I_xx": Parameter("kg m^2", "roll inertia of the sprung mass", True),
    "m_uf": Parameter("kg", "unsprung mass, each front wheel", True),
    "m_ur": Parameter("kg", "unsprung mass, each rear wheel", True),
    "k_sf": Parameter("N/m", "spring rate, each front wheel", True),
    "k_sr": Parameter("N/m", "spring rate, each rear wheel", True),
    "k_tf": Parameter("N/m", "tyre rate, each front wheel", True),
    "k_tr": Parameter("N/m", "tyre rate, each rear wheel", True),
    "c_sf": Parameter("N s/m", "damper rate, each front wheel", True),
    "c_sr": Parameter("N s/m", "damper rate, each rear wheel", True),
    "a": Parameter("m", "centre of gravity of the sprung mass to front axle", False),
    "b": Parameter("m", "centre of gravity of the sprung mass to rear axle", False),
    "t_f": Parameter("m", "half-distance of springs and dampers, front", False),
    "t_r": Parameter("m", "half-distance of springs and dampers, rear", False),
    "t_f1": Parameter("m", "half-distance of the front dampers", False),
    "t_r1": Parameter("m", "half-distance of the rear dampers", False),
    "t_f2": Parameter("m", "half-distance of the front springs", False),
    "t_r2": Parameter("m", "half-distance of the rear springs", False),
    "c_tf": Parameter("N s/m", "tyre damping, each front wheel", True, False),
    "c_tr": Parameter("N s/m", "tyre damping, each rear wheel", True, False),
    "k_af": Parameter("N/m", "front anti-roll bar, per metre of left-right difference in travel", True, False),
    "k_ar": Parameter("N/m", "rear anti-roll bar, per metre of left-right difference in travel", True, False),
    "w_h": Parameter(
        "N m",
        "weight of the body times the height of its centre of gravity above lateral support",
        True,
        False,
        True,
    ),
    "y_s": Parameter("m", "centre of gravity of the sprung mass, left of the centreline", False, False, True),
    "d_ksf": Parameter("N/m", "left front spring rate above the mean of both", True, False, True),
    "d_ksr": Parameter("N/m", "left rear spring rate above the mean of both", True, False, True),
    "d_ktf": Parameter("N/m", "left front tyre rate above the mean of both", True, False, True),
    "d_ktr": Parameter("N/m", "left rear tyre rate above the mean of both", True, False, True),
    "d_csf": Parameter("N s/m", "left front damper rate above the mean of both", True, False, True),
    "d_csr": Parameter("N s/m", "left rear damper rate above the mean of both", True, False, True),
    "n_f": Parameter(
        "1", "place of springs and dampers on a rigid front axle, part of its wheels' half-distance", False
    ),
    "n_r": Parameter(
        "1", "place of springs and dampers on a rigid rear axle, part of its wheels' half-distance", False
    ),
    "n_f1": Parameter("1", "place of the dampers on a rigid front axle, part of its wheels' half-distance", False),
    "n_r1": Parameter("1", "place of the dampers on a rigid rear axle, part of its wheels' half-distance", False),
    "n_f2": Parameter("1", "place of the springs on a rigid front axle, part of its wheels' half-distance", False),
    "n_r2": Parameter("1", "place of the springs on a rigid rear axle, part of its wheels' half-distance", False),
    "m_xf": Parameter(
        "kg",
        "what rolls with a rigid front axle beside its unsprung masses, as a mass at each wheel",
        True,
        False,
        True,
    ),
    "m_xr": Parameter(
        "kg",
        "what rolls with a rigid rear axle beside its unsprung masses, as a mass at each wheel",
        True,
        False,
        True,
    ),
    "m_e": Parameter("kg", "engine that moves on its mounts, a part of the sprung mass", True, False),
    "k_e": Parameter("N/m", "engine mounts, all together", True),
    "c_e": Parameter("N s/m", "damping of the engine mounts, all together", True, False),
    "x_e": Parameter("m", "engine, forward of the front axle", False, False, True),
    "k_df": Parameter(
        "N/m",
        "rate of the rubber mount in series with the damper, each front wheel",
        True,
        vanishes_at_infinity=True,
    ),
    "k_dr": Parameter(
        "N/m",
        "rate of the rubber mount in series with the damper, each rear wheel",
        True,
        vanishes_at_infinity=True,
    ),
    "c_df": Parameter("N s/m", "damping of the rubber mount of the damper, each front wheel", True, False),
    "c_dr": Parameter("N s/m", "damping of the rubber mount of the damper, each rear wheel", True, False),
    "k_zf": Parameter("N/m", "spring rate that relaxes, beside the spring of each front wheel", True, False),
    "k_zr": Parameter("N/m", "spring rate that relaxes, beside the spring of each rear wheel", True, False),
    "c_zf": Parameter("N s/m", "damping in series with the relaxing spring rate, each front wheel", True),
    "c_zr": Parameter("N s/m", "damping in series with the relaxing spring rate, each rear wheel", True),
    "I_w": Parameter(
        "kg m^2",
        "modal inertia of the body's twist, for the angle between the axles",
        True,
        vanishes_at_infinity=True,
    ),
    "k_w": Parameter("N m", "stiffness of the body's twist, for the angle between the axles", True),
    "c_w": Parameter("N m s", "damping of the body's twist, for the angle between the axles", True),
    "a_w": Parameter("m", "node of the body's twist, ahead of the middle between the axles", False, False, True),
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
    "w_l": Parameter(
        "1/s^2", "rate of the seats under a load, over the mass on them", False, vanishes_at_infinity=True
    ),
    "c_l": Parameter("1/s", "damping of the seats under a load, over the mass on them", False, False),
    "F_f": Parameter("N", "dry friction, each front wheel", True, False),
    "F_r": Parameter("N", "dry friction, each rear wheel", True, False),
    "s_f": Parameter("N/m", "stiffness of the front friction before it slides, each wheel", True),
    "s_r": Parameter("N/m", "stiffness of the rear friction before it slides, each wheel", True),
    "u_f": Parameter("1", "growth of the front dry friction with the load, over the weight carried", False, False),
    "u_r": Parameter("1", "growth of the rear dry friction with the load, over the weight carried", False, False),
    "r_f": Parameter("1", "rebound damping over compression damping, front", False),
    "r_r": Parameter("1", "rebound damping over compression damping, rear", False),
    "v_kf": Parameter("m/s", "velocity at which the curve of the front dampers has its knee", False),
    "v_kr": Parameter("m/s", "velocity at which the curve of the rear dampers has its knee", False),
    "q_f": Parameter("1", "damping beyond the knee over that before it, front", False),
    "q_r": Parameter("1", "damping beyond the knee over that before it, rear", False),
    "w_kf": Parameter("m/s", "half the width over which the knee of the front dampers is rounded", False, False),
    "w_kr": Parameter("m/s", "half the width over which the knee of the rear dampers is rounded", False, False),
    "v_2f": Parameter("m/s", "velocity at which the curve of the front dampers has its second knee", False),
    "v_2r": Parameter("m/s", "velocity at which the curve of the rear dampers has its second knee", False),
    "q_2f": Parameter("1", "damping beyond the second knee over that before it, front", False),
    "q_2r": Parameter("1", "damping beyond the second knee over that before it, rear", False),
    "v_3f": Parameter("m/s", "velocity at which the curve of the front dampers has its third knee", False),
    "v_3r": Parameter("m/s", "velocity at which the curve of the rear dampers has its third knee", False),
    "q_3f": Parameter("1", "damping beyond the third knee over that before it, front", False),
    "q_3r": Parameter("1", "damping beyond the third knee over that before it, rear", False),
    "p_f": Parameter(
        "1/m", "growth of the front spring rate with compression, as a part of it per metre", False, False, True
    ),
    "p_r": Parameter(
        "1/m", "growth of the rear spring rate with compression, as a part of it per metre", False, False, True
    ),
    "e_f": Parameter("1/m", "one over the effective height of the air column in a front spring", False, False),
    "e_r": Parameter("1/m", "one over the effective height of the air column in a rear spring", False, False),
    "e_lf": Parameter("1/m", "the same of front springs that a valve levels under every load", False, False),
    "e_lr": Parameter("1/m", "the same of rear springs that a valve levels under every load", False, False),
    "g_f": Parameter(
        "N/(m kg)", "growth of the rate of a levelled front spring per mass that it carries", False, False
    ),
    "g_r": Parameter("N/(m kg)", "growth of the rate of a levelled rear spring per mass that it carries", False, False),
    "h_tf": Parameter(
        "1/m", "growth of the front tyre rate with deflection, as a part of k_tf per metre", False, False, True
    ),
    "h_tr": Parameter(
        "1/m", "growth of the rear tyre rate with deflection, as a part of k_tr per metre", False, False, True
    ),
    "k_bf": Parameter("N/m", "stiffness of the front bump stops, each wheel", True, False),
    "k_br": Parameter("N/m", "stiffness of the rear bump stops, each wheel", True, False),
    "x_bf": Parameter("m", "compression from rest at which the front bump stops are met", False),
    "x_br": Parameter("m", "compression from rest at which the rear bump stops are met", False),
}
"""Every parameter that the models know, in the order in which tables show them."""

EXTRA_PARAMETERS: Mapping[str, tuple[str, ...]] = {
    "anti-roll": ("k_af", "k_ar"),
    "tyre-damping": ("c_tf", "c_tr"),
    "gravity": ("w_h",),
    "engine": ("m_e", "k_e", "c_e", "x_e"),
    "damper-mount": ("k_df", "k_dr"),
    "mount-damping": ("c_df", "c_dr"),
    "zener": ("k_zf", "k_zr", "c_zf", "c_zr"),
    "twist": ("I_w", "k_w", "c_w", "a_w"),
    "bending": ("m_v", "k_v", "c_v", "b_v", "p_v"),
    "occupants": ("m_o", "k_o", "c_o", "x_o", "y_o"),
    "seat-load": ("w_l", "c_l"),
    "friction": ("F_f", "F_r", "s_f", "s_r"),
    "load-friction": ("u_f", "u_r"),
    "rebound": ("r_f", "r_r"),
    "damper-curve": ("v_kf", "v_kr", "q_f", "q_r"),
    "rounded-knee": ("w_kf", "w_kr"),
    "second-knee": ("v_2f", "v_2r", "q_2f", "q_2r"),
    "third-knee": ("v_3f", "v_3r", "q_3f", "q_3r"),
    "progressive": ("p_f", "p_r"),
    "air": ("e_f", "e_r"),
    "levelled-air": ("e_lf", "e_lr", "g_f", "g_r"),
    "tyre-curve": ("h_tf", "h_tr"),
    "bump-stop": ("k_bf", "k_br", "x_bf", "x_br"),
    "asymmetry": ("y_s", "d_ksf", "d_ksr", "d_ktf", "d_ktr", "d_csf", "d_csr"),
    "rigid-axle": ("n_f", "n_r", "n_f1", "n_r1", "n_f2", "n_r2", "m_xf", "m_xr"),
}
"""The parameters that each extra may add; see `parameters_of_term`."""

_INDIFFERENT = frozenset({"s_f", "s_r", "v_kf", "v_kr", "x_bf", "x_br", "k_e", "c_e", "x_e", "c_zf", "c_zr"}) | {
    "v_2f", "v_2r", "v_3f", "v_3r",
    "k_w", "c_w", "a_w", "k_v", "c_v", "b_v", "p_v", "k_o", "c_o", "x_o", "y_o", "c_l"
}  # fmt: skip
"""Parameters of extras without effect where the others of the extra are neutral."""

_FACTORS = frozenset(
    {"r_f", "r_r", "q_f", "q_r", "q_2f", "q_2r", "q_3f", "q_3r", "n_f", "n_r", "n_f1", "n_r1", "n_f2", "n_r2"}
)

NEUTRAL: Mapping[str, float] = {
    name: math.inf if PARAMETERS[name].vanishes_at_infinity else float(name in _FACTORS)
    for names in EXTRA_PARAMETERS.values()
    for name in names
    if name not in _INDIFFERENT
}
"""Values with which an extra has no effect; the others of its parameters then have none either."""


@cache
def parameter_names(tracks: Tracks = "shared", extras: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Return the names of the parameters of a model, in the order of `PARAMETERS`.

    Parameters
    ----------
    tracks
        Whether springs and dampers of an axle share their half-distance.
    extras
        Any of `EXTRA_PARAMETERS`.

    Returns
    -------
    tuple of str
    """
    places = {*half_distances(tracks).values()}
    absent = {name for kind in ("shared", "separate") for name in half_distances(kind).values()} - places
    for extra, names in EXTRA_PARAMETERS.items():
        absent.update(set(names) - set(parameters_of_term(extra, tracks) if extra in extras else ()))
    return tuple(name for name in PARAMETERS if name not in absent)


def parameters_of_term(extra: str, tracks: Tracks) -> tuple[str, ...]:
    """Return the names of the parameters that an extra adds to a model.

    Parameters
    ----------
    extra
        One of `EXTRAS`.
    tracks
        Whether springs and dampers of an axle share their places.

    Returns
    -------
    tuple of str
    """
    other: Tracks = "shared" if tracks == "separate" else "separate"
    elsewhere = set(inboard_shares(other).values())
    return tuple(name for name in EXTRA_PARAMETERS[extra] if name not in elsewhere)


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

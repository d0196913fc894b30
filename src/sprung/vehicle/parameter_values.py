"""Values of a vehicle's parameters: completed from those that are given, and checked."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from functools import cache
from typing import cast

from sprung.errors import Problems, did_you_mean
from sprung.vehicle.layout import LAYOUTS, Layout, LinearLaw, Tracks, VehicleModel, half_distances, inboard_shares
from sprung.vehicle.parameters import ABSENT, NEUTRAL, PARAMETERS, parameter_names, parameters_of_term, terms_of

_ORDER = {name: position for position, name in enumerate(PARAMETERS)}


@cache
def all_names(model: VehicleModel) -> frozenset[str]:
    """Return the names of all parameters that a vehicle may have; half-distances both shared and separate.

    Parameters
    ----------
    model
        Which part of a vehicle it is.

    Returns
    -------
    frozenset of str
    """
    layout, both = LAYOUTS[model], cast("tuple[Tracks, ...]", ("shared", "separate"))
    return frozenset(name for tracks in both for name in parameter_names(tracks, terms_of(layout), layout))


def _places(names_of: Callable[[Tracks], Mapping[tuple[str, LinearLaw], str]]) -> dict[str, tuple[str, str]]:
    shared, apart = names_of("shared"), names_of("separate")
    return {shared[axle, "spring"]: (apart[axle, "damper"], apart[axle, "spring"]) for axle, _ in shared}


APART: Mapping[str, tuple[str, str]] = {**_places(half_distances), **_places(inboard_shares)}
"""By the name of the place that dampers and springs of an axle share: those of dampers and of springs where they do not."""

_PLACES = frozenset({*APART, *(one for apart in APART.values() for one in apart)})
"""Names of all places, shared and apart."""


def model_of(names: Collection[str]) -> VehicleModel:
    """Return the part of a vehicle that has parameters of these names and needs no others; the whole one if none does."""
    given = {*names}
    for layout in reversed(list(LAYOUTS.values())):
        if {*parameter_names("shared", (), layout)} - _PLACES <= given <= all_names(layout.model):
            return layout.model
    return "full"


def complete_parameters(given: Mapping[str, float], layout: Layout, where: str, problems: Problems) -> dict[str, float]:
    """Return the values of all parameters that a vehicle may have, its places apart.

    Parameters
    ----------
    given
        Values by name, SI; of extras that are not named, the values without effect.
    layout
        Of the vehicle.
    where
        The vehicle, for messages.
    problems
        Takes what is unknown, missing or contradictory.

    Returns
    -------
    dict
        By name, SI; NaN for what is missing.
    """
    possible = all_names(layout.model)
    for unknown in sorted(given.keys() - possible):
        problems.add(where, f"'{unknown}'", "the name of a parameter", did_you_mean(unknown, sorted(possible)))
    for name in parameter_names("shared", (), layout):
        if name not in given and name not in _PLACES:
            unit, meaning, *_ = PARAMETERS[name]
            problems.add(where, f"no '{name}'", f"the {meaning} in {unit}", f"Add {name} = ... to it.")
    values = {name: given.get(name, ABSENT.get(name, math.nan)) for name in possible - _PLACES}
    for shared, apart in ((one, APART[one]) for one in APART if one in possible):
        both = given.get(shared)
        own = [given.get(one, both) for one in apart]
        if own == [None, None] and shared in ABSENT:
            own = [ABSENT[shared]] * 2
        if None in own or (both is not None and own != [both, both]):
            stated = [f"{one} = {given[one]:g}" for one in (shared, *apart) if given.get(one) is not None]
            found = ", ".join(stated) or f"no '{shared}'"
            expected = f"either {shared}, or {apart[0]} (dampers) and {apart[1]} (springs)"
            problems.add(f"{where}: {shared}", found, expected, "Give one of the two.")
        values |= {one: math.nan if value is None else value for one, value in zip(apart, own, strict=True)}
    return values


def own_parameters(values: Mapping[str, float], layout: Layout) -> dict[str, float]:
    """Return the parameters of a vehicle in the order of tables: shared places if they are, extras if they have an effect.

    Parameters
    ----------
    values
        As `complete_parameters` returns them.
    layout
        Of the vehicle.

    Returns
    -------
    dict
        By name, SI.
    """
    apart = {shared: own for shared, own in APART.items() if own[0] in values}
    is_shared = all(values[damper] == values[spring] for damper, spring in apart.values())
    tracks: Tracks = "shared" if is_shared else "separate"
    everything = {**values, **{shared: values[own[0]] for shared, own in apart.items()}}
    names = parameter_names(tracks, effective_terms(everything, tracks, layout), layout)
    return {name: float(everything[name]) for name in names}


def effective_terms(values: Mapping[str, float], tracks: Tracks, layout: Layout) -> tuple[str, ...]:
    """Return the extras that have an effect at values of their parameters, SI; those not among the values have none."""
    return tuple(
        extra
        for extra in terms_of(layout)
        if any(
            values.get(name, NEUTRAL[name]) != NEUTRAL[name]
            for name in parameters_of_term(extra, tracks, layout)
            if name in NEUTRAL
        )
    )


def check_values(values: Mapping[str, float], own: Mapping[str, float], where: str, problems: Problems) -> None:
    """Check what values of parameters may be.

    Parameters
    ----------
    values
        Of all parameters, SI.
    own
        Those that the vehicle has.
    where
        The vehicle, for messages.
    problems
        Takes what is impossible.
    """
    has_mounts = any(name.startswith("k_d") for name in own)
    for name, value in sorted(values.items(), key=lambda one: _ORDER[one[0]]):
        parameter = PARAMETERS[name]
        positive = parameter.positive and (has_mounts or not name.startswith("c_s"))
        is_absent = value == NEUTRAL.get(name) and name not in own
        if not (
            (math.isfinite(value) or is_absent) and (value > 0 or parameter.signed or (value == 0 and not positive))
        ):
            kind = "positive" if positive else "finite" if parameter.signed else "finite, not negative"
            problems.add(f"{where}: {name}", repr(value), f"a {kind} number, {parameter.unit}", "Correct it.")
    engine = values["m_e"]
    if engine and not problems:
        ahead = values["a"] + values["x_e"] if "a" in values else 0.0
        if engine * (1 / values["m_s"] + (ahead**2 / values["I_yy"] if ahead else 0.0)) >= 1:
            problems.add(
                f"{where}: m_e",
                f"an engine of {engine:g} kg, {ahead:g} m ahead of the centre of gravity",
                "one that leaves the body some mass and pitch inertia, of which it is a part",
                "Correct m_e and x_e, or m_s and I_yy, which include the engine.",
            )

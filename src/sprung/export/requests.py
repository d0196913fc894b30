"""What an export is asked for: the load, and a vehicle that the format can hold."""

from __future__ import annotations

from collections.abc import Mapping

from sprung.errors import InputError, Problem
from sprung.vehicle import (
    EMPTY,
    LINEAR_EXTRAS,
    REFINED,
    Load,
    Vehicle,
    parameters_of_term,
    with_tyre_rates_at_rest,
)

TERM_NAMES: Mapping[str, str] = {
    "anti-roll": "anti-roll bars",
    "tyre-damping": "tyre damping",
    "gravity": "the moment of the body's weight as it turns",
    "asymmetry": "differences between left and right",
    "rigid-axle": "rigid axles",
    "engine": "an engine on mounts",
    "damper-mount": "rubber mounts in series with the dampers",
    "mount-damping": "damping of the damper mounts",
    "zener": "spring rates that relax",
    "interconnection": "an interconnection of left and right",
    "twist": "twist of the body",
    "bending": "bending of the body",
    "occupants": "people on soft seats",
    "uneven-occupants": "people on soft seats who differ between left and right",
    "seat-load": "loads on soft seats",
    "friction": "dry friction",
    "load-friction": "dry friction that grows with the load",
    "uneven-friction": "dry friction that differs between left and right",
    "rebound": "dampers stiffer in rebound",
    "damper-curve": "damper curves with knees",
    "rebound-knee": "damper knees that differ in rebound",
    "rounded-knee": "rounded knees of damper curves",
    "second-knee": "second knees of damper curves",
    "third-knee": "third knees of damper curves",
    "progressive": "progressive springs",
    "air": "air springs",
    "levelled-air": "levelled air springs",
    "bump-stop": "bump stops",
    "tyre-curve": "tyre rates that grow with deflection",
}
"""Model terms in words."""


def resolve_load(load: Load | None) -> Load:
    """Return the load that is meant: the empty vehicle where none is given."""
    return EMPTY if load is None else load


def parameters_in_words(vehicle: Vehicle, term: str) -> str:
    """Return a term of a vehicle with its parameters."""
    own = [name for name in parameters_of_term(term, vehicle.tracks, vehicle.layout) if name in vehicle.parameters]
    return f"{TERM_NAMES[term]} ({', '.join(own)})"


def check_terms(vehicle: Vehicle, lacking: Mapping[str, str], where: str, approximate: bool) -> list[str]:
    """Return how the terms that a format lacks are approximated, one sentence each.

    Parameters
    ----------
    vehicle
        With its terms.
    lacking
        By term that the format lacks: what an approximation does with it.
    where
        The export, for messages.
    approximate
        Whether this is wanted.

    Raises
    ------
    InputError
        If it is not, with all such terms.
    """
    own = [term for term in vehicle.extras if term in lacking]
    if own and not approximate:
        raise InputError(
            Problem(
                where,
                parameters_in_words(vehicle, term),
                "what the format can hold",
                f"Set approximate=True (--approximate): {lacking[term]}; or export to modelica or fmu, which have all terms.",
            )
            for term in own
        )
    return [f"Approximated: {parameters_in_words(vehicle, term)}: {lacking[term]}." for term in own]


def without_terms(vehicle: Vehicle, load: Load, terms: frozenset[str]) -> Vehicle:
    """Return the vehicle without some of its terms, and with all that refine these.

    Tyres have their rates at the static load where these grow with the deflection, and dampers the mean of compression and
    rebound.

    Parameters
    ----------
    vehicle, load
        The vehicle and what is on it.
    terms
        Names of the terms.
    """
    model = vehicle.linear_model(load)
    values = dict(vehicle.parameters)
    if "tyre-curve" in terms:
        at_rest = with_tyre_rates_at_rest(model, list(values.values()))
        values = dict(zip(values, at_rest.tolist(), strict=True))
    if "rebound" in terms:
        for axle in vehicle.layout.axles:
            ratio = values.get(f"r_{axle}" if axle else "r", 1.0)
            values[f"c_s{axle}"] *= (1.0 + ratio) / 2
    gone = {*terms, *(refined for refined, base in REFINED.items() if base in terms)}
    dropped = {name for term in gone for name in parameters_of_term(term, vehicle.tracks, vehicle.layout)}
    kept = {name: value for name, value in values.items() if name not in dropped}
    return Vehicle(
        kept,
        model=vehicle.model,
        name=vehicle.name,
        cg_height=vehicle.cg_height,
        wheel_height=vehicle.wheel_height,
        roll_axis_height=vehicle.roll_axis_height,
    )


def is_nonlinear(term: str) -> bool:
    """Return whether a term adds nonlinear elements."""
    return term not in LINEAR_EXTRAS

"""An ordinary vehicle: usual values of every parameter and of every term, a start that does not depend on any fit.

Where a model lacks much of what a vehicle has, its fit may end at a vehicle that nobody would recognise; from there no term
that is missing is found.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from sprung.estimation import NEAR, UsualValue, VehicleSize, fit_linear, usual_vehicle
from sprung.selection.search import ModelSearch
from sprung.selection.starts import fit_structure, start_values
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import TERMS
from sprung.uncertainty import KnownValue
from sprung.vehicle import parameter_of

_SPREADS: Mapping[str, float] = {
    "m_s": 1.15,
    "I_yy": 1.4,
    "I_xx": 1.7,
    "m_u": 1.5,
    "k_s": 1.8,
    "k_t": 1.7,
    "c_s": 2.0,
    "a": 1.25,
    "b": 1.25,
    "t": 1.2,
}
"""Factors within which a parameter of an ordinary vehicle usually is, where only its size is known, by the first letters of its
name (Gillespie, Fundamentals of Vehicle Dynamics, 1992; Heydinger and others, SAE 1999-01-1336)."""

_FAR = 4.0
"""Standard deviations of its logarithm by which no parameter of an ordinary vehicle is off."""

ITERATIONS = 22
"""Of a fit from an ordinary vehicle, at the most."""

FIRST_ITERATIONS = 8
"""After which the fit of an ordinary vehicle has to have explained some of the misfit."""

_HELD = 1.1
"""Factor within which a parameter is held that means little where its term is small."""

_VIBRATES = ("m_", "I_", "k_", "c_")
"""First letters of the parameters by which a part that vibrates finds its frequency and damping: the others are its shape."""


def ordinary_vehicle(structure: ModelStructure) -> tuple[dict[str, float], dict[str, UsualValue]]:
    """Return an ordinary vehicle with the terms of a structure, each of its usual size.

    Parameters
    ----------
    structure
        The model.

    Returns
    -------
    values
        Parameters by name, SI.
    usual
        Usual values of all parameters that are not those of a load, with their spread.
    """
    own = usual_vehicle(VehicleSize.of(structure.known, structure.campaign.sensors, structure.layout))
    plain = structure.with_terms(())
    masses = {name: known.value for name, known in structure.known.items() if name in structure.names}
    own = {name: own[name] for name in plain.names if name in own} | masses
    values = start_values(structure, own)
    for term in structure.terms:
        usual_of = TERMS[term].usual
        if usual_of is not None:
            values |= {name: value for name, value in usual_of(own, structure).items() if name in values}
    usual = {
        name: UsualValue(values[name], spread)
        for name in plain.names
        for start, spread in _SPREADS.items()
        if name.startswith(start)
    }
    return values, usual | usual_sizes(structure, values)


def is_ordinary(search: ModelSearch) -> bool:
    """Whether the present fit is a vehicle as there are many: no parameter of the plain one is far from its usual value.

    Parameters
    ----------
    search
        The present model and its fit.

    Returns
    -------
    bool
    """
    _, usual = ordinary_vehicle(search.structure.with_terms(()))
    values = {name: max(search.fit.parameters[name], 0.0) for name in usual if name in search.fit.parameters}
    return all(_is_near(value, usual[name]) for name, value in values.items())


def may_be_astray(search: ModelSearch) -> bool:
    """Whether a fit may have ended at a wrong optimum: it leaves more than noise, or a vehicle that nobody would recognise.

    Parameters
    ----------
    search
        The present model and its fit.

    Returns
    -------
    bool
    """
    return search.is_overdispersed or not is_ordinary(search)


def is_astray(search: ModelSearch) -> bool:
    """Whether a fit has ended at a wrong optimum: it leaves more than noise, with a vehicle that nobody would recognise.

    A fit to little but what the body itself does, or with unlikely gains of the sensors, may leave little; noise it leaves not.

    Parameters
    ----------
    search
        The present model and its fit.

    Returns
    -------
    bool
    """
    return search.is_overdispersed and not is_ordinary(search)


def _is_near(value: float, usual: UsualValue) -> bool:
    """Whether a value is not far from a usual one."""
    factor: float = usual.spread**_FAR
    return usual.value / factor < value < usual.value * factor


def with_usual_scale(search: ModelSearch) -> dict[str, float]:
    """Return the parameters of the present fit, all masses and rates so much smaller or larger that its body is usual.

    Where nothing was weighed only what ballast changes shows the scale, and that only to a model that lacks nothing.

    Parameters
    ----------
    search
        The present model and its fit.

    Returns
    -------
    dict
        SI, by name; as they are where the vehicle was weighed, or its body may be that of a vehicle.
    """
    own, structure = dict(search.fit.parameters), search.structure
    if VehicleSize.of(structure.known, structure.campaign.sensors, structure.layout).weighed:
        return own
    _, usual = ordinary_vehicle(structure)
    if _is_near(own["m_s"], usual["m_s"]):
        return own
    factor = usual["m_s"].value / own["m_s"]
    return {name: value * factor if parameter_of(name).scales else value for name, value in own.items()}


def usual_sizes(structure: ModelStructure, values: Mapping[str, float]) -> dict[str, UsualValue]:
    """Return the usual values of the parameters of a structure's terms, where they are those of a vehicle's.

    Parameters
    ----------
    structure
        The model.
    values
        Parameters of a vehicle with terms of usual size, SI, by name.
    """
    return {
        name: UsualValue(values[name], TERMS[term].spread)
        for term in structure.terms
        for name in TERMS[term].parameters(structure.tracks, structure.layout)
        if values[name] > 0
    }


def held_sizes(structure: ModelStructure, values: Mapping[str, float]) -> dict[str, UsualValue]:
    """Return the usual values of parameters that mean little where their term is small, with a narrow spread.

    Parameters
    ----------
    structure, values
        As for `usual_sizes`.
    """
    held = tuple(TERMS[term].held for term in structure.terms if TERMS[term].held)
    usual = usual_sizes(structure, values)
    return {name: UsualValue(size.value, _HELD) for name, size in usual.items() if name.startswith(held)}


def fit_from_ordinary_vehicle(search: ModelSearch, structure: ModelStructure) -> ModelSearch:
    """Fit a linear structure from an ordinary vehicle that has its terms.

    Parameters
    ----------
    search
        The present model and its fit.
    structure
        What is fitted.

    Returns
    -------
    ModelSearch

    Notes
    -----
    The wheels first keep the masses of the ordinary vehicle, a part that vibrates by itself its shape or place, and the
    sensors read what they should: far from the recordings a fit gains most by shifting mass between body and wheels, by a mode
    of any shape, or by gains many times beyond their uncertainty, and does not come back.
    """
    values, _ = ordinary_vehicle(structure)
    models, sensors, known = structure.linear_models, structure.sensors, structure.known
    parts = [
        name
        for term in structure.terms
        if TERMS[term].explains_all
        for name in TERMS[term].parameters(structure.tracks, structure.layout)
    ]
    first = {
        name: KnownValue(values[name])
        for name in structure.names
        if name.startswith("m_u") or (name in parts and not name.startswith(_VIBRATES))
    }
    exact = [sensor.exact for sensor in sensors]
    # Where a fit makes the damping of a part vanish on its way, no derivative brings it back.
    usual = {name: size for name, size in usual_sizes(structure, values).items() if name not in first}
    held = fit_linear(
        search.decays, models, exact, {**first, **known}, start=values, usual=usual, enough=NEAR, most=ITERATIONS
    )
    fit = fit_linear(
        search.decays, models, sensors, known, start=held.parameters, usual=usual, enough=NEAR, most=ITERATIONS
    )
    return replace(search, structure=structure, fit=fit.after(search.fit))


def or_from_ordinary_vehicle(search: ModelSearch) -> ModelSearch:
    """Return the search, or its model as fitted from an ordinary vehicle where that explains more.

    A model that lacks something may have led the one with a further term to another optimum; and where drops hardly show roll,
    wheels may seem to be nowhere. A vehicle that nobody would recognise gives way to one as there are many whatever it gains.

    Parameters
    ----------
    search
        A model and its fit.

    Returns
    -------
    ModelSearch
        Of the same model.
    """
    is_stepped = search.structure.is_time_stepped
    other = _refit_from_usual_values(search) if is_stepped else fit_from_ordinary_vehicle(search, search.structure)
    enough = 0.0 if is_ordinary(other) and not is_ordinary(search) else search.required_of_switch
    return other if other.fit.converged and other.gain_over(search) > enough else search


def _refit_from_usual_values(search: ModelSearch) -> ModelSearch:
    """Fit a nonlinear model again from where its fit has ended, parameters that no vehicle has from usual values."""
    own, (_, usual) = search.fit.parameters, ordinary_vehicle(search.structure.with_terms(()))
    start = own | {name: size.value for name, size in usual.items() if name in own and not _is_near(own[name], size)}
    first = fit_structure(
        search.structure,
        search.decays,
        search.fit,
        NEAR,
        search.progress,
        beginning_only=True,
        most=FIRST_ITERATIONS,
        start=start,
    )
    return replace(search, fit=first).refit(search.structure)

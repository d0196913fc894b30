"""Fits of one model structure from where the fit of another one ended."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import FitResult, engine_mountings, fit_linear, fit_nonlinear
from sprung.preprocess import FreeDecay
from sprung.progress import Progress
from sprung.selection.linear_terms import ENGINE, FLEXIBLE_BODIES, OCCUPANTS
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import TERMS
from sprung.vehicle import (
    AXLES,
    NEUTRAL,
    LinearModel,
    Rows,
    coordinates,
    heave,
    is_nuisance,
    nonlinear_elements,
    parameter_name,
    state_variables,
    with_separate_tracks,
)

Real = NDArray[np.float64]

_BODY_FREQUENCIES, _SEAT_PLACES = (9.0, 12.0, 16.0), (0.3, 0.7)
"""Hz of twist and bending, and places of seats behind the front axle as parts of the wheelbase, where a fit may begin."""

_STOP_GAPS = (0.35, 0.6, 0.85)
"""Parts of the largest compression at which stops may be met, where a fit begins."""


def neutral_values(structure: ModelStructure, own: Mapping[str, float]) -> dict[str, float]:
    """Return a fitted vehicle by the parameters of a larger structure, whose further terms do nothing.

    Parameters
    ----------
    structure
        The larger one.
    own
        Fitted parameters by name, SI.

    Returns
    -------
    dict
        By name, SI.
    """
    springs = [(parameter_name(place, axle), parameter_name(place, axle, "2")) for place in "tn" for axle in AXLES]
    shared = {both: own[spring] for both, spring in springs if spring in own}
    undefined = [
        term.undefined(own, structure)
        for term in TERMS.values()
        if term.undefined is not None and term.name in structure.terms
    ]
    values = {**NEUTRAL}
    for part in (*undefined, with_separate_tracks(own), shared, own):
        values |= part
    # What was found of the sensors, which belong to no structure, holds for any.
    of_sensors = [name for name in own if is_nuisance(name) and name not in structure.names]
    return {name: values[name] for name in (*structure.names, *of_sensors)}


def start_values(structure: ModelStructure, own: Mapping[str, float]) -> dict[str, float]:
    """Return parameters from which a fit begins: those of a fitted vehicle, and first values of terms that it has not."""
    first: dict[str, float] = {}
    for name in structure.terms:
        start = TERMS[name].first
        first |= {} if start is None else start(own, structure)
    first |= own
    return {name: first.get(name, value) for name, value in neutral_values(structure, own).items()}


def states_by_coordinates(states: Real, before: Sequence[str], names: Sequence[str]) -> Real:
    """Return initial states by the coordinates of another structure; new masses rise as the body does.

    Parameters
    ----------
    states
        {X, Ẋ}, and memories where they are known, SI, shape (drop, state).
    before, names
        Parameters of the structure that they belong to, and of the other.
    """
    own, new = state_variables(before), state_variables(names)
    x, memories = np.split(states, [len(own)], axis=1)
    rises = dict(zip(coordinates(names), heave(names), strict=True))
    with_body = {variable: rises[variable[0]] * x[:, own.index(("z_s", variable[1]))] for variable in new}
    by_variable = with_body | dict(zip(own, x.T, strict=True))
    return np.column_stack([*(by_variable[variable] for variable in new), memories])


def fit_structure(
    structure: ModelStructure,
    decays: Sequence[FreeDecay],
    before: FitResult,
    enough: float,
    progress: Progress,
    states: Real | None = None,
    beginning_only: bool = False,
    most: int = 100,
    start: Mapping[str, float] | None = None,
) -> FitResult:
    """Fit a structure from where another one's fit ended.

    Parameters
    ----------
    structure
        What is fitted.
    decays
        The decays.
    before
        The fit of another structure, or of other decays.
    enough
        Expected gain in log-likelihood at which to stop.
    progress
        Called with each step that begins.
    states
        {X, Ẋ} of each drop at its first sample, SI, shape (drop, state), where these decays begin elsewhere than those of
        the fit before.
    beginning_only
        Whether the beginnings of the decays are enough; for nonlinear structures.
    most
        Largest number of iterations, likewise.
    start
        Parameters to begin with, SI, by name, instead of those of the fit before and first values of what it has not.

    Returns
    -------
    FitResult
    """
    sensors, known = structure.sensors, structure.known
    start = start_values(structure, before.parameters) if start is None else start
    if not structure.is_time_stepped:
        fitted = fit_linear(
            decays,
            structure.linear_models,
            sensors,
            known,
            start=start,
            # Levels of noise that eliminated unknowns couple take several rounds to settle.
            weights=None if before.iterate.at.coupling is None else before.weights,
            usual=structure.usual,
            enough=enough,
            most=most,
        )
        return fitted.after(before)
    states = states_by_coordinates(before.states if states is None else states, before.names, structure.names)
    fitted = fit_nonlinear(
        decays,
        structure.nonlinear_models,
        sensors,
        known,
        start=start,
        states=states,
        enough=enough,
        near=states.shape[1] > len(state_variables(structure.names)),
        beginning_only=beginning_only,
        most=most,
        tilting=structure.gravity_leakage,
        low_pass=structure.low_pass,
        usual=structure.usual,
        step_part=structure.step_part,
        progress=progress,
    )
    return fitted.after(before)


def stop_gaps(structure: ModelStructure, fit: FitResult, decays: Sequence[FreeDecay]) -> list[float]:
    """Return compressions at which stops may be met, m, from how far a fitted vehicle moves."""
    elements = nonlinear_elements(structure.tracks, ("bump-stop",), structure.wheelbase, layout=structure.layout)
    G = Rows.of([element.row for element in elements], fit.names).at(fit.values)
    motions = (fit.motion(drop, 0, decay.samples) for drop, decay in enumerate(decays))
    largest = max(float(-(G @ motion[: G.shape[1]]).min()) for motion in motions)
    return [part * largest for part in _STOP_GAPS] if largest > 0 else []


def usual_variants(term: str, structure: ModelStructure, own: Mapping[str, float]) -> list[ModelStructure]:
    """Return a structure with each of the starts that a term usually has: an engine may be mounted in several ways.

    A body may bend at several frequencies, and people sit at several places.
    """
    if term in FLEXIBLE_BODIES:
        return [replace(structure, body_frequency=frequency) for frequency in _BODY_FREQUENCIES]
    if term == OCCUPANTS:
        return [replace(structure, seat_place=place) for place in _SEAT_PLACES]
    if term != ENGINE:
        return [structure]
    mountings = engine_mountings(own.get("a", 0.0) + own.get("b", 0.0))
    return [replace(structure, engine_frequency=frequency, engine_place=place) for frequency, place in mountings]


def start_variants(term: str, structure: ModelStructure, own: Mapping[str, float]) -> list[ModelStructure]:
    """Return the structures with the usual starts of a term from which its fit may begin: all parts have mass there."""
    variants = usual_variants(term, structure, own)
    if term != ENGINE:
        return variants
    # They differ in their values alone: one compilation of the equations of motion serves all.
    return [variant for variant in variants if has_positive_masses(structure.linear_models, start_values(variant, own))]


def has_positive_masses(models: Mapping[str, LinearModel], values: Mapping[str, float]) -> bool:
    """Whether every part of a vehicle has mass, by the parameters of its equations of motion, SI."""
    masses = [model.matrices([values[name] for name in model.names]).M for model in models.values()]
    massive = next(iter(models.values())).massive
    return all(np.linalg.eigvalsh(M[:massive, :massive])[0] > 0 for M in masses)


def thinned(decays: Sequence[FreeDecay], rate: float, duration: float) -> tuple[list[FreeDecay], float]:
    """Return decays at about a rate in Hz and of at most a duration in s, and the part of all samples that they have."""
    thin = []
    for decay in decays:
        every = max(int(decay.rate / rate), 1)
        values = decay.values[:, : round(min(duration * decay.rate, decay.samples)) : every]
        thin.append(replace(decay, values=values, rate=decay.rate / every))
    return thin, sum(decay.samples for decay in thin) / sum(decay.samples for decay in decays)

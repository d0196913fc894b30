"""Candidates: what each extra brings to a model, where its fit starts, whether it can be and what it matters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import USUAL_ENGINE, FitResult, fit_linear, fit_nonlinear, mountings_of, wald_test
from sprung.preprocess import FreeDecay
from sprung.progress import Progress
from sprung.selection.structure import ModelStructure
from sprung.vehicle import (
    EXTRA_PARAMETERS,
    NEUTRAL,
    PARAMETERS,
    Rows,
    Tracks,
    coordinates,
    nonlinear_elements,
    parameters_of_term,
    with_separate_tracks,
)

Real = NDArray[np.float64]

SEPARATE = "tracks apart"
"""Springs and dampers at half-distances of their own, as one candidate among the extras."""

ENGINE = "engine"
"""An engine on mounts of its own."""

_TRAVEL = 0.002
"""m of travel at which a spring's force is the size of the friction from which a fit starts."""

_STIFFER = 10.0
"""How many times stiffer than the spring a friction is before it slides, at the start of a fit."""

_NOT_NEGATIVE = frozenset(name for name, told in PARAMETERS.items() if not (told.positive or told.signed))
"""Parameters of extras that cannot be below zero."""

_UNEVEN = ("ks", "kt", "cs")
"""Rates that may differ between left and right, by their names without the axle."""

_BY_CHANCE = 4.0
"""Likelihood ratio that a parameter below zero may have by chance: two standard errors, squared."""

_STROKE = 0.05
"""m of travel over which a progressive spring is judged."""

_MET = (0.35, 0.6, 0.85)
"""Parts of the largest compression at which stops may be met, where a fit begins."""

_SPECK = 1e-5
"""Part of the body that weighs so little that it changes nothing."""

_ENOUGH = 250.0
"""Samples per second, at least, that tell what an extra promises."""

_LONG_ENOUGH = 3.0
"""s of each decay that tell it."""


def fit_structure(
    choice: ModelStructure,
    decays: Sequence[FreeDecay],
    before: FitResult,
    enough: float,
    progress: Progress,
    states: Real | None = None,
    begun: bool = False,
    most: int = 100,
) -> FitResult:
    """Fit a model from where another one's fit ended.

    Parameters
    ----------
    choice
        The model.
    decays
        The decays.
    before
        Where the other fit of these decays ended.
    enough
        Expected gain in log-likelihood at which to stop.
    progress
        Called with each step that begins.
    states
        {X, Ẋ} of each drop at its first sample, shape (drop, state), where these decays begin elsewhere than those.
    begun
        Whether their beginnings will do.
    most
        Steps at the most.
    """
    states = carried_over(before.states if states is None else states, before.names, choice.names)
    sensors, known = choice.campaign.sensors, choice.known
    start = start_of(choice, before.parameters)
    if not choice.is_time_stepped:
        found = fit_linear(decays, choice.linear_models, sensors, known, start=start, enough=enough, most=most)
    else:
        found = fit_nonlinear(
            decays,
            choice.nonlinear_models,
            sensors,
            known,
            start=start,
            states=states,
            enough=enough,
            near=states.shape[1] > 2 * len(coordinates(choice.names)),
            begun=begun,
            most=most,
            tilting=choice.gravity_leakage,
            progress=progress,
        )
    return found.after(before)


def decided(choice: ModelStructure) -> list[str]:
    """Give what the records brought into the model."""
    tracks = [SEPARATE] if choice.tracks_open and choice.tracks == "separate" else []
    return [*tracks, *(extra for extra in choice.terms if extra in choice.open_terms)]


def without(choice: ModelStructure, extra: str) -> ModelStructure:
    """Give a model without an extra."""
    if extra == SEPARATE:
        return choice.with_terms(choice.terms, "shared")
    return choice.with_terms(tuple(one for one in choice.terms if one != extra))


def size_of(extra: str, p: Mapping[str, float]) -> float:
    """Give what an extra matters beside what it is an extra to, as a part."""
    parts: dict[str, Callable[[str], float]] = {
        SEPARATE: lambda axle: p[f"t_{axle}1"] / p[f"t_{axle}2"] - 1,
        "anti-roll": lambda axle: p[f"k_a{axle}"] / p[f"k_s{axle}"],
        "tyre-damping": lambda axle: p[f"c_t{axle}"] / p[f"c_s{axle}"],
        "gravity": lambda axle: p["w_h"] / p[f"k_s{axle}"],
        "friction": lambda axle: p[f"F_{axle}"] / (_TRAVEL * p[f"k_s{axle}"]),
        "rebound": lambda axle: p[f"r_{axle}"] - 1,
        "progressive": lambda axle: _STROKE * p[f"p_{axle}"],
        "bump-stop": lambda axle: p[f"k_b{axle}"] / p[f"k_s{axle}"],
        "asymmetry": lambda axle: max(abs(p[f"d_{rate}{axle}"] / p[f"{rate[0]}_{rate[1:]}{axle}"]) for rate in _UNEVEN),
        ENGINE: lambda _: p["m_e"] / p["m_s"],
        "rigid-axle": lambda axle: 1 - p[f"n_{axle}" if f"n_{axle}" in p else f"n_{axle}2"],
    }
    return max(abs(parts[extra](axle)) for axle in "fr")


def possible(extra: str, optimum: FitResult) -> bool:
    """Say whether an extra's parameters are what they can be: friction that drives is none, nor is a damper that does."""
    brought = () if extra == SEPARATE else EXTRA_PARAMETERS[extra]
    below = [name for name in _NOT_NEGATIVE.intersection(brought, optimum.names) if optimum.parameters[name] < 0]
    return not any(wald_test(optimum, [(name, 0.0)]) > _BY_CHANCE for name in below)


def brought(extra: str, tracks: Tracks) -> tuple[str, ...]:
    """Name the parameters that move on their own in the larger model only."""
    return ("t_f1", "t_r1") if extra == SEPARATE else parameters_of_term(extra, tracks)


def neutral(extra: str, tracks: Tracks) -> list[tuple[str, str | float]]:
    """Give what each parameter would have to be for the extra not to be there: a value, or another parameter."""
    if extra == SEPARATE:
        return [("t_f1", "t_f2"), ("t_r1", "t_r2")]
    return [(name, NEUTRAL[name]) for name in parameters_of_term(extra, tracks) if name in NEUTRAL]


def places_of_stops(choice: ModelStructure, optimum: FitResult, decays: Sequence[FreeDecay]) -> list[float]:
    """Give compressions, m, at which stops may be met, from how far a fitted vehicle moves."""
    rows = Rows.of([force.row for force in nonlinear_elements(choice.tracks, ("bump-stop",))], choice.names)
    G = rows.at(optimum.values)
    motions = (optimum.motion(i, 0, decay.samples) for i, decay in enumerate(decays))
    largest = max(float(-(G @ motion[: G.shape[1]]).min()) for motion in motions)
    return [part * largest for part in _MET] if largest > 0 else []


def variants(extra: str, choice: ModelStructure, own: Mapping[str, float]) -> list[ModelStructure]:
    """Give the places from which the fit of an extra may begin, where what it is an extra to says nothing of them."""
    if extra != ENGINE:
        return [choice]
    mountings = mountings_of(own["a"] + own["b"])
    return [one for one in (replace(choice, engine_mounting=each) for each in mountings) if has_masses(one, own)]


def has_masses(choice: ModelStructure, own: Mapping[str, float]) -> bool:
    """Say whether a fit begins with a vehicle of which every part has mass."""
    start = np.array(list(start_of(choice, own).values()))
    return all(np.linalg.eigvalsh(model.matrices(start).M)[0] > 0 for model in choice.linear_models.values())


def neutral_start(choice: ModelStructure, own: Mapping[str, float]) -> dict[str, float]:
    """Give the same vehicle by the names of a larger model; an engine is next to none, as without any it would be nowhere."""
    together = {name: own[f"{name}2"] for name in ("t_f", "t_r", "n_f", "n_r") if f"{name}2" in own}
    stiff = {f"s_{axle}": _STIFFER * own[f"k_s{axle}"] for axle in "fr"}
    stops = dict.fromkeys(("x_bf", "x_br"), choice.stop_gap)
    engine = choice.engine_mounting.engine(_SPECK * own["m_s"])
    known = {**NEUTRAL, **stiff, **stops, **engine, **with_separate_tracks(own), **together, **own}
    return {name: known[name] for name in choice.names}


def start_of(choice: ModelStructure, own: Mapping[str, float]) -> dict[str, float]:
    """Give where to start a model from: friction and engines that are not there yet start with some."""
    slid = {f"F_{axle}": _TRAVEL * own[f"k_s{axle}"] for axle in "fr"}
    begun = {**slid, **choice.engine_mounting.engine(USUAL_ENGINE * own["m_s"]), **own}
    return {name: begun.get(name, value) for name, value in neutral_start(choice, own).items()}


def carried_over(states: Real, before: Sequence[str], names: Sequence[str]) -> Real:
    """Give initial states by the coordinates of another model; an engine that is new moves as the body does.

    Parameters
    ----------
    states
        {X, Ẋ}, and memories where they are known, SI, shape (drop, state).
    before, names
        Parameters of the model that they belong to, and of the other.
    """
    own, other = coordinates(before), coordinates(names)
    X, V, memories = np.split(states, [len(own), 2 * len(own)], axis=1)
    chosen = [own.index(one) if one in own else 0 for one in other]
    return np.hstack([X[:, chosen], V[:, chosen], memories])


def thinned(decays: Sequence[FreeDecay]) -> tuple[list[FreeDecay], float]:
    """Take as many samples as tell what an extra promises, and give the part of all that they are."""
    thin = []
    for decay in decays:
        every = max(int(decay.rate / _ENOUGH), 1)
        values = decay.values[:, : int(_LONG_ENOUGH * decay.rate) : every]
        thin.append(replace(decay, values=values, rate=decay.rate / every))
    return thin, sum(decay.samples for decay in thin) / sum(decay.samples for decay in decays)

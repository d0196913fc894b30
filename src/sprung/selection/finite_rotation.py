"""Finite rotation: whether the recordings show that the body turns by finite angles, and how a load changes the geometry.

A simulated vehicle of the linear model has neither, a real one both. They have no parameter of their own: the recordings decide
by their likelihood, as about any term. What sensors read of it follows from the fitted motion and is subtracted from
the recordings.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from sprung.estimation import NEAR, FitResult
from sprung.preprocess import FreeDecay
from sprung.selection.linear_terms import GRAVITY
from sprung.selection.ordinary_vehicle import is_ordinary
from sprung.selection.search import ModelSearch
from sprung.selection.starts import fit_structure, start_values, thinned
from sprung.selection.stepwise import select_linear_terms
from sprung.selection.structure import ModelStructure
from sprung.selection.term_fits import fit_term
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import EMPTY, FULL, Heights, body_sinking, coordinates, finite_rotation_readings

Real = NDArray[np.float64]

_WHEEL_HEIGHT = 0.32
"""Height of wheel centres above the ground that is assumed where it is not stated, m: radii of loaded tyres of cars and vans
are 0.28 to 0.37 m (ETRTO Standards Manual). It only counts for the height of loads above the wheels; the other assumption is
that the loads are level with the centre of gravity."""

_PASSES = 2
"""Fits, each with the motion and the geometry of the one before; the second changes little."""

_RATE, _PART = 125.0, 0.5
"""Hz of the thinned decays in which the correction is tried first, several samples in a period of wheel hop; and the part of
all samples up to which that saves anything."""

_FIRST_ITERATIONS = 2
"""Iterations after which there has to be a gain: the optimum moves by a few standard errors only."""

REQUIRED_OF_ROTATION = float(chi2.isf(2 * 0.01 / 4, 1))
"""Gain in twice the log-likelihood that is required of finite rotation. Every vehicle turns so, which is no discovery: the gain
has to be more than chance brings in one of 100 vehicles of the linear model, where that is likeliest and the best of four
assumptions counts. Without parameters the gain of a wrong model is -d² ± 2d, which is above g most often where d² = g: it is
beyond √g standard deviations of a normal distribution. Parameters differ by less than a standard error there, while the pitch
inertia of a tall vehicle was ten off that turned with a gain of 10."""

_FEW, _BODY = 4, 2 * np.pi * 1.5
"""Drops that are enough for that, and usual own frequency of the body, 1/s."""

_Assumption = tuple[bool, bool]
"""Of a vehicle under a load: whether loads are level with the centre of gravity, where no heights are stated; and whether the
body rests lower on its wheels, not where it is levelled, or where a simulation keeps it level."""

_ASSUMPTIONS: tuple[_Assumption, ...] = ((True, False), (True, True), (False, True), (False, False))
"""What the recordings decide by their likelihood, the plainest first; the first two where heights are stated."""


def select_finite_rotation(search: ModelSearch, plain: ModelStructure) -> ModelSearch:
    """Return the search with the effects of finite rotation, if the recordings support them.

    Parameters
    ----------
    search
        Once the linear terms are decided.
    plain
        The structure without anything that the recordings brought into it: terms that made up for these effects are no longer
        needed beside them, and others show.

    Returns
    -------
    ModelSearch
    """
    found = _select(search, plain)
    if not found.is_overdispersed or GRAVITY not in search.open_terms([GRAVITY]):
        return found
    # How high the body turns above its wheels shows in what gravity does to it. Where drops hardly roll, neither explains
    # much without the other.
    high = fit_term(search, GRAVITY)
    gain = high.gain_over(search)
    if not high.fit.converged or gain < search.required(GRAVITY) or high.veto(GRAVITY):
        return found
    high = high.recorded({GRAVITY: gain}, True, True)
    other = _select(high, plain)
    return other if other is not high and other.gain_over(found) > search.required(GRAVITY) else found


def _select(search: ModelSearch, plain: ModelStructure) -> ModelSearch:
    """Return the search with the effects of finite rotation, if the recordings support them beside its terms."""
    structure = search.structure
    is_held = structure.campaign.heights.roll_axis_height is not None
    # It is that of a body that pitches and rolls.
    if structure.layout != FULL or structure.is_time_stepped or is_held or any(decay.clocks for decay in search.decays):
        return search
    # Angles are small: what is large is something else, a fault perhaps, which would be taken for it. And a vehicle that nobody
    # would recognise, in drops that hardly roll above all, has no geometry that tells anything.
    if search.is_misfit_large or not is_ordinary(search):
        return search
    recorded = search.decays
    plainest, *others = _ASSUMPTIONS[:2] if structure.campaign.heights.has_effect else _ASSUMPTIONS
    if _loses_much(search, plainest, _drops_that_turn_most(search.fit)):
        return search
    first, assumption = _corrected(search, recorded, plainest, passes=1, most=_enough_to_tell(search)), plainest
    if not search.is_overdispersed and _promised(first.fit) > search.fit.loglikelihood:
        first = _corrected(search, recorded, plainest, passes=1, most=_FIRST_ITERATIONS)
    if first.fit.loglikelihood > search.fit.loglikelihood:
        # Assumptions are compared once each has the geometry that it leads to itself.
        tried = [_corrected(first, recorded, plainest, passes=1, most=_FIRST_ITERATIONS)]
        tried += [_corrected(search, recorded, one, most=_FIRST_ITERATIONS) for one in others]
        likeliest = max(range(len(tried)), key=lambda i: tried[i].fit.loglikelihood)
        first, assumption = tried[likeliest], (plainest, *others)[likeliest]
    if first.gain_over(search) <= REQUIRED_OF_ROTATION:
        return search
    turned = _without_unneeded(_corrected(first, recorded, assumption), recorded, assumption)
    if plain.names != structure.names and turned.is_overdispersed:
        base = _with_geometry(replace(plain, carried_at=structure.carried_at), turned.fit.parameters, assumption)
        again = select_linear_terms(replace(turned.refit(base), steps=search.steps))
        anew = _corrected(again, recorded, assumption)
        turned = anew if anew.delta_bic(turned) > 0 else replace(turned, steps=anew.steps)
    return turned if turned.gain_over(search) > REQUIRED_OF_ROTATION else search


def _drops_that_turn_most(fit: FitResult) -> list[int]:
    """Return the positions of the drops in which the body turns furthest: the effects go with its square."""
    every, states = coordinates(fit.names), fit.states
    own = np.array([every.index("theta"), every.index("phi")])
    angles, rates = states[:, own], states[:, len(every) + own]
    turned = (angles**2 + (rates / _BODY) ** 2).sum(axis=1)
    return sorted(np.argsort(-turned, kind="stable")[:_FEW].tolist())


def _loses_much(search: ModelSearch, assumption: _Assumption, drops: Sequence[int]) -> bool:
    """Whether the correction loses so much in a part of the samples that it cannot gain in all of them."""
    decays = [search.decays[drop] for drop in drops]
    thin, part = thinned(decays, _RATE, np.inf)
    if part > _PART or any(decay.pads for decay in decays):  # of a driven record the lines count, not the samples
        return False
    fit, structure = search.fit, _with_geometry(search.structure, search.fit.parameters, assumption)
    motions = [
        fit.motion(drop, 0, decay.samples)[:, :: round(decay.rate / one.rate)]
        for drop, decay, one in zip(drops, decays, thin, strict=True)
    ]
    corrected = _without_rotation(structure, fit, thin, motions)
    before, after = (
        _promised(fit_structure(own, decays, fit, NEAR, search.progress, most=_enough_to_tell(search)))
        for own, decays in ((search.structure, thin), (structure, corrected))
    )
    return 2 * (after - before) < -search.required_of_switch


def _enough_to_tell(search: ModelSearch) -> int:
    """Return the iterations that tell what the correction gains: where only noise is left, one and what the next promises.

    A step from where the geometry was another one promises less than it gains.
    """
    return _FIRST_ITERATIONS if search.is_overdispersed else 1


def _promised(fit: FitResult) -> float:
    """Return the log-likelihood to which one Newton step leads."""
    return fit.loglikelihood + 0.5 * fit.remaining_gain


def _corrected(
    search: ModelSearch, recorded: Sequence[FreeDecay], assumption: _Assumption, passes: int = _PASSES, most: int = 100
) -> ModelSearch:
    """Subtract what finite rotation adds to the recordings of the fitted motion, and fit again.

    Parameters
    ----------
    search
        With the motion.
    recorded
        The decays without any correction, which begin where those of the search do.
    assumption
        On what no recording tells by itself.
    passes
        How many fits, each with the motion of the one before.
    most
        Largest number of iterations of each fit.
    """
    for _ in range(passes):
        fit, structure = search.fit, _with_geometry(search.structure, search.fit.parameters, assumption)
        motions = [fit.motion(drop, 0, decay.samples) for drop, decay in enumerate(recorded)]
        decays = _without_rotation(structure, fit, recorded, motions)
        fitted = fit_structure(structure, decays, fit, NEAR, search.progress, most=most)
        search = replace(search, structure=structure, fit=fitted, decays=tuple(decays))
    return search


def _without_unneeded(search: ModelSearch, recorded: Sequence[FreeDecay], assumption: _Assumption) -> ModelSearch:
    """Leave out terms that made up for finite rotation: what a part that hardly weighs does is no motion of the body's."""
    unneeded = [term for term in search.selected if not search.needs(term)]
    if not unneeded:
        return search
    for term in unneeded:
        search = search.recorded({term: search.wald_gain(term)}, True, False, search.veto(term))
    return _corrected(search.refit(search.without(*unneeded)), recorded, assumption)


def _without_rotation(
    structure: ModelStructure, fit: FitResult, recorded: Sequence[FreeDecay], motions: Sequence[Real]
) -> list[FreeDecay]:
    """Subtract from decays what finite rotation adds to their motions, {X, Ẋ} of shape (state, time) each."""
    loads = {load.name: load for load in structure.campaign.loads}
    decays = list(recorded)
    for load, rate in dict.fromkeys((decay.load, decay.rate) for decay in recorded):
        drops = [drop for drop, decay in enumerate(recorded) if (decay.load, decay.rate) == (load, rate)]
        readings = finite_rotation_readings(
            structure.linear_models[load],
            structure.tracks,
            structure.heights_of(load),
            loads[load],
            structure.campaign.sensors,
            fit.values[: len(structure.names)],  # without what was found of the sensors
            [motions[drop] for drop in drops],
            1 / rate,
        )
        for drop, reading in zip(drops, readings, strict=True):
            decays[drop] = replace(recorded[drop], values=recorded[drop].values - reading)
    return decays


def _with_geometry(
    structure: ModelStructure, parameters: Mapping[str, float], assumption: _Assumption
) -> ModelStructure:
    """Return a structure with the heights that a fitted vehicle shows, and with the sinking of its body under each load."""
    (is_load_level, sinks), stated = assumption, structure.campaign.heights
    own = start_values(structure, parameters)
    assumed = None
    if not stated.has_effect:
        arm = own["w_h"] / (STANDARD_GRAVITY * own["m_s"]) if "w_h" in own else 0.0
        centre = stated.cg_height or (_mean_load_height(structure) if is_load_level else None)
        wheels = stated.wheel_height or (centre - arm if centre else _WHEEL_HEIGHT)
        assumed = Heights(wheels + arm, wheels)
    structure = replace(structure, assumed_heights=assumed, sinking={})
    values = np.array([own[name] for name in structure.names])
    if not sinks:
        return structure
    models = structure.linear_models
    sinking = {
        load: body_sinking(models[EMPTY.name], model, structure.tracks, values) for load, model in models.items()
    }
    return replace(structure, sinking=sinking)


def _mean_load_height(structure: ModelStructure) -> float | None:
    """Return the mean height of the items on the body above the ground, m; None without any."""
    items = [
        (item.mass, item.position[2])
        for load in structure.campaign.loads
        for item in load.items
        if item.position is not None
    ]
    mass = sum(mass for mass, _ in items)
    return sum(mass * height for mass, height in items) / mass if mass else None

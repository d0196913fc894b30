"""Scores: what forces beside the linear vehicle would gain, told where the linear vehicle was fitted, without any step of time.

A small force changes a linear motion by what it would do alone. So its response is one filter for each mode, the derivatives
of everything that was fitted are sums of exponentials, and what is left of the one beside the other is the score (Rao, Proc.
Camb. Phil. Soc. 44 (1948) 50). Every campaign is asked this, so it has to be quick.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from sprung.estimation.closed_form import LikelihoodAt
from sprung.estimation.expm_likelihood import reach
from sprung.estimation.fit import FitResult
from sprung.estimation.problem import identifiable_subspace
from sprung.preprocess import FreeDecay
from sprung.vehicle import ElementInput, NonlinearModel

Real = NDArray[np.float64]

_ENOUGH = 250.0
"""Samples per second, at least, that tell it: only every so many are looked at."""


def score_nonlinear_terms(
    optimum: FitResult,
    models: Mapping[str, NonlinearModel],
    values: Mapping[str, float],
    candidates: Mapping[str, Sequence[str]],
) -> dict[str, float]:
    """Score forces beside a linear vehicle that is fitted already.

    Parameters
    ----------
    summit
        Where the linear fit ended.
    models
        Equations of motion by load name with all the forces.
    values
        Their parameters where the forces are none, SI, by name.
    candidates
        By name the parameters that one of them brings; those that do not matter where there is no force may be among them.

    Returns
    -------
    dict
        What each would gain in twice the log-likelihood, to second order; 0 where modal coordinates do not exist.

    Raises
    ------
    TypeError
        If the summit is not that of a linear fit.
    """
    place, priors = optimum.point.place, optimum.problem.priors
    if not isinstance(place, LikelihoodAt):
        raise TypeError("scores start from a linear fit")
    brought = list(dict.fromkeys(name for names in candidates.values() for name in names))
    sums = [
        _of_drop(optimum, place, residual, decay, i, models[decay.load], values, brought)
        for i, (residual, decay) in enumerate(zip(optimum.residuals, optimum.decays, strict=True))
    ]
    information, gradient = (np.sum(each, axis=0) for each in zip(*sums, strict=True))
    own = len(optimum.names)
    u = optimum.point.u
    slopes, prior, free = priors.coordinates.slopes(u), priors.prior(u), priors.free(u)
    basis = slopes[:, None] * free
    within = basis.T @ information[:own, :own] @ basis + free.T @ prior.slopes.T @ prior.slopes @ free
    told = identifiable_subspace(within)
    across = (basis @ told).T @ information[:own, own:]
    carried = np.linalg.solve(told.T @ within @ told, across)
    left = information[own:, own:] - across.T @ carried
    score = gradient[own:] - carried.T @ (
        (basis @ told).T @ gradient[:own] + told.T @ free.T @ prior.slopes.T @ prior.residual
    )
    found = {}
    for name, names in candidates.items():
        those = [brought.index(one) for one in names if left[brought.index(one), brought.index(one)] > 0]
        system = left[np.ix_(those, those)]
        found[name] = float(score[those] @ np.linalg.pinv(system, hermitian=True) @ score[those])
    return found


def _of_drop(
    optimum: FitResult,
    place: LikelihoodAt,
    residual: Real,
    decay: FreeDecay,
    position: int,
    model: NonlinearModel,
    values: Mapping[str, float],
    brought: Sequence[str],
) -> tuple[Real, Real]:
    """Give information and gradient of the fitted parameters and of those that are brought, of one drop."""
    weights = optimum.point.weights
    run, group = place.run_of(position)
    load, step, samples = int(run.load[group]), float(run.step[group]), decay.samples
    poles, left, shapes = place.modes.poles[load], place.modes.left[load], place.modes.shapes[load]
    state = optimum.states[position]
    motion = place.motion(weights, position, 0, samples)

    # What the forces are per unit of each parameter, and how every mode answers them.
    here = np.array([values[name] for name in model.names])
    G = model.forces.rows.at(here)
    X, V = np.split(motion, 2)
    travel, rate = G @ (X + model.sag(here)[:, None]), G @ V
    way = np.diff(travel, axis=1, prepend=travel[:, :1] - step * rate[:, :1])
    felt = ElementInput(travel.T, rate.T, way.T, np.zeros_like(travel.T))
    chosen = [model.names.index(name) for name in brought]
    unit = model.forces.differentiate(here, felt)[0][:, :, chosen]
    pushes = -np.linalg.solve(model.linear.matrices(here).M, G.T)
    into = left[:, len(X) :] @ pushes
    modal = np.einsum("jf,tfb->jbt", into, unit, optimize=True)
    answers = np.empty(modal.shape, dtype=np.complex128)
    for j, pole in enumerate(poles):
        turn = np.exp(pole * step)
        held = (turn - 1) / pole
        rising = (held / step - 1) / pole
        answers[j] = lfilter([rising, held - rising], [1.0, -turn], modal[j], axis=-1)

    every = max(int(decay.rate / _ENOUGH), 1)
    at = np.arange(0, samples, every)
    S = place.likelihood.sensors.at(place.values)
    forced = np.einsum("cj,jbt->tcb", shapes, answers[:, :, at], optimize=True).real
    forced += np.einsum("cf,tfb->tcb", S @ pushes, unit[at], optimize=True)
    waves = np.exp(np.multiply.outer(at, poles * step))
    driven = waves * (left @ state)
    slopes = place.slopes_of(position)
    fitted = (np.hstack([driven, driven * at[:, None]]) @ slopes.reshape(-1, slopes.shape[-1]).T).real.reshape(
        len(at), *slopes.shape[:2]
    )
    starts = (shapes[:, None, :] * left.T[None]).reshape(-1, len(poles))
    begun = (waves @ starts.T).real.reshape(len(at), len(shapes), len(poles))
    whole = np.concatenate([fitted, forced, begun, np.nan_to_num(residual)[:, at].T[:, :, None]], axis=2)
    whole = (whole - whole.mean(axis=0)) * np.sqrt(weights * run.present)[:, None]
    flat = whole.reshape(-1, whole.shape[2])
    products = flat.T @ flat * (samples / len(at))
    count = fitted.shape[2] + forced.shape[2]
    across, within = products[:count, count:-1], products[count:-1, count:-1] + np.diag(reach(len(state)) ** -2.0)
    taken = np.linalg.solve(within, np.column_stack([across.T, products[count:-1, -1]]))
    information = products[:count, :count] - across @ taken[:, :-1]
    return information, products[:count, -1] - across @ taken[:, -1]

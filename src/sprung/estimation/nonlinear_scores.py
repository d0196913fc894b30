"""Score tests of nonlinear forces beside a fitted linear vehicle, without any step of time.

A small force changes a linear motion by what it would do alone. So its response is one filter for each mode, the derivatives
of everything that was fitted are sums of exponentials, and what the one leaves beside the other is the score. Every campaign is
tested for these forces, so it has to be quick.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from sprung.estimation.elimination import eliminate
from sprung.estimation.fit_result import FitResult
from sprung.estimation.objective import HasModalResponse
from sprung.estimation.projected_response import initial_state_prior_std
from sprung.estimation.records import channel_rate_ratios
from sprung.estimation.score_test import score_added
from sprung.vehicle import ElementInput, NonlinearModel, highest_derivatives, state_matrix

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_RATE = 250.0
"""Samples per second, at least, that are enough: the others are left out."""


def score_nonlinear_terms(
    fit: FitResult,
    models: Mapping[str, NonlinearModel],
    values: Mapping[str, float],
    candidates: Mapping[str, Sequence[str]],
) -> dict[str, tuple[float, dict[str, float]]]:
    """Return what nonlinear forces would gain in a fitted linear vehicle, by :term:`score tests <score test>`, and their sizes.

    Parameters
    ----------
    fit
        Of the linear vehicle.
    models
        Equations of motion by load name with all the forces.
    values
        Their parameters where the forces are zero, SI, by name.
    candidates
        By name the parameters that each force brings; those that do not matter where there is no force may be among them.

    Returns
    -------
    dict
        By candidate: the gain in twice the log-likelihood, to second order, 0 where modal coordinates do not exist; and the
        estimates of its parameters by one Newton step, SI, by name.
    """
    match fit.iterate.at:
        case HasModalResponse() as at:
            brought = list(dict.fromkeys(name for names in candidates.values() for name in names))
            drops = range(len(fit.decays))
            systems = [_of_drop(fit, at, drop, models[fit.decays[drop].load], values, brought) for drop in drops]
            information, gradient = (np.sum(parts, axis=0) for parts in zip(*systems, strict=True))
            test = score_added(fit, gradient, information)
            scores = {}
            for term, names in candidates.items():
                own = [brought.index(name) for name in names]
                step = test.joint_values(own)
                estimates = {name: values[name] + float(step[i]) for name, i in zip(names, own, strict=True)}
                scores[term] = (test.gain(own), estimates)
            return scores
        case _:
            return {term: (0.0, {name: values[name] for name in names}) for term, names in candidates.items()}


def _of_drop(
    fit: FitResult,
    at: HasModalResponse,
    drop: int,
    model: NonlinearModel,
    values: Mapping[str, float],
    brought: Sequence[str],
) -> tuple[Real, Real]:
    """Return information and gradient of the fitted parameters and of those that are brought, of one drop."""
    decay, residual = fit.decays[drop], fit.residuals[drop]
    step, samples = 1.0 / decay.rate, decay.samples
    poles, left, shapes, derivatives = at.response_of(drop)
    state, motion = fit.states[drop], fit.motion(drop, 0, samples)
    neutral = np.array([values[name] for name in model.names])
    force_rows = -np.linalg.solve(model.linear.matrices(neutral).leading, model.forces.rows.at(neutral).T)
    unit = _unit_forces(model, neutral, motion, step, [model.names.index(name) for name in brought])

    every = max(int(decay.rate / _RATE), 1)
    chosen = np.arange(0, samples, every)
    driven_states = highest_derivatives(len(force_rows), model.linear.massive)
    responses = _modal_responses(poles, left[:, driven_states] @ force_rows, unit, step)
    forced = np.einsum("cj,jbt->tcb", shapes, responses[:, :, chosen], optimize=True).real
    forced += np.einsum("cf,tfb->tcb", at.sensor_rows @ force_rows, unit[chosen], optimize=True)
    waves = np.exp(np.multiply.outer(chosen, poles * step))
    driven = waves * (left @ state)
    flat = derivatives.reshape(-1, derivatives.shape[-1])
    fitted = (np.hstack([driven, driven * chosen[:, None]]) @ flat.T).real
    fitted = fitted.reshape(len(chosen), *derivatives.shape[:2])
    by_state = (waves @ (shapes[:, None, :] * left.T[None]).reshape(-1, len(poles)).T).real
    by_state = by_state.reshape(len(chosen), len(shapes), len(poles))
    columns = [fitted, forced, by_state, np.nan_to_num(residual)[:, chosen].T[:, :, None]]
    whole = np.concatenate(columns, axis=2)
    counted = decay.usable * channel_rate_ratios(decay)
    whole = (whole - whole.mean(axis=0)) * np.sqrt(fit.weights * counted)[:, None]
    rows = whole.reshape(-1, whole.shape[2])
    products = rows.T @ rows * (samples / len(chosen))
    count = fitted.shape[2] + forced.shape[2]
    products[count:-1, count:-1] += np.diag(initial_state_prior_std(len(force_rows), len(state)) ** -2.0)
    information, gradient, _ = eliminate(products[:-1, :-1], products[:-1, -1], count)
    return information, gradient


def _unit_forces(model: NonlinearModel, values: Real, motion: Real, step: float, chosen: Sequence[int]) -> Real:
    """Return the forces per unit of each chosen parameter along a motion, shape (time, force, parameter)."""
    rows = model.forces.rows.at(values)
    n = rows.shape[1]
    velocity = state_matrix(model.linear.accelerations(values)[0], model.linear.massive)[:n] @ motion
    travel, rate = rows @ (motion[:n] + model.sag(values)[:, None]), rows @ velocity
    way = np.diff(travel, axis=1, prepend=travel[:, :1] - step * rate[:, :1])
    felt = ElementInput(travel.T, rate.T, way.T, np.zeros_like(travel.T))
    return np.asarray(model.forces.differentiate(values, felt)[0][:, :, list(chosen)])


def _modal_responses(poles: Complex, participation: Complex, forces: Real, step: float) -> Complex:
    """Return the response of every mode to forces that run straight between samples, shape (mode, parameter, time)."""
    modal = np.einsum("jf,tfb->jbt", participation, forces, optimize=True)
    responses = np.empty(modal.shape, dtype=np.complex128)
    for j, pole in enumerate(poles):
        turn = np.exp(pole * step)
        held = (turn - 1) / pole if pole else step
        rising = (held / step - 1) / pole if pole else step / 2
        responses[j] = lfilter([rising, held - rising], [1.0, -turn], modal[j], axis=-1)
    return responses

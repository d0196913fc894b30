"""Score tests of nonlinear forces beside a fitted linear vehicle, without any step of time.

A small force changes a linear motion by what it would do alone. So its response is one filter for each mode, the derivatives
of everything that was fitted are sums of exponentials, and what the one leaves beside the other is the score. Every campaign is
tested for these forces, so it has to be quick.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from sprung.estimation.elimination import eliminate
from sprung.estimation.fit_result import FitResult
from sprung.estimation.objective import HasModalResponse
from sprung.estimation.projected_response import initial_state_prior_std
from sprung.estimation.records import channel_rate_ratios
from sprung.estimation.score_test import score_added
from sprung.vehicle import ElementInput, NonlinearModel
from sprung.vibration import exponentials, real_product

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
    decay = fit.decays[drop]
    every = max(int(decay.rate / _RATE), 1)
    step, samples = every / decay.rate, -(-decay.samples // every)
    poles, left, shapes, derivatives = at.response_of(drop)
    # A pole and its conjugate add the same real part twice, so that one of them is enough.
    upper = poles.imag >= 0
    poles, left, shapes = poles[upper], left[upper], shapes[:, upper] * np.where(poles[upper].imag > 0, 2.0, 1.0)
    derivatives = derivatives[..., np.tile(upper, 2)] * np.tile(np.where(poles.imag > 0, 2.0, 1.0), 2)
    state, motion = fit.states[drop], fit.motion(drop, 0, decay.samples)[:, ::every]
    neutral = np.array([values[name] for name in model.names])
    force_rows = -np.linalg.solve(model.linear.matrices(neutral).M, model.forces.rows.at(neutral).T)
    participation, direct = left[:, len(motion) // 2 :] @ force_rows, at.sensor_rows @ force_rows

    columns = derivatives.shape[1], len(brought), len(state)
    whole = np.zeros((sum(columns) + 1, len(shapes), samples))
    fitted, forced, by_state, residual = np.split(whole, np.cumsum(columns))
    waves = exponentials(poles * step, samples)
    # The secular terms count the samples of the decay.
    secular = waves * (every * np.arange(samples))[:, None]
    amplitudes = left @ state
    coefficients = np.swapaxes(derivatives * np.tile(amplitudes, 2), 0, 1)
    fitted[:] = real_product(coefficients, np.hstack([waves, secular]))
    by_state[:] = real_product(left.T[:, None, :] * shapes, waves)
    residual[0] = np.nan_to_num(fit.residuals[drop][:, ::every])
    for name, own, forces in _unit_forces(model, neutral, motion, step):
        if name in brought:
            modal = np.asarray(participation[:, own] @ forces, dtype=np.complex128)
            responses = _modal_responses(poles, modal, step)
            forced[brought.index(name)] += real_product(shapes, responses.T) + direct[:, own] @ forces

    whole -= whole.mean(axis=2, keepdims=True)
    whole *= np.sqrt(fit.weights * decay.usable * channel_rate_ratios(decay))[:, None]
    rows = whole.reshape(len(whole), -1)
    products = rows @ rows.T * (decay.samples / samples)
    count = columns[0] + columns[1]
    products[count:-1, count:-1] += np.diag(initial_state_prior_std(len(state)) ** -2.0)
    information, gradient, _ = eliminate(products[:-1, :-1], products[:-1, -1], count)
    return information, gradient


def _unit_forces(
    model: NonlinearModel, values: Real, motion: Real, step: float
) -> Iterator[tuple[str, list[int], Real]]:
    """Yield parameters, the rows on which each acts and their forces per unit of it along a motion, (row, time).

    Parameters without any force are left out: what has no stiffness has no clearance that matters.
    """
    rows = model.forces.rows.at(values)
    X, V = np.split(motion, 2)
    travel, rate = (rows @ (X + model.sag(values)[:, None])).T, (rows @ V).T
    way = np.diff(travel, axis=0, prepend=travel[:1] - step * rate[:1])
    for law, chosen, _, positions in model.forces.laws:
        felt = ElementInput(*(part[:, chosen] for part in (travel, rate, way, np.zeros_like(travel))))
        at = np.arange(model.forces.number)[chosen]
        by_parameter, _ = law.differentiate(values[positions], felt)
        for of_elements, forces in zip(positions, by_parameter, strict=True):
            for position in np.unique(of_elements).tolist() if forces.any() else ():
                own = np.flatnonzero(of_elements == position)
                yield model.names[position], at[own].tolist(), forces[:, own].T


def _modal_responses(poles: Complex, modal: Complex, step: float) -> Complex:
    """Return the response of every mode to modal forces that run straight between samples; both of shape (mode, time)."""
    turn = np.exp(poles * step)
    held = (turn - 1) / poles
    rising = (held / step - 1) / poles
    filters = zip(rising, held, turn, modal, strict=True)
    return np.array([lfilter([now, whole - now], [1.0, -z], force) for now, whole, z, force in filters])

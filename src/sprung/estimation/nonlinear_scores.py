"""Score tests of nonlinear forces beside a fitted linear vehicle, without any step of time.

A small force changes a linear motion by what it would do alone. So its response is one filter for each mode, the derivatives
of everything that was fitted are sums of exponentials, and what the one leaves beside the other is the score. Every campaign is
tested for these forces, so it has to be quick.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.closed_form_likelihood import ClosedFormAt
from sprung.estimation.elimination import eliminate
from sprung.estimation.fit_result import FitResult
from sprung.estimation.projected_response import initial_state_prior_std
from sprung.estimation.records import channel_rate_ratios
from sprung.estimation.score_test import score_added
from sprung.vehicle import ElementInput, NonlinearModel, highest_derivatives
from sprung.vibration import exponentials

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_RATE = 250.0
"""Samples per second, at least, that are enough: the others are left out."""

_LARGEST_POWER = 300.0
"""Powers of e that a number in double precision holds, and its inverse."""


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
    at = fit.iterate.at.modal
    if at is None:
        return {term: (0.0, {name: values[name] for name in names}) for term, names in candidates.items()}
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


def _of_drop(
    fit: FitResult,
    at: ClosedFormAt,
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
    force_rows = -np.linalg.solve(model.linear.matrices(neutral).leading, model.forces.directions(neutral).T)
    driven = highest_derivatives(len(force_rows), model.linear.massive)
    participation, direct = left[:, driven] @ force_rows, at.sensor_rows @ force_rows

    # What was fitted are sums of exponentials, and the samples of these are all that is needed of them.
    waves = exponentials(poles * step, samples)
    basis = np.hstack([waves, waves * (every * np.arange(samples))[:, None]]).view(float).T
    basis = basis - basis.mean(axis=1, keepdims=True)
    by_parameter = np.swapaxes(derivatives * np.tile(left @ state, 2), 0, 1)
    by_state = left.T[:, None, :] * shapes
    by_state = np.concatenate([by_state, np.zeros_like(by_state)], axis=2)
    sums = np.ascontiguousarray(np.concatenate([by_parameter, by_state]).conj()).view(float)

    sampled = np.zeros((len(shapes), len(brought) + 1, samples))
    sampled[:, -1] = np.nan_to_num(fit.residuals[drop][:, ::every])
    powers = _powers(poles * step, samples)
    for name, own, forces in _unit_forces(model, neutral, motion, step):
        if name in brought:
            response = _response(poles, participation[:, own], shapes, forces, step, powers)
            sampled[:, brought.index(name)] += response + direct[:, own] @ forces
    sampled -= sampled.mean(axis=2, keepdims=True)

    weights = fit.weights * decay.usable * channel_rate_ratios(decay) * (decay.samples / samples)
    weighted = (weights[:, None] * sums).reshape(len(sums), -1)
    among_sums = weighted @ (sums @ (basis @ basis.T)).reshape(len(sums), -1).T
    across = weighted @ np.swapaxes(sampled @ basis.T, 1, 2).reshape(weighted.shape[1], -1)
    among_sampled = np.tensordot(weights, sampled @ np.swapaxes(sampled, 1, 2), 1)
    products = np.block([[among_sums, across], [across.T, among_sampled]])
    own_state = np.arange(len(by_parameter), len(sums))
    products[own_state, own_state] += initial_state_prior_std(len(force_rows), len(state)) ** -2.0
    # The initial state is eliminated.
    kept = np.delete(np.arange(len(products) - 1), own_state)
    order = np.concatenate([kept, own_state])
    information, gradient, _ = eliminate(products[np.ix_(order, order)], products[order, -1], len(kept))
    return information, gradient


def _unit_forces(
    model: NonlinearModel, values: Real, motion: Real, step: float
) -> Iterator[tuple[str, list[int], Real]]:
    """Yield parameters, the rows on which each acts and their forces per unit of it along a motion, (row, time).

    Parameters without any force are left out: what has no stiffness has no clearance that matters.
    """
    rows = model.forces.rows.at(values)
    travel = (rows @ (motion[: rows.shape[1]] + model.sag(values)[:, None])).T
    rate = (rows @ model.linear.velocities(values) @ motion).T
    way = np.diff(travel, axis=0, prepend=travel[:1] - step * rate[:1])
    for law, chosen, _, positions in model.forces.laws:
        felt = ElementInput(*(part[:, chosen] for part in (travel, rate, way, np.zeros_like(travel))))
        at = np.arange(model.forces.number)[chosen]
        by_parameter, _ = law.differentiate(values[positions], felt)
        for of_elements, forces in zip(positions, by_parameter, strict=True):
            for position in np.unique(of_elements).tolist() if forces.any() else ():
                own = np.flatnonzero(of_elements == position)
                yield model.names[position], at[own].tolist(), np.ascontiguousarray(forces[:, own].T)


def _response(
    poles: Complex, participation: Complex, shapes: Complex, forces: Real, step: float, powers: tuple[Complex, Complex]
) -> Real:
    """Return the response of the channels to forces that run straight between samples, shape (channel, time)."""
    held = np.expm1(poles * step) / poles
    rising = (held / step - 1) / poles
    both = np.vstack([forces, np.hstack([np.zeros((len(forces), 1)), forces[:, :-1]])])
    weights = np.hstack([participation * rising[:, None], participation * (held - rising)[:, None]])
    # As products of real matrices: one of a complex matrix with a real one is made sample by sample.
    drive = np.empty((len(poles), both.shape[1]), dtype=np.complex128)
    drive.real, drive.imag = weights.real @ both, weights.imag @ both
    modal = _accumulated(drive, np.exp(poles * step), powers)
    return np.asarray(shapes.real @ modal.real - shapes.imag @ modal.imag, dtype=np.float64)


def _powers(exponent: Complex, samples: int) -> tuple[Complex, Complex]:
    """Return e^{λk} and its inverse for as many samples as numbers hold both, each of shape (mode, time)."""
    length = min(samples, max(int(_LARGEST_POWER / np.abs(exponent.real).max()), 1))
    powers, inverse = (np.ascontiguousarray(exponentials(way, length).T) for way in (exponent, -exponent))
    return powers, inverse


def _accumulated(drive: Complex, turn: Complex, powers: tuple[Complex, Complex]) -> Complex:
    """Return y of y(k) = z y(k-1) + d(k), from d of shape (mode, time), z of shape (mode,), its powers and their inverse.

    That is z^k times the sum of d(i)/z^i up to k, over as many samples as there are powers.
    """
    growth, inverse = powers
    parts, last = [], np.zeros_like(turn)
    for begin in range(0, drive.shape[1], growth.shape[1]):
        part = drive[:, begin : begin + growth.shape[1]]
        part = part * inverse[:, : part.shape[1]]
        part[:, 0] += turn * last
        np.cumsum(part, axis=1, out=part)
        part *= growth[:, : part.shape[1]]
        parts.append(part)
        last = part[:, -1]
    return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)

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
from sprung.preprocess import FreeDecay
from sprung.vehicle import ElementInput, NonlinearModel, highest_derivatives
from sprung.vibration import exponentials, real_product

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.int64]

_RATE = 250.0
"""Samples per second, at least, that are enough: the others are left out."""

_LARGEST = 2400
"""Samples of drops that are scored together, unless one of them has more: their responses then stay in a processor's cache."""

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
    systems = [
        _of_drops(fit, at, drops, models[fit.decays[drops[0]].load], values, brought)
        for drops in _alike(fit.decays, at)
    ]
    information, gradient = (np.sum(parts, axis=0) for parts in zip(*systems, strict=True))
    test = score_added(fit, gradient, information)
    scores = {}
    for term, names in candidates.items():
        own = [brought.index(name) for name in names]
        step = test.joint_values(own)
        estimates = {name: values[name] + float(step[i]) for name, i in zip(names, own, strict=True)}
        scores[term] = (test.gain(own), estimates)
    return scores


def _alike(decays: Sequence[FreeDecay], at: ClosedFormAt) -> list[list[int]]:
    """Return the positions of decays in groups of the same modes, none of much more samples than stay in a cache."""
    sizes = [_thinned(decay)[1] for decay in decays]
    groups: dict[tuple[int, int], list[list[int]]] = {}
    for drop in range(len(decays)):
        parts = groups.setdefault(at.group_of(drop), [[]])
        together = [*parts[-1], drop]
        if parts[-1] and len(together) * max(sizes[one] for one in together) > _LARGEST:
            parts.append([])
        parts[-1].append(drop)
    return [part for parts in groups.values() for part in parts]


def _thinned(decay: FreeDecay) -> tuple[int, int]:
    """Return how many samples of a decay are one of the thinned one, and how many those are."""
    every = max(int(decay.rate / _RATE), 1)
    return every, -(-decay.samples // every)


def _of_drops(
    fit: FitResult,
    at: ClosedFormAt,
    drops: Sequence[int],
    model: NonlinearModel,
    values: Mapping[str, float],
    brought: Sequence[str],
) -> tuple[Real, Real]:
    """Return information and gradient of the fitted parameters and of those that are brought, of drops with the same modes.

    What lies behind the end of a shorter drop is zero.
    """
    decays = [fit.decays[drop] for drop in drops]
    every, _ = _thinned(decays[0])
    step, counts = every / decays[0].rate, np.array([_thinned(decay)[1] for decay in decays])
    samples = int(counts.max())
    poles, left, shapes, derivatives = at.response_of(drops[0])
    # A pole and its conjugate add the same real part twice, so that one of them is enough.
    upper = poles.imag >= 0
    twice = np.where(poles[upper].imag > 0, 2.0, 1.0)
    right = at.modes.right[at.loads.index(decays[0].load)][:, upper] * twice
    poles, left, shapes = poles[upper], left[upper], shapes[:, upper] * twice
    derivatives = derivatives[..., np.tile(upper, 2)] * np.tile(twice, 2)
    amplitudes = fit.states[drops] @ left.T
    neutral = np.array([values[name] for name in model.names])
    force_rows = -np.linalg.solve(model.linear.matrices(neutral).leading, model.forces.directions(neutral).T)
    driven = highest_derivatives(len(force_rows), model.linear.massive)
    participation, direct = left[:, driven] @ force_rows, at.sensor_rows @ force_rows

    # What was fitted are sums of exponentials, and the samples of these are all that is needed of them.
    waves = exponentials(poles * step, samples)
    motion = real_product(amplitudes[:, None, :] * right, waves)
    within = np.arange(samples) < counts[:, None]
    basis = np.hstack([waves, waves * (every * np.arange(samples))[:, None]]).view(float).T * within[:, None]
    basis -= basis.sum(axis=2, keepdims=True) / counts[:, None, None] * within[:, None]
    by_parameter = np.swapaxes(derivatives * np.tile(amplitudes, 2)[:, None, None, :], 1, 2)
    by_state = left.T[:, None, :] * shapes
    by_state = np.concatenate([by_state, np.zeros_like(by_state)], axis=2)
    sums = np.concatenate([by_parameter, np.broadcast_to(by_state, (len(drops), *by_state.shape))], axis=1)
    sums = np.ascontiguousarray(sums.conj()).view(float)

    by_name = np.zeros((len(drops), len(brought) + 1, len(shapes), samples))
    for i, (drop, count) in enumerate(zip(drops, counts.tolist(), strict=True)):
        by_name[i, -1, :, :count] = np.nan_to_num(fit.residuals[drop][:, ::every])
    powers = _powers(poles * step, samples)
    for name, own, forces in _unit_forces(model, neutral, motion, step):
        if name in brought:
            response = _response(poles, participation[:, own], shapes, forces, step, powers)
            response += direct[:, own] @ forces
            by_name[:, brought.index(name)] += response
    for i, count in enumerate(counts.tolist()):
        by_name[i, ..., count:] = 0.0

    weights = np.array(
        [
            fit.weights * decay.usable * channel_rate_ratios(decay) * (decay.samples / count)
            for decay, count in zip(decays, counts.tolist(), strict=True)
        ]
    )
    products = _products(sums, basis, by_name, weights, samples / counts)
    own_state = np.arange(by_parameter.shape[1], sums.shape[1])
    products[:, own_state, own_state] += initial_state_prior_std(len(force_rows), len(own_state)) ** -2.0
    # The initial state is eliminated.
    kept = np.delete(np.arange(products.shape[1] - 1), own_state)
    order = np.concatenate([kept, own_state])
    information, gradient, _ = eliminate(products[:, order[:, None], order], products[:, order, -1], len(kept))
    return information.sum(axis=0), gradient.sum(axis=0)


def _products(sums: Real, basis: Real, sampled: Real, weights: Real, shares: Real) -> Real:
    """Return the inner products of the readings of each drop, means subtracted, summed over the channels.

    Parameters
    ----------
    sums
        Readings that are sums of the basis, shape (drop, sum, channel, basis).
    basis
        Shape (drop, basis, time), without its mean over the samples of the drop.
    sampled
        The others, zero beyond the end of each drop, shape (drop, sampled, channel, time).
    weights
        Shape (drop, channel).
    shares
        Of all samples over those of each drop, shape (drop,).

    Returns
    -------
    ndarray
        Shape (drop, sum + sampled, sum + sampled).
    """
    flat = (len(sums), sums.shape[1], -1)
    weighted = (weights[:, None, :, None] * sums).reshape(flat)
    transposed = np.swapaxes(basis, 1, 2)
    among_sums = weighted @ np.swapaxes((sums @ (basis @ transposed)[:, None]).reshape(flat), 1, 2)
    drops, count, channels, samples = sampled.shape
    met = sampled.reshape(drops, -1, samples) @ transposed
    across = weighted @ np.swapaxes(met.reshape(drops, count, -1), 1, 2)
    by_channel = np.swapaxes(sampled, 1, 2)
    squares = by_channel @ np.swapaxes(by_channel, 2, 3)
    sizes, means = samples * shares, by_channel.mean(axis=-1)
    squares -= sizes[:, None, None, None] * means[..., :, None] * means[..., None, :]
    among_sampled = (weights[:, None] @ squares.reshape(drops, channels, -1)).reshape(drops, count, count)
    above = np.concatenate([among_sums, across], axis=2)
    below = np.concatenate([np.swapaxes(across, 1, 2), among_sampled], axis=2)
    return np.concatenate([above, below], axis=1)


def _unit_forces(
    model: NonlinearModel, values: Real, motion: Real, step: float
) -> Iterator[tuple[str, list[int], Real]]:
    """Yield parameters, the rows on which each acts and their forces per unit of it along motions, (drop, row, time).

    Parameters without any force are left out: what has no stiffness has no clearance that matters.
    """
    rows = model.forces.rows.at(values)
    travel = np.swapaxes(rows @ (motion[:, : rows.shape[1]] + model.sag(values)[:, None]), 1, 2)
    rate = np.swapaxes(rows @ model.linear.velocities(values) @ motion, 1, 2)
    way = np.diff(travel, axis=1, prepend=travel[:, :1] - step * rate[:, :1])
    together = [part.reshape(-1, len(rows)) for part in (travel, rate, way, np.zeros_like(travel))]
    for law, chosen, _, positions in model.forces.laws:
        felt = ElementInput(*(part[:, chosen] for part in together))
        at = np.arange(model.forces.number)[chosen]
        by_parameter, _ = law.differentiate(values[positions], felt)
        for of_elements, forces in zip(positions, by_parameter, strict=True):
            for position in np.unique(of_elements).tolist() if forces.any() else ():
                own = np.flatnonzero(of_elements == position)
                by_drop = forces[:, own].reshape(*travel.shape[:2], len(own))
                yield model.names[position], at[own].tolist(), np.ascontiguousarray(np.swapaxes(by_drop, 1, 2))


def _response(
    poles: Complex, participation: Complex, shapes: Complex, forces: Real, step: float, powers: tuple[Complex, Complex]
) -> Real:
    """Return the response of the channels to forces that run straight between samples, shape (drop, channel, time)."""
    held = np.expm1(poles * step) / poles
    rising = (held / step - 1) / poles
    before = np.zeros_like(forces)
    before[..., 1:] = forces[..., :-1]
    both = np.concatenate([forces, before], axis=1)
    weights = np.hstack([participation * rising[:, None], participation * (held - rising)[:, None]])
    # As products of real matrices: one of a complex matrix with a real one is made sample by sample.
    drive = np.empty((len(forces), len(poles), both.shape[-1]), dtype=np.complex128)
    drive.real, drive.imag = weights.real @ both, weights.imag @ both
    modal = _accumulated(drive, np.exp(poles * step), powers)
    return np.asarray(shapes.real @ modal.real - shapes.imag @ modal.imag, dtype=np.float64)


def _powers(exponent: Complex, samples: int) -> tuple[Complex, Complex]:
    """Return e^{λk} and its inverse for as many samples as numbers hold both, each of shape (mode, time)."""
    length = min(samples, max(int(_LARGEST_POWER / np.abs(exponent.real).max()), 1))
    powers, inverse = (np.ascontiguousarray(exponentials(way, length).T) for way in (exponent, -exponent))
    return powers, inverse


def _accumulated(drive: Complex, turn: Complex, powers: tuple[Complex, Complex]) -> Complex:
    """Return y of y(k) = z y(k-1) + d(k), from d of shape (drop, mode, time), z of shape (mode,), its powers and their inverse.

    That is z^k times the sum of d(i)/z^i up to k, over as many samples as there are powers.
    """
    growth, inverse = powers
    parts, last = [], np.zeros(drive.shape[:2], dtype=np.complex128)
    for begin in range(0, drive.shape[-1], growth.shape[1]):
        part = drive[..., begin : begin + growth.shape[1]]
        part = part * inverse[:, : part.shape[-1]]
        part[..., 0] += turn * last
        np.cumsum(part, axis=-1, out=part)
        part *= growth[:, : part.shape[-1]]
        parts.append(part)
        last = part[..., -1]
    return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=-1)

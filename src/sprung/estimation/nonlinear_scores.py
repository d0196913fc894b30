"""Score tests of nonlinear forces beside a fitted linear vehicle, without any step of time.

A small force changes a linear motion by what it would do alone. So its response is one filter for each mode, the derivatives
of everything that was fitted are sums of exponentials, and what the one leaves beside the other is the score. Every campaign is
tested for these forces, so it has to be quick.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

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
    # Of all readings, the square roots of the weights in them.
    roots = np.array(
        [
            np.sqrt(fit.weights * decay.usable * channel_rate_ratios(decay) * (decay.samples / count))
            for decay, count in zip(decays, counts.tolist(), strict=True)
        ]
    )

    # What was fitted are sums of exponentials, and the samples of these are all that is needed of them.
    waves = exponentials(poles * step, samples)
    motion = real_product(amplitudes[:, None, :] * right, waves)
    within = np.arange(samples) < counts[:, None]
    basis = np.hstack([waves, waves * (every * np.arange(samples))[:, None]]).view(float) * within[:, :, None]
    basis -= basis.sum(axis=1, keepdims=True) / counts[:, None, None] * within[:, :, None]
    by_parameter = np.swapaxes(derivatives * np.tile(amplitudes, 2)[:, None, None, :], 1, 2)
    by_state = left.T[:, None, :] * shapes
    by_state = np.concatenate([by_state, np.zeros_like(by_state)], axis=2)
    sums = np.concatenate([by_parameter, np.broadcast_to(by_state, (len(drops), *by_state.shape))], axis=1)
    sums = np.ascontiguousarray(sums.conj()).view(float) * roots[:, None, :, None]

    by_name = np.zeros((len(brought) + 1, len(drops), samples, len(shapes)))
    for i, (drop, count) in enumerate(zip(drops, counts.tolist(), strict=True)):
        by_name[-1, i, :count] = np.nan_to_num(fit.residuals[drop][:, ::every]).T * roots[i]
    response = _ModalResponse.of(poles, participation, shapes, direct, roots, step, samples)
    for name, own, forces in _unit_forces(model, neutral, motion, step):
        if name in brought:
            by_name[brought.index(name)] += response.to(own, forces)
    for i, count in enumerate(counts.tolist()):
        by_name[:, i, count:] = 0.0

    products = _products(sums, basis, by_name, counts)
    own_state = np.arange(by_parameter.shape[1], sums.shape[1])
    products[:, own_state, own_state] += initial_state_prior_std(len(force_rows), len(own_state)) ** -2.0
    # The initial state is eliminated.
    kept = np.delete(np.arange(products.shape[1] - 1), own_state)
    order = np.concatenate([kept, own_state])
    information, gradient, _ = eliminate(products[:, order[:, None], order], products[:, order, -1], len(kept))
    return information.sum(axis=0), gradient.sum(axis=0)


def _products(sums: Real, basis: Real, sampled: Real, counts: Index) -> Real:
    """Return the inner products of the weighted readings of each drop, means subtracted, summed over the channels.

    Parameters
    ----------
    sums
        Readings that are sums of the basis, shape (drop, sum, channel, basis).
    basis
        Shape (drop, time, basis), without its mean over the samples of the drop.
    sampled
        The others, zero beyond the end of each drop, shape (sampled, drop, time, channel).
    counts
        Samples of each drop, shape (drop,).

    Returns
    -------
    ndarray
        Shape (drop, sum + sampled, sum + sampled).
    """
    flat, drops = (len(sums), sums.shape[1], -1), len(sums)
    rows = sums.reshape(flat)
    among_sums = rows @ np.swapaxes((sums @ (np.swapaxes(basis, 1, 2) @ basis)[:, None]).reshape(flat), 1, 2)
    with_one = np.concatenate([basis, np.ones((*basis.shape[:2], 1))], axis=2)
    met = np.moveaxis(np.swapaxes(with_one, 1, 2) @ sampled, 0, 1)
    across = rows @ np.swapaxes(np.swapaxes(met[:, :, :-1], 2, 3).reshape(drops, len(sampled), -1), 1, 2)
    whole = np.swapaxes(sampled, 0, 1).reshape(drops, len(sampled), -1)
    means = met[:, :, -1] / np.sqrt(counts)[:, None, None]
    among_sampled = whole @ np.swapaxes(whole, 1, 2) - means @ np.swapaxes(means, 1, 2)
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
                yield model.names[position], at[own].tolist(), forces[:, own].reshape(*travel.shape[:2], len(own))


@dataclass(frozen=True, eq=False)
class _ModalResponse:
    """Response of weighted readings to forces that run straight between samples, by one filter for each mode.

    With the force f a mode is g + r f, where g(k) = z g(k-1) + v f(k-1).

    Attributes
    ----------
    drive
        v of every row, real and imaginary parts beside each other, shape (row, 2 mode).
    readings
        Of g, likewise, shape (drop, 2 mode, channel).
    direct
        Readings of the forces themselves, shape (drop, row, channel).
    turn
        z, shape (mode,).
    growth, inverse
        z^k, and its inverse, for as many samples as numbers hold both, shape (time, mode).
    buffer
        Written anew for every force, shape (drop, time, 2 mode).
    """

    drive: Real
    readings: Real
    direct: Real
    turn: Complex
    growth: Complex
    inverse: Complex
    buffer: Real

    @classmethod
    def of(
        cls,
        poles: Complex,
        participation: Complex,
        shapes: Complex,
        direct: Real,
        roots: Real,
        step: float,
        samples: int,
    ) -> _ModalResponse:
        """Return the response of modes.

        Parameters
        ----------
        poles
            1/s, shape (mode,).
        participation
            Of the force of each row in each mode, shape (mode, row).
        shapes
            Readings of the modes, shape (channel, mode).
        direct
            Readings of the forces, shape (channel, row).
        roots
            Square roots of the weights of readings, shape (drop, channel).
        step
            s.
        samples
            Of the longest drop.
        """
        held = np.expm1(poles * step) / poles
        rising = (held / step - 1) / poles
        z = np.exp(poles * step)
        drive = ((z * rising + held - rising)[:, None] * participation).T
        at_once = direct + (shapes @ (rising[:, None] * participation)).real
        length = min(samples, max(int(_LARGEST_POWER / np.abs(poles.real * step).max()), 1))
        return cls(
            np.ascontiguousarray(drive).view(float),
            np.ascontiguousarray(shapes.conj()).view(float).T * roots[:, None],
            at_once.T * roots[:, None],
            z,
            exponentials(poles * step, length),
            exponentials(-poles * step, length),
            np.empty((len(roots), samples, 2 * len(poles))),
        )

    def to(self, rows: list[int], forces: Real) -> Real:
        """Return the response to the forces of some rows, shape (drop, time, row); shape (drop, time, channel)."""
        response: Real = forces @ self.direct[:, rows]
        drive = np.matmul(forces, self.drive[rows], out=self.buffer).view(np.complex128)
        # The sum of d(i) z^(k-i) up to k is z^k times that of d(i)/z^i, over as many samples as there are powers.
        length = len(self.growth)
        for begin in range(0, drive.shape[1], length):
            part = drive[:, begin : begin + length]
            part *= self.inverse[: part.shape[1]]
            if begin:
                part[:, 0] += self.turn * drive[:, begin - 1]
            np.cumsum(part, axis=1, out=part)
            part *= self.growth[: part.shape[1]]
        response[:, 1:] += drive.view(float)[:, :-1] @ self.readings
        return response

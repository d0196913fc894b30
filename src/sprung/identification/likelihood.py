"""The likelihood of all decays at once, with initial states and offsets eliminated, and its exact derivatives.

In modal coordinates a channel of a decay is Σ_j s_cj q_j e^{λ_j t} plus an offset, and its derivative by a parameter
is Σ_j (σ_cj + τ_cj t) q_j e^{λ_j t}. The amplitudes q (the unknown initial state) and the offsets are linear: they are
solved for in closed form, and their directions are projected off the derivatives (variable projection after Golub and
Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, in Kaufman's form). Every sum over samples is one of `sums`, so an
evaluation touches the records in one matrix product and everything else is small.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.identification.longhand import Longhand, evaluate_drop
from sprung.identification.sums import blocks, correlate, moments
from sprung.prepare import Decay
from sprung.vehicle import LinearModel, Rows

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_CLOSE = 1e-6
"""Two poles are one where their difference turns by less than this over a record: their mode is then t e^{λt}."""

_DEFECTIVE = 100.0
"""Condition number of a pole from which two modes have all but met in one shape, and the long way is taken."""

_RIDGE = 1e-13
"""Relative ridge on the amplitudes' normal equations: keeps a mode that no channel sees from dividing by zero."""


@dataclass(frozen=True, eq=False)
class Group:
    """Decays of one load and one sampling rate: they share poles and shapes.

    Attributes
    ----------
    members
        Positions of the group's decays in the fit's list; shape (drop,).
    model
        Equations of motion with the load, over the fit's parameters.
    blocked
        Centred records cut into blocks, channels that are left out zero; shape (drop, channel, block, BLOCK).
    energy
        Sum of squares of the centred records; shape (drop, channel).
    present
        1 for a channel that is used, 0 for one that is left out; shape (drop, channel).
    samples
        Shape (drop,).
    rate
        Samples per second.
    """

    members: NDArray[np.int64]
    model: LinearModel
    blocked: Real
    energy: Real
    present: Real
    samples: NDArray[np.int64]
    rate: float


class Evaluation(NamedTuple):
    """What one evaluation of the likelihood gives; parameters in SI, drops in the fit's order.

    Attributes
    ----------
    residual
        Residual sum of squares, (m/s²)², shape (drop, channel).
    leverage
        How many of the amplitudes each channel of each drop pays for; shape (drop, channel).
    gradient
        Σ derivative · residual / σ², by parameter and drop; shape (drop, parameter).
    information
        Fisher information of the parameters, amplitudes and offsets eliminated; shape (parameter, parameter).
    """

    residual: Real
    leverage: Real
    gradient: Real
    information: Real


class ModalSolution(NamedTuple):
    """Poles and acceleration shapes of one load at the sensors, with their derivatives.

    Attributes
    ----------
    poles
        λ, 1/s, shape (14,).
    pole_slopes
        Derivative of each pole by each parameter, shape (parameter, 14).
    coordinates
        Displacement of the seven coordinates per unit of modal amplitude, shape (7, 14).
    shapes
        s: reading of each channel per unit of modal amplitude, shape (channel, 14).
    shape_slopes
        σ, shape (parameter, channel, 14).
    secular_slopes
        τ, shape (parameter, channel, 14).
    condition
        Largest condition number of a pole: infinite where two modes meet in one shape.
    """

    poles: Complex
    pole_slopes: Complex
    coordinates: Complex
    shapes: Complex
    shape_slopes: Complex
    secular_slopes: Complex
    condition: float


@dataclass(frozen=True, eq=False)
class Likelihood:
    """All decays of a campaign, ready to be fitted.

    Attributes
    ----------
    groups
        Decays by load and rate.
    sensors
        The sensors' rows over the fit's parameters.
    drops, channels
        How many there are.
    """

    groups: tuple[Group, ...]
    sensors: Rows
    drops: int
    channels: int

    @classmethod
    def of(cls, decays: Sequence[Decay], models: Mapping[str, LinearModel], sensors: Rows) -> Likelihood:
        """Take up the records, once.

        Parameters
        ----------
        decays
            What to fit.
        models
            Equations of motion by load name.
        sensors
            The sensors' rows, in the order of the decays' channels.
        """
        keys = sorted({(decay.load, decay.rate) for decay in decays})
        groups = []
        for load, rate in keys:
            members = [i for i, decay in enumerate(decays) if (decay.load, decay.rate) == (load, rate)]
            groups.append(_group([decays[i] for i in members], np.array(members), models[load], rate))
        return cls(tuple(groups), sensors, len(decays), len(sensors.affine))

    @property
    def observations(self) -> Real:
        """Samples by drop and channel, 0 where a channel is left out; shape (drop, channel)."""
        counts = np.zeros((self.drops, self.channels))
        for group in self.groups:
            counts[group.members] = group.present * group.samples[:, None]
        return counts

    def evaluate(self, values: Real, weights: Real) -> Evaluation:
        """Evaluate fit and derivatives.

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).
        weights
            1/σ² of each channel, shape (channel,).

        Returns
        -------
        Evaluation
        """
        parameters = len(values)
        residual = np.zeros((self.drops, self.channels))
        leverage = np.zeros((self.drops, self.channels))
        gradient = np.zeros((self.drops, parameters))
        information = np.zeros((parameters, parameters))
        for group in self.groups:
            modes = self._modes(group, values)
            if modes.condition > _DEFECTIVE:
                part = _stack(self._longhand(group, values, weights))
            else:
                part = _evaluate_group(group, modes, weights)
            residual[group.members] = part.residual
            leverage[group.members] = part.leverage
            gradient[group.members] = part.gradient
            information += part.information
        return Evaluation(residual, leverage, gradient, information)

    def misfit(self, values: Real, weights: Real) -> Real:
        """Give the residual sums of squares alone, at a fraction of the price; shape (drop, channel)."""
        residual = np.zeros((self.drops, self.channels))
        for group in self.groups:
            residual[group.members] = _solve_amplitudes(group, self._modes(group, values), weights).residual
        return residual

    def fitted(self, values: Real, weights: Real) -> list[Real]:
        """Give what the model makes of every record, its mean taken off; each of shape (channel, time)."""
        records: list[Real] = [np.zeros((self.channels, 0))] * self.drops
        for group in self.groups:
            modes = self._modes(group, values)
            if modes.condition > _DEFECTIVE:
                for member, one in zip(group.members, self._longhand(group, values, weights), strict=True):
                    records[member] = one.fitted
                continue
            amplitudes = _solve_amplitudes(group, modes, weights).amplitudes
            for member, q, samples in zip(group.members, amplitudes, group.samples, strict=True):
                powers = np.exp(modes.poles[:, None] * (np.arange(samples) / group.rate))
                record = ((modes.shapes * q) @ powers).real
                records[member] = record - record.mean(axis=1, keepdims=True)
        return records

    def _modes(self, group: Group, values: Real) -> ModalSolution:
        return solve_modes(group.model, self.sensors, values, float(group.samples.max()) / group.rate)

    def _longhand(self, group: Group, values: Real, weights: Real) -> list[Longhand]:
        records = group.blocked.reshape(*group.energy.shape, -1)
        return [
            evaluate_drop(group.model, self.sensors, values, record[:, :samples], group.rate, present * weights)
            for record, samples, present in zip(records, group.samples, group.present, strict=True)
        ]


def _stack(drops: Sequence[Longhand]) -> Evaluation:
    return Evaluation(
        np.array([drop.residual for drop in drops]),
        np.array([drop.leverage for drop in drops]),
        np.array([drop.gradient for drop in drops]),
        np.sum([drop.information for drop in drops], axis=0),
    )


def _group(decays: Sequence[Decay], members: NDArray[np.int64], model: LinearModel, rate: float) -> Group:
    samples = np.array([decay.samples for decay in decays])
    present = np.array([decay.usable for decay in decays], dtype=float)
    records = np.zeros((len(decays), len(decays[0].values), int(samples.max())))
    for record, decay in zip(records, decays, strict=True):
        usable = decay.values[decay.usable]
        record[decay.usable, : decay.samples] = usable - usable.mean(axis=1, keepdims=True)
    energy = np.einsum("dct,dct->dc", records, records)
    return Group(members, model, blocks(records), energy, present, samples, rate)


def solve_modes(model: LinearModel, sensors: Rows, values: Real, span: float) -> ModalSolution:
    """Solve the eigenvalue problem of one load and differentiate the response with it.

    Parameters
    ----------
    model
        Equations of motion.
    sensors
        The sensors' rows.
    values
        Parameters, SI.
    span
        Length of the longest record, s: decides which poles are too close to be told apart.

    Returns
    -------
    ModalSolution

    Notes
    -----
    The derivative of e^{At} in modal coordinates has the entries D_kj (e^{λ_j t} - e^{λ_k t})/(λ_j - λ_k), with
    D = V⁻¹ dA V. The e^{λ_k t} in it multiplies the shape of mode k, so the free amplitudes absorb it. What is left is
    D_kj/(λ_j - λ_k) e^{λ_j t} for different poles and D_kj t e^{λ_j t} for equal ones.

    """
    lower, dlower = model.accelerations(values)
    poles, V = np.linalg.eig(np.vstack([np.hstack([np.zeros((7, 7)), np.eye(7)]), lower]))
    left = np.linalg.inv(V)
    S, dS = sensors.at(values), sensors.slopes
    accelerations = lower @ V
    shapes = S @ accelerations
    changes = dlower @ V
    D = left[:, 7:] @ changes
    difference = poles[None, :] - poles[:, None]
    close = np.abs(difference) * span < _CLOSE
    mixing = np.where(close, 0.0, 1.0 / np.where(close, 1.0, difference))
    return ModalSolution(
        poles,
        np.einsum("pjj->pj", D),
        V[:7],
        shapes,
        dS @ accelerations + S @ changes + shapes @ (D * mixing),
        shapes @ (D * close),
        _condition(poles, V, left),
    )


def _condition(poles: Complex, right: Complex, left: Complex) -> float:
    """Give the largest |w||v|/|w·v| of all poles, displacements and velocities made comparable by a mean frequency."""
    balance = np.repeat([float(np.abs(poles).mean()), 1.0], 7)
    lengths = np.linalg.norm(right * balance[:, None], axis=0) * np.linalg.norm(left / balance, axis=1)
    return float(lengths.max())


class _Amplitudes(NamedTuple):
    """The linear half of an evaluation: what the free initial states make of given poles and shapes."""

    gram: Complex  # of (e^{λt}, t e^{λt}), (drop, 28, 28)
    data: Complex  # inner products of (e^{λt}, t e^{λt}) with the records, (drop, channel, 28)
    smoothed: Complex  # the same with the fitted records
    inverse: Complex  # of the amplitudes' normal equations, (drop, 14, 14)
    weights: Real  # 1/σ², zero for channels left out, (drop, channel)
    amplitudes: Complex  # q, (drop, 14)
    residual: Real  # (drop, channel)


def _solve_amplitudes(group: Group, modes: ModalSolution, weights: Real) -> _Amplitudes:
    step = 1.0 / group.rate
    exponent = modes.poles * step
    N = group.samples[:, None]
    w = group.present * weights

    # Everything is centred over the record, because every channel of every drop has an offset of its own.
    pair = moments(np.conj(exponent)[:, None] + exponent, N[:, :, None])
    mean = moments(exponent, N)
    means = np.concatenate([mean.zeroth, mean.first * step], axis=1) / N
    lagged = pair.first * step
    whole = np.block([[pair.zeroth, lagged], [lagged, pair.second * step**2]])
    gram = np.asarray(whole - N[:, :, None] * np.conj(means)[:, :, None] * means[:, None, :], dtype=np.complex128)
    zeroth, first = correlate(group.blocked, exponent)
    data: Complex = np.concatenate([zeroth, first * step], axis=2)

    s = modes.shapes
    normal = np.einsum("cj,dc,ck->djk", s.conj(), w, s, optimize=True) * gram[:, :14, :14]
    size = np.sqrt(np.maximum(np.einsum("djj->dj", normal).real, np.finfo(float).tiny))
    scale = size[:, :, None] * size[:, None, :]
    inverse: Complex = np.linalg.inv(normal / scale + _RIDGE * np.eye(14)) / scale
    q = (inverse @ np.einsum("cj,dc,dcj->dj", s.conj(), w, data[:, :, :14], optimize=True)[:, :, None])[:, :, 0]
    fitted = s * q[:, None, :]
    smoothed = fitted @ np.swapaxes(gram[:, :, :14], 1, 2)
    explained = np.sum(fitted.conj() * (2 * data[:, :, :14] - smoothed[:, :, :14]), axis=2).real
    residual = np.maximum(group.energy - group.present * explained, 0.0)
    return _Amplitudes(gram, data, smoothed, inverse, w, q, residual)


def _evaluate_group(group: Group, modes: ModalSolution, weights: Real) -> Evaluation:
    linear = _solve_amplitudes(group, modes, weights)
    s, w, gram = modes.shapes, linear.weights, linear.gram
    drops, parameters = len(group.members), len(modes.shape_slopes)
    leverage = np.einsum("cj,djk,dkj,ck,dc->dc", s.conj(), gram[:, :14, :14], linear.inverse, s, w, optimize=True).real

    # Derivatives of the fitted records: coefficients of (e^{λt}, t e^{λt}) for every parameter, channel and drop.
    slopes = np.concatenate([modes.shape_slopes, modes.secular_slopes], axis=2)
    J = slopes * np.tile(linear.amplitudes, 2)[:, None, None, :]
    weighted = J.conj() * w[:, None, :, None]
    gradient = np.einsum("dpcj,dcj->dp", weighted, linear.data - linear.smoothed, optimize=True).real
    products = (J.reshape(drops, -1, 28) @ np.swapaxes(gram, 1, 2)).reshape(J.shape)
    within = weighted.reshape(drops, parameters, -1) @ np.swapaxes(products.reshape(drops, parameters, -1), 1, 2)
    across = np.einsum("cj,dc,dpcj->dpj", s.conj(), w, products[..., :14], optimize=True)
    information = (within - across.conj() @ linear.inverse @ np.swapaxes(across, 1, 2)).real.sum(axis=0)
    return Evaluation(linear.residual, leverage, gradient, information)

"""The likelihood of all decays at once, with initial states and offsets eliminated, and its exact derivatives.

In modal coordinates a channel of a decay is Σ_j s_cj q_j e^{λ_j t} plus an offset, and its derivative by a parameter
is Σ_j (σ_cj + τ_cj t) q_j e^{λ_j t}. The amplitudes q (the unknown initial state) and the offsets are linear: they are
solved for in closed form, and their directions are projected off the derivatives (variable projection after Golub and
Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, in Kaufman's form). All that is assumed of an initial state is that it is one
a vehicle can be in, so that a motion which no sensor sees is taken to be none. Every sum over samples is one of `sums`, so an
evaluation touches the records in one matrix product and everything else is small.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.identification.longhand import REACH, Longhand, evaluate_drop
from sprung.identification.solution import ModalSlopes, ModalSolution, differentiate_modes, solve_modes
from sprung.identification.sums import blocks, correlate, moments
from sprung.prepare import Decay
from sprung.vehicle import LinearModel, Rows

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_DEFECTIVE = 100.0
"""Condition number of a pole from which two modes have all but met in one shape, and the long way is taken."""


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
        Fisher information of the parameters from each drop, amplitudes and offsets eliminated; shape (drop, parameter,
        parameter).
    """

    residual: Real
    leverage: Real
    gradient: Real
    information: Real


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

    @property
    def energy(self) -> Real:
        """Sum of squares of all centred records of each channel, (m/s²)², shape (channel,)."""
        energy: Real = np.sum([group.energy.sum(axis=0) for group in self.groups], axis=0)
        return energy

    @property
    def largest(self) -> Likelihood:
        """The part of it with most drops that share one load and one rate; the other drops count as perfectly fitted."""
        group = max(self.groups, key=lambda group: len(group.members))
        return replace(self, groups=(group,))

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
        information = np.zeros((self.drops, parameters, parameters))
        for group in self.groups:
            modes = self._modes(group, values)
            if modes.condition > _DEFECTIVE:
                part = _stack(self._longhand(group, values, weights))
            else:
                part = _evaluate_group(group, modes, self._slopes(group, values, modes), weights)
            residual[group.members] = part.residual
            leverage[group.members] = part.leverage
            gradient[group.members] = part.gradient
            information[group.members] = part.information
        return Evaluation(residual, leverage, gradient, information)

    def feigned(self, values: Real, weights: Real) -> Real:
        """Give the information that noise alone feigns.

        A motion that no drop excites has amplitudes too: those that noise fits. The information is quadratic in the
        amplitudes, so on average it is too large by what their covariance puts in their place. Shape (parameter, parameter).
        """
        total = np.zeros((len(values), len(values)))
        for group in self.groups:
            modes = self._modes(group, values)
            if modes.condition <= _DEFECTIVE:  # else modes of their own cannot be told apart
                total += _feigned_group(group, modes, self._slopes(group, values, modes), weights)
        return total

    def misfit(self, values: Real, weights: Real) -> Real:
        """Give the residual sums of squares alone, at a fraction of the price; shape (drop, channel)."""
        residual = np.zeros((self.drops, self.channels))
        for group in self.groups:
            residual[group.members] = _solve_amplitudes(group, self._modes(group, values), weights, False).residual
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
                # A pole and its conjugate add the same real part twice.
                upper = modes.poles.imag >= 0
                twice = np.where(modes.poles.imag > 0, 2.0, 1.0)[upper]
                powers = np.exp(modes.poles[upper, None] * (np.arange(samples) / group.rate))
                record = ((modes.shapes * q)[:, upper] * twice @ powers).real
                records[member] = record - record.mean(axis=1, keepdims=True)
        return records

    def states(self, values: Real, weights: Real) -> Real:
        """Give {X, Ẋ} of each drop at its first sample, SI, shape (drop, 14)."""
        states = np.zeros((self.drops, 14))
        for group in self.groups:
            modes = self._modes(group, values)
            if modes.condition > _DEFECTIVE:
                states[group.members] = [one.state for one in self._longhand(group, values, weights)]
            else:
                amplitudes = _solve_amplitudes(group, modes, weights).amplitudes
                states[group.members] = (amplitudes @ modes.right.T).real
        return states

    def _modes(self, group: Group, values: Real) -> ModalSolution:
        return solve_modes(group.model, self.sensors, values)

    def _slopes(self, group: Group, values: Real, modes: ModalSolution) -> ModalSlopes:
        span = float(group.samples.max()) / group.rate
        return differentiate_modes(group.model, self.sensors, values, modes, span)

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
        np.array([drop.information for drop in drops]),
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


class _Amplitudes(NamedTuple):
    """The linear half of an evaluation: what the free initial states make of given poles and shapes."""

    gram: Complex  # of (e^{λt}, t e^{λt}), (drop, 28, 28)
    data: Complex  # inner products of (e^{λt}, t e^{λt}) with the records, (drop, channel, 28)
    smoothed: Complex  # the same with the fitted records
    normal: Complex  # normal equations of the amplitudes, from the records alone, (drop, 14, 14)
    inverse: Complex  # of the same with their reach added
    weights: Real  # 1/σ², zero for channels left out, (drop, channel)
    amplitudes: Complex  # q, (drop, 14)
    residual: Real  # (drop, channel)


def _solve_amplitudes(group: Group, modes: ModalSolution, weights: Real, secular: bool = True) -> _Amplitudes:
    """Solve for the amplitudes; what t e^{λt} has to do with the records only derivatives need."""
    step = 1.0 / group.rate
    exponent = modes.poles * step
    N = group.samples[:, None]
    w = group.present * weights

    gram = _gram(exponent, N, step, secular)
    # Poles come in conjugate pairs, one beside the other: one of each pair is enough for real records.
    upper = exponent.imag >= 0
    of_pair = np.cumsum(upper) - 1
    parts = correlate(group.blocked, exponent[upper], secular)
    halves = [np.where(upper, part[:, :, of_pair], part[:, :, of_pair].conj()) for part in parts]
    data = np.concatenate([half * step**power for power, half in enumerate(halves)], axis=2)

    s = modes.shapes
    weighted = s.conj() * w[:, :, None]
    within_reach = (modes.right.conj().T / REACH**2) @ modes.right
    normal = (np.swapaxes(weighted, 1, 2) @ s) * gram[:, :14, :14]
    size = np.sqrt(np.einsum("djj->dj", normal + within_reach).real)
    scale = size[:, :, None] * size[:, None, :]
    inverse: Complex = np.linalg.inv((normal + within_reach) / scale) / scale
    q = (inverse @ (weighted * data[:, :, :14]).sum(axis=1)[:, :, None])[:, :, 0]
    fitted = s * q[:, None, :]
    smoothed = fitted @ np.swapaxes(gram[:, :, :14], 1, 2)
    explained = np.sum(fitted.conj() * (2 * data[:, :, :14] - smoothed[:, :, :14]), axis=2).real
    residual = np.maximum(group.energy - group.present * explained, 0.0)
    return _Amplitudes(gram, data, smoothed, normal, inverse, w, q, residual)


def _gram(exponent: Complex, samples: NDArray[np.int64], step: float, secular: bool) -> Complex:
    """Give the products of (e^{λt}, t e^{λt}) with each other over records of so many samples; (drop, 28 or 14, ...).

    Everything is centred over the record, because every channel of every drop has an offset of its own.
    """
    pair = moments(np.conj(exponent)[:, None] + exponent, samples[:, :, None])
    mean = moments(exponent, samples)
    whole, sums = pair.zeroth, mean.zeroth
    if secular:
        lagged = pair.first * step
        above, below = np.concatenate([whole, lagged], axis=2), np.concatenate([lagged, pair.second * step**2], axis=2)
        whole, sums = np.concatenate([above, below], axis=1), np.concatenate([sums, mean.first * step], axis=1)
    means = sums / samples
    gram = whole - samples[:, :, None] * np.conj(means)[:, :, None] * means[:, None, :]
    return np.asarray(gram, dtype=np.complex128)


def _evaluate_group(group: Group, modes: ModalSolution, slopes: ModalSlopes, weights: Real) -> Evaluation:
    linear = _solve_amplitudes(group, modes, weights)
    s, w, gram = modes.shapes, linear.weights, linear.gram
    drops, parameters = len(group.members), len(slopes.shapes)
    hat = gram[:, :14, :14] * np.swapaxes(linear.inverse, 1, 2)
    leverage = w * ((s.conj() @ hat) * s).sum(axis=2).real

    J = _derivatives(slopes, linear.amplitudes)
    weighted = (J.conj() * w[:, None, :, None]).reshape(drops, parameters, -1)
    gradient = (weighted @ (linear.data - linear.smoothed).reshape(drops, -1, 1))[:, :, 0].real
    return Evaluation(linear.residual, leverage, gradient, _information(J, modes, linear))


def _derivatives(slopes: ModalSlopes, amplitudes: NDArray[np.complexfloating]) -> Complex:
    """Give the derivatives of the fitted records, as coefficients of (e^{λt}, t e^{λt}); (drop, parameter, channel, 28)."""
    J: Complex = np.concatenate([slopes.shapes, slopes.secular], axis=2) * np.tile(amplitudes, 2)[:, None, None, :]
    return J


def _information(J: Complex, modes: ModalSolution, linear: _Amplitudes) -> Real:
    """Give the products of derivatives with what amplitudes and offsets can take up projected off."""
    drops, parameters = J.shape[:2]
    w = linear.weights[:, None, :, None]
    products = (J.reshape(drops, -1, 28) @ np.swapaxes(linear.gram, 1, 2)).reshape(J.shape)
    within = (J.conj() * w).reshape(drops, parameters, -1) @ np.swapaxes(products.reshape(drops, parameters, -1), 1, 2)
    across = (modes.shapes.conj() * w * products[..., :14]).sum(axis=2)
    information: Real = (within - across.conj() @ linear.inverse @ np.swapaxes(across, 1, 2)).real
    return information


def _feigned_group(group: Group, modes: ModalSolution, slopes: ModalSlopes, weights: Real) -> Real:
    linear = _solve_amplitudes(group, modes, weights)
    # What noise puts into the amplitudes: their inverse normal equations, less what their reach holds back.
    eigenvalues, vectors = np.linalg.eigh(linear.normal)
    roots = linear.inverse @ (vectors * np.sqrt(np.maximum(eigenvalues, 0.0))[:, None, :])
    each = [_information(_derivatives(slopes, roots[:, :, j]), modes, linear) for j in range(14)]
    total: Real = np.sum(each, axis=(0, 1))
    return total

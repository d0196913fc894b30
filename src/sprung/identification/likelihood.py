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
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.identification.longhand import REACH, Longhand, evaluate_drop
from sprung.identification.records import Records
from sprung.identification.solution import ModalSolution, differentiate_modes, solve_modes
from sprung.identification.sums import moments
from sprung.prepare import Decay
from sprung.vehicle import LinearModel, Rows

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_DEFECTIVE = 100.0
"""Condition number of a pole from which two modes have all but met in one shape, and the long way is taken."""


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
    records
        The decays.
    models
        Equations of motion by the position of the load in the records.
    sensors
        The sensors' rows over the fit's parameters.
    drops
        How many decays the fit's list has; those that are not in the records count as perfectly fitted.
    """

    records: Records
    models: tuple[LinearModel, ...]
    sensors: Rows
    drops: int

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
        records = Records.of(decays)
        return cls(records, tuple(models[load] for load in records.loads), sensors, len(decays))

    @property
    def channels(self) -> int:
        """How many channels there are."""
        return len(self.sensors.affine)

    @property
    def observations(self) -> Real:
        """Samples by drop and channel, 0 where a channel is left out; shape (drop, channel)."""
        return self._in_order(self.records.present * self.records.samples[:, None])

    @property
    def energy(self) -> Real:
        """Sum of squares of all centred records of each channel, (m/s²)², shape (channel,)."""
        energy: Real = self.records.energy.sum(axis=0)
        return energy

    @cached_property
    def largest(self) -> Likelihood:
        """The part of it with most drops that share one load and one rate; the other drops count as perfectly fitted."""
        records = self.records.largest
        models = tuple(self.models[self.records.loads.index(load)] for load in records.loads)
        return replace(self, records=records, models=models)

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
        modes = self._modes(values)
        if _defective(modes):
            part = _stack(self._longhand(values, weights))
        else:
            part = _evaluate(self.records, modes, self._slopes(values, modes), weights)
        return Evaluation(*(self._in_order(each) for each in part))

    def feigned(self, values: Real, weights: Real) -> Real:
        """Give the information that noise alone feigns.

        A motion that no drop excites has amplitudes too: those that noise fits. The information is quadratic in the
        amplitudes, so on average it is too large by what their covariance puts in their place. Shape (parameter, parameter).
        """
        modes = self._modes(values)
        if _defective(modes):  # modes of their own cannot be told apart
            return np.zeros((len(values), len(values)))
        return _feigned(self.records, modes, self._slopes(values, modes), weights)

    def misfit(self, values: Real, weights: Real) -> Real:
        """Give the residual sums of squares alone, at a fraction of the price; shape (drop, channel)."""
        return self._in_order(_solve_amplitudes(self.records, self._modes(values), weights, False).residual)

    def fitted(self, values: Real, weights: Real) -> list[Real]:
        """Give what the model makes of every record, its mean taken off; each of shape (channel, time)."""
        modes = self._modes(values)
        if _defective(modes):
            found = [one.fitted for one in self._longhand(values, weights)]
        else:
            amplitudes = _solve_amplitudes(self.records, modes, weights).amplitudes
            load, step, samples = self.records.load, self.records.step, self.records.samples
            found = [_record(modes[load[d]], q, step[d], int(samples[d])) for d, q in enumerate(amplitudes)]
        return [found[position] for position in np.argsort(self.records.order)]

    def states(self, values: Real, weights: Real) -> Real:
        """Give {X, Ẋ} of each drop at its first sample, SI, shape (drop, 14)."""
        modes = self._modes(values)
        if _defective(modes):
            return self._in_order(np.array([one.state for one in self._longhand(values, weights)]))
        amplitudes = _solve_amplitudes(self.records, modes, weights).amplitudes
        right = np.array([one.right for one in modes])[self.records.load]
        return self._in_order((right @ amplitudes[:, :, None])[:, :, 0].real)

    def _modes(self, values: Real) -> list[ModalSolution]:
        return [solve_modes(model, self.sensors, values) for model in self.models]

    def _slopes(self, values: Real, modes: Sequence[ModalSolution]) -> Complex:
        """Give σ and τ of every load side by side; shape (load, parameter, channel, 28)."""
        span = float(np.max(self.records.samples * self.records.step))
        found = [
            differentiate_modes(model, self.sensors, values, one, span)
            for model, one in zip(self.models, modes, strict=True)
        ]
        return np.array([np.concatenate([slopes.shapes, slopes.secular], axis=2) for slopes in found])

    def _longhand(self, values: Real, weights: Real) -> list[Longhand]:
        records = self.records
        return [
            evaluate_drop(
                self.models[records.load[drop]],
                self.sensors,
                values,
                records.record(drop),
                1.0 / records.step[drop],
                records.present[drop] * weights,
            )
            for drop in range(len(records.load))
        ]

    def _in_order(self, by_record: Real) -> Real:
        """Put what belongs to records where the fit's list of decays has them."""
        ordered = np.zeros((self.drops, *by_record.shape[1:]))
        ordered[self.records.order] = by_record
        return ordered


def _defective(modes: Sequence[ModalSolution]) -> bool:
    return max(one.condition for one in modes) > _DEFECTIVE


def _record(modes: ModalSolution, amplitudes: Complex, step: float, samples: int) -> Real:
    # A pole and its conjugate add the same real part twice.
    upper = modes.poles.imag >= 0
    twice = np.where(modes.poles.imag > 0, 2.0, 1.0)[upper]
    powers = np.exp(modes.poles[upper, None] * (np.arange(samples) * step))
    record: Real = ((modes.shapes * amplitudes)[:, upper] * twice @ powers).real
    record -= record.mean(axis=1, keepdims=True)
    return record


def _stack(drops: Sequence[Longhand]) -> Evaluation:
    return Evaluation(
        np.array([drop.residual for drop in drops]),
        np.array([drop.leverage for drop in drops]),
        np.array([drop.gradient for drop in drops]),
        np.array([drop.information for drop in drops]),
    )


class _Amplitudes(NamedTuple):
    """The linear half of an evaluation: what the free initial states make of given poles and shapes."""

    shapes: Complex  # s, (drop, channel, 14)
    gram: Complex  # of (e^{λt}, t e^{λt}), (drop, 28, 28)
    data: Complex  # inner products of (e^{λt}, t e^{λt}) with the records, (drop, channel, 28)
    smoothed: Complex  # the same with the fitted records
    normal: Complex  # normal equations of the amplitudes, from the records alone, (drop, 14, 14)
    inverse: Complex  # of the same with their reach added
    weights: Real  # 1/σ², zero for channels left out, (drop, channel)
    amplitudes: Complex  # q, (drop, 14)
    residual: Real  # (drop, channel)


def _solve_amplitudes(
    records: Records, modes: Sequence[ModalSolution], weights: Real, secular: bool = True
) -> _Amplitudes:
    """Solve for the amplitudes; what t e^{λt} has to do with the records only derivatives need."""
    exponent = np.array([one.poles for one in modes], dtype=np.complex128)[records.load] * records.step[:, None]
    w = records.present * weights
    gram = _gram(exponent, records.samples[:, None], records.step[:, None, None], secular)
    data = records.correlate(exponent, secular)

    s = np.array([one.shapes for one in modes])[records.load]
    weighted = s.conj() * w[:, :, None]
    reach = np.array([(one.right.conj().T / REACH**2) @ one.right for one in modes])[records.load]
    normal = (np.swapaxes(weighted, 1, 2) @ s) * gram[:, :14, :14]
    size = np.sqrt(np.einsum("djj->dj", normal + reach).real)
    scale = size[:, :, None] * size[:, None, :]
    inverse: Complex = np.linalg.inv((normal + reach) / scale) / scale
    q = (inverse @ (weighted * data[:, :, :14]).sum(axis=1)[:, :, None])[:, :, 0]
    fitted = s * q[:, None, :]
    smoothed = fitted @ np.swapaxes(gram[:, :, :14], 1, 2)
    explained = np.sum(fitted.conj() * (2 * data[:, :, :14] - smoothed[:, :, :14]), axis=2).real
    residual = np.maximum(records.energy - records.present * explained, 0.0)
    return _Amplitudes(s, gram, data, smoothed, normal, inverse, w, q, residual)


def _gram(exponent: Complex, samples: NDArray[np.int64], step: Real, secular: bool) -> Complex:
    """Give the products of (e^{λt}, t e^{λt}) with each other over records of so many samples; (drop, 28 or 14, ...).

    Everything is centred over the record, because every channel of every drop has an offset of its own.
    """
    pair = moments(np.conj(exponent)[:, :, None] + exponent[:, None, :], samples[:, :, None])
    mean = moments(exponent, samples)
    whole, sums = pair.zeroth, mean.zeroth
    if secular:
        lagged = pair.first * step
        above, below = np.concatenate([whole, lagged], axis=2), np.concatenate([lagged, pair.second * step**2], axis=2)
        whole, sums = np.concatenate([above, below], axis=1), np.concatenate([sums, mean.first * step[:, 0]], axis=1)
    means = sums / samples
    gram = whole - samples[:, :, None] * np.conj(means)[:, :, None] * means[:, None, :]
    return np.asarray(gram, dtype=np.complex128)


def _evaluate(records: Records, modes: Sequence[ModalSolution], slopes: Complex, weights: Real) -> Evaluation:
    linear = _solve_amplitudes(records, modes, weights)
    s, w = linear.shapes, linear.weights
    hat = linear.gram[:, :14, :14] * np.swapaxes(linear.inverse, 1, 2)
    leverage = w * ((s.conj() @ hat) * s).sum(axis=2).real

    J = _derivatives(slopes[records.load], linear.amplitudes)
    weighted = (J.conj() * w[:, None, :, None]).reshape(*J.shape[:2], -1)
    gradient = (weighted @ (linear.data - linear.smoothed).reshape(len(J), -1, 1))[:, :, 0].real
    return Evaluation(linear.residual, leverage, gradient, _information(J, linear))


def _derivatives(slopes: Complex, amplitudes: NDArray[np.complexfloating]) -> Complex:
    """Give the derivatives of the fitted records, as coefficients of (e^{λt}, t e^{λt}); (drop, parameter, channel, 28)."""
    J: Complex = slopes * np.tile(amplitudes, 2)[:, None, None, :]
    return J


def _information(J: Complex, linear: _Amplitudes) -> Real:
    """Give the products of derivatives with what amplitudes and offsets can take up projected off."""
    drops, parameters = J.shape[:2]
    w = linear.weights[:, None, :, None]
    products = (J.reshape(drops, -1, 28) @ np.swapaxes(linear.gram, 1, 2)).reshape(J.shape)
    within = (J.conj() * w).reshape(drops, parameters, -1) @ np.swapaxes(products.reshape(drops, parameters, -1), 1, 2)
    across = (linear.shapes.conj()[:, None] * w * products[..., :14]).sum(axis=2)
    information: Real = (within - across.conj() @ linear.inverse @ np.swapaxes(across, 1, 2)).real
    return information


def _feigned(records: Records, modes: Sequence[ModalSolution], slopes: Complex, weights: Real) -> Real:
    linear = _solve_amplitudes(records, modes, weights)
    # What noise puts into the amplitudes: their inverse normal equations, less what their reach holds back.
    eigenvalues, vectors = np.linalg.eigh(linear.normal)
    roots = linear.inverse @ (vectors * np.sqrt(np.maximum(eigenvalues, 0.0))[:, None, :])
    of_drops = slopes[records.load]
    each = [_information(_derivatives(of_drops, roots[:, :, j]), linear) for j in range(14)]
    total: Real = np.sum(each, axis=(0, 1))
    return total

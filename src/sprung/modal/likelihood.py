"""The likelihood of free decays given their poles and shapes: y_d = Re Σ_j φ_j q_dj e^{λ_j t} + offset_d + noise.

Poles λ and shapes φ are shared by all records; how much of each mode a record holds (q) and its offsets are its own, and as
they are linear they are solved for in closed form (variable projection: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973)
413). A pole and its conjugate are two columns here, so complex and real poles are treated alike, and whatever is solved for
comes out conjugate too. All sums over samples are those of `sprung.vibration`: nothing of the records' length is ever formed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.modal.decays import Decays
from sprung.modal.spectrum import Spectrum
from sprung.vibration import EQUAL_ENTRIES

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.int64]

_ROUNDING_SHARE = 1e-15
"""Part of its diagonal added to normal equations that are to be inverted: rounding must not make them indefinite."""

_UNDETERMINED = 1e-13
"""Information, relative to that of a parameter alone, that is lost in rounding."""

LEAST_NOISE = 1e-6
"""Noise of a channel, as a part of its root-mean-square, below which it cannot be distinguished from rounding."""


@dataclass(frozen=True, eq=False)
class Poles:
    """Poles and shapes, one of each conjugate pair.

    Attributes
    ----------
    exponent
        λ per sample, imaginary part not negative, shape (mode,).
    shapes
        At the channels, real for a real pole, each with an entry of 1 where it is `held`; shape (channel, mode).
    held
        Which channel that is, shape (mode,).
    """

    exponent: Complex
    shapes: Complex
    held: Index

    @classmethod
    def of(cls, exponent: Complex, shapes: Complex) -> Poles:
        """Scale shapes to a largest entry of 1; those of real poles become real."""
        sizes = np.abs(shapes)
        held = np.argmax(sizes >= (1 - EQUAL_ENTRIES) * sizes.max(axis=0), axis=0)
        scaled = shapes / shapes[held, np.arange(len(held))]
        real = exponent.imag == 0
        return cls(exponent, np.where(real, scaled.real, scaled).astype(np.complex128), held)

    @property
    def count(self) -> int:
        """How many modes there are."""
        return len(self.exponent)

    @cached_property
    def paired(self) -> Index:
        """Which of them have a conjugate."""
        return np.flatnonzero(self.exponent.imag != 0)

    def both(self, values: Complex, axis: int = -1) -> Complex:
        """Append the conjugates of the values of paired poles."""
        return np.concatenate([values, np.take(values, self.paired, axis=axis).conj()], axis=axis)

    def without(self, which: int) -> Poles:
        """Return the poles without one mode."""
        kept = np.arange(self.count) != which
        return Poles(self.exponent[kept], self.shapes[:, kept], self.held[kept])

    def joined_with(self, other: Poles) -> Poles:
        """Append other poles."""
        return Poles(
            np.concatenate([self.exponent, other.exponent]),
            np.concatenate([self.shapes, other.shapes], axis=1),
            np.concatenate([self.held, other.held]),
        )


@dataclass(frozen=True, eq=False)
class ModalObjective:
    """The likelihood and its derivatives at given poles and shapes, channels weighted by 1/σ².

    Attributes
    ----------
    decays
        The records.
    poles
        Poles and shapes.
    weights
        1/σ² of each channel, shape (channel,).
    gram, data
        Inner products of (e^{λk}, k e^{λk}) with each other and with the records, conjugates behind; shapes (record,
        2 pole, 2 pole) and (record, channel, 2 pole).
    """

    decays: Decays
    poles: Poles
    weights: Real
    gram: Complex
    data: Complex

    @classmethod
    def at(cls, decays: Decays, poles: Poles, weights: Real) -> ModalObjective:
        """Sum over the samples."""
        exponent = poles.both(poles.exponent)
        products = decays.correlate(poles.exponent).reshape(decays.count, decays.channels, 2, poles.count)
        data = poles.both(products).reshape(decays.count, decays.channels, -1)
        return cls(decays, poles, weights, decays.gram(exponent), data)

    def weighted(self, weights: Real) -> ModalObjective:
        """Return the objective with other weights."""
        return ModalObjective(self.decays, self.poles, weights, self.gram, self.data)

    def without(self, which: int) -> ModalObjective:
        """Return the objective without one mode and its sums."""
        size = self.shapes.shape[1]
        gone = np.append(np.flatnonzero(self.poles.paired == which) + self.poles.count, which)
        kept = np.setdiff1d(np.arange(size), gone)
        both = np.concatenate([kept, kept + size])
        gram, data = self.gram[:, both[:, None], both], self.data[:, :, both]
        return ModalObjective(self.decays, self.poles.without(which), self.weights, gram, data)

    @cached_property
    def shapes(self) -> Complex:
        """Of all poles, conjugates behind, shape (channel, pole)."""
        return self.poles.both(self.poles.shapes)

    @cached_property
    def _across(self) -> Complex:
        """Φᴴ W Φ, shape (pole, pole)."""
        return np.asarray((self.shapes.conj().T * self.weights) @ self.shapes, dtype=np.complex128)

    @cached_property
    def normal(self) -> Complex:
        """Normal equations of the amplitudes, shape (record, pole, pole)."""
        size = self.shapes.shape[1]
        return self._across * self.gram[:, :size, :size]

    @cached_property
    def inverse(self) -> Complex:
        """Their inverse."""
        return invert_normal_equations(self.normal)

    @cached_property
    def amplitudes(self) -> Complex:
        """q, shape (record, pole)."""
        size = self.shapes.shape[1]
        seen = np.einsum("cj,c,dcj->dj", self.shapes.conj(), self.weights, self.data[:, :, :size])
        return np.asarray((self.inverse @ seen[:, :, None])[:, :, 0], dtype=np.complex128)

    @cached_property
    def coefficients(self) -> Complex:
        """Of e^{λk} in what is fitted, shape (record, channel, pole)."""
        return np.asarray(self.shapes * self.amplitudes[:, None, :], dtype=np.complex128)

    @cached_property
    def _unexplained(self) -> Complex:
        """Inner products of (e^{λk}, k e^{λk}) with the residuals, shape (record, channel, 2 pole)."""
        size = self.shapes.shape[1]
        fitted = self.coefficients @ np.swapaxes(self.gram[:, :, :size], 1, 2)
        return np.asarray(self.data - fitted, dtype=np.complex128)

    @cached_property
    def residual(self) -> Real:
        """Residual sum of squares, shape (record, channel)."""
        size = self.shapes.shape[1]
        explained = self.coefficients.conj() * (self.data + self._unexplained)[:, :, :size]
        return np.asarray(np.maximum(self.decays.energy - explained.real.sum(axis=2), 0.0))

    @property
    def shares(self) -> Real:
        """Energy of each mode alone as a part of that of each channel, all records together; shape (channel, mode)."""
        size, count = self.shapes.shape[1], self.poles.count
        twice = np.where(self.poles.exponent.imag != 0, 2.0, 1.0)
        energies = np.diagonal(self.gram[:, :size, :size], axis1=1, axis2=2).real[:, None, :count]
        # A pole outside the motion may have any amplitude.
        sizes = np.minimum(np.abs(self.coefficients[:, :, :count]) * np.sqrt(np.maximum(energies, 0.0)), 1e100)
        energy = (sizes**2).sum(axis=0) * twice
        return np.asarray(energy / np.maximum(self.decays.energy.sum(axis=0), 1e-300)[:, None])

    @cached_property
    def residuals(self) -> tuple[Real, ...]:
        """Residuals of each record, shape (channel, time)."""
        return self.decays.subtract(self.poles.both(self.poles.exponent), self.coefficients)

    @cached_property
    def residual_spectrum(self) -> Spectrum:
        """Spectrum of the residuals."""
        return Spectrum.of(self.residuals, self.decays.rate)

    @cached_property
    def variance(self) -> Real:
        """Maximum likelihood estimate of σ² of each channel, shape (channel,)."""
        return np.asarray(np.maximum(self.residual.sum(axis=0) / self.decays.sample_count, self.least_variance))

    @property
    def least_variance(self) -> Real:
        """Lower limit of σ², set by rounding, shape (channel,)."""
        energy = self.decays.energy.sum(axis=0)
        return np.asarray(np.where(energy > 0, LEAST_NOISE**2 * energy, 1.0) / self.decays.sample_count)

    @property
    def cost(self) -> float:
        """Twice the negative log-likelihood with σ² eliminated, less a constant."""
        return float(self.decays.sample_count * np.log(self.variance).sum())

    @property
    def parameters(self) -> int:
        """Number of free real parameters: poles, shapes, amplitudes, offsets."""
        poles, channels, records = self.shapes.shape[1], self.decays.channels, self.decays.count
        return int(poles * (channels + records) + records * channels)

    @cached_property
    def free(self) -> Index:
        """Positions of the free entries of (shapes, channel by channel; poles), without those held at 1; with conjugates."""
        size = self.shapes.shape[1]
        held = self.poles.both(self.poles.held.astype(np.complex128)).real.astype(np.int64)
        kept = np.ones((self.decays.channels + 1, size), dtype=np.bool_)
        kept[held, np.arange(size)] = False
        return np.flatnonzero(kept)

    def pole_of(self, which: int) -> Index:
        """Return the positions of the pole of a mode and of its conjugate."""
        first = self.decays.channels * self.shapes.shape[1]
        twin = np.flatnonzero(self.poles.paired == which) + self.poles.count
        return np.asarray(np.concatenate([[which], twin]) + first, dtype=np.int64)

    @cached_property
    def gradient(self) -> Complex:
        """Of the log-likelihood by the conjugates of shapes and poles, shape (channel + 1, pole)."""
        return np.asarray(self._gradients.sum(axis=0))

    @cached_property
    def _gradients(self) -> Complex:
        """The same of each record, shape (record, channel + 1, pole)."""
        size = self.shapes.shape[1]
        turned = self.amplitudes.conj()[:, None, :] * self._unexplained[:, :, :size] * self.weights[:, None]
        moved = self.amplitudes.conj()[:, None, :] * self._unexplained[:, :, size:] * self.weights[:, None]
        of_poles = (self.shapes.conj() * moved).sum(axis=1, keepdims=True)
        return np.concatenate([turned, of_poles], axis=1)

    @cached_property
    def information(self) -> Complex:
        """Fisher information of shapes and poles, amplitudes and offsets eliminated.

        Between their conjugates and themselves, as for complex numbers of which each has its conjugate in the list; shape
        (parameter, parameter) with parameters channel by channel, pole by pole, then the poles themselves.
        """
        return self._information(np.arange(self.decays.count))

    @cached_property
    def covariance(self) -> Complex:
        """The inverse of that over what is free; shape (parameter, parameter), zero for what is held."""
        covariance = np.zeros((self.gradient.size,) * 2, dtype=np.complex128)
        covariance[np.ix_(self.free, self.free)] = invert_information(self.information[np.ix_(self.free, self.free)])
        return covariance

    def by_record(self) -> Iterator[tuple[Complex, Complex]]:
        """Yield the gradient and information of each record; shapes (parameter,) and (parameter, parameter)."""
        for record in range(self.decays.count):
            yield self._gradients[record].ravel(), self._information(np.array([record]))

    def _information(self, records: Index) -> Complex:
        size, channels = self.shapes.shape[1], self.decays.channels
        q, w, s, gram = self.amplitudes[records], self.weights, self.shapes, self.gram[records]
        both = q.conj()[:, :, None] * q[:, None, :]
        within = (both * gram[:, :size, :size]).sum(axis=0)
        onward = (both * gram[:, :size, size:]).sum(axis=0)
        sensitivity_products = (both * gram[:, size:, size:]).sum(axis=0)
        whole = np.zeros((channels + 1, size, channels + 1, size), dtype=np.complex128)
        channel = np.arange(channels)
        whole[channel, :, channel, :] = w[:, None, None] * within
        whole[:channels, :, channels, :] = w[:, None, None] * onward * s[:, None, :]
        whole[channels, :, :channels, :] = np.moveaxis(whole[:channels, :, channels, :].conj(), (0, 1, 2), (1, 2, 0))
        whole[channels, :, channels, :] = self._across * sensitivity_products
        # Elimination of the amplitudes (Schur complement).
        coupling = np.empty((len(records), size, channels + 1, size), dtype=np.complex128)
        through = (s.conj() * w[:, None]).T
        coupling[:, :, :channels] = through[None, :, :, None] * gram[:, :size, None, :size] * q[:, None, None, :]
        coupling[:, :, channels] = self._across * gram[:, :size, size:] * q[:, None, :]
        flat = coupling.reshape(len(records), size, -1)
        eliminated = (np.swapaxes(flat.conj(), 1, 2) @ (self.inverse[records] @ flat)).sum(axis=0)
        return np.asarray(whole.reshape(eliminated.shape) - eliminated)

    def moved(self, step: Complex) -> Poles:
        """Return the poles and shapes after a step, shape (channel + 1, pole)."""
        count = self.poles.count
        real = self.poles.exponent.imag == 0
        exponent = self.poles.exponent + np.where(real, step[-1, :count].real, step[-1, :count])
        # A pair that would cross the real axis stays a pair: `real_axis_alternatives` tries the other side.
        exponent = np.where(real, exponent, exponent.real + 1j * np.abs(exponent.imag))
        return Poles.of(exponent, self.poles.shapes + step[:-1, :count])


def unit_scales(diagonal: Real) -> Real:
    """Return the scales that turn a diagonal, in the last axis, into ones; limited for entries near zero."""
    least = np.maximum(1e-60 * diagonal.max(axis=-1, keepdims=True), 1e-200)
    return np.asarray(1 / np.sqrt(np.maximum(diagonal, least)))


def invert_information(information: Complex) -> Complex:
    """Invert an information matrix; directions without information get the largest variance that rounding allows."""
    scale = unit_scales(np.diagonal(information).real)
    eigenvalues, vectors = np.linalg.eigh(information * scale[:, None] * scale)
    # Rounding alone is left in a direction that nothing determines: its variance has an upper limit.
    roots = scale[:, None] * vectors / np.sqrt(np.maximum(eigenvalues, _UNDETERMINED))
    return np.asarray(roots @ roots.conj().T, dtype=np.complex128)


def invert_normal_equations(normal: Complex) -> Complex:
    """Invert normal equations of amplitudes, which may differ by orders of magnitude."""
    scale = unit_scales(np.diagonal(normal, axis1=1, axis2=2).real)
    both = scale[:, :, None] * scale[:, None, :]
    scaled = normal * both + _ROUNDING_SHARE * np.eye(normal.shape[1])
    return np.asarray(np.linalg.inv(scaled) * both, dtype=np.complex128)

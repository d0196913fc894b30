"""A run of records at given poles and shapes: its free amplitudes, and what they leave of the derivatives.

In modal coordinates a channel of a decay is Σ_j s_cj q_j e^{λ_j t} plus an offset, and its derivative by a parameter
is Σ_j (σ_cj + τ_cj t) q_j e^{λ_j t}. The amplitudes q (the unknown initial state) and the offsets are linear: they are
solved for in closed form, and their directions are projected off the derivatives (variable projection after Golub and
Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, in Kaufman's form). All that is assumed of an initial state is that it is one
a vehicle can be in, so that a motion which no sensor sees is taken to be none.

Shapes belong to a load, not to a record. So whatever they multiply is added up over the records of a group first, and
derivatives of records are never made.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.delays import SETTLED, STEPS, Delays
from sprung.estimation.expm_likelihood import reach
from sprung.estimation.records import RecordBatch
from sprung.vibration import exponential_gram, exponentials

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


def reach_of(right: Complex) -> Complex:
    """Give what is assumed of initial states as information on the amplitudes of modes; both of shape (..., mode, mode)."""
    return np.asarray((np.swapaxes(right.conj(), 1, 2) / reach(right.shape[-1]) ** 2) @ right, dtype=np.complex128)


def inverse_of(normal: Complex) -> Complex:
    """Invert normal equations of amplitudes, which may differ by orders of magnitude; shape (..., mode, mode)."""
    scale = 1 / np.sqrt(np.diagonal(normal, axis1=1, axis2=2).real)
    both = scale[:, :, None] * scale[:, None, :]
    return np.asarray(np.linalg.inv(normal * both), dtype=np.complex128) * both


@dataclass(frozen=True, eq=False)
class ExponentialSums:
    """What an evaluation needs of a run's samples, whatever the weights.

    Attributes
    ----------
    run
        The records.
    values
        Parameters, SI, shape (parameter,).
    expected
        How late each logger should be, s, shape (record, logger).
    poles
        λ, 1/s, shape (group, mode).
    shapes
        s, shape (group, channel, mode).
    reach
        What is assumed of initial states, as information on the amplitudes, shape (group, mode, mode).
    gram
        Inner products of (e^{λk}, k e^{λk}) with each other, shape (record, 2 mode, 2 mode).
    data
        Inner products of them with the records, shape (record, channel, 2 mode).
    """

    run: RecordBatch
    values: Real
    expected: Real
    poles: Complex
    shapes: Complex
    reach: Complex
    gram: Complex
    data: Complex

    @classmethod
    def of(cls, run: RecordBatch, values: Real, poles: Complex, right: Complex, shapes: Complex) -> ExponentialSums:
        """Sum over the samples, once for given parameters and their poles, eigenvectors and shapes of each load."""
        expected = run.expected + run.follows @ values if run.late.size else run.expected
        poles, right = poles[run.load], right[run.load]
        exponent = poles * run.step[:, None]
        products = exponential_gram(exponent, run.samples, run.group)
        return cls(run, values, expected, poles, shapes[run.load], reach_of(right), products, run.correlate(exponent))

    def solve(self, weights: Real) -> ProjectedResponse:
        """Solve for the amplitudes and delays, channels weighted by 1/σ², shape (channel,)."""
        late = self.run.late
        if not late.shape[1]:
            return self._solve(weights)
        values = self.expected
        for _ in range(STEPS):
            turned = self._turned(values)
            solved = turned._solve(weights)
            delays = turned._delays(solved, values)
            step = delays.step
            if np.abs(step).max() < SETTLED:
                break
            values = values + step
        return replace(solved, delays=delays)

    def align_by_likelihood(self, weights: Real, shifts: Real) -> Real:
        """Slide clocks that are hardly known to where the records are likeliest; shape (record, logger)."""
        expected, wide = self.expected, self.run.expected_std
        found = expected.copy()
        for _ in range(2):
            for logger in np.flatnonzero((wide > shifts.max() / 10).any(axis=0)).tolist():
                values = np.repeat(found[None], len(shifts), axis=0)
                values[:, :, logger] = expected[:, logger] + shifts[:, None]
                left = [self._turned(tried)._solve(weights).residual @ weights for tried in values]
                costs = np.array(left) + (shifts[:, None] / wide[:, logger]) ** 2
                found[:, logger] = values[np.argmin(costs, axis=0), np.arange(len(found)), logger]
        return found

    def _turned(self, delays: Real) -> ExponentialSums:
        """Give the same with delays in the shapes; records are groups then."""
        late = (delays @ self.run.late.T)[:, :, None]
        return replace(self, shapes=self.shapes * np.exp(self.poles[:, None] * late))

    def _delays(self, solved: ProjectedResponse, values: Real) -> Delays:
        weighted = self.shapes.conj() * solved.weights[:, None]
        m = solved.modes
        exponential_gram, data = self.gram[:, :m, :m], self.data[:, :, :m]
        inverse, amplitudes = solved.inverse, solved.amplitudes
        run = self.run
        known = self.expected, run.expected_std, run.follows, run.late, run.flown, self.values
        return Delays(values, *known, self.poles, self.shapes, weighted, exponential_gram, data, inverse, amplitudes)

    def _solve(self, weights: Real) -> ProjectedResponse:
        w, group, m = self.run.present * weights, self.run.group, self.poles.shape[1]
        weighted = self.shapes.conj() * w[:, None]
        normal = (np.swapaxes(weighted, 1, 2) @ self.shapes)[group] * self.gram[:, :m, :m]
        inverse = inverse_of(normal + self.reach[group])
        projected = (weighted[group] * self.data[:, :, :m]).sum(axis=1)
        return ProjectedResponse(self, w, normal, inverse, (inverse @ projected[:, :, None])[:, :, 0])


@dataclass(frozen=True, eq=False)
class ProjectedResponse:
    """The linear half of an evaluation.

    Attributes
    ----------
    sums
        Where.
    weights
        1/σ², zero for channels that are left out, shape (channel,).
    normal
        Normal equations of the amplitudes, from the records alone, shape (record, mode, mode).
    inverse
        Inverse of the same with their reach added, shape (record, mode, mode).
    amplitudes
        q, shape (record, mode).
    delays
        Those of several loggers' clocks, which are in the shapes of the sums; None where all have one clock.
    """

    sums: ExponentialSums
    weights: Real
    normal: Complex
    inverse: Complex
    amplitudes: Complex
    delays: Delays | None = None

    @property
    def modes(self) -> int:
        """How many there are."""
        return len(self.amplitudes[0])

    @cached_property
    def _fitted(self) -> Complex:
        """Coefficients of e^{λk} in the fitted records, shape (record, channel, mode)."""
        return self.sums.shapes[self.sums.run.group] * self.amplitudes[:, None, :]

    @cached_property
    def _smoothed(self) -> Complex:
        """Inner products of (e^{λk}, k e^{λk}) with the fitted records, shape (record, channel, 2 mode)."""
        return self._fitted @ np.swapaxes(self.sums.gram[:, :, : self.modes], 1, 2)

    @cached_property
    def residual(self) -> Real:
        """Residual sum of squares of each channel, (m/s²)², shape (record, channel)."""
        run, fitted, m = self.sums.run, self._fitted, self.modes
        unexplained = 2 * self.sums.data[:, :, :m] - self._smoothed[:, :, :m]
        explained = (fitted.real * unexplained.real + fitted.imag * unexplained.imag).sum(axis=2)
        residual: Real = run.present * np.maximum(run.energy - explained, 0.0)
        return residual

    @property
    def penalty(self) -> float:
        """What is to be added to the weighted residuals for delays that are not as expected."""
        return 0.0 if self.delays is None else self.delays.penalty

    @property
    def leverage(self) -> Real:
        """How many of the amplitudes each channel pays for, all records together; shape (channel,)."""
        s, m = self.sums.shapes, self.modes
        hat = self.sums.run.by_group(self.sums.gram[:, :m, :m] * np.swapaxes(self.inverse, 1, 2))
        leverage: Real = self.weights * ((s.conj() @ hat) * s).sum(axis=(0, 2)).real
        return leverage

    def turned(self, slopes: Complex) -> Complex:
        """Give σ and τ where the channels have the delays that were found: for t + δ stands where t stood.

        Parameters
        ----------
        slopes
            Without delays: σ and τ beside each other, τ per sample; shape (group, channel, change, 2 mode).
        """
        if self.delays is None:
            return slopes
        later = (self.delays.values @ self.delays.late.T)[:, :, None, None]
        turn = np.exp(self.sums.poles[:, None, None] * later)
        shapes, secular = np.split(slopes, 2, axis=-1)
        secular = secular * turn
        moved = shapes * turn + secular * (later / self.sums.run.step[:, None, None, None])
        return np.concatenate([moved, secular], axis=-1)

    def gradient(self, slopes: Complex) -> Real:
        """Give Σ derivative · residual / σ² of each record.

        Parameters
        ----------
        slopes
            σ and τ beside each other, τ per sample; shape (group, channel, parameter, 2 mode).

        Returns
        -------
        ndarray
            Shape (record, parameter).
        """
        left = (self.sums.data - self._smoothed).conj() * np.tile(self.amplitudes, 2)[:, None, :]
        left *= self.weights[:, None]
        run = self.sums.run
        parts = [
            np.tensordot(left[run.members(group)], own, axes=([1, 2], [0, 2])).real for group, own in enumerate(slopes)
        ]
        gradient = np.concatenate(parts)
        if self.delays is not None:
            parameters = self.delays.follows.shape[2]
            gradient[:, :parameters] += self.delays.gradient
        return gradient

    def information(self, slopes: Complex, apart: bool = False) -> Real:
        """Give the products of the derivatives with each other, less what amplitudes and offsets can take up.

        Parameters
        ----------
        slopes
            As for `gradient`.
        apart
            Whether those of each record are wanted, or of each group together.

        Returns
        -------
        ndarray
            Fisher information, shape (group or record, parameter, parameter).
        """
        run, q = self.sums.run, np.tile(self.amplitudes, 2)
        driven = self.sums.gram * q[:, None, :]
        found = []
        for group, own in enumerate(slopes):
            members, parameters = run.members(group), own.shape[1]
            shared = q[members].conj()[:, :, None] * driven[members]
            if not apart:
                shared = shared.sum(axis=0, keepdims=True)
            products = (own.reshape(-1, q.shape[1]) @ np.swapaxes(shared, 1, 2)).reshape(-1, *own.shape)
            products *= self.weights[:, None, None]
            # The real part of a product of complex numbers, one conjugated, is that of pairs of real ones.
            within = (own.view(float) @ np.swapaxes(products.view(float), 2, 3)).sum(axis=1)
            flat = self._across(group, own, driven[members])
            taken = (np.swapaxes(flat.conj(), 1, 2) @ (self.inverse[members] @ flat)).real
            if self.delays is not None:
                taken += self.delays.taken(group, own, driven[group], flat[0])
                within += self.delays.information(group, parameters)
            found.append(within - (taken if apart else taken.sum(axis=0, keepdims=True)))
        return np.concatenate(found)

    def _across(self, group: int, slopes: Complex, driven: Complex) -> Complex:
        """Give the inner products of a group's derivatives with what the amplitudes do, (record, mode, parameter)."""
        channels, parameters = slopes.shape[:2]
        # Amplitudes see the derivatives through the shapes.
        through = (self.sums.shapes[group].conj() * self.weights[:, None]).T
        seen = (through @ slopes.reshape(channels, -1)).reshape(self.modes, parameters, -1)
        across = np.swapaxes(driven[:, : self.modes], 0, 1) @ np.swapaxes(seen, 1, 2)
        return np.ascontiguousarray(np.swapaxes(across, 0, 1))

    def delay_covariances(self, slopes: Complex, covariance: Real) -> Iterator[Real]:
        """Give the covariance of every record's delays, that of the parameters in it; s², shape (delay, delay).

        Parameters
        ----------
        slopes
            As for `gradient`.
        covariance
            Of the parameters, SI, shape (parameter, parameter).
        """
        assert self.delays is not None  # noqa: S101 (asked for where there are some; for the type checker)
        driven = self.sums.gram * np.tile(self.amplitudes, 2)[:, None, :]
        for record, own in enumerate(slopes):
            across = self._across(record, own, driven[record : record + 1])[0]
            alone = self.delays.covariance[record]
            carried = alone @ self.delays.response(record, own, driven[record], across)
            yield alone + carried @ covariance @ carried.T

    def noise_bias_of_information(self, slopes: Complex) -> Real:
        """Give the information that noise alone feigns, shape (parameter, parameter)."""
        # What noise puts into the amplitudes: their inverse normal equations, less what their reach holds back.
        eigenvalues, vectors = np.linalg.eigh(self.normal)
        roots = self.inverse @ (vectors * np.sqrt(np.maximum(eigenvalues, 0.0))[:, None, :])
        each = [replace(self, amplitudes=roots[:, :, j], delays=None).information(slopes) for j in range(self.modes)]
        total: Real = np.sum(each, axis=(0, 1))
        return total

    def fitted(self, poles: Complex) -> Iterator[Real]:
        """Give what the model makes of each record, its mean taken off, from poles of each load; of shape (channel, time)."""
        run = self.sums.run
        for group, (load, step) in enumerate(zip(run.load, run.step, strict=True)):
            members = run.members(group)
            # A pole and its conjugate add the same real part twice.
            upper = poles[load].imag >= 0
            twice = np.where(poles[load].imag > 0, 2.0, 1.0)[upper]
            # The real part of a product of complex numbers is that of pairs of real ones, one of them conjugated.
            motion = exponentials(poles[load][upper] * step, int(run.samples[members].max())).view(float)
            for one, samples in zip(self._fitted[members][..., upper] * twice, run.samples[members], strict=True):
                record = np.ascontiguousarray(one.conj()).view(float) @ motion[:samples].T
                record -= record.mean(axis=1, keepdims=True)
                yield record

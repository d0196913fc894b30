"""A batch of records at given poles and shapes: its free amplitudes, and what they leave of the derivatives.

In modal coordinates a channel of a decay is Σ_j s_cj q_j e^{λ_j t} plus an offset, and its derivative by a parameter
is Σ_j (σ_cj + τ_cj t) q_j e^{λ_j t}. The amplitudes q (the unknown initial state) and the offsets are linear: they are
solved for in closed form, and their directions are projected off the derivatives (variable projection after Golub and
Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, in Kaufman's form). All that is assumed of an initial state is that it is one
a vehicle can be in, so that a motion which no sensor observes is taken to be none.

Shapes belong to a load, not to a record. So whatever they multiply is added up over the records of a group first, and
derivatives of records are never made.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.clock_delays import CONVERGED, MOST_STEPS, ClockDelays
from sprung.estimation.modal_solution import ModalSolution, turns
from sprung.estimation.records import RecordBatch
from sprung.vibration import exponential_gram, exponentials

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


def initial_state_prior_std(coordinates: int, states: int) -> Real:
    """Return the prior of an initial state {X, Ẋ}: a metre or radian, and ten of them in a second; shape (state,)."""
    return np.repeat([1.0, 10.0], [coordinates, states - coordinates])


def amplitude_prior(modes: ModalSolution) -> Complex:
    """Return the prior of initial states as information on the amplitudes of modes, shape (..., mode, mode)."""
    std = initial_state_prior_std(modes.coordinates, modes.poles.shape[-1])
    scaled = np.swapaxes(modes.right.conj(), -1, -2) / std**2
    return np.asarray(scaled @ modes.right, dtype=np.complex128)


def inverse_of(normal: Complex) -> Complex:
    """Return the inverse of normal equations of amplitudes, which may differ by orders of magnitude; (..., mode, mode).

    Of two modes that coincide the records determine the sum of both amplitudes: the pseudo-inverse gives each one half.
    """
    scale = 1 / np.sqrt(np.diagonal(normal, axis1=1, axis2=2).real)
    both = scale[:, :, None] * scale[:, None, :]
    try:
        inverse = np.linalg.inv(normal * both)
    except np.linalg.LinAlgError:
        inverse = np.linalg.pinv(normal * both, hermitian=True)
    return np.asarray(inverse, dtype=np.complex128) * both


@dataclass(frozen=True, eq=False)
class ExponentialSums:
    """What an evaluation needs of a batch's samples, whatever the weights.

    Attributes
    ----------
    batch
        The records.
    values
        Parameters, SI, shape (parameter,).
    poles
        λ, 1/s, shape (group, mode).
    shapes
        s, shape (group, channel, mode).
    prior
        Information on the amplitudes from the prior of initial states, shape (group, mode, mode).
    gram
        Inner products of (e^{λk}, k e^{λk}) with each other, shape (record, 2 mode, 2 mode).
    data
        Inner products of them with the records, shape (record, channel, 2 mode).
    """

    batch: RecordBatch
    values: Real
    poles: Complex
    shapes: Complex
    prior: Complex
    gram: Complex
    data: Complex

    @classmethod
    def of(cls, batch: RecordBatch, values: Real, modes: ModalSolution) -> ExponentialSums:
        """Return the sums over the samples at parameters and the poles and shapes of each load."""
        poles, shapes, prior = modes.poles[batch.load], modes.shapes[batch.load], amplitude_prior(modes)[batch.load]
        exponent = poles * batch.step[:, None]
        gram = exponential_gram(exponent, batch.samples, batch.group)
        return cls(batch, values, poles, shapes, prior, gram, batch.correlate(exponent))

    def waves(self) -> list[Complex]:
        """Return e^{λk} of one pole of each pair over the longest record of each group, shape (time, upper mode).

        They are as large as the records of a drop, and not kept.
        """
        batch = self.batch
        # Where every record is a group, as its clocks differ, many have the same poles and steps.
        kinds = list(zip(batch.load.tolist(), batch.step.tolist(), strict=True))
        longest, made = dict[tuple[int, float], int](), dict[tuple[int, float], Complex]()
        for group, kind in enumerate(kinds):
            longest[kind] = max(longest.get(kind, 0), int(batch.samples[batch.members(group)].max()))
        for poles, kind in zip(self.poles, kinds, strict=True):
            if kind not in made:
                made[kind] = exponentials(poles[poles.imag >= 0] * kind[1], longest[kind])
        return [made[kind] for kind in kinds]

    @cached_property
    def expected_delays(self) -> Real:
        """Delay of each logger as known beforehand, s, shape (record, logger)."""
        batch = self.batch
        if not batch.clock_design.shape[1]:
            return batch.expected_delays
        return np.asarray(batch.expected_delays + batch.d_delay_d_parameter @ self.values)

    def project(self, weights: Real) -> ProjectedResponse:
        """Solve for amplitudes and delays, channels weighted by 1/σ², shape (channel,)."""
        if not self.batch.clock_design.shape[1]:
            return self._project(weights)
        delays = self.expected_delays
        for _ in range(MOST_STEPS):
            response = self._turned(delays)._project(weights)
            clocks = self._clock_delays(response, delays)
            step = clocks.step
            if np.abs(step).max() < CONVERGED:
                break
            delays = delays + step
        return replace(response, clocks=clocks)

    def most_likely_delays(self, weights: Real, shifts: Real) -> Real:
        """Search for the delays of clocks that are hardly known, one logger after the other; shape (record, logger)."""
        expected, std = self.expected_delays, self.batch.delay_std
        found = expected.copy()
        for _ in range(2):
            for logger in np.flatnonzero((std > shifts.max() / 10).any(axis=0)).tolist():
                tried = np.repeat(found[None], len(shifts), axis=0)
                tried[:, :, logger] = expected[:, logger] + shifts[:, None]
                squares = [self._turned(delays)._project(weights).residual_sums @ weights for delays in tried]
                costs = np.array(squares) + (shifts[:, None] / std[:, logger]) ** 2
                found[:, logger] = tried[np.argmin(costs, axis=0), np.arange(len(found)), logger]
        return found

    def _turned(self, delays: Real) -> ExponentialSums:
        """Return the sums with delays in the shapes; every record is a group then."""
        by_channel = (delays @ self.batch.clock_design.T)[:, :, None]
        return replace(self, shapes=self.shapes * turns(self.poles[:, None] * by_channel))

    def _clock_delays(self, response: ProjectedResponse, delays: Real) -> ClockDelays:
        sums, m = response.sums, response.modes
        return ClockDelays(
            batch=self.batch,
            values=delays,
            expected=self.expected_delays,
            parameters=self.values,
            poles=self.poles,
            shapes=sums.shapes,
            weights=response.weights,
            gram=sums.gram[:, :m, :m],
            data=sums.data[:, :, :m],
            inverse=response.inverse,
            amplitudes=response.amplitudes,
        )

    def _project(self, weights: Real) -> ProjectedResponse:
        w, group, m = self.batch.channel_weights * weights, self.batch.group, self.poles.shape[1]
        weighted = self.shapes.conj() * w[:, None]
        normal = (np.swapaxes(weighted, 1, 2) @ self.shapes)[group] * self.gram[:, :m, :m]
        inverse = inverse_of(normal + self.prior[group])
        projected = (weighted[group] * self.data[:, :, :m]).sum(axis=1)
        return ProjectedResponse(self, w, normal, inverse, (inverse @ projected[:, :, None])[:, :, 0])


@dataclass(frozen=True, eq=False)
class ProjectedResponse:
    """The linear half of an evaluation: amplitudes and what they leave.

    Attributes
    ----------
    sums
        Over the samples.
    weights
        1/σ², zero for channels that are left out, shape (channel,).
    normal
        Normal equations of the amplitudes, from the records alone, shape (record, mode, mode).
    inverse
        Inverse of the same with their prior added, shape (record, mode, mode).
    amplitudes
        q, shape (record, mode).
    clocks
        Delays of several loggers' clocks, which are in the shapes of the sums; None where all have one clock.
    """

    sums: ExponentialSums
    weights: Real
    normal: Complex
    inverse: Complex
    amplitudes: Complex
    clocks: ClockDelays | None = None

    @property
    def modes(self) -> int:
        """Number of modes."""
        return int(self.amplitudes.shape[1])

    @cached_property
    def _coefficients(self) -> Complex:
        """Coefficients of e^{λk} in the fitted records, shape (record, channel, mode)."""
        return self.sums.shapes[self.sums.batch.group] * self.amplitudes[:, None, :]

    @cached_property
    def _smoothed(self) -> Complex:
        """Inner products of (e^{λk}, k e^{λk}) with the fitted records, shape (record, channel, 2 mode)."""
        return self._coefficients @ np.swapaxes(self.sums.gram[:, :, : self.modes], 1, 2)

    @cached_property
    def residual_sums(self) -> Real:
        """Residual sums of squares, (m/s²)², shape (record, channel)."""
        batch, fitted, m = self.sums.batch, self._coefficients, self.modes
        unexplained = 2 * self.sums.data[:, :, :m] - self._smoothed[:, :, :m]
        explained = (fitted.real * unexplained.real + fitted.imag * unexplained.imag).sum(axis=2)
        sums: Real = batch.channel_weights * np.maximum(batch.energy - explained, 0.0)
        return sums

    @property
    def penalty(self) -> float:
        """What is to be added to the weighted residuals for delays that are not as expected."""
        return 0.0 if self.clocks is None else self.clocks.penalty

    @property
    def leverage(self) -> Real:
        """Number of the amplitudes that each channel determines, all records together; shape (channel,)."""
        s, m = self.sums.shapes, self.modes
        hat = self.sums.batch.sum_groups(self.sums.gram[:, :m, :m] * np.swapaxes(self.inverse, 1, 2))
        leverage: Real = self.weights * ((s.conj() @ hat) * s).sum(axis=(0, 2)).real
        return leverage

    def turned(self, derivatives: Complex) -> Complex:
        """Return σ and τ where the channels have the delays that were found: with t + δ in place of t.

        Parameters
        ----------
        derivatives
            Without delays: σ and τ beside each other, τ per sample; shape (group, channel, change, 2 mode).
        """
        if self.clocks is None:
            return derivatives
        batch = self.sums.batch
        delay = (self.clocks.values @ batch.clock_design.T)[:, :, None, None]
        turn = turns(self.sums.poles[:, None, None] * delay)
        shapes, secular = np.split(derivatives, 2, axis=-1)
        secular = secular * turn
        moved = shapes * turn + secular * (delay / batch.step[:, None, None, None])
        return np.concatenate([moved, secular], axis=-1)

    def gradient(self, derivatives: Complex) -> Real:
        """Return Σ derivative · residual / σ² of each record.

        Parameters
        ----------
        derivatives
            σ and τ beside each other, τ per sample; shape (group, channel, parameter, 2 mode).

        Returns
        -------
        ndarray
            Shape (record, parameter).
        """
        residual = (self.sums.data - self._smoothed).conj() * np.tile(self.amplitudes, 2)[:, None, :]
        residual *= self.weights[:, None]
        batch = self.sums.batch
        parts = [
            np.tensordot(residual[batch.members(group)], own, axes=([1, 2], [0, 2])).real
            for group, own in enumerate(derivatives)
        ]
        gradient = np.concatenate(parts)
        if self.clocks is not None:
            gradient[:, : len(self.sums.values)] += self.clocks.gradient
        return gradient

    def information(self, derivatives: Complex, by_record: bool = False) -> Real:
        """Return the Fisher information: products of the derivatives less what amplitudes, offsets and delays explain.

        Parameters
        ----------
        derivatives
            As for `gradient`.
        by_record
            Whether that of each record is wanted, or of each group together.

        Returns
        -------
        ndarray
            Shape (group or record, parameter, parameter).
        """
        batch, q = self.sums.batch, np.tile(self.amplitudes, 2)
        driven = self.sums.gram * q[:, None, :]
        found = []
        for group, own in enumerate(derivatives):
            members = batch.members(group)
            shared = q[members].conj()[:, :, None] * driven[members]
            if not by_record:
                shared = shared.sum(axis=0, keepdims=True)
            products = (own.reshape(-1, q.shape[1]) @ np.swapaxes(shared, 1, 2)).reshape(-1, *own.shape)
            products *= self.weights[:, None, None]
            # The real part of a product of complex numbers, one conjugated, is that of pairs of real ones.
            within = (own.view(float) @ np.swapaxes(products.view(float), 2, 3)).sum(axis=1)
            across = self._across(group, own, driven[members])
            explained = (np.swapaxes(across.conj(), 1, 2) @ (self.inverse[members] @ across)).real
            if self.clocks is not None:
                explained += self.clocks.explained(group, own, driven[group], across[0])
                within += self.clocks.information(group, own.shape[1])
            found.append(within - (explained if by_record else explained.sum(axis=0, keepdims=True)))
        return np.concatenate(found)

    def _across(self, group: int, derivatives: Complex, driven: Complex) -> Complex:
        """Inner products of a group's derivatives with what the amplitudes do, (record, mode, parameter)."""
        channels, parameters = derivatives.shape[:2]
        # Amplitudes meet the derivatives through the shapes.
        through = (self.sums.shapes[group].conj() * self.weights[:, None]).T
        met = (through @ derivatives.reshape(channels, -1)).reshape(self.modes, parameters, -1)
        across = np.swapaxes(driven[:, : self.modes], 0, 1) @ np.swapaxes(met, 1, 2)
        return np.ascontiguousarray(np.swapaxes(across, 0, 1))

    def delay_covariances(self, clocks: ClockDelays, derivatives: Complex, covariance: Real) -> Iterator[Real]:
        """Covariance of every record's delays, that of the parameters included; s², shape (delay, delay).

        Parameters
        ----------
        clocks
            The delays.
        derivatives
            As for `gradient`.
        covariance
            Of the parameters, SI, shape (parameter, parameter).
        """
        driven = self.sums.gram * np.tile(self.amplitudes, 2)[:, None, :]
        for record, own in enumerate(derivatives):
            across = self._across(record, own, driven[record : record + 1])[0]
            alone = clocks.covariance[record]
            projected = alone @ clocks.response(record, own, driven[record], across)
            yield alone + projected @ covariance @ projected.T

    def noise_bias_of_information(self, derivatives: Complex) -> Real:
        """Information that noise alone adds on average, shape (parameter, parameter).

        The information is quadratic in the amplitudes, so on average it is too large by what their covariance puts in their
        place.
        """
        # What noise puts into the amplitudes: their inverse normal equations, less what their prior holds back.
        eigenvalues, vectors = np.linalg.eigh(self.normal)
        roots = self.inverse @ (vectors * np.sqrt(np.maximum(eigenvalues, 0.0))[:, None, :])
        parts = [
            replace(self, amplitudes=roots[:, :, j], clocks=None).information(derivatives) for j in range(self.modes)
        ]
        total: Real = np.sum(parts, axis=(0, 1))
        return total

    def fitted(self) -> Iterator[Real]:
        """Modelled records, their means subtracted; each of shape (channel, time)."""
        batch = self.sums.batch
        for group, (poles, waves) in enumerate(zip(self.sums.poles, self.sums.waves(), strict=True)):
            members = batch.members(group)
            # A pole and its conjugate add the same real part twice.
            upper = poles.imag >= 0
            twice = np.where(poles.imag > 0, 2.0, 1.0)[upper]
            # The real part of a product of complex numbers is that of pairs of real ones, one of them conjugated.
            motion = waves.view(float)
            coefficients = self._coefficients[members][..., upper] * twice
            for own, samples in zip(coefficients, batch.samples[members], strict=True):
                record = np.ascontiguousarray(own.conj()).view(float) @ motion[:samples].T
                record -= record.mean(axis=1, keepdims=True)
                yield record

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
    initial_states
        Of each mode, in standard deviations of their prior, shape (group, state, mode).
    gram
        Inner products of (e^{λk}, k e^{λk}) with each other, shape (record, 2 mode, 2 mode).
    data
        Inner products of them with the records, shape (record, channel, 2 mode).
    """

    batch: RecordBatch
    values: Real
    poles: Complex
    shapes: Complex
    initial_states: Complex
    gram: Complex
    data: Complex

    @classmethod
    def of(cls, batch: RecordBatch, values: Real, modes: ModalSolution) -> ExponentialSums:
        """Return the sums over the samples at parameters and the poles and shapes of each load."""
        poles, shapes, initial_states = (part[batch.load] for part in (modes.poles, modes.shapes, modes.initial_states))
        exponent = poles * batch.step[:, None]
        gram = exponential_gram(exponent, batch.samples, batch.group)
        return cls(batch, values, poles, shapes, initial_states, gram, batch.correlate(exponent))

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
        prior = np.swapaxes(self.initial_states.conj(), 1, 2) @ self.initial_states
        inverse = inverse_of(normal + prior[group])
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

    @cached_property
    def _initial_states(self) -> Complex:
        """{X, Ẋ} of each record in standard deviations of their prior, shape (record, state)."""
        of_modes = self.sums.initial_states[self.sums.batch.group]
        return np.asarray((of_modes @ self.amplitudes[:, :, None])[:, :, 0])

    @property
    def penalty(self) -> float:
        """What is to be added to the weighted residuals for initial states, and for delays that are not as expected."""
        of_states = float(np.sum(self._initial_states.real**2))
        return of_states + (0.0 if self.clocks is None else self.clocks.penalty)

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
            Without delays: σ and τ beside each other, τ per sample; shape (group, channel + state, change, 2 mode).
        """
        if self.clocks is None:
            return derivatives
        channels = len(self.weights)
        batch = self.sums.batch
        delay = (self.clocks.values @ batch.clock_design.T)[:, :, None, None]
        turn = turns(self.sums.poles[:, None, None] * delay)
        shapes, secular = np.split(derivatives[:, :channels], 2, axis=-1)
        secular = secular * turn
        moved = shapes * turn + secular * (delay / batch.step[:, None, None, None])
        turned = np.concatenate([moved, secular], axis=-1)
        return np.concatenate([turned, derivatives[:, channels:]], axis=1)

    def _moved_states(self, group: int, derivatives: Complex) -> Complex:
        """Differentiate the initial states of a group, in standard deviations; shape (record, state, parameter)."""
        by_mode = derivatives[len(self.weights) :, :, : self.modes]
        return np.asarray(np.moveaxis(by_mode @ self.amplitudes[self.sums.batch.members(group)].T, -1, 0))

    def gradient(self, derivatives: Complex) -> Real:
        """Return Σ derivative · residual / σ² of each record, and of its initial state.

        Parameters
        ----------
        derivatives
            σ and τ beside each other, τ per sample; shape (group, channel + state, parameter, 2 mode).

        Returns
        -------
        ndarray
            Shape (record, parameter).
        """
        residual = (self.sums.data - self._smoothed).conj() * np.tile(self.amplitudes, 2)[:, None, :]
        residual *= self.weights[:, None]
        batch, channels = self.sums.batch, len(self.weights)
        parts = []
        for group, own in enumerate(derivatives):
            members = batch.members(group)
            of_records = np.tensordot(residual[members], own[:channels], axes=([1, 2], [0, 2])).real
            states = self._initial_states[members].conj()[:, None]
            parts.append(of_records - (states @ self._moved_states(group, own))[:, 0].real)
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
        driven, channels = self.sums.gram * q[:, None, :], len(self.weights)
        found = []
        for group, whole in enumerate(derivatives):
            members, own, states = batch.members(group), whole[:channels], self._moved_states(group, whole)
            shared = q[members].conj()[:, :, None] * driven[members]
            if not by_record:
                shared = shared.sum(axis=0, keepdims=True)
            products = (own.reshape(-1, q.shape[1]) @ np.swapaxes(shared, 1, 2)).reshape(-1, *own.shape)
            products *= self.weights[:, None, None]
            # The real part of a product of complex numbers, one conjugated, is that of pairs of real ones.
            within = (own.view(float) @ np.swapaxes(products.view(float), 2, 3)).sum(axis=1)
            of_states = (np.swapaxes(states.conj(), 1, 2) @ states).real
            within += of_states if by_record else of_states.sum(axis=0)
            across = self._across(group, own, driven[members], states)
            explained = (np.swapaxes(across.conj(), 1, 2) @ (self.inverse[members] @ across)).real
            if self.clocks is not None:
                explained += self.clocks.explained(group, own, driven[group], across[0])
                within += self.clocks.information(group, own.shape[1])
            found.append(within - (explained if by_record else explained.sum(axis=0, keepdims=True)))
        return np.concatenate(found)

    def _across(self, group: int, derivatives: Complex, driven: Complex, states: Complex) -> Complex:
        """Inner products of a group's derivatives with what the amplitudes do, (record, mode, parameter)."""
        channels, parameters = derivatives.shape[:2]
        # Amplitudes meet the derivatives through the shapes.
        through = (self.sums.shapes[group].conj() * self.weights[:, None]).T
        met = (through @ derivatives.reshape(channels, -1)).reshape(self.modes, parameters, -1)
        across = np.swapaxes(driven[:, : self.modes], 0, 1) @ np.swapaxes(met, 1, 2)
        of_states = self.sums.initial_states[group].conj().T @ states
        return np.ascontiguousarray(np.swapaxes(across, 0, 1) + of_states)

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
        for record, whole in enumerate(derivatives):
            own, states = whole[: len(self.weights)], self._moved_states(record, whole)
            across = self._across(record, own, driven[record : record + 1], states)[0]
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

    def fitted(self, poles: Complex) -> Iterator[Real]:
        """Modelled records, their means subtracted, from poles of each load; each of shape (channel, time)."""
        batch = self.sums.batch
        for group, (load, step) in enumerate(zip(batch.load, batch.step, strict=True)):
            members = batch.members(group)
            # A pole and its conjugate add the same real part twice.
            upper = poles[load].imag >= 0
            twice = np.where(poles[load].imag > 0, 2.0, 1.0)[upper]
            # The real part of a product of complex numbers is that of pairs of real ones, one of them conjugated.
            motion = exponentials(poles[load][upper] * step, int(batch.samples[members].max())).view(float)
            coefficients = self._coefficients[members][..., upper] * twice
            for own, samples in zip(coefficients, batch.samples[members], strict=True):
                record = np.ascontiguousarray(own.conj()).view(float) @ motion[:samples].T
                record -= record.mean(axis=1, keepdims=True)
                yield record

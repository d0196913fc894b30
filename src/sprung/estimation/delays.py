"""Delays: how far the clocks of several loggers stand apart in each drop, found along with its amplitudes.

A channel whose samples were taken δ later than the drop's clock says is Σ_j s_cj q_j e^{λ_j (t + δ)}: its shape is turned by
e^{λδ}. So at given parameters the amplitudes and delays of a drop are a small problem of their own, in inner products that are
there already, and both are eliminated together (variable projection).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.records import FlightInformation

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_LONGEST = 0.004
"""s by which a delay may change at once: a small part of a period of wheel hop."""

SETTLED, STEPS = 1e-8, 40
"""s, far below any delay's uncertainty, and steps to get there at the most."""


@dataclass(frozen=True, eq=False)
class Delays:
    """The delays of the records of a run, and what eliminating them takes.

    Attributes
    ----------
    values
        δ, s, shape (record, delay).
    expected, expected_std
        What is known of them beforehand, s, shape (record, delay).
    follows
        How that grows with the parameters, shape (record, delay, parameter).
    late
        1 where a channel has a delay, shape (channel, delay).
    flown
        What the flights before the records tell of the vehicle.
    parameters
        Of the vehicle, shape (parameter,).
    poles
        λ, 1/s, shape (record, mode).
    turned
        Shapes with the delays in them, shape (record, channel, mode).
    weighted
        Their conjugates, times 1/σ².
    gram
        Inner products of e^{λk} with each other, shape (record, mode, mode).
    data
        Inner products of them with the records, shape (record, channel, mode).
    inverse
        Inverse normal equations of the amplitudes, shape (record, mode, mode).
    amplitudes
        q, shape (record, mode).
    """

    values: Real
    expected: Real
    expected_std: Real
    follows: Real
    late: Real
    flown: FlightInformation
    parameters: Real
    poles: Complex
    turned: Complex
    weighted: Complex
    gram: Complex
    data: Complex
    inverse: Complex
    amplitudes: Complex

    @cached_property
    def _velocities(self) -> Complex:
        """λ q: what a delay adds to the amplitudes of its channels, shape (record, mode)."""
        return self.poles * self.amplitudes

    def _seen(self, amplitudes: Complex) -> Complex:
        """Give the weighted inner products of each channel's share of a motion with the exponentials."""
        seen: Complex = self.weighted * ((self.turned * amplitudes[:, None]) @ np.swapaxes(self.gram, 1, 2))
        return seen

    @cached_property
    def _driven(self) -> Complex:
        """Inner products of what each delay changes with what the amplitudes do, shape (record, delay, mode)."""
        return np.asarray(self.late.T @ self._seen(self._velocities), dtype=np.complex128)

    @property
    def penalty(self) -> float:
        """What delays and parameters miss of what is known beforehand, in units of its uncertainty, squared."""
        missed = float(np.sum(((self.values - self.expected) / self.expected_std) ** 2))
        return missed + self.flown.penalty(self.parameters)

    @property
    def gradient(self) -> Real:
        """What the same adds to the gradient by the parameters, shape (record, parameter)."""
        missed = (self.values - self.expected) / self.expected_std**2
        return np.asarray((missed[:, None] @ self.follows)[:, 0] + self.flown.score(self.parameters), dtype=np.float64)

    def information(self, record: int, changes: int) -> Real:
        """Give what the same adds to a record's information on parameters, and on other changes behind them; square."""
        scaled = self.follows[record] / self.expected_std[record][:, None]
        whole = np.zeros((changes, changes))
        whole[: scaled.shape[1], : scaled.shape[1]] = scaled.T @ scaled + self.flown.information[record]
        return whole

    @cached_property
    def covariance(self) -> Real:
        """Covariance of the delays at given parameters, amplitudes unknown, s², shape (record, delay, delay)."""
        own = (self._driven * self._velocities.conj()[:, None]).sum(axis=2).real + 1 / self.expected_std**2
        taken = (self._driven.conj() @ self.inverse @ np.swapaxes(self._driven, 1, 2)).real
        return np.asarray(np.linalg.inv(own[:, :, None] * np.eye(own.shape[1]) - taken), dtype=np.float64)

    @property
    def step(self) -> Real:
        """The Gauss-Newton step of the delays, s, shape (record, delay)."""
        left = self.weighted * self.data - self._seen(self.amplitudes)
        slope = (left * self._velocities.conj()[:, None]).sum(axis=2).real @ self.late
        slope += (self.expected - self.values) / self.expected_std**2
        step = (self.covariance @ slope[:, :, None])[:, :, 0]
        return np.asarray(np.clip(step, -_LONGEST, _LONGEST), dtype=np.float64)

    def response(self, record: int, slopes: Complex, driven: Complex, across: Complex) -> Real:
        """Give how the delays of a record follow the parameters, times their information; amplitudes eliminated.

        Parameters
        ----------
        record
            Which.
        slopes
            Derivatives of the turned shapes, see `ProjectedResponse.information`; shape (channel, parameter, 2 mode).
        driven
            Inner products of (e^{λk}, k e^{λk}) with each other, times the amplitudes; shape (2 mode, 2 mode).
        across
            Inner products of the derivatives with what the amplitudes do, shape (mode, parameter).

        Returns
        -------
        ndarray
            Shape (delay, parameter).
        """
        moved = (self.weighted[record] * self._velocities[record].conj()) @ driven[: len(driven) // 2]
        by_channel = (slopes @ moved[:, :, None])[..., 0].real
        shared = (self._driven[record].conj() @ (self.inverse[record] @ across)).real
        response: Real = self.late.T @ by_channel - shared
        response[:, : self.follows.shape[2]] -= self.follows[record] / self.expected_std[record][:, None] ** 2
        return response

    def taken(self, record: int, slopes: Complex, driven: Complex, across: Complex) -> Real:
        """Give what the delays of a record can take up of the derivatives, beyond the amplitudes; (parameter, parameter)."""
        response = self.response(record, slopes, driven, across)
        return np.asarray(response.T @ self.covariance[record] @ response, dtype=np.float64)

"""How far the clocks of several loggers stand apart in each drop, found along with its amplitudes.

A channel whose samples were taken δ later than the drop's clock says is Σ_j s_cj q_j e^{λ_j (t + δ)}: its shape is turned by
e^{λδ}. So at given parameters the amplitudes and delays of a drop are a small problem of their own, in inner products that are
there already, and both are eliminated together (variable projection).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.records import RecordBatch

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_LONGEST = 0.004
"""s by which a delay may change at once: a small part of a period of wheel hop."""

CONVERGED, MOST_STEPS = 1e-8, 40
"""s, far below any delay's uncertainty, and steps to get there at the most."""


@dataclass(frozen=True, eq=False)
class ClockDelays:
    """The delays of the records of a batch, and what eliminating them takes.

    Attributes
    ----------
    batch
        The records, one in each group.
    values
        δ, s, shape (record, delay).
    expected
        What is known of them beforehand at these parameters, s, shape (record, delay).
    parameters
        Of the vehicle, SI, shape (parameter,).
    poles
        λ, 1/s, shape (record, mode).
    shapes
        Turned by the delays, shape (record, channel, mode).
    weights
        1/σ², zero for channels that are left out, shape (channel,).
    gram
        Inner products of e^{λk} with each other, shape (record, mode, mode).
    data
        Inner products of them with the records, shape (record, channel, mode).
    inverse
        Inverse normal equations of the amplitudes, shape (record, mode, mode).
    amplitudes
        q, shape (record, mode).
    """

    batch: RecordBatch
    values: Real
    expected: Real
    parameters: Real
    poles: Complex
    shapes: Complex
    weights: Real
    gram: Complex
    data: Complex
    inverse: Complex
    amplitudes: Complex

    @cached_property
    def _velocities(self) -> Complex:
        """λ q: what a delay adds to the amplitudes of its channels, shape (record, mode)."""
        return self.poles * self.amplitudes

    @cached_property
    def _weighted(self) -> Complex:
        """Conjugate shapes over σ²."""
        return self.shapes.conj() * self.weights[:, None]

    def _products(self, amplitudes: Complex) -> Complex:
        """Weighted inner products of each channel's share of a motion with the exponentials."""
        products: Complex = self._weighted * ((self.shapes * amplitudes[:, None]) @ np.swapaxes(self.gram, 1, 2))
        return products

    @cached_property
    def _across(self) -> Complex:
        """Inner products of what each delay changes with what the amplitudes do, shape (record, delay, mode)."""
        return np.asarray(self.batch.clock_design.T @ self._products(self._velocities), dtype=np.complex128)

    @property
    def penalty(self) -> float:
        """Deviation of delays and parameters from what is known beforehand, in standard uncertainties, squared."""
        missed = float(np.sum(((self.values - self.expected) / self.batch.delay_std) ** 2))
        return missed + self.batch.flight_penalty(self.parameters)

    @property
    def gradient(self) -> Real:
        """What the priors of the delays add to the gradient by the parameters, shape (record, parameter)."""
        missed = (self.values - self.expected) / self.batch.delay_std**2
        by_parameter = (missed[:, None] @ self.batch.d_delay_d_parameter)[:, 0]
        return np.asarray(by_parameter + self.batch.flight_score(self.parameters), dtype=np.float64)

    def information(self, record: int, unknowns: int) -> Real:
        """Return what the same adds to a record's information on parameters, the first of so many unknowns; square."""
        scaled = self.batch.d_delay_d_parameter[record] / self.batch.delay_std[record][:, None]
        whole = np.zeros((unknowns, unknowns))
        whole[: scaled.shape[1], : scaled.shape[1]] = scaled.T @ scaled + self.batch.flight_information[record]
        return whole

    @cached_property
    def covariance(self) -> Real:
        """Covariance of the delays at given parameters, amplitudes unknown, s², shape (record, delay, delay)."""
        own = (self._across * self._velocities.conj()[:, None]).sum(axis=2).real + 1 / self.batch.delay_std**2
        explained = (self._across.conj() @ self.inverse @ np.swapaxes(self._across, 1, 2)).real
        return np.asarray(np.linalg.inv(own[:, :, None] * np.eye(own.shape[1]) - explained), dtype=np.float64)

    @property
    def step(self) -> Real:
        """The Gauss-Newton step of the delays, s, shape (record, delay)."""
        residual = self._weighted * self.data - self._products(self.amplitudes)
        gradient = (residual * self._velocities.conj()[:, None]).sum(axis=2).real @ self.batch.clock_design
        gradient += (self.expected - self.values) / self.batch.delay_std**2
        step = (self.covariance @ gradient[:, :, None])[:, :, 0]
        return np.asarray(np.clip(step, -_LONGEST, _LONGEST), dtype=np.float64)

    def response(self, record: int, derivatives: Complex, driven: Complex, across: Complex) -> Real:
        """Return how the delays of a record respond to the parameters, times their information; amplitudes eliminated.

        Parameters
        ----------
        record
            Which.
        derivatives
            Of the turned shapes, see `ProjectedResponse.information`; shape (channel, parameter, 2 mode).
        driven
            Inner products of (e^{λk}, k e^{λk}) with each other, times the amplitudes; shape (2 mode, 2 mode).
        across
            Inner products of the derivatives with what the amplitudes do, shape (mode, parameter).

        Returns
        -------
        ndarray
            Shape (delay, parameter).
        """
        moved = (self._weighted[record] * self._velocities[record].conj()) @ driven[: len(driven) // 2]
        by_channel = (derivatives @ moved[:, :, None])[..., 0].real
        explained = (self._across[record].conj() @ (self.inverse[record] @ across)).real
        response: Real = self.batch.clock_design.T @ by_channel - explained
        expected = self.batch.d_delay_d_parameter[record]
        response[:, : expected.shape[1]] -= expected / self.batch.delay_std[record][:, None] ** 2
        return response

    def explained(self, record: int, derivatives: Complex, driven: Complex, across: Complex) -> Real:
        """Information that the delays of a record explain beyond the amplitudes, shape (parameter, parameter)."""
        response = self.response(record, derivatives, driven, across)
        return np.asarray(response.T @ self.covariance[record] @ response, dtype=np.float64)

"""What remains of a driven record once the motions of the pads, and the ends of the record, are eliminated.

At each line the transforms U of the pads' displacements are unknown: the sensors of the pads are channels with noise like all
others (:term:`errors in variables`; Pintelon and Schoukens, System Identification, section 8.2). Readings are linear in U, in
the differences of the state between both ends of the record, and in the end corrections of the channels, so that all of them
are eliminated by weighted least squares, U line by line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.forced_response import ForcedResponse

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class EliminatedInputs:
    """Some lines of a record, the motions of the pads eliminated; arrays with an axis of channels are divided by the noise.

    Attributes
    ----------
    response
        At these lines.
    scale
        1/σ, zero for channels that are left out, shape (channel,).
    """

    response: ForcedResponse
    scale: Real

    @cached_property
    def _factors(self) -> tuple[Complex, Complex, Complex]:
        """Orthonormal columns Q of the readings by the inputs, (line, channel, wheel), Qᴴ, and R, (line, wheel, wheel)."""
        orthonormal, triangular = np.linalg.qr(self.response.of_inputs * self.scale[:, None])
        return orthonormal, np.swapaxes(orthonormal.conj(), 1, 2), triangular

    def log_determinant(self, weights: Real) -> float:
        """Return by how much the information on the inputs exceeds that at fixed weights of the channels, shape (channel,).

        As the logarithm of its determinant, summed over real and imaginary parts of all lines.
        """
        _, _, triangular = self._factors
        of_inputs = self.response.of_inputs * np.sqrt(np.where(self.scale > 0, weights, 0.0))[:, None]
        _, fixed = np.linalg.slogdet(np.swapaxes(of_inputs.conj(), 1, 2) @ of_inputs)
        own = 2 * np.log(np.abs(np.diagonal(triangular, axis1=1, axis2=2))).sum()
        return 2 * float(own - fixed.sum())

    @cached_property
    def hat(self) -> Complex:
        """What inputs explain of readings, shape (line, channel, channel)."""
        orthonormal, adjoint, _ = self._factors
        return np.asarray(orthonormal @ adjoint)

    def remainder(self, readings: Complex) -> Complex:
        """Return readings less what inputs explain of them, shape (line, channel, ...)."""
        orthonormal, adjoint, _ = self._factors
        return np.asarray(readings - orthonormal @ (adjoint @ readings))

    def inputs_from(self, readings: Complex) -> Complex:
        """Return the most likely transforms of the pads' displacements for readings of shape (line, channel), (line, wheel)."""
        _, adjoint, triangular = self._factors
        return np.asarray(np.linalg.solve(triangular, adjoint @ readings[:, :, None])[:, :, 0])

    @cached_property
    def data(self) -> Complex:
        """The lines, shape (line, channel)."""
        return np.asarray(self.response.lines.values[self.response.part] * self.scale)

    @cached_property
    def _left(self) -> Complex:
        """Readings by differences of the states, and the lines, less what inputs explain; shape (line, channel, state + 1)."""
        of_ends = self.response.of_ends * self.scale[:, None]
        return self.remainder(np.concatenate([of_ends, self.data[:, :, None]], axis=2))

    @property
    def of_states(self) -> Complex:
        """Readings by differences of the states, less what inputs explain, shape (line, channel, state)."""
        return self._left[:, :, :-1]

    @cached_property
    def _met(self) -> Real:
        """Inner products of all ends with what inputs leave of the states and of the lines, shape (end, state + 1)."""
        return self.met(self._left)

    @property
    def met_data(self) -> Real:
        """Inner products of all ends with the lines, shape (end,)."""
        return self._met[:, -1]

    def residual(self, ends: Real) -> Complex:
        """Return what inputs and ends leave of the lines, shape (line, channel)."""
        states = self.of_states.shape[2]
        corrected = self.remainder(self.of_corrections(ends[states:, None]))
        left = self._left @ np.append(-ends[:states], 1.0)
        return np.asarray(left - corrected[:, :, 0])

    @cached_property
    def corrections(self) -> tuple[Real, Real]:
        """Scaled prior of the end corrections, shape (2, channel); and powers of ω which they multiply, shape (2, line)."""
        lines, omega = self.response.lines, self.response.lines.omega[self.response.part]
        return lines.ends * self.scale, np.array([np.ones_like(omega), omega])

    def of_corrections(self, ends: Real) -> Complex:
        """Return end corrections in units of their prior as readings; shape (2 channel, ...) to (line, channel, ...)."""
        size, powers = self.corrections
        constant, linear = ends.reshape(2, len(self.scale), -1) * size[:, :, None]
        return np.asarray(constant + 1j * powers[1][:, None, None] * linear)

    def by_ends(self, ends: Real) -> Complex:
        """Return readings of ends, differences of the state first, inputs held; shape (line, channel)."""
        states = self.of_states.shape[2]
        whole = self.response.of_ends.reshape(-1, states) @ ends[:states]
        corrected = self.of_corrections(ends[states:, None])[:, :, 0]
        return np.asarray(whole.reshape(self.data.shape) * self.scale + corrected)

    def met(self, readings: Complex) -> Real:
        """Return inner products of all ends with readings that inputs do not explain; shape (end, ...)."""
        by_states = _real_products(self.of_states, readings)
        size, powers = self.corrections
        moments = np.tensordot(powers, readings, axes=(1, 0))
        # The second correction is multiplied by iω, and conjugated.
        met = np.array([moments[0].real, moments[1].imag])
        met *= size.reshape(*size.shape, *(1,) * (met.ndim - 2))
        return np.concatenate([by_states, met.reshape(-1, *met.shape[2:])])

    @cached_property
    def normal(self) -> Real:
        """Inner products of all ends with each other, shape (end, end)."""
        size, powers = self.corrections
        states, channels = self.of_states.shape[2], len(self.scale)
        normal = np.empty((states + 2 * channels, states + 2 * channels))
        normal[:, :states] = self._met[:, :states]
        normal[:states, states:] = normal[states:, :states].T
        own = np.eye(channels) - self.hat
        moments = np.tensordot(np.array([powers[0], powers[1], powers[1] ** 2]), own, axes=(1, 0))
        # Inner products of (1, iω) with themselves through a Hermitian matrix.
        blocks = np.array([[moments[0].real, -moments[1].imag], [moments[1].imag, moments[2].real]])
        blocks *= size[:, None, :, None] * size[None, :, None, :]
        normal[states:, states:] = blocks.transpose(0, 2, 1, 3).reshape(2 * channels, -1)
        return normal


@dataclass(frozen=True, eq=False)
class EliminatedEnds:
    """A record, pads and ends eliminated.

    Attributes
    ----------
    blocks
        Its lines.
    """

    blocks: Sequence[EliminatedInputs]

    @cached_property
    def _normal(self) -> Real:
        """Normal equations of the ends, their prior added, shape (end, end)."""
        whole: Real = np.sum([block.normal for block in self.blocks], axis=0)
        return whole + np.eye(len(whole))

    @cached_property
    def _inverse(self) -> Real:
        return scaled_inverse(self._normal)

    @cached_property
    def ends(self) -> Real:
        """Ends, in units of their prior: differences of the states, then end corrections; shape (end,)."""
        return np.asarray(self._inverse @ np.sum([block.met_data for block in self.blocks], axis=0))

    @property
    def _states(self) -> int:
        return int(self.blocks[0].of_states.shape[2])

    @cached_property
    def _without_ends(self) -> list[Complex]:
        """Data less the ends, by block, shape (line, channel)."""
        return [block.data - block.by_ends(self.ends) for block in self.blocks]

    @cached_property
    def _residuals(self) -> list[Complex]:
        return [block.residual(self.ends) for block in self.blocks]

    @property
    def residual(self) -> Complex:
        """What remains, over the noise, shape (line, channel)."""
        return np.concatenate(self._residuals)

    @cached_property
    def _inputs(self) -> list[Complex]:
        return [block.inputs_from(data) for block, data in zip(self.blocks, self._without_ends, strict=True)]

    @cached_property
    def _motions(self) -> list[Complex]:
        ends = self.ends[: self._states]
        return [block.response.motion(own, ends) for block, own in zip(self.blocks, self._inputs, strict=True)]

    def states(self, last: int) -> Real:
        """Return {X, Ẋ} at so many samples from the first one on, as far as the lines tell, SI, shape (state, sample)."""
        response = self.blocks[0].response
        displacement, velocity, _ = np.concatenate(self._motions, axis=1)
        whole = np.concatenate([displacement, velocity[:, : response.model.massive]], axis=1)
        return response.lines.to_time(whole)[:, :last]

    @cached_property
    def residual_sums(self) -> Real:
        """Residual sums of squares, SI, shape (channel,); 0 for channels that are left out."""
        squares = np.sum([np.sum(own.real**2 + own.imag**2, axis=0) for own in self._residuals], axis=0)
        scale = self.blocks[0].scale
        return np.asarray(squares / np.where(scale > 0, scale, 1.0) ** 2)

    @property
    def penalty(self) -> float:
        """Twice the negative log-likelihood of the ends under their priors."""
        return float(self.ends @ self.ends)

    @cached_property
    def _spent_on_ends(self) -> Real:
        """Numbers that each channel determines of the ends, shape (channel,)."""
        # One after the other: a channel's own corrections, then what the states add to them.
        states, normal = self._states, self._normal
        corrections = scaled_inverse(normal[states:, states:])
        shared = corrections @ normal[states:, :states]
        found = (1 - np.diag(corrections)).reshape(2, -1).sum(axis=0)
        for block in self.blocks:
            seen = block.of_states - block.remainder(block.of_corrections(shared))
            both = (seen @ self._inverse[:states, :states]) * seen.conj()
            found += both.real.sum(axis=(0, 2))
        return np.asarray(found)

    @cached_property
    def leverage(self) -> Real:
        """Numbers that each channel determines of inputs and ends, shape (channel,)."""
        of_inputs = np.sum([np.einsum("lcc->c", block.hat).real for block in self.blocks], axis=0)
        return np.asarray(2 * of_inputs + self._spent_on_ends)

    def restriction(self, weights: Real) -> float:
        """Return what the eliminated unknowns add to minus twice the log-likelihood, beside that at fixed weights, (channel,).

        The information that the channels have on them, with which noise levels are those of the
        :term:`restricted maximum likelihood`. Information at fixed weights is taken off: it depends on the parameters of the
        vehicle, of which the most likely inputs, not their average, tell without bias.
        """
        own = self.blocks[0].scale ** 2
        ratio = np.log(np.where(own > 0, own / weights, 1.0))
        return sum(block.log_determinant(weights) for block in self.blocks) + float(self._spent_on_ends @ ratio)

    @cached_property
    def coupling(self) -> Real:
        """Expected residual sums of each channel by what noise of each adds, in units of the weights; (channel, channel)."""
        used = self.blocks[0].scale > 0
        found = -np.diag(self._spent_on_ends)
        for block in self.blocks:
            own = np.eye(len(used)) - block.hat
            found += 2 * np.sum(own.real**2 + own.imag**2, axis=0)
        return np.asarray(found * np.outer(used, used))

    @cached_property
    def score(self) -> tuple[Real, Real]:
        """Gradient of the log-likelihood by the parameters, and their information; SI, (parameter,) and its square."""
        return self.with_changes(())

    def with_changes(self, ways: Sequence[tuple[Sequence[ForcedResponse], Real]]) -> tuple[Real, Real]:
        """Return gradient and information of the parameters and of changes of larger vehicles behind them.

        Parameters
        ----------
        ways
            The response of each larger vehicle, block by block, and how much of each of its parameters a change adds, SI, shape
            (change, parameter).

        Returns
        -------
        gradient, information
            Shapes (parameter + change,) and its square.
        """
        gradient: Real | float = 0.0
        within: Real | float = 0.0
        met: Real | float = 0.0
        for i, block in enumerate(self.blocks):
            inputs, motion, residual = self._inputs[i], self._motions[i], self._residuals[i]
            own = block.response.derivatives(inputs, motion)
            changed = (
                larger[i].derivatives_of_smaller(block.response, inputs, motion, changes) for larger, changes in ways
            )
            derivatives: Complex = np.concatenate([own, *changed], axis=2)
            derivatives *= block.scale[:, None]
            gradient = gradient + _real_products(derivatives, residual)
            left = block.remainder(derivatives)
            within = within + _real_products(left, left)
            met = met + block.met(left)
        met = np.asarray(met)
        return np.asarray(gradient), np.asarray(within - met.T @ self._inverse @ met)


def scaled_inverse(normal: Real) -> Real:
    """Return the inverse of normal equations of unknowns that differ by orders of magnitude, shape (unknown, unknown)."""
    scale = 1 / np.sqrt(np.diag(normal))
    both = np.outer(scale, scale)
    return np.asarray(np.linalg.inv(normal * both) * both)


def _real_products(first: Complex, second: Complex) -> Real:
    """Return real parts of inner products over lines and channels; (line, channel, n) and (line, channel, ...) to (n, ...)."""
    one = first.reshape(-1, first.shape[2])
    other = second.reshape(len(one), -1)
    products = one.real.T @ other.real + one.imag.T @ other.imag
    return np.asarray(products.reshape(first.shape[2], *second.shape[2:]))

"""The response of a linear vehicle to its pads at spectral lines, and its derivatives.

With the transforms U of the pads' displacements and X of the coordinates over a record of length T, integration by parts gives

    (K + iω C - ω² M) X = (B_k + iω B_c) U + (iω M + C) j_x + M j_v

with the differences j of the displacements and of the velocities between both ends, which are zero where the vehicle is at rest
at both (Pintelon and Schoukens, System Identification, section 6.3). Readings are rows of X and of the transforms of its
derivatives, and of U. Sums over samples in place of integrals add to each channel the end corrections of Euler and Maclaurin:
a constant and a term with iω.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.projected_response import initial_state_prior_std
from sprung.estimation.spectral_lines import SpectralLines
from sprung.vehicle import LinearModel, PadInputs, Readout, coordinates

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class ForcedResponse:
    """The response of one load's vehicle at some of the lines of one record, whatever the weights.

    Attributes
    ----------
    lines
        Of the record.
    model
        Equations of motion.
    sensors
        The sensors.
    pads
        What the pads add.
    values
        Parameters, SI, shape (parameter,).
    part
        Which of the lines.
    """

    lines: SpectralLines
    model: LinearModel
    sensors: Readout
    pads: PadInputs
    values: Real
    part: slice

    @cached_property
    def _iw(self) -> Complex:
        """iω, shape (line, 1, 1)."""
        return np.asarray(1j * self.lines.omega[self.part, None, None])

    @cached_property
    def _of_rows(self) -> tuple[Real, Real, Real]:
        """Rows of displacements, velocities and accelerations, shape (channel, coordinate) each."""
        rows, n = self.sensors.at(self.values), self.model.size
        blocks = dict(zip(self.sensors.orders, np.split(rows, len(self.sensors.orders), axis=1), strict=True))
        nothing = np.zeros((len(rows), n))
        return blocks.get(0, nothing), blocks.get(1, nothing), blocks.get(2, nothing)

    @cached_property
    def _delays(self) -> Complex | None:
        """e^{-iωδ} of channels with a delay, shape (line, channel, 1)."""
        if not self.sensors.has_delays:
            return None
        return np.asarray(np.exp(-self._iw * self.sensors.delays(self.values)[:, None]))

    @cached_property
    def _stiffness(self) -> Complex:
        """Dynamic stiffness K + iω C - ω² M, shape (line, coordinate, coordinate)."""
        M, C, K = self.model.matrices(self.values)
        return np.asarray(K + self._iw * C + self._iw**2 * M)

    @cached_property
    def _inverse(self) -> Complex:
        """Receptance, the inverse of the dynamic stiffness, shape (line, coordinate, coordinate)."""
        return np.asarray(np.linalg.inv(self._stiffness))

    @property
    def _of_displacements(self) -> Complex:
        """Readings by displacements of the coordinates, delays left out, shape (line, channel, coordinate)."""
        of_displacement, of_velocity, of_acceleration = self._of_rows
        return np.asarray(of_displacement + self._iw * (of_velocity + self._iw * of_acceleration))

    @cached_property
    def _of_forces(self) -> Complex:
        """Readings by forces on the coordinates, shape (line, channel, coordinate)."""
        read = self._of_displacements @ self._inverse
        return np.asarray(read if self._delays is None else read * self._delays)

    @cached_property
    def of_inputs(self) -> Complex:
        """Readings by the pads' displacements, H, shape (line, channel, wheel)."""
        by_displacement, by_velocity = self.pads.forces(self.values)
        direct, of_rate = self.pads.readings(self.values) * self.sensors.gains(self.values)[:, None]
        own = direct + self._iw * of_rate
        if self._delays is not None:
            own = own * self._delays
        return np.asarray(self._of_forces @ (by_displacement + self._iw * by_velocity) + own)

    @cached_property
    def of_ends(self) -> Complex:
        """Readings by differences of the state between both ends, in units of their prior; (line, channel, state)."""
        M, C, _ = self.model.matrices(self.values)
        n, m = self.model.size, self.model.massive
        _, of_velocity, of_acceleration = self._of_rows
        found = np.empty((len(self._iw), len(of_velocity), n + m), dtype=np.complex128)
        found[:, :, :n] = self._of_forces @ (self._iw * M + C)
        found[:, :, n:] = self._of_forces @ M[:, :m]
        direct = -(of_velocity + self._iw * of_acceleration), -of_acceleration[:, :m] + 0 * self._iw
        for part, own in zip((slice(0, n), slice(n, None)), direct, strict=True):
            found[:, :, part] += own if self._delays is None else own * self._delays
        return found * self._ends_scale

    @cached_property
    def _ends_scale(self) -> Real:
        """What one unit of the prior of the differences is in the lines, shape (state,)."""
        return self.lines.jump * initial_state_prior_std(self.model.size, self.model.size + self.model.massive)

    def motion(self, inputs: Complex, ends: Real) -> Complex:
        """Return the transforms of displacements, velocities and accelerations of the coordinates.

        Parameters
        ----------
        inputs
            U, shape (line, wheel).
        ends
            Differences of the state between the ends, in units of their prior, shape (state,).

        Returns
        -------
        ndarray
            Scaled, SI, shape (3, line, coordinate).
        """
        M, C, _ = self.model.matrices(self.values)
        n, m = self.model.size, self.model.massive
        jumps = ends * self._ends_scale
        moved, pushed = jumps[:n], np.concatenate([jumps[n:], np.zeros(n - m)])
        by_displacement, by_velocity = self.pads.forces(self.values)
        iw = self._iw[:, :, 0]
        forces = inputs @ by_displacement.T + iw * (inputs @ by_velocity.T + M @ moved) + (C @ moved + M @ pushed)
        displacement = (self._inverse @ forces[:, :, None])[:, :, 0]
        velocity = iw * displacement - moved
        return np.array([displacement, velocity, iw * velocity - pushed])

    def derivatives(self, inputs: Complex, motion: Complex) -> Complex:
        """Return the derivatives of the readings by the parameters, U and the ends held.

        Parameters
        ----------
        inputs, motion
            U, and what follows from it, as from `motion`.

        Returns
        -------
        ndarray
            Shape (line, channel, parameter).
        """
        of_model = len(self.model.names)
        found = self._direct(inputs, motion)
        found[:, :, :of_model] += self._of_forces @ self._changed_forces(inputs, motion)
        return found

    def _changed_forces(self, inputs: Complex, motion: Complex, changes: Real | None = None) -> Complex:
        """Return the forces that changes add: those of the matrices on the motion, and of the tyres on the wheels.

        Changes are those of the parameters unless given, shape (change, parameter); (line, coordinate, change).
        """
        slopes = self.model.slopes(self.values, changes)
        of_tyres = self.pads.force_slopes[: len(self.model.names)]
        if changes is not None:
            of_tyres = np.tensordot(changes, of_tyres, axes=1)
        changed = np.concatenate([-slopes.K, -slopes.C, -slopes.M, *np.moveaxis(of_tyres, 1, 0)], axis=2)
        moved = np.concatenate([*motion, inputs, self._iw[:, :, 0] * inputs], axis=1)
        # As a product of real matrices, of which one holds pairs of real and imaginary parts.
        pairs = np.ascontiguousarray(moved.T).view(float)
        forces = (changed.reshape(-1, changed.shape[2]) @ pairs).view(np.complex128)
        return np.asarray(forces.reshape(len(changed), -1, len(moved)).transpose(2, 1, 0))

    def _direct(self, inputs: Complex, motion: Complex) -> Complex:
        """Return the derivatives of the readings by the parameters, the motion held; shape (line, channel, parameter)."""
        iw = self._iw[:, :, 0]
        found = np.zeros((len(iw), len(self.lines.usable), len(self.sensors.names)), dtype=np.complex128)
        turns = None if self._delays is None else self._delays[:, :, 0]
        displacement, velocity, acceleration = motion
        observed = self.sensors.observed(displacement, velocity, acceleration, axis=1)
        rows, gains = self.sensors.slopes(self.values), self.sensors.gains(self.values)
        for channel, parameter in np.argwhere(rows.any(axis=2)):
            own = observed @ rows[channel, parameter]
            found[:, channel, parameter] += own if turns is None else own * turns[:, channel]
        of_pads = self.pads.reading_slopes * gains[:, None]
        for parameter, channel in np.argwhere(of_pads.any(axis=(1, 3))):
            own = inputs @ of_pads[parameter, 0, channel] + iw[:, 0] * (inputs @ of_pads[parameter, 1, channel])
            found[:, channel, parameter] += own if turns is None else own * turns[:, channel]
        direct = self.pads.readings(self.values)
        for channel, parameter in self.sensors.gain_positions:
            own = inputs @ direct[0, channel] + iw[:, 0] * (inputs @ direct[1, channel])
            found[:, channel, parameter] += own if turns is None else own * turns[:, channel]
        if turns is not None:
            at_rows = observed @ self.sensors.at(self.values).T
            at_pads = inputs @ (direct[0] * gains[:, None]).T + iw * (inputs @ (direct[1] * gains[:, None]).T)
            for channel, parameter in self.sensors.delay_positions:
                whole = (at_rows + at_pads)[:, channel] * turns[:, channel]
                found[:, channel, parameter] = -iw[:, 0] * whole
        return found

    def derivatives_of_smaller(
        self, smaller: ForcedResponse, inputs: Complex, motion: Complex, changes: Real
    ) -> Complex:
        """Return the derivatives of the readings of a fitted vehicle by changes of this larger one, U and the ends held.

        Of coordinates that the fitted one has not, only the motion is considered that the others force on them, as by
        `eliminate_coordinates`.

        Parameters
        ----------
        smaller
            The response of the fitted vehicle at these lines.
        inputs, motion
            U, and how the coordinates of the fitted vehicle follow, as from its `motion`.
        changes
            How much of each parameter of the larger one a change adds, SI, shape (change, parameter).

        Returns
        -------
        ndarray
            Shape (line, channel, change).
        """
        every = coordinates(self.model.names)
        own = [every.index(one) for one in coordinates(smaller.model.names)]
        others = np.setdiff1d(np.arange(len(every)), own)
        M, C, K = self.model.matrices(self.values)
        among, back = self._stiffness[:, others[:, None], others], self._stiffness[:, own, :][:, :, others]
        displacement, velocity, acceleration = motion
        across = others[:, None], own
        forced = displacement @ K[across].T + velocity @ C[across].T + acceleration @ M[across].T
        lifted = np.zeros((3, len(forced), len(every)), dtype=np.complex128)
        lifted[:, :, own] = motion
        iw = self._iw[:, :, 0]
        lifted[0][:, others] = -np.linalg.solve(among, forced[:, :, None])[:, :, 0]
        lifted[1:, :, others] = lifted[0, :, others].T * np.array([iw, iw**2])
        forces = self._changed_forces(inputs, lifted, changes)
        added = np.linalg.solve(among, forces[:, others])
        read = self._of_displacements[:, :, others] @ added
        read = read if self._delays is None else read * self._delays
        direct = self._direct(inputs, lifted)[:, :, : changes.shape[1]] @ changes.T
        return np.asarray(smaller._of_forces @ (forces[:, own] - back @ added) + read + direct)

"""Modal coordinates: poles and shapes at the sensors, and their derivatives by the parameters.

Every array may have leading axes: of loads where several models are stacked, of vehicles where the values
have them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle import LinearModel, Readout, highest_derivatives

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_CLOSE = 1e-6
"""Two poles are one where their difference turns by less than this over a record: their mode is then t e^{λt}."""

_BACKWARD = 30.0
"""Powers of e by which a motion may grow on its way back in time: before the start of a record, it is none of a vehicle."""

_FORWARD = 300.0
"""The same by which it may fade: less is nothing, by which no shape can be divided."""


@dataclass(frozen=True, eq=False)
class ModalSolution:
    """Poles and shapes of a linear vehicle at its sensors.

    Attributes
    ----------
    poles
        λ, 1/s, shape (..., mode): two for every coordinate with mass, one for every other.
    right
        Eigenvectors of the state matrix as columns, shape (..., mode, mode).
    shapes
        s: reading of each channel per unit of modal amplitude, shape (..., channel, mode).
    leading_inverse
        Inverse of the coefficients of the highest derivatives, shape (..., coordinate, coordinate).
    """

    poles: Complex
    right: Complex
    shapes: Complex
    leading_inverse: Real

    @property
    def coordinates(self) -> int:
        """Number of coordinates."""
        return int(self.leading_inverse.shape[-1])

    @cached_property
    def left(self) -> Complex:
        """Inverse of `right`, shape (..., mode, mode)."""
        return np.asarray(np.linalg.inv(self.right), dtype=np.complex128)

    @property
    def displacements(self) -> Complex:
        """Displacements of the coordinates in each mode, shape (..., coordinate, mode)."""
        return self.right[..., : self.coordinates, :]

    @property
    def velocities(self) -> Complex:
        """Velocities of the coordinates in each mode, shape (..., coordinate, mode)."""
        return self.displacements * self.poles[..., None, :]

    @property
    def accelerations(self) -> Complex:
        """Accelerations of the coordinates in each mode, shape (..., coordinate, mode)."""
        return self.velocities * self.poles[..., None, :]

    def observed(self, sensors: Readout) -> Complex:
        """Return what sensors read rows of, in each mode, shape (..., column, mode)."""
        return sensors.observed(self.displacements, self.velocities, self.accelerations)

    @property
    def separation(self) -> float:
        """How far apart the two modes are that are most alike, in poles and in shapes, dimensionless; 0 where they meet in one.

        The larger of |λ₁ - λ₂|/|λ₁| and the sine of the angle between the displacements, their coordinates made comparable.
        """
        frequency = np.maximum(np.abs(self.poles), np.finfo(float).tiny)
        with np.errstate(over="ignore"):  # from a pole at zero all others are infinitely far
            apart = np.abs(self.poles[..., :, None] - self.poles[..., None, :]) / frequency[..., :, None]
        shapes = self.displacements / _sizes(self.displacements, axis=-2)[..., None, :]
        shapes = shapes / np.maximum(_sizes(shapes, axis=-1), np.finfo(float).tiny)[..., :, None]
        shapes = shapes / _sizes(shapes, axis=-2)[..., None, :]
        alike = np.abs(np.swapaxes(shapes.conj(), -1, -2) @ shapes)
        angle = np.sqrt(np.maximum(1 - alike**2, 0.0))
        return float((np.maximum(apart, angle) + 2 * np.eye(apart.shape[-1])).min())


def solve_modes(model: LinearModel, sensors: Readout, values: Real) -> ModalSolution:
    """Solve the eigenvalue problem.

    Parameters
    ----------
    model
        Equations of motion.
    sensors
        The sensors.
    values
        Parameters, SI, shape (..., parameter).

    Returns
    -------
    ModalSolution
    """
    A, leading_inverse = model.matrices(values).state_and_leading_inverse(model.massive)
    # A real matrix whose poles are all real gives real arrays.
    poles, right = (np.asarray(part, dtype=np.complex128) for part in np.linalg.eig(A))
    S = sensors.at(values)
    S = S.reshape(*S.shape[:-2], *(1,) * (A.ndim - S.ndim), *S.shape[-2:])
    modes = ModalSolution(poles, right, right, leading_inverse)
    shapes = S @ modes.observed(sensors)
    return replace(modes, shapes=shapes * turns_of_delays(sensors, values, poles) if sensors.has_delays else shapes)


def turns_of_delays(sensors: Readout, values: Real, poles: Complex) -> Complex:
    """Return by what a delay δ of each sensor turns its shape in each mode: e^{-λδ}, shape (..., channel, mode)."""
    return turns(poles[..., None, :] * -sensors.delays(values)[..., None])


def turns(exponents: Complex) -> Complex:
    """Return by what times turn shapes, e^{λt}; of a mode that dies long before the next sample, no more than can be told.

    Parameters
    ----------
    exponents
        λt.
    """
    return np.asarray(np.exp(np.clip(exponents.real, -_FORWARD, _BACKWARD) + 1j * exponents.imag))


def differentiate_modes(
    model: LinearModel, sensors: Readout, values: Real, modes: ModalSolution, span: float
) -> tuple[Complex, Complex]:
    """Return the derivatives of poles and readings by the parameters.

    Parameters
    ----------
    model, sensors
        As for `solve_modes`.
    values
        Of shape (parameter,).
    modes
        Poles and shapes there.
    span
        Length of the longest record, s: decides which poles count as equal.

    Returns
    -------
    poles
        Shape (..., parameter, mode), for the parameters of the model.
    readings
        For all parameters: σ and τ, what multiplies q e^{λt} and q t e^{λt} in the derivative of a channel, beside each
        other; shape (..., channel, parameter, 2 mode).

    Notes
    -----
    The derivative of e^{At} in modal coordinates has the entries D_kj (e^{λ_j t} - e^{λ_k t})/(λ_j - λ_k), with
    D = V⁻¹ dA V. The e^{λ_k t} in it multiplies the shape of mode k, so the free amplitudes absorb it. What remains is
    D_kj/(λ_j - λ_k) e^{λ_j t} for different poles and D_kj t e^{λ_j t} for equal ones.

    With motions v, λv, λ²v of a mode, dA V is -L⁻¹ (dM λ²v + dC λv + dK v), L being the coefficients of the highest
    derivatives: M, and for coordinates without mass C.
    """
    motions = np.concatenate([modes.accelerations, modes.velocities, modes.displacements], axis=-2)
    # The rows of dM, dC and dK beside each other: (..., the rows of every parameter, 3 coordinate).
    derivatives = np.moveaxis(np.concatenate(model.slopes(values), axis=-1), 0, -2)
    lead = modes.poles.shape[:-1]
    by_coordinate = (*lead, derivatives.shape[-3], len(model.names), modes.poles.shape[-1])
    forces = (derivatives.reshape(*lead, -1, derivatives.shape[-1]) @ motions).reshape(by_coordinate)
    poles, of_model = differentiate_response(model, sensors, values, modes, forces, span)
    m, (channels, parameters, columns) = modes.poles.shape[-1], (slopes := sensors.slopes(values)).shape
    readings = np.zeros((*lead, channels, parameters, 2 * m), dtype=np.complex128)
    readings[..., : len(model.names), :] = of_model
    of_sensors = (slopes.reshape(-1, columns) @ modes.observed(sensors)).reshape(*lead, channels, parameters, m)
    if sensors.has_delays:
        of_sensors *= turns_of_delays(sensors, values, modes.poles)[..., None, :]
        for channel, position in sensors.delay_positions:
            of_sensors[..., channel, position, :] = -modes.poles * modes.shapes[..., channel, :]
    readings[..., :m] += of_sensors
    return poles, readings


def differentiate_response(
    model: LinearModel,
    sensors: Readout,
    values: Real,
    modes: ModalSolution,
    forces: Complex,
    span: float,
    direct: Complex | float = 0.0,
) -> tuple[Complex, Complex]:
    """Return the derivatives of poles and readings by changes of the equations of motion.

    Parameters
    ----------
    model, sensors, values, modes, span
        As for `differentiate_modes`.
    forces
        (dM λ² + dC λ + dK) v of every mode v, for several changes; shape (..., coordinate, change, mode).
    direct
        What the sensors read in every mode of what else a change moves, SI, shape (..., channel, change, mode).

    Returns
    -------
    poles, readings
        As from `differentiate_modes`, by change instead of by parameter.
    """
    *lead, n, changes, m = forces.shape
    channels = len(sensors.positions)
    S = np.broadcast_to(sensors.of_accelerations(sensors.at(values)), (*lead, channels, n))
    left = modes.left[..., highest_derivatives(n, model.massive)]
    both = np.concatenate([left, S], axis=-2) @ -modes.leading_inverse
    changed = (both @ forces.reshape(*lead, n, -1)).reshape(*lead, m + channels, changes, m)
    D, of_sensors = changed[..., :m, :, :], changed[..., m:, :, :] + direct

    difference = modes.poles[..., None, :] - modes.poles[..., :, None]
    close = np.abs(difference) * span < _CLOSE
    mixing = np.where(close, 0.0, 1.0 / np.where(close, 1.0, difference))

    turns = turns_of_delays(sensors, values, modes.poles) if sensors.has_delays else None
    shapes = modes.shapes if turns is None else modes.shapes / turns

    def at_sensors(mixed: Complex) -> Complex:
        by_channel: Complex = shapes @ mixed.reshape(*lead, m, -1)
        return by_channel.reshape(*lead, channels, changes, m)

    readings = np.empty((*lead, channels, changes, 2 * m), dtype=np.complex128)
    readings[..., :m] = of_sensors + at_sensors(D * mixing[..., :, None, :])
    readings[..., m:] = at_sensors(D * close[..., :, None, :])
    if turns is not None:
        readings[..., :m] -= sensors.delays(values)[:, None, None] * readings[..., m:]
        readings *= np.tile(turns, 2)[..., None, :]
    return np.diagonal(D, axis1=-3, axis2=-1), readings


def _sizes(vectors: Complex, axis: int) -> Real:
    sizes: Real = np.sqrt(np.sum(vectors.real**2 + vectors.imag**2, axis=axis))
    return sizes

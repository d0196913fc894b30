"""Modal coordinates: poles and shapes at the sensors, and their derivatives by the parameters.

Every array may have leading axes: of loads where the model is one of several `side_by_side`, of vehicles where the values
have them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle import LinearModel, Rows

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_CLOSE = 1e-6
"""Two poles are one where their difference turns by less than this over a record: their mode is then t e^{λt}."""


@dataclass(frozen=True, eq=False)
class ModalSolution:
    """Poles and shapes.

    Attributes
    ----------
    poles
        λ, 1/s, shape (..., 14).
    right
        Eigenvectors of the state matrix as columns, shape (..., 14, 14).
    shapes
        s: reading of each channel per unit of modal amplitude, shape (..., channel, 14).
    """

    poles: Complex
    right: Complex
    shapes: Complex

    @cached_property
    def left(self) -> Complex:
        """Inverse of `right`, shape (..., 14, 14)."""
        return np.asarray(np.linalg.inv(self.right), dtype=np.complex128)

    @property
    def accelerations(self) -> Complex:
        """Accelerations of the seven coordinates in each mode, shape (..., 7, 14)."""
        return self.right[..., 7:, :] * self.poles[..., None, :]

    @property
    def condition(self) -> float:
        """Largest condition number |w||v|/|w·v| of a pole: infinite where two modes meet in one shape."""
        # Displacements and velocities are made comparable by a mean frequency.
        balance = np.repeat([float(np.abs(self.poles).mean()), 1.0], 7)
        right = _sizes(self.right * balance[:, None], axis=-2)
        return float((right * _sizes(self.left / balance, axis=-1)).max())


class ModalSlopes(NamedTuple):
    """Derivatives of poles and readings by the parameters.

    Attributes
    ----------
    poles
        Shape (..., parameter, 14).
    shapes
        σ, what multiplies q e^{λt} in the derivative of a channel; shape (..., channel, parameter, 14).
    secular
        τ, what multiplies q t e^{λt}; shape (..., channel, parameter, 14).
    """

    poles: Complex
    shapes: Complex
    secular: Complex


def solve_modes(model: LinearModel, sensors: Rows, values: Real) -> ModalSolution:
    """Solve the eigenvalue problem.

    Parameters
    ----------
    model
        Equations of motion.
    sensors
        The sensors' rows.
    values
        Parameters, SI, shape (..., parameter).

    Returns
    -------
    ModalSolution
    """
    A = model.matrices(values).state
    # A real matrix whose poles are all real gives real arrays.
    poles, right = (part.astype(np.complex128) for part in np.linalg.eig(A))
    S = sensors.at(values)
    S = S.reshape(*S.shape[:-2], *(1,) * (A.ndim - S.ndim), *S.shape[-2:])
    return ModalSolution(poles, right, S @ (right[..., 7:, :] * poles[..., None, :]))


def differentiate_modes(
    model: LinearModel, sensors: Rows, values: Real, modes: ModalSolution, span: float
) -> ModalSlopes:
    """Differentiate the response by the parameters.

    Parameters
    ----------
    model, sensors
        As for `solve_modes`.
    values
        Of shape (parameter,).
    modes
        Poles and shapes there.
    span
        Length of the longest record, s: decides which poles are too close to be told apart.

    Returns
    -------
    ModalSlopes

    Notes
    -----
    The derivative of e^{At} in modal coordinates has the entries D_kj (e^{λ_j t} - e^{λ_k t})/(λ_j - λ_k), with
    D = V⁻¹ dA V. The e^{λ_k t} in it multiplies the shape of mode k, so the free amplitudes absorb it. What is left is
    D_kj/(λ_j - λ_k) e^{λ_j t} for different poles and D_kj t e^{λ_j t} for equal ones.

    With motions v, λv, λ²v of a mode, dA V is -M⁻¹ (dM λ²v + dC λv + dK v).
    """
    displacements = modes.right[..., :7, :]
    motions = np.concatenate([modes.accelerations, modes.right[..., 7:, :], displacements], axis=-2)
    # The rows of dM, dC and dK beside each other: (..., 7 rows of every parameter, 21).
    slopes = np.moveaxis(np.concatenate(model.slopes(values), axis=-1), 0, -2)
    lead = modes.poles.shape[:-1]
    forces = (slopes.reshape(*lead, -1, 21) @ motions).reshape(*lead, 7, len(values), 14)
    changed = respond(model, sensors, values, modes, forces, span)
    moved = (sensors.slopes.reshape(-1, 7) @ modes.accelerations).reshape(*changed.shapes.shape)
    return changed._replace(shapes=changed.shapes + moved)


def respond(
    model: LinearModel, sensors: Rows, values: Real, modes: ModalSolution, forces: Complex, span: float
) -> ModalSlopes:
    """Give what forces that grow with the motion change in the response.

    Parameters
    ----------
    model, sensors, values, modes, span
        As for `differentiate_modes`.
    forces
        (dM λ² + dC λ + dK) v of every mode v, for several changes; shape (..., 7, change, 14).

    Returns
    -------
    ModalSlopes
        By change instead of by parameter.
    """
    lead, channels, changes = modes.poles.shape[:-1], len(sensors.affine), forces.shape[-2]
    S = np.broadcast_to(sensors.at(values), (*lead, channels, 7))
    both = np.concatenate([modes.left[..., 7:], S], axis=-2) @ -np.linalg.inv(model.matrices(values).M)
    changed = (both @ forces.reshape(*lead, 7, -1)).reshape(*lead, 14 + channels, changes, 14)
    D, of_sensors = changed[..., :14, :, :], changed[..., 14:, :, :]

    difference = modes.poles[..., None, :] - modes.poles[..., :, None]
    close = np.abs(difference) * span < _CLOSE
    mixing = np.where(close, 0.0, 1.0 / np.where(close, 1.0, difference))

    def seen(mixed: Complex) -> Complex:
        by_channel: Complex = modes.shapes @ mixed.reshape(*lead, 14, -1)
        return by_channel.reshape(*lead, channels, changes, 14)

    return ModalSlopes(
        np.diagonal(D, axis1=-3, axis2=-1),
        of_sensors + seen(D * mixing[..., :, None, :]),
        seen(D * close[..., :, None, :]),
    )


def _sizes(vectors: Complex, axis: int) -> Real:
    sizes: Real = np.sqrt(np.sum(vectors.real**2 + vectors.imag**2, axis=axis))
    return sizes

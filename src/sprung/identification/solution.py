"""Modal coordinates of one load: poles and shapes at the sensors, and their derivatives by the parameters."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle import LinearModel, Rows

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_CLOSE = 1e-6
"""Two poles are one where their difference turns by less than this over a record: their mode is then t e^{λt}."""


class ModalSolution(NamedTuple):
    """Poles and shapes of one load.

    Attributes
    ----------
    poles
        λ, 1/s, shape (14,).
    right, left
        Eigenvectors of the state matrix as columns, and their inverse, shape (14, 14).
    shapes
        s: reading of each channel per unit of modal amplitude, shape (channel, 14).
    """

    poles: Complex
    right: Complex
    left: Complex
    shapes: Complex

    @property
    def condition(self) -> float:
        """Largest condition number |w||v|/|w·v| of a pole: infinite where two modes meet in one shape."""
        # Displacements and velocities are made comparable by a mean frequency.
        balance = np.repeat([float(np.abs(self.poles).mean()), 1.0], 7)
        right = np.linalg.norm(self.right * balance[:, None], axis=0)
        return float((right * np.linalg.norm(self.left / balance, axis=1)).max())


class ModalSlopes(NamedTuple):
    """Derivatives of poles and readings by the parameters.

    Attributes
    ----------
    poles
        Shape (parameter, 14).
    shapes
        σ, shape (parameter, channel, 14).
    secular
        τ, shape (parameter, channel, 14).
    """

    poles: Complex
    shapes: Complex
    secular: Complex


def solve_modes(model: LinearModel, sensors: Rows, values: Real) -> ModalSolution:
    """Solve the eigenvalue problem of one load.

    Parameters
    ----------
    model
        Equations of motion.
    sensors
        The sensors' rows.
    values
        Parameters, SI.

    Returns
    -------
    ModalSolution
    """
    A = model.matrices(values).state
    poles, right = np.linalg.eig(A)
    return ModalSolution(poles, right, np.linalg.inv(right), sensors.at(values) @ (A[7:] @ right))


def differentiate_modes(
    model: LinearModel, sensors: Rows, values: Real, modes: ModalSolution, span: float
) -> ModalSlopes:
    """Differentiate the response by the parameters.

    Parameters
    ----------
    model, sensors, values
        As for `solve_modes`, which gave `modes`.
    modes
        Poles and shapes.
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
    """
    lower, slopes = model.accelerations(values)
    changes = slopes @ modes.right
    D = modes.left[:, 7:] @ changes
    difference = modes.poles[None, :] - modes.poles[:, None]
    close = np.abs(difference) * span < _CLOSE
    mixing = np.where(close, 0.0, 1.0 / np.where(close, 1.0, difference))
    of_sensors = sensors.slopes @ (lower @ modes.right) + sensors.at(values) @ changes
    return ModalSlopes(
        np.diagonal(D, axis1=1, axis2=2), of_sensors + modes.shapes @ (D * mixing), modes.shapes @ (D * close)
    )

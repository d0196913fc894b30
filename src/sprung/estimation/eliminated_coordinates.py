"""Added coordinates, eliminated: what parts that a fitted vehicle does not have would do to its modes.

With the dynamic stiffness D(λ) = M λ² + C λ + K of a larger vehicle, in blocks of the coordinates x of the fitted one and of
the others e, mode j forces on these the motion e = -D_ee⁻¹ D_ex v_j, all at λ_j, and they act on the fitted one as its dynamic
stiffness D_xx - D_xe D_ee⁻¹ D_ex says (dynamic condensation: Leung, Int. J. Numer. Meth. Eng. 12 (1978) 1705). Its derivative
by a parameter is P dD Pᵀ with P = [I, -D_xe D_ee⁻¹]. The free motion of what is added is left out: it is a decay of its own,
which tells of a part that hardly acts on the vehicle no more than any other decay would.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.modal_solution import ModalSolution
from sprung.vehicle import LinearModel, coordinates

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


def eliminate_coordinates(
    modes: ModalSolution, names: Sequence[str], larger: LinearModel, values: Real, changed: Real
) -> tuple[Complex, Complex]:
    """Return the derivatives of forces on a fitted vehicle, and of added motions, by changes of a larger one.

    Parameters
    ----------
    modes
        Of the fitted vehicle under every load.
    names
        Its parameters.
    larger
        Equations of motion of the larger vehicle, stacked likewise.
    values
        Its parameters, SI, shape (parameter,), at which it equals the fitted one, or nearly so.
    changed
        How much of each of them a change adds, SI, shape (change, parameter).

    Returns
    -------
    forces
        In every mode, as `differentiate_response` takes them, SI, shape (load, coordinate, change, mode).
    added
        Accelerations of all coordinates of the larger vehicle, those of the fitted one being held, SI, shape (load, coordinate,
        change, mode).
    """
    every = coordinates(larger.names)
    own = [every.index(one) for one in coordinates(names)]
    others = np.setdiff1d(np.arange(len(every)), own)
    poles = modes.poles[..., None, None]
    M, C, K = (matrix[:, None] for matrix in larger.matrices(values))
    stiffness = (M * poles + C) * poles + K
    among, across = stiffness[..., others[:, None], others], stiffness[..., others[:, None], own]
    back = stiffness[..., own, :][..., others]
    # All arrays by load, mode, coordinate and change from here on.
    shapes = np.swapaxes(modes.displacements, -1, -2)[..., None]
    lifted = np.zeros((*shapes.shape[:2], len(every), 1), dtype=np.complex128)
    lifted[..., own, :] = shapes
    lifted[..., others, :] = -np.linalg.solve(among, across @ shapes)
    motions = np.concatenate([lifted * poles**2, lifted * poles, lifted], axis=-2)[..., 0]
    # The rows of dM, dC and dK beside each other, those of every change below each other, by load.
    rows = np.moveaxis(np.concatenate(larger.slopes(values, changed), axis=-1), 0, -2)
    lead, size = rows.shape[0], rows.shape[-1]
    # As a product of real matrices, of which one holds pairs of real and imaginary parts.
    pairs = np.ascontiguousarray(np.swapaxes(motions, -1, -2)).view(float)
    forces = (rows.reshape(lead, -1, size) @ pairs).view(np.complex128)
    forces = np.moveaxis(forces.reshape(lead, len(every), len(changed), -1), -1, 1)
    moved = -np.linalg.solve(among, forces[..., others, :])
    added = np.zeros_like(forces)
    added[..., others, :] = moved * poles**2
    condensed = forces[..., own, :] + back @ moved
    return np.ascontiguousarray(np.moveaxis(condensed, 1, -1)), np.moveaxis(added, 1, -1)

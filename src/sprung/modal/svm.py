"""The State Variable Method: free vibration as a linear recursion, eqs. (5)-(12) of the paper."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.display import shown
from sprung.errors import Problems
from sprung.modal.record_checks import check_records
from sprung.vibration import Mode, make_modes

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


@shown
@dataclass(frozen=True, eq=False)
class StateVariableFit:
    """Result of the State Variable Method.

    Attributes
    ----------
    transition
        A₁ of eq. (10) over one step of the recursion, for the state {X(t), X(t + lag)} of channels that were each
        divided by their largest reading; shape (2n, 2n).
    poles
        λ of eq. (11), 1/s; shape (2n,), complex ones with their conjugates.
    shapes
        Φ of eq. (11) at the channels, as columns, dimensionless; shape (n, 2n).
    """

    transition: Real
    poles: Complex
    shapes: Complex

    @property
    def modes(self) -> tuple[Mode, ...]:
        """One mode for each conjugate pair and each real pole."""
        return make_modes(self.poles, self.shapes)

    @property
    def state_matrix(self) -> Real:
        """State matrix A of eqs. (4) and (12) for the channels as coordinates, shape (2n, 2n)."""
        return state_matrix(self.poles, self.shapes)


def state_matrix(poles: ArrayLike, shapes: ArrayLike) -> Real:
    """Return the state matrix with given poles and shapes, eq. (12).

    Eq. (12) writes the poles as seven and their conjugates; here all 2n stand in one list, so that the real poles of
    overdamped modes have their place.

    Parameters
    ----------
    poles
        1/s, shape (2n,), complex ones with their conjugates.
    shapes
        As columns, shape (n, 2n).

    Returns
    -------
    ndarray
        A, shape (2n, 2n), for the state {X, Ẋ}; its lower blocks are -M⁻¹K and -M⁻¹C.
    """
    poles, shapes = np.asarray(poles, dtype=complex), np.asarray(shapes, dtype=complex)
    vectors = np.vstack([shapes, shapes * poles])
    vectors = vectors / np.linalg.norm(vectors, axis=0)
    # A V = V Λ, solved from the right.
    A: Real = np.linalg.solve(vectors.T, (vectors * poles).T).T.real
    return A


def state_variable_method(records: Sequence[ArrayLike], rate: float, lag: int = 1) -> StateVariableFit:
    """Identify a freely vibrating system with as many degrees of freedom as there are channels.

    Φ̄ = A₁ Φ, eq. (8), is solved for all records at once by orthogonal factorisation, not by the inverse of ΦΦᵀ of
    eq. (10), which would square its condition number; the channels are first brought to one size.

    Parameters
    ----------
    records
        One array of shape (channel, time) for each drop: displacements, velocities or accelerations in free decay
        without offsets, the same channels in each.
    rate
        Samples per second, the same in all records.
    lag
        Samples between X(k) and X(k + 1) of eq. (6): ΔT = lag / rate. 1 is the method as printed. At usual rates one
        sample is too short a time for the state to change, and about 15 ms condition the recursion far better; half a
        period of the fastest motion, about 40 ms on a road vehicle, is the upper bound. Every sample is used whatever
        the lag.

    Returns
    -------
    StateVariableFit

    Raises
    ------
    InputError
        If the records differ in channels, hold something else than numbers, or are too short.

    Notes
    -----
    One-lag least squares has the records' noise in its regressor and is biased by it: 0.1 mg spoil the result on a car.

    References
    ----------
    Zhang and Hayama's State Variable Method as given in section 2.2 of the paper.
    """
    arrays = check_records(records, rate, "svm")
    channels = arrays[0].shape[0]
    equations = sum(max(record.shape[1] - 2 * lag, 0) for record in arrays)
    problems = Problems()
    if lag < 1:
        problems.add("svm: lag", f"{lag}", "one sample or more", "Take about 15 ms times the sampling rate.")
    elif equations < 2 * channels:
        problems.add(
            "svm: records",
            f"{equations} pairs of states from {len(arrays)} records at a lag of {lag} samples",
            f"at least {2 * channels}, twice the {channels} channels",
            "Give longer records or a smaller lag.",
        )
    problems.raise_if_any()

    size = np.max([np.abs(record).max(axis=1, initial=0.0) for record in arrays], axis=0)
    size = np.where(size > 0, size, 1.0)[:, None]
    long_enough = [record / size for record in arrays if record.shape[1] > 2 * lag]
    before = np.hstack([np.vstack([x[:, : -2 * lag], x[:, lag:-lag]]) for x in long_enough])
    after = np.hstack([np.vstack([x[:, lag:-lag], x[:, 2 * lag :]]) for x in long_enough])
    transition = np.asarray(np.linalg.lstsq(before.T, after.T, rcond=None)[0].T, dtype=float)
    z, vectors = np.linalg.eig(transition)
    poles = np.log(np.where(z == 0, np.finfo(float).tiny, z).astype(complex)) * rate / lag
    return StateVariableFit(transition, poles, size * vectors[:channels])

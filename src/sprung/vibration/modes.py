"""A mode of free vibration, and the modes of a vehicle whose matrices are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.display import shown
from sprung.vehicle import Matrices

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


EQUAL_ENTRIES = 1e-6
"""Relative difference below which two entries of a shape are equal."""

UNRESOLVED_FROM = 0.1
"""Standard uncertainty of a pole, as a part of its size, from which on the records do not determine it."""


@shown
@dataclass(frozen=True, eq=False)
class ModeUncertainty:
    """Uncertainty of a mode.

    Attributes
    ----------
    pole
        Covariance of the pole's real and imaginary part, 1/s², shape (2, 2).
    shape
        Standard uncertainty of each entry of the shape, that of its real part and, as imaginary part, that of its imaginary
        part; 0 for the entry that is 1; shape (channel,).
    excess
        Variance of the residuals around the mode's frequency in units of white noise: contained in both; 1 for white noise.
    """

    pole: Real
    shape: Complex
    excess: float = 1.0


@shown
@dataclass(frozen=True, eq=False)
class Mode:
    """One mode: a pair of conjugate poles, or one real pole of an overdamped motion.

    Attributes
    ----------
    pole
        1/s, imaginary part not negative.
    shape
        How far each channel or coordinate moves, dimensionless, its largest entry 1; shape (channel,).
    name
        One of `MODE_NAMES`; None where the shape has no name.
    uncertainty
        Its uncertainty; None where the method gives none.
    """

    pole: complex
    shape: Complex
    name: str | None = None
    uncertainty: ModeUncertainty | None = None

    @property
    def frequency(self) -> float:
        """Undamped natural frequency |pole|/2π, Hz."""
        return abs(self.pole) / (2 * np.pi)

    @property
    def damped_frequency(self) -> float:
        """Frequency of the motion itself, Hz; 0 for a real pole."""
        return abs(self.pole.imag) / (2 * np.pi)

    @property
    def damping_ratio(self) -> float:
        """Share of critical damping; 1 for a real pole of a decaying motion."""
        return -self.pole.real / abs(self.pole)

    @property
    def is_resolved(self) -> bool:
        """Whether the records determine the pole; true where no uncertainty is given."""
        return self.uncertainty is None or bool(
            np.trace(self.uncertainty.pole) < (UNRESOLVED_FROM * abs(self.pole)) ** 2
        )

    @property
    def frequency_std(self) -> float | None:
        """Standard uncertainty of the undamped natural frequency, Hz."""
        return self._std(np.array([self.pole.real, self.pole.imag]) / abs(self.pole) / (2 * np.pi))

    @property
    def damped_frequency_std(self) -> float | None:
        """Standard uncertainty of the damped frequency, Hz."""
        return self._std(np.array([0.0, 1.0]) / (2 * np.pi))

    @property
    def damping_ratio_std(self) -> float | None:
        """Standard uncertainty of the damping ratio; 0 for a real pole, whose ratio is 1."""
        across = np.array([-self.pole.imag, self.pole.real]) * self.pole.imag
        return self._std(across / abs(self.pole) ** 3)

    def _std(self, slope: Real) -> float | None:
        if self.uncertainty is None:
            return None
        return float(np.sqrt(np.maximum(slope @ self.uncertainty.pole @ slope, 0.0)))


def modal_assurance_criterion(one: ArrayLike, other: ArrayLike) -> Real:
    """Return the :term:`modal assurance criterion` of shapes, |u·v|²/(|u|²|v|²), independent of their lengths and phases.

    Parameters
    ----------
    one, other
        Shapes as columns, shape (channel, n) and (channel, m).

    Returns
    -------
    ndarray
        Between 0 and 1, shape (n, m).
    """
    u, v = np.asarray(one), np.asarray(other)
    lengths = np.outer(np.linalg.norm(u, axis=0), np.linalg.norm(v, axis=0))
    comparison: Real = (np.abs(u.conj().T @ v) / np.where(lengths > 0, lengths, 1.0)) ** 2
    return comparison


def group_real_pairs(modes: Sequence[Mode]) -> list[tuple[Mode, ...]]:
    """Group the two real poles of each overdamped motion, in the order of undamped natural frequency.

    Two real poles λ₁ λ₂ belong together where their shapes are most alike; their undamped natural frequency is √(λ₁λ₂).

    Parameters
    ----------
    modes
        In any order.

    Returns
    -------
    list of tuple of Mode
        One mode each, or two with real poles.
    """
    found = [(mode,) for mode in modes if mode.pole.imag != 0]
    real = sorted((mode for mode in modes if mode.pole.imag == 0), key=lambda mode: abs(mode.pole))
    groups: list[tuple[Mode, ...]] = list(found)
    if real:
        shapes = np.stack([mode.shape for mode in real], axis=1)
        alike = np.triu(modal_assurance_criterion(shapes, shapes), 1)
        left = set(range(len(real)))
        for i, j in np.argwhere(alike > 0)[np.argsort(-alike[alike > 0], kind="stable")].tolist():
            if i in left and j in left:
                groups.append((real[i], real[j]))
                left -= {i, j}
        groups.extend((real[i],) for i in left)
    return sorted(groups, key=lambda group: float(np.mean([np.log(max(abs(m.pole), 1e-300)) for m in group])))


def largest_entry(shape: ArrayLike) -> int:
    """Index of the largest entry of a shape; of entries as large as each other the first.

    Left and right of a symmetric vehicle are equal but for rounding, which must not decide the sign of a shape.

    Parameters
    ----------
    shape
        Real or complex, shape (channel,).

    Returns
    -------
    int
    """
    sizes = np.abs(np.asarray(shape))
    return int(np.argmax(sizes >= (1 - EQUAL_ENTRIES) * sizes.max()))


def make_modes(poles: ArrayLike, shapes: ArrayLike) -> tuple[Mode, ...]:
    """Return the modes of all poles of a real system.

    Parameters
    ----------
    poles
        1/s, complex ones with their conjugates; shape (pole,).
    shapes
        Their shapes as columns, shape (channel, pole).

    Returns
    -------
    tuple of Mode
        One for each conjugate pair and each real pole, in the order of `group_real_pairs`.
    """
    poles, shapes = np.asarray(poles, dtype=complex), np.asarray(shapes, dtype=complex)
    modes = []
    for pole, shape in zip(poles.tolist(), shapes.T, strict=True):
        if pole.imag >= 0:
            largest = shape[largest_entry(shape)]
            modes.append(Mode(pole, shape / (largest if largest != 0 else 1.0)))
    return tuple(mode for group in group_real_pairs(modes) for mode in group)


def sort_modes(modes: Sequence[Mode]) -> tuple[Mode, ...]:
    """Sort modes in the order of `make_modes`, with their uncertainties.

    Parameters
    ----------
    modes
        In any order.

    Returns
    -------
    tuple of Mode
    """
    if not modes:
        return ()
    ordered = make_modes([mode.pole for mode in modes], np.stack([mode.shape for mode in modes], axis=1))
    remaining = list(modes)
    found = []
    for mode in ordered:
        position = next(i for i, candidate in enumerate(remaining) if candidate.pole == mode.pole)
        found.append(replace(remaining.pop(position), shape=mode.shape))
    return tuple(found)


def eigenmodes(matrices: Matrices) -> tuple[Mode, ...]:
    """Return the modes of M Ẍ + C Ẋ + K X = 0, eq. (3), without names.

    Parameters
    ----------
    matrices
        M, C and K.

    Returns
    -------
    tuple of Mode
        Shapes in its coordinates, in the order of `group_real_pairs`; without the relaxations of `is_vibration`.
    """
    poles, vectors = np.linalg.eig(matrices.state)
    shapes = vectors[: len(matrices.M)]
    vibrations = is_vibration(poles, shapes, matrices.M)
    return make_modes(poles[vibrations], shapes[:, vibrations])


_NO_MASS = 0.01
"""kg (or kg m²) that a mode moves at the most where nothing moves in it that a vehicle has."""


def is_vibration(poles: ArrayLike, shapes: ArrayLike, M: ArrayLike) -> NDArray[np.bool_]:
    """Return which modes move masses, and do not only relax.

    Each coordinate without mass adds one pole: the relaxation of a damper against the spring in series with it. Of the real
    poles these are the ones in whose shapes the coordinates without mass have the largest shares. What has next to no mass, as
    a seat on which nothing lies, is none either.

    Parameters
    ----------
    poles
        1/s, shape (pole,).
    shapes
        In the coordinates, those with mass first, as columns; shape (coordinate, pole).
    M
        Mass matrix, SI, shape (coordinate, coordinate).

    Returns
    -------
    ndarray
        Shape (pole,).
    """
    shapes, M = np.asarray(shapes), np.asarray(M)
    sizes, massive = np.abs(shapes) ** 2, int(M.any(axis=0).sum())
    moved = np.einsum("ip,ij,jp->p", np.conj(shapes), M, shapes, optimize=True).real / sizes.max(axis=0)
    share = np.where(np.imag(poles) == 0, sizes[massive:].sum(axis=0) / sizes.sum(axis=0), -1.0)
    found = np.argsort(-share, kind="stable")[: len(sizes) - massive]
    vibrations = np.asarray(moved > _NO_MASS)
    vibrations[found[share[found] > 0]] = False
    return vibrations

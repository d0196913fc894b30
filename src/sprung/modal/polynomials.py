"""Poles from the Fourier transform of whole records by polynomials: least-squares complex frequency and rational fractions.

The transform of N samples of a decay, Σ_n z_jⁿ z⁻ⁿ = (1 - z_jᴺ z⁻ᴺ)/(1 - z_j z⁻¹), is rational in z on the lines of the
discrete Fourier transform, where z⁻ᴺ = 1: that the record begins and ends somewhere changes what a pole contributes, not the
pole. So both methods are exact for the whole transform of a sampled, finite record, without any window; an offset is on the
line at 0 Hz alone, which is left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.modal.decimation import DecimatedRecords, triangular_factor
from sprung.modal.identification_task import IdentificationTask
from sprung.modal.mode_set import ModeSet
from sprung.modal.shape_fit import fit_shapes
from sprung.modal.subspace import poles_of_transition

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_FAR = 2.0
"""Size of s up to which lines are used, 1 at a quarter of the rate: powers of larger ones drown all others."""

_WEIGHINGS, _LEAST = 8, 1e-9
"""How many times lines are weighed by the denominator found before (Sanathanan and Koerner, IEEE Trans. Autom. Control 8
(1963) 56), without which those far from all poles count for everything; and its least size, as a part of its largest."""

_ROUNDING = 1e-12

_RANK_TOLERANCE = 1e-15
"""Singular value, as a part of the largest, that is rounding."""

_OVERSIZE = 3
"""Times the lags that the order asks for: the ones too many take up noise."""


def complex_frequency(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify modes by the poly-reference least-squares complex frequency method (PolyMAX).

    A left matrix fraction A(z) Y(z) = B(z), with matrices over the channels in A and a polynomial for each record in B, is
    fitted to all lines. B is eliminated: of A's equations only what is no polynomial remains.

    Parameters
    ----------
    records, rate, order
        As for `eigensystem_realisation`. The model has more poles; those that explain most of the records are kept.

    Returns
    -------
    ModeSet
        Exact without noise, repeated and real poles too.

    Raises
    ------
    InputError
        As `eigensystem_realisation`.

    References
    ----------
    B. Peeters, H. Van der Auweraer, P. Guillaume and J. Leuridan, Shock Vib. 11 (2004) 395.
    """
    task = IdentificationTask.of(records, rate, order, "lscf")
    decimated, channels = task.decimated, task.decays.channels
    longest = max((decimated.shortest // 2 - 2) // (channels + 2), 1)
    task.allow(longest * channels)
    lags = min(_OVERSIZE * -(-task.order // channels), longest)
    factors = []
    for lines, transform in _transforms(decimated.records, decimated.step):
        powers = lines[:, None] ** -np.arange(lags + 1)
        block = np.concatenate([powers[:, i : i + 1] * transform.T for i in range(lags + 1)], axis=1)
        factors.append(_eliminate(powers[:, :-1], block))
    stacked = np.vstack(factors)
    # A(z) begins with 1: the newest samples are what the delayed ones give, within the rank of the motion.
    left, singular, right = np.linalg.svd(stacked[:, channels:], full_matrices=False)
    kept = slice(min(task.order, int(np.sum(singular > _RANK_TOLERANCE * singular[0]))))
    inverse = (right[kept].T / singular[kept]) @ left[:, kept].T
    coefficients = (inverse @ stacked[:, :channels]).T
    companion = np.eye(lags * channels, k=-channels)
    companion[:channels] = coefficients
    seen = np.eye(channels, lags * channels)
    return task.modes(poles_of_transition(companion, seen, decimated))


def rational_fractions(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify modes by rational fraction polynomials with one denominator for all channels and records.

    Over s = (z - 1)/(z + 1), the imaginary axis of which is the unit circle of z, each transform is B(s)/D(s) with real
    polynomials. Both are written in polynomials that are orthogonal over the lines (Forsythe's), so that orders of 14
    and more are no matter; D alone remains to be solved for, and its roots are the poles. A repeated pole is one root with
    several shapes.

    Parameters
    ----------
    records, rate, order
        As for `eigensystem_realisation`. Poles that repeat count once.

    Returns
    -------
    ModeSet
        Exact without noise, repeated and real poles too.

    Raises
    ------
    InputError
        As `eigensystem_realisation`.

    References
    ----------
    M. H. Richardson and D. L. Formenti, Proc. 1st Int. Modal Analysis Conf. (1982) 167; G. E. Forsythe, J. Soc. Ind. Appl.
    Math. 5 (1957) 74.
    """
    task = IdentificationTask.of(records, rate, order, "rfp")
    decimated = task.decimated
    task.allow(max(decimated.shortest // 2 - 2, 1) // 2)
    lines = list(_on_the_axis(decimated))
    weights = [np.ones(len(s)) for s, _ in lines]
    # Where several denominators fit exactly there is a smaller one.
    size = max(task.order + 1 - _exact(lines, weights, task.order), 1)
    for _ in range(_WEIGHINGS):
        poles, sizes = _denominator(lines, weights, size)
        weights = [1 / np.maximum(size, _LEAST * size.max()) for size in sizes]
    z = (1 + poles) / (1 - poles)
    usable = (np.abs(z) > 1e-12) & ~((z.imag == 0) & (z.real < 0)) & (z.imag >= 0) & (np.abs(z) < 1)
    exponent = np.log(z[usable].astype(complex)) / (decimated.step * decimated.every)
    if not exponent.size:
        return ModeSet((), (), "rfp")
    return task.modes(fit_shapes(task.decimated, exponent))


def _on_the_axis(decimated: DecimatedRecords) -> Iterator[tuple[Complex, Complex]]:
    """Yield the lines of all records on the imaginary axis of s, and their transforms."""
    for lines, transform in _transforms(decimated.records, decimated.step):
        s = (lines - 1) / (lines + 1)
        near = np.abs(s) < _FAR
        yield s[near], transform[:, near]


def _exact(lines: list[tuple[Complex, Complex]], weights: list[Real], order: int) -> int:
    """Count the denominators of some order that fit but for rounding, one at the least."""
    singular = np.linalg.svd(_misfit(lines, weights, order)[0], compute_uv=False)
    return max(int((singular < _ROUNDING * singular[0]).sum()), 1)


def _denominator(lines: list[tuple[Complex, Complex]], weights: list[Real], order: int) -> tuple[Complex, list[Real]]:
    """Fit numerators and a denominator of some order to the lines of all records.

    Returns
    -------
    poles
        Roots of the denominator, in s, shape (order,).
    sizes
        Of the denominator on the lines of each record.
    """
    misfit, recursion = _misfit(lines, weights, order)
    coefficients = np.linalg.svd(misfit)[2][-1]
    sizes = [np.abs(_continued(s, recursion) @ coefficients) for s, _ in lines]
    return _roots(coefficients, recursion), sizes


def _misfit(lines: list[tuple[Complex, Complex]], weights: list[Real], order: int) -> tuple[Real, Real]:
    """Return the equations of the denominator with numerators eliminated, as R of the QR factorisation, and the recursion."""
    recursion = _orthogonal(lines[0][0], weights[0], order)[1]
    factors: list[Real] = []
    for (s, transform), weight in zip(lines, weights, strict=True):
        basis = _orthogonal(s, weight, order)[0]
        common = _continued(s, recursion) * weight[:, None]
        factors.extend(_eliminate(basis, common * channel[:, None]) for channel in transform)
    return triangular_factor(np.vstack(factors)), recursion


def _transforms(records: Sequence[Real], step: int) -> Iterator[tuple[Complex, Complex]]:
    """Yield the lines z and the transform of every record, averaged over a lag; shapes (line,), (channel, line)."""
    for record in records:
        count = record.shape[1] // step
        means = record[:, : count * step].reshape(len(record), count, step).mean(axis=2)
        transform = np.fft.rfft(means - means.mean(axis=1, keepdims=True)) / np.sqrt(count)
        lines = np.exp(2j * np.pi * np.arange(transform.shape[1]) / count)
        # The line at half the rate is at infinity for s, that at 0 Hz holds the offset.
        kept = slice(1, (count - 1) // 2 + 1)
        yield lines[kept], transform[:, kept]


def _eliminate(known: Complex, block: Complex) -> Real:
    """Eliminate complex functions with real coefficients from a block, and return R of the remainder.

    Parameters
    ----------
    known, block
        Shapes (line, function) and (line, column).

    Returns
    -------
    ndarray
        Shape (at most column, column): the same inner products as the block has beside the functions.
    """
    real = np.concatenate([np.vstack([part.real, part.imag]) for part in (known, block)], axis=1)
    factor = triangular_factor(real)
    return factor[known.shape[1] :, known.shape[1] :]


def _orthogonal(s: Complex, weight: Real, order: int) -> tuple[Complex, Real]:
    """Return weighted polynomials of s up to an order, orthonormal over the lines, and their recursion.

    The recursion s p_k = Σ_i h_ik p_i (Arnoldi's) has real coefficients, as lines and their conjugates both count.
    """
    basis = np.empty((len(s), order + 1), dtype=np.complex128)
    recursion = np.zeros((order + 1, order))
    basis[:, 0] = weight / np.linalg.norm(weight)
    for k in range(order):
        new = s * basis[:, k]
        for _ in range(2):  # twice is enough
            along = (basis[:, : k + 1].conj().T @ new).real
            new = new - basis[:, : k + 1] @ along
            recursion[: k + 1, k] += along
        recursion[k + 1, k] = np.linalg.norm(new)
        basis[:, k + 1] = new / recursion[k + 1, k]
    return basis, recursion


def _continued(s: Complex, recursion: Real) -> Complex:
    """Evaluate the polynomials of a recursion elsewhere."""
    order = recursion.shape[1]
    basis = np.empty((len(s), order + 1), dtype=np.complex128)
    basis[:, 0] = 1.0
    for k in range(order):
        new = s * basis[:, k] - basis[:, : k + 1] @ recursion[: k + 1, k]
        basis[:, k + 1] = new / recursion[k + 1, k]
    return basis


def _roots(coefficients: Real, recursion: Real) -> Complex:
    """Return the roots of Σ c_k p_k: eigenvalues of the recursion, closed by p_n = -Σ c_k p_k / c_n."""
    order = recursion.shape[1]
    matrix = recursion[:order].T.copy()
    matrix[-1] -= recursion[order, -1] * coefficients[:order] / coefficients[order]
    return np.asarray(np.linalg.eigvals(matrix), dtype=np.complex128)

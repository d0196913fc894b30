"""Alternatives across the real axis: two real poles for a conjugate pair, and a pair for real poles.

A step of the optimiser cannot cross the real axis, as a pole and its conjugate meet there with one shape. Models on the other
side are tried as separate starts.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sprung.modal.likelihood import Poles

_NEARLY_REAL = 0.4
"""Imaginary part of a pole, as a part of its real one, up to which two real poles may be as likely."""

_NEAR = 2.0
"""Ratio of two real poles up to which a pair may be as likely."""

_APART = 0.3
"""Distance of the new poles, as a part of their size."""


def real_axis_alternatives(poles: Poles) -> Iterator[Poles]:
    """Yield models with a pair replaced by real poles, or real poles by a pair.

    Parameters
    ----------
    poles
        Poles and shapes.

    Yields
    ------
    Poles
        With two real poles for a pair that is nearly real, a pair for two real poles that are near each other, and a pair for
        a single real pole.
    """
    real = np.flatnonzero(poles.exponent.imag == 0)
    for j in poles.paired.tolist():
        pole, shape = complex(poles.exponent[j]), poles.shapes[:, j]
        if pole.imag < _NEARLY_REAL * abs(pole.real):
            two = abs(pole) * np.array([-1 - _APART, -1 + _APART], dtype=complex)
            shapes = shape.real + shape.imag * np.array([[1.0], [-1.0]])
            yield poles.without(j).joined_with(Poles.of(two.astype(np.complex128), shapes.T.astype(np.complex128)))
    for position, i in enumerate(real.tolist()):
        rest = poles.without(i)
        for j in real[position + 1 :].tolist():
            first, second = poles.exponent[i].real, poles.exponent[j].real
            if 1 / _NEAR < first / second < _NEAR:
                shape = poles.shapes[:, i] + 1j * poles.shapes[:, j]
                yield rest.without(j - 1).joined_with(_pair(-float(np.sqrt(first * second)), shape))
        if poles.exponent[i].real < 0:
            yield rest.joined_with(_pair(float(poles.exponent[i].real), poles.shapes[:, i]))


def _pair(size: float, shape: np.ndarray[tuple[int], np.dtype[np.complex128]]) -> Poles:
    return Poles.of(np.array([size * (1 - 1j * _APART)]), shape[:, None])

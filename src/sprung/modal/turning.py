"""Where two poles meet on the real axis: a pair that became two real poles, or two real poles a pair.

A step along the likelihood cannot cross there, as a pole and its conjugate meet with one shape. What lies on the other side is
tried instead.
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
"""How far apart the poles are put that take the place of others, as a part of their size."""


def alternatives(poles: Poles) -> Iterator[Poles]:
    """Give poles on the other side of the real axis's meeting points.

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
            turned = shape.real + shape.imag * np.array([[1.0], [-1.0]])
            yield poles.without(j).beside(Poles.of(two.astype(np.complex128), turned.T.astype(np.complex128)))
    for place, i in enumerate(real.tolist()):
        rest = poles.without(i)
        for j in real[place + 1 :].tolist():
            one, other = poles.exponent[i].real, poles.exponent[j].real
            if 1 / _NEAR < one / other < _NEAR:
                shape = poles.shapes[:, i] + 1j * poles.shapes[:, j]
                yield rest.without(j - 1).beside(_pair(-float(np.sqrt(one * other)), shape))
        if poles.exponent[i].real < 0:
            yield rest.beside(_pair(float(poles.exponent[i].real), poles.shapes[:, i]))


def _pair(size: float, shape: np.ndarray[tuple[int], np.dtype[np.complex128]]) -> Poles:
    return Poles.of(np.array([size * (1 - 1j * _APART)]), shape[:, None])

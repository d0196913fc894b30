"""A quarter car by its textbook equations, written out beside the program."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle import Vehicle

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

M_S, M_U, K_S, K_T, C_S = 380.0, 42.0, 19000.0, 190000.0, 1500.0

QUARTER = Vehicle(model="quarter", m_s=M_S, m_u=M_U, k_s=K_S, k_t=K_T, c_s=C_S)

VALUES: Real = np.array(list(QUARTER.parameters.values()))


def transfer(frequency: Real) -> tuple[Complex, Complex]:
    """Return body and wheel displacement over the road's height (Wong, Theory of Ground Vehicles, section 7.2)."""
    s = 2j * np.pi * frequency
    suspension = K_S + s * C_S
    body = M_S * s**2 + suspension
    whole = body * (M_U * s**2 + suspension + K_T) - suspension**2
    return np.asarray(K_T * suspension / whole), np.asarray(K_T * body / whole)


def mean_square(numerator: tuple[float, float, float, float], white: float) -> float:
    """Return the mean square of a quantity under white noise in closed form.

    Newland (An Introduction to Random Vibrations, 1993, appendix 1): for H = (B₀ + iωB₁ - ω²B₂ - iω³B₃)/(A₀ + iωA₁ - ω²A₂ -
    iω³A₃ + ω⁴A₄) the integral of |H|² over all ω, times the two-sided spectrum.

    Parameters
    ----------
    numerator
        B₀ to B₃ of the quantity over the velocity of the road.
    white
        One-sided spectrum of this velocity over f, (m/s)²/Hz.
    """
    a0, a1, a2, a3, a4 = K_S * K_T, C_S * K_T, (M_S + M_U) * K_S + M_S * K_T, (M_S + M_U) * C_S, M_S * M_U
    b0, b1, b2, b3 = numerator
    top = a0 * b3**2 * (a0 * a3 - a1 * a2) + a0 * a1 * a4 * (2 * b1 * b3 - b2**2)
    top += -a0 * a3 * a4 * (b1**2 - 2 * b0 * b2) + a4 * b0**2 * (a1 * a4 - a2 * a3)
    bottom = a0 * a4 * (a0 * a3**2 + a1**2 * a4 - a1 * a2 * a3)
    return float(np.pi * top / bottom * white / (4 * np.pi))


BODY_ACCELERATION = (0.0, K_S * K_T, C_S * K_T, 0.0)
"""s (K_T (K_S + C_S s)) over the velocity: acceleration is s² z, the velocity of the road s h."""

TRAVEL = (0.0, -M_S * K_T, 0.0, 0.0)
"""(z_s - z_u)/(s h) = K_T (-M_S s²)/s over the denominator."""

TYRE_LOAD = (0.0, K_T * (M_S + M_U) * K_S, K_T * (M_S + M_U) * C_S, K_T * M_S * M_U)
"""K_T (h - z_u)/(s h)."""

"""Rounding of a value by its uncertainty: two figures of the uncertainty, and the value to the same place."""

from __future__ import annotations

import math


def place_of(std: float) -> int:
    """Return the decimal place of the second significant figure of an uncertainty.

    Examples
    --------
    >>> place_of(0.0312), place_of(27.3)
    (3, 0)
    """
    place = 1 - math.floor(math.log10(abs(std)))
    # 0.0996 rounds to 0.10, whose second figure stands one place further left.
    return place - 1 if round(abs(std), place) >= 10 ** (2 - place) else place


def round_by_uncertainty(value: float, std: float) -> tuple[str, str]:
    """Return a value and its uncertainty as text, rounded to the second figure of the uncertainty.

    Parameters
    ----------
    value, std
        In one unit; a std of 0 stands for an exact value, which is written as it is.

    Returns
    -------
    value, std
        As text; the uncertainty of an exact value is empty.

    Examples
    --------
    >>> round_by_uncertainty(17007.3, 43.9), round_by_uncertainty(1.2505, 0.00161), round_by_uncertainty(2.76, 0.0)
    (('17007', '44'), ('1.2505', '0.0016'), ('2.76', ''))
    """
    if not std > 0 or not math.isfinite(std):
        return f"{value:.10g}", "" if std == 0 else "?"
    place = place_of(std)
    if place < 0:
        return f"{round(value, place):.0f}", f"{round(std, place):.0f}"
    return f"{value:.{place}f}", f"{std:.{place}f}"

"""Cells of tables: numbers rounded by their uncertainty, and units."""

from __future__ import annotations

import re

from sprung.uncertainty import Estimate, round_by_uncertainty

_FINEST = 6
"""Largest number of decimal places of a frequency in Hz or a damping ratio: further ones are rounding errors."""

_NEGATIVE = re.compile(r"(?<![\w.)\]-])-(?=\d)")
"""Hyphen of a negative number."""

_SUPERSCRIPT = str.maketrans({"^": "", "2": "²"})


def value_cells(estimate: Estimate) -> list[str]:
    """Return the cells of an estimate: value, standard uncertainty, percent, unit, status.

    Parameters
    ----------
    estimate
        With or without a value.

    Returns
    -------
    list of str
        "-" for a missing number.
    """
    unit = unit_text(estimate.unit)
    if estimate.value is None or estimate.std is None:
        return ["-", "-", "-", unit, estimate.status]
    value, std = round_by_uncertainty(estimate.value, estimate.std)
    percent = "" if estimate.percent is None or estimate.std == 0 else percent_text(estimate.percent)
    return [value, std, percent, unit, estimate.status]


def percent_text(percent: float) -> str:
    """Return a percentage as text, with the digits of an uncertainty.

    Parameters
    ----------
    percent
        Percent, not negative.

    Returns
    -------
    str
        Without the sign.
    """
    if percent >= 10:
        return f"{percent:.0f}"
    return f"{percent:.2f}" if percent >= 0.01 else f"{percent:.1g}"


def with_minus_signs(text: str) -> str:
    """Return text in which every negative number has a minus sign in place of a hyphen.

    Parameters
    ----------
    text
        Of a cell; hyphens in words, names and dates stay.

    Returns
    -------
    str

    Examples
    --------
    >>> with_minus_signs("-0.14 to 2, run-2, 2026-11-22")
    '−0.14 to 2, run-2, 2026-11-22'
    """
    return _NEGATIVE.sub("\N{MINUS SIGN}", text)


def unit_text(unit: str) -> str:
    """Return a unit as text, ``kg m²``; empty for a dimensionless number.

    Parameters
    ----------
    unit
        As in results: ``kg m^2``, or ``1`` for a dimensionless number.

    Returns
    -------
    str
    """
    return "" if unit == "1" else unit.translate(_SUPERSCRIPT)


def with_std(value: float, std: float | None) -> tuple[str, str]:
    """Return a frequency or damping ratio and its uncertainty as text, rounded by the uncertainty.

    Parameters
    ----------
    value, std
        In one unit; a std of None is an undetermined number.

    Returns
    -------
    value, std
        "-" for both where the number is undetermined. An uncertainty below 1e-6, which only noise-free records give, is "-":
        its digits are rounding errors.
    """
    if std is None:
        return "-", "-"
    if std < 10.0**-_FINEST:
        return f"{value:.{_FINEST}f}", "-"
    return round_by_uncertainty(value, std)

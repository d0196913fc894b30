"""Numbers as tables write them: rounded by their uncertainty, units as people write them."""

from __future__ import annotations

from sprung.uncertainty import Estimate, round_by_uncertainty

_FINEST = 6
"""Decimal places of a frequency in Hz or a damping ratio: no test tells more, and what stands further right is rounding."""

_SUPERSCRIPT = str.maketrans({"^": "", "2": "²"})


def value_cells(estimate: Estimate) -> list[str]:
    """Write an estimate: value, standard uncertainty, percent, unit, status.

    Parameters
    ----------
    estimate
        With or without a value.

    Returns
    -------
    list of str
        "-" for what there is not.
    """
    unit = unit_text(estimate.unit)
    if estimate.value is None or estimate.std is None:
        return ["-", "-", "-", unit, estimate.status]
    value, std = round_by_uncertainty(estimate.value, estimate.std)
    percent = "" if estimate.percent is None or estimate.std == 0 else percent_text(estimate.percent)
    return [value, std, percent, unit, estimate.status]


def percent_text(percent: float) -> str:
    """Write a percentage, to no more digits than an uncertainty has.

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


def unit_text(unit: str) -> str:
    """Write a unit as people do: ``kg m²``; nothing for a plain number.

    Parameters
    ----------
    unit
        As results have it: ``kg m^2``, or ``1`` for a plain number.

    Returns
    -------
    str
    """
    return "" if unit == "1" else unit.translate(_SUPERSCRIPT)


def with_std(value: float, std: float | None) -> tuple[str, str]:
    """Round a frequency or damping ratio by its uncertainty; without one there is no number.

    Parameters
    ----------
    value, std
        In one unit; a std of None stands for what is not determined.

    Returns
    -------
    value, std
        As text; "-" for both where there is no number. An uncertainty below 1e-6, which only records without noise give, is
        "-" too: the rounding of the processor would decide its digits.
    """
    if std is None:
        return "-", "-"
    if std < 10.0**-_FINEST:
        return f"{value:.{_FINEST}f}", "-"
    return round_by_uncertainty(value, std)

"""Estimates beside true values, for the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Group, RenderableType

from sprung.report.terminal.layout import hanging, table
from sprung.study import TrueValue
from sprung.tables import unit_text
from sprung.uncertainty import round_by_uncertainty

_USUAL = 2.0
"""Standard errors within which 95 of 100 differences lie."""


def truth_view(values: Mapping[str, TrueValue]) -> RenderableType:
    """Show estimates beside the true values, and how large their errors are.

    Parameters
    ----------
    values
        From `sprung.study.true_values`.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    headers = ("parameter", "true", "estimate", "±", "unit", "difference %", "in standard errors")
    rows = [[name, *_cells(one)] for name, one in values.items()]
    shown = table("Against the true values, which are known because the vehicle is simulated", headers, rows, _NUMBERS)
    near = sum(abs(one.standard_errors) <= _USUAL for one in values.values())
    said = (
        f"{near} of {len(values)} estimates lie within {_USUAL:g} standard errors of the true value; 95 of 100 are to be "
        "expected there. The errors are not independent of each other: one wrong scale moves all masses and rates together."
    )
    return Group(shown, hanging("", said))


_NUMBERS = ("true", "estimate", "±", "difference %", "in standard errors")


def _cells(one: TrueValue) -> list[str]:
    value, std = round_by_uncertainty(one.estimate.value or 0.0, one.estimate.std or 0.0)
    return [
        f"{one.true:.7g}",
        value,
        std,
        unit_text(one.estimate.unit),
        f"{one.percent:+.2f}",
        f"{one.standard_errors:+.1f}",
    ]

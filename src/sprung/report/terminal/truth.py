"""Estimates and true values, for the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Group, RenderableType

from sprung.report.terminal.layout import hanging_text, render_rows
from sprung.study import TrueValue
from sprung.tables import unit_text
from sprung.uncertainty import round_by_uncertainty

_COVERAGE_95 = 2.0
"""Standard uncertainties within which 95 of 100 estimates lie."""


def truth_view(values: Mapping[str, TrueValue]) -> RenderableType:
    """Return the table of estimates and true values with the errors.

    Parameters
    ----------
    values
        From `sprung.study.true_values`.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    headers = ("parameter", "true", "estimate", "±", "unit", "difference %", "standard errors")
    rows = [[name, *_cells(value)] for name, value in values.items()]
    shown = render_rows("Estimates and true values of the simulated vehicle", headers, rows, _NUMBERS)
    covered = sum(abs(value.standard_errors) <= _COVERAGE_95 for value in values.values())
    text = (
        f"{covered} of {len(values)} estimates are within {_COVERAGE_95:g} standard errors of the true value (expected: 95 %). "
        "The errors are correlated: an error of the scale affects all masses and rates."
    )
    return Group(shown, hanging_text("", text))


_NUMBERS = ("true", "estimate", "±", "difference %", "standard errors")


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

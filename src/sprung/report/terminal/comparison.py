"""The comparison of results, for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.report.terminal.layout import hanging_text, render_rows, significant_figures
from sprung.report.terminal.result import COLOURS
from sprung.study import Comparison, Difference, JointTest, QuantityComparison, ResultValue, ScatterEstimate
from sprung.tables import unit_text
from sprung.uncertainty import round_by_uncertainty

_FINDINGS = {
    "none": "not significant",
    "likely": "likely",
    "certain": "certain",
    "given": "known beforehand",
    "not comparable": "not comparable",
}

_SMALLEST = 1e-9
"""Smallest probability that is written out."""


def comparison_view(comparison: Comparison) -> RenderableType:
    """Return the view of a comparison: results side by side, differences and their significance.

    Parameters
    ----------
    comparison
        From `sprung.compare`.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    parts: list[RenderableType] = [*_verdicts(comparison), Text()]
    labels = tuple(result.name for result in comparison.results)
    for title, rows in _tables(comparison).items():
        cells = [[name, unit_text(row.unit), *map(_cell, row.values)] for name, row in rows.items()]
        headers = ("", "unit", *labels)
        parts += [render_rows(f"{title}, value ± standard uncertainty", headers, cells, labels, heads=2), Text()]
    for i in range(len(labels) - 1):
        parts += [*_differences_from_first(comparison, i), Text()]
    if comparison.scatter:
        parts += [scatter_table(comparison), Text()]
    parts += [hanging_text("  - ", note) for note in comparison.notes]
    parts.append(hanging_text("  - ", _SIGNIFICANCE))
    return Group(*parts)


_SIGNIFICANCE = (
    "likely: p ≤ 0.05, certain: p ≤ 0.001; p is the probability of such a difference anywhere in the table between two tests "
    "of one unchanged vehicle (Holm's correction for the number of rows; errors of the results assumed independent)"
)


def _tables(comparison: Comparison) -> dict[str, dict[str, QuantityComparison]]:
    """Return the rows of every table by its title: parameters, and modes of each load."""
    tables = {"Parameters": comparison.parameters}
    for name, row in comparison.modes.items():
        load, _, mode = name.partition(", ")
        tables.setdefault(f"Modes, {load}", {})[_short(mode)] = row
    return {title: rows for title, rows in tables.items() if rows}


def _short(mode: str) -> str:
    return mode.replace(", frequency", ", f_n").replace(", damping ratio", ", damping")


def _verdicts(comparison: Comparison) -> Iterator[RenderableType]:
    yield Text("Results", style="bold")
    for i, result in enumerate(comparison.results):
        name = f"{result.name}{' (reference)' * (i == 0)}: {result.vehicle}, "
        yield hanging_text("  - ", Text.assemble(name, (result.verdict, COLOURS[result.verdict])))


def _cell(quantity: ResultValue) -> str:
    if quantity.value is None or quantity.std is None:
        return "-"
    value, std = round_by_uncertainty(quantity.value, quantity.std)
    return f"{value} ± {std}" if std else value


def _differences_from_first(comparison: Comparison, i: int) -> Iterator[RenderableType]:
    first, other = comparison.results[0].name, comparison.results[i + 1].name
    modes = {_short(name): row for name, row in comparison.modes.items()}
    for kind, rows in (("parameters", comparison.parameters), ("modal values", modes)):
        tested = {name: row for name, row in rows.items() if row.differences[i].p is not None}
        significant = {name: row for name, row in tested.items() if row.differences[i].finding in ("likely", "certain")}
        if tested:
            title = f"{other} minus {first}: {len(significant)} of {len(tested)} {kind} differ"
            # Of two results every difference is shown, of many the significant ones.
            shown = tested if len(comparison.results) == 2 and kind == "parameters" else significant
            yield _differences(title, shown, i) if shown else Text(title, style="bold")
    yield from _joint_line(comparison.joint[i])
    yield from _not_compared(comparison.parameters, i)


def _differences(title: str, rows: Mapping[str, QuantityComparison], i: int) -> RenderableType:
    headers = ("", "difference", "±", "unit", "%", "z", "p", "finding")
    cells = [_row(name, row, row.differences[i]) for name, row in rows.items()]
    return render_rows(title, headers, cells, ("difference", "±", "%", "z", "p"), ("unit", "z", "±", "p"))


def _row(name: str, row: QuantityComparison, difference: Difference) -> list[str]:
    value, std = round_by_uncertainty(difference.value or 0.0, difference.std or 0.0)
    percent = "" if difference.percent is None else f"{difference.percent:+.2f}"
    z = "" if difference.z is None else f"{difference.z:+.1f}"
    sign = "+" if not value.startswith("-") else ""
    p = _probability(difference.p_holm)
    return [name, sign + value, std, unit_text(row.unit), percent, z, p, _FINDINGS[difference.finding]]


def _probability(p: float | None) -> str:
    if p is None:
        return ""
    return f"< {_SMALLEST:g}" if p < _SMALLEST else significant_figures(p, 2)


def _joint_line(test: JointTest | None) -> Iterator[RenderableType]:
    if test is not None and test.freedom:
        statistic = f"chi-square {significant_figures(test.chi_square, 3)} with {test.freedom} degrees of freedom"
        p = f"p = {_probability(test.p)}".replace("= <", "<")
        text = f"Joint test of all {len(test.names)} estimated parameters: {statistic}, {p}."
        yield hanging_text("", text)


def _not_compared(rows: Mapping[str, QuantityComparison], i: int) -> Iterator[RenderableType]:
    """Yield the reasons why quantities are not compared, each once."""
    reasons: dict[str, list[str]] = {}
    for name, row in rows.items():
        difference = row.differences[i]
        if difference.finding == "not comparable" and difference.why:
            reasons.setdefault(difference.why, []).append(name)
        elif difference.finding == "given":
            equality = "equal" if difference.value == 0 else "different"
            reasons.setdefault(f"known beforehand in both, {equality}", []).append(name)
    for why, names in reasons.items():
        yield hanging_text("", f"Not compared: {', '.join(names)} ({why}).")


def scatter_table(comparison: Comparison) -> RenderableType:
    """Return the table of the scatter of all results, and the outliers.

    Parameters
    ----------
    comparison
        From `sprung.compare`, of three results or more.
    """
    rows = []
    for name, scatter in comparison.scatter.items():
        row = comparison.parameters.get(name) or comparison.modes[name]
        furthest = f"{scatter.furthest}{' !' * scatter.stands_out}"
        rows.append([_short(name), *_scatter_cells(scatter), unit_text(row.unit), furthest])
    headers = ("", "mean", "±", "spread", "%", "p", "unit", "furthest")
    shown = render_rows(
        f"Scatter of {max(len(scatter.names) for scatter in comparison.scatter.values())} results beyond their uncertainties",
        headers,
        rows,
        headers[1:6],
        ("unit", "p", "±"),
    )
    outliers = {scatter.furthest for scatter in comparison.scatter.values() if scatter.stands_out}
    text = (
        f"!: outlier at the 5 % level: {', '.join(sorted(outliers))}." if outliers else "No outlier at the 5 % level."
    )
    return Group(shown, hanging_text("", text))


def _scatter_cells(scatter: ScatterEstimate) -> list[str]:
    mean, std = round_by_uncertainty(scatter.mean, scatter.mean_std)
    spread = significant_figures(scatter.spread, 2) if scatter.spread else "0"
    percent = (
        significant_figures(100 * scatter.spread / abs(scatter.mean), 2) if scatter.spread and scatter.mean else "0"
    )
    return [mean, std, spread, percent, _probability(scatter.p)]

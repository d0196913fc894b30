"""Results side by side, for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.report.terminal.layout import figures, hanging, table
from sprung.report.terminal.result import COLOURS
from sprung.study import Comparison, Difference, Joint, Quantity, Scatter, Told
from sprung.tables import unit_text
from sprung.uncertainty import round_by_uncertainty

_WORDS = {
    "none": "none to be seen",
    "likely": "likely",
    "certain": "certain",
    "given": "known beforehand",
    "not comparable": "not comparable",
}

_SMALLEST = 1e-9
"""A chance below which its size says nothing more."""


def comparison_view(comparison: Comparison) -> RenderableType:
    """Show results side by side, what differs, and how sure that is.

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
    labels = tuple(one.name for one in comparison.results)
    for title, rows in _tables(comparison).items():
        cells = [[name, unit_text(row.unit), *map(_cell, row.told)] for name, row in rows.items()]
        headers = ("", "unit", *labels)
        parts += [table(f"{title}, value ± standard uncertainty", headers, cells, labels, heads=2), Text()]
    first, *others = (one.name for one in comparison.results)
    for i, other in enumerate(others):
        parts += [*_against(comparison, first, other, i), Text()]
    if comparison.scatter:
        parts += [scatter_table(comparison), Text()]
    parts += [hanging("  - ", note) for note in comparison.notes]
    parts.append(hanging("  - ", _HOW))
    return Group(*parts)


_HOW = (
    "likely: chance up to 0.05, certain: up to 0.001, of such a difference anywhere in the table between two tests of one "
    "unchanged vehicle (Holm's correction for the number of rows; errors of the results taken as independent)"
)


def _tables(comparison: Comparison) -> dict[str, dict[str, Quantity]]:
    """Give the rows of every table by its title: parameters, and modes load by load."""
    tables = {"Parameters": comparison.parameters}
    for name, row in comparison.modes.items():
        load, _, mode = name.partition(", ")
        tables.setdefault(f"Modes, {load}", {})[_short(mode)] = row
    return {title: rows for title, rows in tables.items() if rows}


def _short(mode: str) -> str:
    return mode.replace(", frequency", ", f_n").replace(", damping ratio", ", damping")


def _verdicts(comparison: Comparison) -> Iterator[RenderableType]:
    yield Text("Compared", style="bold")
    for i, one in enumerate(comparison.results):
        what = f"{one.name}{' (reference)' * (i == 0)}: {one.vehicle}, "
        yield hanging("  - ", Text.assemble(what, (one.verdict, COLOURS[one.verdict])))


def _cell(told: Told) -> str:
    if told.value is None or told.std is None:
        return "-"
    value, std = round_by_uncertainty(told.value, told.std)
    return f"{value} ± {std}" if std else value


def _against(comparison: Comparison, first: str, other: str, i: int) -> Iterator[RenderableType]:
    modes = {_short(name): row for name, row in comparison.modes.items()}
    for kind, rows in (("parameters", comparison.parameters), ("modal values", modes)):
        judged = {name: row for name, row in rows.items() if row.differences[i].p is not None}
        seen = {name: row for name, row in judged.items() if row.differences[i].finding in ("likely", "certain")}
        if judged:
            title = f"{other} less {first}: {len(seen)} of {len(judged)} {kind} differ"
            # Of two results every difference is shown; of many those that matter.
            shown = judged if len(comparison.results) == 2 and kind == "parameters" else seen
            yield _differences(title, shown, i) if shown else Text(title, style="bold")
    yield from _joint_line(comparison.joint[i])
    yield from _not_compared(comparison.parameters, i)


def _differences(title: str, rows: Mapping[str, Quantity], i: int) -> RenderableType:
    headers = ("", "difference", "±", "unit", "%", "z", "chance", "finding")
    cells = [_row(name, row, row.differences[i]) for name, row in rows.items()]
    return table(title, headers, cells, ("difference", "±", "%", "z", "chance"), ("unit", "z", "±", "chance"))


def _row(name: str, row: Quantity, one: Difference) -> list[str]:
    value, std = round_by_uncertainty(one.value or 0.0, one.std or 0.0)
    percent = "" if one.percent is None else f"{one.percent:+.2f}"
    sure = "" if one.z is None else f"{one.z:+.1f}"
    sign = "+" if not value.startswith("-") else ""
    return [name, sign + value, std, unit_text(row.unit), percent, sure, _chance(one.p_holm), _WORDS[one.finding]]


def _chance(p: float | None) -> str:
    if p is None:
        return ""
    return f"< {_SMALLEST:g}" if p < _SMALLEST else figures(p, 2)


def _joint_line(one: Joint | None) -> Iterator[RenderableType]:
    if one is not None and one.freedom:
        told = f"chi-square {figures(one.chi_square, 3)} of {one.freedom} degrees of freedom"
        yield hanging(
            "",
            f"All {len(one.names)} estimated parameters at once: {told}, chance {_chance(one.p)} if nothing differs.",
        )


def _not_compared(rows: Mapping[str, Quantity], i: int) -> Iterator[RenderableType]:
    """Say why some are not compared, each reason once."""
    reasons: dict[str, list[str]] = {}
    for name, row in rows.items():
        one = row.differences[i]
        if one.finding == "not comparable" and one.why:
            reasons.setdefault(one.why, []).append(name)
        elif one.finding == "given":
            same = "the same" if one.value == 0 else "not the same"
            reasons.setdefault(f"known beforehand in both, {same}", []).append(name)
    for why, names in reasons.items():
        yield hanging("", f"Not compared: {', '.join(names)} ({why}).")


def scatter_table(comparison: Comparison) -> RenderableType:
    """Show how far all results scatter, and what stands out.

    Parameters
    ----------
    comparison
        From `sprung.compare`, of three results or more.
    """
    rows = []
    for name, one in comparison.scatter.items():
        row = comparison.parameters.get(name) or comparison.modes[name]
        rows.append([_short(name), *_scatter_cells(one), unit_text(row.unit), f"{one.furthest}{' !' * one.stands_out}"])
    headers = ("", "mean", "±", "spread", "%", "chance", "unit", "furthest")
    shown = table(
        f"Scatter of {max(len(one.names) for one in comparison.scatter.values())} results beyond their uncertainties",
        headers,
        rows,
        headers[1:6],
        ("unit", "chance", "±"),
    )
    out = {one.furthest for one in comparison.scatter.values() if one.stands_out}
    said = f"!: stands out from the others' scatter (5 %): {', '.join(sorted(out))}." if out else "None stands out."
    return Group(shown, hanging("", said))


def _scatter_cells(one: Scatter) -> list[str]:
    mean, std = round_by_uncertainty(one.mean, one.mean_std)
    spread = figures(one.spread, 2) if one.spread else "0"
    percent = figures(100 * one.spread / abs(one.mean), 2) if one.spread and one.mean else "0"
    return [mean, std, spread, percent, _chance(one.p)]

"""What could be measured next, for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.planning import Plan, PlanRow, two_figures
from sprung.report.terminal.layout import hanging, table

_FIRST = ("m_s", "I_yy", "I_xx", "k_sf", "k_sr", "c_sf", "c_sr", "m_uf", "m_ur", "k_tf", "k_tr", "a", "b")
"""Parameters whose columns stand first."""

_NAMED = 4
"""Alternatives that one reason names before it counts the others."""


def plan_view(plan: Plan) -> RenderableType:
    """Show a plan.

    Parameters
    ----------
    plan
        From `sprung.plan`.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    if plan.rejected:
        head = hanging(
            "", Text(f"{plan.vehicle}: the campaign is rejected; no plan can be made from it.", style="bold red")
        )
        return Group(head, *(hanging("  - ", reason) for reason in plan.rejected))
    parts = [plan_table(plan), Text()]
    reasons = [hanging("  - ", reason) for reason in _reasons(plan)]
    if reasons:
        parts += [Text("Not determined", style="bold"), *reasons, Text()]
    return Group(*parts, next_line(plan.next_step.text))


def next_line(text: str) -> RenderableType:
    """Show what to measure next."""
    return hanging("Next: ", f"{text}.")


def plan_table(plan: Plan) -> RenderableType:
    """Show every alternative with the percentages that it promises."""
    named = {name: None for row in plan.rows if row.bound is not None for name in row.bound.percents}
    ranked = sorted(named, key=lambda name: _FIRST.index(name) if name in _FIRST else len(_FIRST))
    above = f"> {plan.wanted:g} %"
    headers = ("test", "worst", "%", above, *ranked)
    rows = [[row.label, *_cells(plan, row, ranked)] for row in plan.rows]
    title = f"{plan.vehicle}: standard uncertainty to expect, %"
    return table(title, headers, rows, headers[2:])


def _cells(plan: Plan, row: PlanRow, names: Sequence[str]) -> Iterator[str]:
    if row.bound is None:
        yield from ("-",) * (3 + len(names))
        return
    worst = row.bound.worst
    yield "-" if worst is None else worst
    yield "-" if worst is None else two_figures(row.bound.percents[worst])
    yield str(row.bound.above(plan.wanted))
    for name in names:
        yield two_figures(row.bound.percents.get(name))


def _reasons(plan: Plan) -> Iterator[str]:
    """Say of every dash why it stands there, each reason once."""
    rows: dict[str, list[str]] = {}
    for row in plan.rows:
        if row.refused is not None:
            rows.setdefault(f"cannot be done: {row.refused}", []).append(row.label)
        elif row.bound is not None:
            for one in row.bound.why:
                # The scale's text is about whatever scales and does not name it, the others begin with their names.
                names = (
                    "" if one.parameters[0] in one.text.replace(",", " ").split() else f"{', '.join(one.parameters)}: "
                )
                rows.setdefault(f"{names}{one.text}", []).append(row.label)
    for reason, labels in rows.items():
        others = f" and {len(labels) - _NAMED} more" if len(labels) > _NAMED else ""
        yield f"{', '.join(labels[:_NAMED])}{others}: {reason}"

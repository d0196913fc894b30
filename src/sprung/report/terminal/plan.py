"""The plan of a test, for the terminal."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.planning import Plan, PlanRow, TermDetectability, two_figures
from sprung.report.terminal.layout import hanging_text, render_rows

_FIRST = ("m_s", "I_yy", "I_xx", "k_sf", "k_sr", "c_sf", "c_sr", "m_uf", "m_ur", "k_tf", "k_tr", "a", "b")
"""Parameters whose columns come first."""

_NAMED = 4
"""Alternatives that a reason lists by name; of more their number is given."""


def plan_view(plan: Plan) -> RenderableType:
    """Return the view of a plan.

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
        head = hanging_text(
            "", Text(f"{plan.vehicle}: the campaign is rejected; no plan can be made from it.", style="bold red")
        )
        return Group(head, *(hanging_text("  - ", reason) for reason in plan.rejected))
    parts = [plan_table(plan), Text()]
    reasons = [hanging_text("  - ", reason) for reason in _reasons(plan)]
    if reasons:
        parts += [Text("Not determined", style="bold"), *reasons, Text()]
    parts += [part for label, found in plan.terms.items() for part in (terms_table(label, found), Text())]
    return Group(*parts, next_line(plan.next_step.text))


def terms_table(label: str, terms: Sequence[TermDetectability]) -> RenderableType:
    """Return the table of the sizes from which the model terms would be found, in percent of what each acts beside."""
    headers = ("term", "usual", "found from", "most like", "told from it from")
    rows = [
        (
            one.name,
            *(two_figures(100 * size if math.isfinite(size) else None) for size in (one.size, one.smallest)),
            one.rival or "-",
            two_figures(100 * one.smallest_beside if math.isfinite(one.smallest_beside) else None),
        )
        for one in terms
    ]
    return render_rows(f"Model terms, {label}: size, %", headers, rows, (*headers[1:3], headers[4]))


def next_line(text: str) -> RenderableType:
    """Return the line with the recommended next measurement."""
    return hanging_text("Next: ", f"{text}.")


def plan_table(plan: Plan) -> RenderableType:
    """Return the table of all alternatives with the expected uncertainties."""
    names = {name: None for row in plan.rows if row.bound is not None for name in row.bound.percents}
    ranked = sorted(names, key=lambda name: _FIRST.index(name) if name in _FIRST else len(_FIRST))
    above = f"> {plan.wanted:g} %"
    headers = ("test", "worst", "%", above, *ranked)
    rows = [[row.label, *_cells(plan, row, ranked)] for row in plan.rows]
    title = f"{plan.vehicle}: expected standard uncertainty, %"
    return render_rows(title, headers, rows, headers[2:])


def _cells(plan: Plan, row: PlanRow, names: Sequence[str]) -> Iterator[str]:
    if row.bound is None:
        yield from ("-",) * (3 + len(names))
        return
    worst = row.bound.worst
    yield "-" if worst is None else worst
    yield "-" if worst is None else two_figures(row.bound.percents[worst])
    yield str(row.bound.count_above(plan.wanted))
    for name in names:
        yield two_figures(row.bound.percents.get(name))


def _reasons(plan: Plan) -> Iterator[str]:
    """Yield the reason for every dash, each once: those of parameters that are missing in the same tests together."""
    rows: dict[tuple[str, str], list[str]] = {}
    for row in plan.rows:
        for reason in _reasons_of(row):
            rows.setdefault(reason, []).append(row.label)
    together: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for (name, text), labels in rows.items():
        together.setdefault((text, tuple(labels)), []).append(name)
    for (text, tests), names in together.items():
        others = f" and {len(tests) - _NAMED} more" if len(tests) > _NAMED else ""
        subject = f"{', '.join(names)}: each " if len(names) > 1 else f"{names[0]} ".lstrip()
        yield f"{', '.join(tests[:_NAMED])}{others}: {subject}{text}"


def _reasons_of(row: PlanRow) -> Iterator[tuple[str, str]]:
    """Yield the reasons for the dashes of a row: the parameter whose name begins the text, if it is one alone, and the text."""
    if row.refused is not None:
        yield "", f"not possible: {row.refused}"
    for combination in row.bound.unidentifiable if row.bound is not None else ():
        names, text = combination.parameters, combination.text
        if len(names) == 1 and text.startswith(f"{names[0]} "):
            yield names[0], text.removeprefix(f"{names[0]} ")
        elif names[0] in text.replace(",", " ").split():
            yield "", text
        else:  # the text about the scale does not name its parameters
            yield "", f"{', '.join(names)}: {text}"

"""A Monte Carlo study, for the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.display import count_text
from sprung.report.terminal.layout import hanging_text, render_table
from sprung.report.terminal.result import COLOURS
from sprung.study import MonteCarlo, ParameterAccuracy, Share
from sprung.tables import Table, unit_text

_LISTED = 20
"""Largest number of failures that the terminal lists."""


def monte_carlo_view(found: MonteCarlo) -> RenderableType:
    """Return the view of a Monte Carlo study: bias, scatter, stated uncertainty and coverage of each parameter.

    Parameters
    ----------
    found
        From `sprung.study.monte_carlo`.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    counts = found.counts
    text = f"{found.vehicle}: {count_text(counts.done, 'campaign')} simulated and identified, {counts.failed} failed"
    there = counts.done + counts.failed - found.computed
    parts: list[RenderableType] = [
        Text(f"{text}; {there} of them in an earlier run." if there else f"{text}.", style="bold")
    ]
    for verdict, one in found.verdicts.items():
        parts.append(hanging_text("  - ", Text.assemble((verdict, COLOURS[verdict]), f": {_share(one)}")))
    for number, message in list(found.failures.items())[:_LISTED]:
        parts.append(hanging_text("  - ", f"campaign {number}: {message}"))
    headers: tuple[str, ...] = (
        "",
        "true",
        "unit",
        "bias %",
        "± %",
        "scatter %",
        "± % ",
        "stated %",
        "coverage %",
        "95 % interval",
        "-",
    )
    rows = tuple((name, *_accuracy_cells(one)) for name, one in found.parameters.items())
    if not any(row[-1] for row in rows):
        headers, rows = headers[:-1], tuple(row[:-1] for row in rows)
    headers = tuple("not determined" if header == "-" else header for header in headers)
    table = Table(
        "Errors of the estimates, in percent of the true value",
        headers,
        rows,
        frozenset(headers) - {"", "unit"},
        ("unit", "95 % interval", "± % ", "± %"),
    )
    parts += [Text(), render_table(table)]
    parts.append(hanging_text("  - ", _bias_sentence(found.parameters)))
    return Group(*parts)


def _accuracy_cells(one: ParameterAccuracy) -> list[str]:
    undetermined = str(one.undetermined) if one.undetermined else ""
    if one.bias is None or one.bias_std is None or one.scatter is None or one.scatter_std is None or one.stated is None:
        return [f"{one.true:.6g}", unit_text(one.unit), *["-"] * 7, undetermined]
    coverage = one.coverage
    return [
        f"{one.true:.6g}",
        unit_text(one.unit),
        f"{one.bias:+.3f}",
        f"{one.bias_std:.3f}",
        f"{one.scatter:.3f}",
        f"{one.scatter_std:.3f}",
        f"{one.stated:.3f}",
        f"{100 * coverage.part:.1f}",
        f"{100 * coverage.low:.1f} to {100 * coverage.high:.1f}",
        undetermined,
    ]


def _share(one: Share) -> str:
    return (
        f"{100 * one.part:.1f} % ({one.count} of {one.of}; 95 % interval {100 * one.low:.1f} to {100 * one.high:.1f} %)"
    )


def _bias_sentence(parameters: Mapping[str, ParameterAccuracy]) -> str:
    tested = [name for name, one in parameters.items() if one.bias_std is not None]
    if not tested:
        return "nothing can be said of bias: no parameter is estimated by two campaigns or more; use more --campaigns"
    biased = [name for name in tested if parameters[name].is_biased]
    level = "Student's t; as improbable by chance as three standard errors of many campaigns"
    if not biased:
        return f"no bias of the {len(tested)} estimated parameters is significant ({level})"
    return f"significant bias: {', '.join(biased)} ({level})"

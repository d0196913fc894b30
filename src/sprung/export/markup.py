"""Tables of a result in Markdown and LaTeX: parameters, quantities that follow from them, and modes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from sprung.export.file import ExportedFile
from sprung.export.outputs import identifier
from sprung.results import Result, characteristics_tables, modes_table, other_quantities, parameters_table
from sprung.tables import Table

_ESCAPES = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        **{character: f"\\{character}" for character in "&%$#_{}"},
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "±": r"$\pm$",
        "²": r"$^2$",
        "·": r"$\cdot$",
        "°": r"$^\circ$",
        "–": "--",
    }
)
"""Characters that LaTeX reads otherwise."""


def markdown(result: Result) -> ExportedFile:
    """Return the tables of a result in Markdown, its verdict first.

    Parameters
    ----------
    result
        Of an identification; a rejected one has no estimates.

    Returns
    -------
    ExportedFile
        Text with pipe tables.
    """
    parts = [
        f"# {_cell(result.name)}",
        f"**{result.verdict.state}**",
        *(f"- {_cell(one)}" for one in result.verdict.reasons),
    ]
    parts += [_markdown_table(table) for table in _tables(result)]
    text = "\n\n".join(parts).replace("\n\n- ", "\n- ", len(result.verdict.reasons)) + "\n"
    return ExportedFile(f"{identifier(result.name)}.md", text.encode())


def latex(result: Result) -> ExportedFile:
    r"""Return the tables of a result in LaTeX, for `\input`; no package is needed.

    Parameters
    ----------
    result
        Of an identification; a rejected one has no estimates.

    Returns
    -------
    ExportedFile
        One ``table`` environment for each table, the verdict in a comment.
    """
    verdict = [f"% {_line(text)}" for text in (f"{result.name}: {result.verdict.state}", *result.verdict.reasons)]
    parts = ["\n".join(verdict), *(_latex_table(table) for table in _tables(result))]
    return ExportedFile(f"{identifier(result.name)}.tex", ("\n\n".join(parts) + "\n").encode())


def _tables(result: Result) -> Iterable[Table]:
    yield parameters_table(result.name, {**result.parameters, **other_quantities(result.derived)})
    if result.verdict.state != "reject":
        yield from (table for table in characteristics_tables(result.name, result.derived) if table.rows)
        yield from (modes_table(load, modes) for load, modes in result.modes.items() if modes)


def _markdown_table(table: Table) -> str:
    rules = ["---:" if header in table.numbers else "---" for header in table.headers]
    rows = [
        [_cell(header.strip()) for header in table.headers],
        rules,
        *([_cell(cell) for cell in row] for row in table.rows),
    ]
    lines = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join([f"**{_cell(table.title)}**", "", *lines])


def _cell(text: str) -> str:
    return re.sub(r"([\\`*_{}\[\]<>#|])", r"\\\1", _line(text))


def _line(text: str) -> str:
    return " ".join(text.split())


def _latex_table(table: Table) -> str:
    columns = "".join("r" if header in table.numbers else "l" for header in table.headers)
    head = _latex_row([_escaped(header.strip()) for header in table.headers])
    rows = [_latex_row([_symbol(row[0]), *map(_escaped, row[1:])]) for row in table.rows]
    return "\n".join(
        [
            r"\begin{table}",
            rf"\caption{{{_escaped(table.title)}}}",
            rf"\begin{{tabular}}{{{columns}}}",
            r"\hline",
            head,
            r"\hline",
            *rows,
            r"\hline",
            r"\end{tabular}",
            r"\end{table}",
        ]
    )


def _latex_row(cells: Sequence[str]) -> str:
    return " & ".join(cells) + r" \\"


def _symbol(name: str) -> str:
    """Return the symbol of a parameter, k_sf as k with an index; any other text as it is."""
    found = re.fullmatch(r"([A-Za-z])(?:_([A-Za-z0-9]{1,3}))?", name)
    if found is None:
        return _escaped(name)
    letter, index = found.groups()
    return f"${letter}$" if index is None else rf"${letter}_{{\mathrm{{{index}}}}}$"


def _escaped(text: str) -> str:
    return _line(text).translate(_ESCAPES)

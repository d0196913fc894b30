"""Tables of a result in Markdown and LaTeX: every estimate, in a table that other programs read."""

from __future__ import annotations

import re
from pathlib import Path

import markdown_it
import pytest

import sprung
from sprung import export
from sprung.results import parameters_table

SAVED = Path(__file__).resolve().parents[1] / "report"


@pytest.mark.parametrize("state", ["accept", "doubtful", "reject", "unidentifiable"])
def test_markdown_has_every_cell(state: str) -> None:
    result = sprung.load(SAVED / f"{state}.json", series=False)
    text = export.markdown(result).text
    html = markdown_it.MarkdownIt("commonmark").enable("table").render(text)
    cells = re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", html)
    table = parameters_table(result.name, result.parameters)
    assert cells[: len(table.headers)] == list(table.headers)
    for row in table.rows:
        place = cells.index(row[0])
        assert cells[place : place + len(row)] == [cell.replace("&", "&amp;") for cell in row]
    assert f"<strong>{result.verdict.state}</strong>" in html
    assert html.count("<li>") == len(result.verdict.reasons)
    assert (html.count("<table>") > 1) == (state != "reject")


@pytest.mark.parametrize("state", ["accept", "doubtful", "reject", "unidentifiable"])
def test_latex_has_every_row(state: str) -> None:
    result = sprung.load(SAVED / f"{state}.json", series=False)
    text = export.latex(result).text
    assert text.startswith(f"% {result.name}: {result.verdict.state}\n")
    for environment in ("table", "tabular"):
        assert text.count(rf"\begin{{{environment}}}") == text.count(rf"\end{{{environment}}}") >= 1
    for block in re.findall(r"\\begin{tabular}{(\w+)}\n(.*?)\\end{tabular}", text, re.DOTALL):
        rows = [line for line in block[1].splitlines() if line != r"\hline"]
        assert all(line.endswith(r" \\") for line in rows)
        assert all(len(re.findall(r"(?<!\\)&", line)) == len(block[0]) - 1 for line in rows)
    code = "\n".join(line for line in text.splitlines() if not line.startswith("%"))
    assert not re.search(r"(?<!\\)[#%~]", code)
    assert not re.search(r"[^\x00-\x7f]", code)
    for name in result.parameters:
        letter, _, index = name.partition("_")
        assert (rf"${letter}_{{\mathrm{{{index}}}}}$" if index else f"${letter}$") in text


def test_a_name_with_signs_of_markup_is_escaped() -> None:
    result = sprung.load(SAVED / "accept.json", series=False)
    from dataclasses import replace  # noqa: PLC0415

    named = replace(result, tested_vehicle=replace(result.tested_vehicle, name="A_1 & B|2 #3 100 %"))
    assert r"A\_1 & B\|2 \#3 100 %" in export.markdown(named).text
    assert r"A\_1 \& B|2 \#3 100 \%" in export.latex(named).text
    assert export.latex(named).name == "A_1___B_2__3_100__.tex"

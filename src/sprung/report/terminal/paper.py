"""The reproduction of the paper, for the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.paper import Misprint, ModalValues, ModeRow, NoisePoint, PaperReproduction, ParameterRow
from sprung.report.terminal.layout import hanging_text, render_rows


def paper_view(reproduction: PaperReproduction) -> RenderableType:
    """Return the view of the reproduction of the paper.

    Parameters
    ----------
    reproduction
        From `sprung.study.reproduce`.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    parts = (
        _parameters("Table 2: the simulated car, without noise", reproduction.table2, "paper"),
        _modes(reproduction.table3),
        _parameters("The school bus, identified from simulated drops", reproduction.bus, None),
        _misprints(reproduction.misprints),
        _noise(reproduction.noise),
    )
    return Group(*[piece for part in parts for piece in (part, Text())][:-1])


def _parameters(title: str, rows: Sequence[ParameterRow], paper: str | None) -> RenderableType:
    headers = ["parameter", "known", *([paper, "error %"] if paper else []), "sprung", "error % "]
    cells = []
    for row in rows:
        printed = [f"{row.paper:g}", f"{100 * (row.paper / row.known - 1):+.3f}"] if paper else []
        error = "known" if row.given else f"{row.error_percent:+.1e}"
        cells.append([row.name, f"{row.known:.8g}", *printed, f"{row.identified:.8g}", error])
    return render_rows(title, headers, cells, headers[1:])


def _modes(rows: Sequence[ModeRow]) -> RenderableType:
    def three(values: ModalValues) -> list[str]:
        return [
            f"{values.natural_frequency:.4f}",
            f"{values.damped_frequency:.4f}",
            f"{values.damping_ratio:.4f}",
        ]

    headers = ["mode", "paper's name", "paper f_n", "f_d", "ζ", "computed f_n", "f_d", "ζ"]
    cells = [[row.mode, row.paper_name, *three(row.paper), *three(row.computed)] for row in rows]
    return render_rows("Table 3: modes of the bus of Tables 4 and 5, Hz", headers, cells, headers[2:])


def _misprints(misprints: Sequence[Misprint]) -> RenderableType:
    lines: list[RenderableType] = [Text("Misprints", style="bold")]
    for misprint in misprints:
        lines.append(hanging_text("", Text.assemble((misprint.where, "bold"), f": {misprint.printed}")))
        lines.append(hanging_text("  correct: ", misprint.should_be))
        lines.append(hanging_text("  reason:  ", misprint.reason))
    return Group(*lines)


def _noise(points: Sequence[NoisePoint]) -> RenderableType:
    def two_figures(percent: float | None) -> str:
        return "-" if percent is None else f"{float(f'{percent:.2g}'):g}"

    cells = [[f"{point.noise:g}", two_figures(point.paper_method), two_figures(point.joint_fit)] for point in points]
    headers = ["noise m/s²", "paper's method %", "joint fit %"]
    return render_rows(
        "Sensitivity to noise: largest error of any parameter, five bumps, ΔM = 0.1 M", headers, cells, headers
    )

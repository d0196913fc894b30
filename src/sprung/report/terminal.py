"""What the terminal shows: the parameter table, the modal tables, the verdict, the faults."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from sprung.errors import Fault
from sprung.estimate import Estimate, round_by_uncertainty
from sprung.identification import ModeEstimate
from sprung.pipeline import Check, Result
from sprung.vehicle import PARAMETERS

_COLOURS = {"accept": "green", "doubtful": "yellow", "reject": "red"}
_WIDE = 100
"""Columns from which there is room for what a parameter means."""

_SUPERSCRIPT = str.maketrans({"^": "", "2": "²"})


def table(title: str, headers: Sequence[str], rows: Iterable[Sequence[str]], numbers: Iterable[str] = ()) -> Table:
    """Lay out one table.

    Parameters
    ----------
    title
        Above it.
    headers
        Of its columns.
    rows
        Cells as text.
    numbers
        Headers of the columns to set flush right.
    """
    right = set(numbers)
    made = Table(title=title, title_justify="left", title_style="bold", header_style="dim", box=None, pad_edge=False)
    for header in headers:
        made.add_column(header, justify="right" if header in right else "left", no_wrap=header in right)
    for row in rows:
        made.add_row(*row)
    return made


def result_view(result: Result, width: int) -> RenderableType:
    """Show a result.

    Parameters
    ----------
    result
        The result.
    width
        Of the terminal, columns.
    """
    parts: list[RenderableType] = [parameter_table(result, width), Text()]
    parts += [note for item in result.unidentifiable for note in (Text(f"Not determined: {item.text}."), Text())]
    if not result.scale.known and result.scale.per_total_mass:
        parts += [ratio_table(result), Text()]
    for load, modes in result.modes.items():
        parts += [mode_table(load, modes), Text()]
    parts += [fit_line(result), Text()]
    if result.faults:
        parts += [fault_list(result.faults), Text()]
    parts.append(verdict_view(result))
    return Group(*parts)


def verdict_view(result: Result) -> RenderableType:
    """Show the verdict and its reasons."""
    verdict = result.verdict
    head = Text.assemble(("Verdict: ", "bold"), (verdict.state, f"bold {_COLOURS[verdict.state]}"))
    return Group(head, *(Text(f"  - {reason}") for reason in verdict.reasons))


def parameter_table(result: Result, width: int) -> Table:
    """Show every parameter with its uncertainty."""
    wide = width >= _WIDE
    headers = ["parameter", "value", "±", "%", "unit", "status", *(["meaning"] if wide else [])]
    rows = [
        [name, *_value_cells(estimate), *([PARAMETERS[name].meaning] if wide else [])]
        for name, estimate in result.parameters.items()
    ]
    return table(f"{result.vehicle.name}: parameters, one standard uncertainty", headers, rows, ("value", "±", "%"))


def _value_cells(estimate: Estimate) -> list[str]:
    unit = _unit(estimate.unit)
    if estimate.value is None or estimate.std is None:
        return ["-", "-", "-", unit, estimate.status]
    value, std = round_by_uncertainty(estimate.value, estimate.std)
    percent = "" if estimate.percent is None or estimate.std == 0 else _percent(estimate.percent)
    return [value, std, percent, unit, estimate.status]


def _percent(percent: float) -> str:
    if percent >= 10:
        return f"{percent:.0f}"
    return f"{percent:.2f}" if percent >= 0.01 else f"{percent:.1g}"


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit.translate(_SUPERSCRIPT).replace("/s²", "/s²")


def ratio_table(result: Result) -> Table:
    """Show what is left without absolute scale."""
    rows = []
    for name, ratio in result.scale.per_total_mass.items():
        value, std = round_by_uncertainty(ratio.value, ratio.std)
        rows.append([name, value, std, _unit(ratio.unit)])
    return table(
        "Per kilogram of the empty vehicle's total mass", ["parameter", "value", "±", "unit"], rows, ("value", "±")
    )


def mode_table(load: str, modes: Sequence[ModeEstimate]) -> Table:
    """Show the modes of one load."""
    rows = []
    for mode in modes:
        frequency, frequency_std = _with_std(mode.frequency, mode.frequency_std, 4)
        damping, damping_std = _with_std(mode.damping_ratio, mode.damping_ratio_std, 4)
        rows.append([mode.name, frequency, frequency_std, f"{mode.damped_frequency:.3f}", damping, damping_std])
    headers = ["mode", "f_n Hz", "± Hz", "f_d Hz", "damping", "±"]
    return table(f"Modes, {load}", headers, rows, headers[1:])


def _with_std(value: float, std: float | None, places: int) -> tuple[str, str]:
    if std is None or std == 0:
        return f"{value:.{places}f}", "-"
    return round_by_uncertainty(value, std)


def fit_line(result: Result) -> RenderableType:
    """Say in a line or two how the fit went."""
    fit = result.fit
    noise = ", ".join(f"{channel} {value:.3g}" for channel, value in fit.noise.items())
    extras = f", with {', '.join(fit.model)}" if fit.model else ""
    text = (
        f"Fit: {fit.method}{extras}; {fit.drops} drops, {fit.samples} samples, {fit.iterations} steps, "
        f"{fit.starts_agreeing} of {fit.starts} starts agree."
    )
    if fit.inflation > 1:
        text += f" The residuals are coloured: every uncertainty was enlarged by {fit.inflation**0.5:.2f}."
    return Text(f"{text}\nNoise, m/s² rms: {noise}.")


def fault_list(faults: Sequence[Fault]) -> RenderableType:
    """Show what is wrong with the recordings and what to do."""
    lines = [Text("Faults", style="bold")]
    for fault in faults:
        lines.append(Text.assemble(f"  {fault.where}: ", (fault.code, "yellow"), f": {fault.what}. {fault.do}"))
    return Group(*lines)


def check_view(check: Check) -> RenderableType:
    """Show what a look at the recordings gave."""
    rows = []
    for drop in check.drops:
        if drop.start is None or drop.end is None:
            rows.append([drop.file, drop.load, "-", "-", "left out", ", ".join(drop.faults)])
        else:
            length = f"{drop.end - drop.start:.2f}"
            rows.append([drop.file, drop.load, f"{drop.start:.3f}", f"{drop.end:.3f}", length, ", ".join(drop.faults)])
    headers = ["recording", "load", "decay from s", "to s", "length s", "faults"]
    parts: list[RenderableType] = [table("Drops", headers, rows, headers[2:5])]
    if check.faults:
        parts += [Text(), fault_list(check.faults)]
    return Group(*parts)


def modes_view(modes: Mapping[str, Sequence[ModeEstimate]]) -> RenderableType:
    """Show modes found without a vehicle model."""
    return Group(*(part for load, found in modes.items() for part in (mode_table(load, found), Text())))


def show(view: RenderableType, console: Console | None = None) -> None:
    """Print a view to standard output."""
    (console or Console(highlight=False)).print(view)

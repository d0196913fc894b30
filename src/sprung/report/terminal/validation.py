"""What a validation shows: a table of the drops and one of the modes for the terminal, and drawings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.assessment import AmplitudeCurve, DropValidation, ModeAmplitude
from sprung.report.terminal.layout import figures, hanging, laid_out
from sprung.report.terminal.result import fault_list, verdict_view
from sprung.study import Validation
from sprung.tables import Table

COLUMNS = (
    "/noise: residual over the sensors' noise. Predicted: by the vehicle fitted to all other drops. Least white: largest "
    "autocorrelation of the residuals: channel, value, lag."
)
"""What the columns of the table of drops say."""

AMPLITUDES = (
    "A damped sinusoid fitted to one and a half periods of a record at a time (symbols, with two standard uncertainties), the "
    "same of the simulated drops (thin lines), and a free decay of the fitted vehicle in this mode alone (thick line); dashed "
    "its linear part."
)
"""How modes against amplitude are to be read."""

_COLOURED = 6.0
"""Standard deviations from which a channel's residuals are said not to be white."""


def validation_view(validation: Validation) -> RenderableType:
    """Show a validation.

    Parameters
    ----------
    validation
        From `sprung.validate`.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    result = validation.result
    parts: list[RenderableType] = [
        laid_out(validation_table(result.name, result.validation)),
        hanging("", COLUMNS),
        Text(),
    ]
    if validation.amplitudes:
        parts += [laid_out(amplitude_table(validation.load, validation.amplitudes)), Text()]
    if result.faults:
        parts += [fault_list(result.faults), Text()]
    return Group(*parts, verdict_view(result))


def validation_table(vehicle: str, drops: Mapping[str, DropValidation]) -> Table:
    """Show how well each drop is explained, and predicted by the others.

    Parameters
    ----------
    vehicle
        Whose they are.
    drops
        By name.
    """
    headers = ("drop", "vertical %", "pitch %", "roll %", "all %", "/noise", "predicted %", "/noise ", "least white")
    rows = tuple(
        (
            name,
            *(_percent(error) for error in (drop.vertical, drop.pitch, drop.roll, drop.fitted)),
            f"{drop.residual:.2f}",
            _percent(drop.predicted),
            "-" if drop.predicted_residual is None else f"{drop.predicted_residual:.2f}",
            _least_white(drop),
        )
        for name, drop in drops.items()
    )
    title = f"{vehicle}: measured minus simulated as a part of the measured, of the body and of all channels"
    return Table(title, headers, rows, frozenset(headers[1:-1]), ("least white", "all %", "/noise"))


def amplitude_table(load: str, amplitudes: Sequence[ModeAmplitude]) -> Table:
    """Show frequency and damping of each mode at its largest and its smallest amplitude.

    Parameters
    ----------
    load
        On the vehicle.
    amplitudes
        By mode.
    """
    rows = []
    for one in amplitudes:
        for trace in one.records:
            if trace.amplitude.size:
                rows.append((one.mode, trace.name, *_ends(trace)))
        if one.model.amplitude.size:
            rows.append((one.mode, "fitted vehicle", *_ends(one.model)))
    headers = ("mode", "from", "mm", "f Hz", "±", "damping", "mm ", "f Hz ", "± ", "damping ")
    title = f"Modes of the body against amplitude, {load}: at the largest, then at the smallest"
    return Table(title, headers, tuple(rows), frozenset(headers[2:]), ("± ", "±", "damping ", "damping"))


def _ends(trace: AmplitudeCurve) -> list[str]:
    cells = []
    for i in (int(trace.amplitude.argmax()), int(trace.amplitude.argmin())):
        cells += [
            figures(1e3 * float(trace.amplitude[i]), 2),
            f"{trace.frequency[i]:.3f}",
            f"{trace.frequency_std[i]:.3f}",
            f"{trace.damping_ratio[i]:.3f}",
        ]
    return cells


def _percent(error: float | None) -> str:
    return "-" if error is None else f"{100 * error:.1f}"


def _least_white(drop: DropValidation) -> str:
    if not drop.whiteness:
        return "-"
    name, left = max(drop.whiteness.items(), key=lambda item: item[1].colour)
    return "none" if left.colour < _COLOURED else f"{name} {left.correlation:.2f} at {1e3 * left.lag:.0f} ms"

"""A cross-validation, for the terminal: a table of the drops and one of the modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.assessment import AmplitudeCurve, DropValidation, ModeAmplitude, motions_of
from sprung.report.terminal.layout import hanging_text, render_table, significant_figures
from sprung.report.terminal.result import fault_list, verdict_view
from sprung.study import Validation
from sprung.tables import Table
from sprung.vehicle import Layout, layout_of

COLUMNS = (
    "/noise: residual over the sensors' noise. Predicted: by the vehicle fitted to all other drops. Autocorrelation: largest "
    "residual autocorrelation: channel, value, lag."
)
"""Explanation of the columns of the table of drops."""

AMPLITUDES = (
    "Symbols: damped sinusoid fitted to 1.5 periods of the recording at a time, with two standard uncertainties. Thin lines: "
    "the same of the simulated drops. Thick line: free decay of the fitted vehicle in this mode alone; dashed: its linear part."
)
"""Explanation of the figures of modes against amplitude."""

_SIGNIFICANT = 6.0
"""Standard deviations above which an autocorrelation is significant."""


def validation_view(validation: Validation) -> RenderableType:
    """Return the view of a cross-validation.

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
        render_table(validation_table(result.name, result.validation, layout_of(result.parameters))),
        hanging_text("", COLUMNS),
        Text(),
    ]
    if validation.amplitudes:
        parts += [render_table(amplitude_table(validation.load, validation.amplitudes)), Text()]
    if result.faults:
        parts += [fault_list(result.faults), Text()]
    return Group(*parts, verdict_view(result))


def validation_table(vehicle: str, drops: Mapping[str, DropValidation], layout: Layout) -> Table:
    """Return the table of fitted and predicted errors by drop.

    Parameters
    ----------
    vehicle
        Name of the vehicle.
    drops
        By name.
    layout
        Of the vehicle: a motion that it does not have gets no column.
    """
    motions = motions_of(layout)
    headers = (
        "drop",
        *(f"{motion} %" for motion in motions),
        "all %",
        "/noise",
        "predicted %",
        "/noise ",
        "autocorrelation",
    )
    rows = tuple(
        (
            name,
            *(_percent(getattr(drop, motion)) for motion in motions),
            _percent(drop.fitted),
            f"{drop.residual:.2f}",
            _percent(drop.predicted),
            "-" if drop.predicted_residual is None else f"{drop.predicted_residual:.2f}",
            _autocorrelation(drop),
        )
        for name, drop in drops.items()
    )
    title = f"{vehicle}: measured minus simulated, % of the measured, of the body and of all channels"
    return Table(title, headers, rows, frozenset(headers[1:-1]), ("autocorrelation", "all %", "/noise"))


def amplitude_table(load: str, amplitudes: Sequence[ModeAmplitude]) -> Table:
    """Return the table of frequency and damping of each mode at its largest and its smallest amplitude.

    Parameters
    ----------
    load
        On the vehicle.
    amplitudes
        By mode.
    """
    rows = []
    for mode in amplitudes:
        for curve in mode.records:
            if curve.amplitude.size:
                rows.append((mode.mode, curve.name, *_ends(curve)))
        if mode.model.amplitude.size:
            rows.append((mode.mode, "fitted vehicle", *_ends(mode.model)))
    headers = ("mode", "from", "mm", "f Hz", "±", "damping", "mm ", "f Hz ", "± ", "damping ")
    title = f"Modes of the body at the largest and the smallest amplitude, {load}"
    return Table(title, headers, tuple(rows), frozenset(headers[2:]), ("± ", "±", "damping ", "damping"), heads=2)


def _ends(curve: AmplitudeCurve) -> list[str]:
    cells = []
    for i in (int(curve.amplitude.argmax()), int(curve.amplitude.argmin())):
        cells += [
            significant_figures(1e3 * float(curve.amplitude[i]), 2),
            f"{curve.frequency[i]:.3f}",
            f"{curve.frequency_std[i]:.3f}",
            f"{curve.damping_ratio[i]:.3f}",
        ]
    return cells


def _percent(error: float | None) -> str:
    return "-" if error is None else f"{100 * error:.1f}"


def _autocorrelation(drop: DropValidation) -> str:
    if not drop.whiteness:
        return "-"
    name, residual = max(drop.whiteness.items(), key=lambda item: item[1].colour)
    if residual.colour < _SIGNIFICANT:
        return "none"
    return f"{name} {residual.correlation:.2f} at {1e3 * residual.lag:.0f} ms"

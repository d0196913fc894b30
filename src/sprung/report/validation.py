"""What a validation shows: a table of the drops and one of the modes for the terminal, and drawings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.pipeline import Validation
from sprung.recording import write_whole
from sprung.report.drawing import drawer, file_names
from sprung.report.layout import figures, hanging, table
from sprung.report.terminal import fault_list, verdict_view
from sprung.validation import DropValidation, ModeAmplitude, Trace

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
    parts: list[RenderableType] = [drop_table(result.vehicle.name, result.validation), Text()]
    if validation.amplitudes:
        parts += [amplitude_table(validation.load, validation.amplitudes), Text()]
    if result.faults:
        parts += [fault_list(result.faults), Text()]
    return Group(*parts, verdict_view(result))


def drop_table(vehicle: str, drops: Mapping[str, DropValidation]) -> RenderableType:
    """Show how well each drop is explained, and predicted by the others."""
    headers = ("drop", "vertical %", "pitch %", "roll %", "all %", "/noise", "predicted %", "/noise ", "least white")
    rows = [
        [
            name,
            *(_percent(error) for error in (drop.vertical, drop.pitch, drop.roll, drop.fitted)),
            f"{drop.residual:.2f}",
            _percent(drop.predicted),
            "-" if drop.predicted_residual is None else f"{drop.predicted_residual:.2f}",
            _least_white(drop),
        ]
        for name, drop in drops.items()
    ]
    title = f"{vehicle}: measured minus simulated as a part of the measured, of the body and of all channels"
    said = (
        "/noise: what is left, over the noise. Predicted: by the vehicle fitted to all other drops. Least white: in which "
        "channel what is left repeats itself, how much, and after what time."
    )
    shown = table(title, headers, rows, headers[1:-1], ("least white", "all %", "/noise"))
    return Group(shown, hanging("", said))


def amplitude_table(load: str, amplitudes: Sequence[ModeAmplitude]) -> RenderableType:
    """Show frequency and damping of each mode at its largest and its smallest amplitude."""
    rows = []
    for one in amplitudes:
        for trace in one.records:
            if trace.amplitude.size:
                rows.append([one.mode, trace.name, *_ends(trace)])
        if one.model.amplitude.size:
            rows.append([one.mode, "fitted vehicle", *_ends(one.model)])
    headers = ("mode", "from", "mm", "f Hz", "±", "damping", "mm ", "f Hz ", "± ", "damping ")
    title = f"Modes of the body against amplitude, {load}: at the largest, then at the smallest"
    return table(title, headers, rows, headers[2:], ("± ", "±", "damping ", "damping"))


def _ends(trace: Trace) -> list[str]:
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


def draw_validation(validation: Validation) -> dict[str, str]:
    """Draw a validation: each drop in coordinates of the body, and the modes of the body against amplitude.

    Parameters
    ----------
    validation
        From `sprung.validate`.

    Returns
    -------
    dict
        SVG text by file name; the same for the same recordings.

    Raises
    ------
    InputError
        If matplotlib, which draws, is not installed.
    """
    motion, amplitude = drawer("motion"), drawer("amplitude")
    result = validation.result
    drawn = {}
    if validation.amplitudes:
        title = f"{result.vehicle.name}, {validation.load}: modes of the body against amplitude"
        drawn["amplitude.svg"] = amplitude.svg_of_amplitudes(validation.amplitudes, title)
    names = file_names(["amplitude", *(one.name for one in validation.motions)])
    next(names)  # taken by the drawing above
    for name, one in zip(names, validation.motions, strict=True):
        drawn[name] = motion.svg_of_motion(one, result.validation[one.name])
    return drawn


def write_validation(validation: Validation, folder: Path, drawings: Mapping[str, str]) -> tuple[Path, ...]:
    """Write numbers, series and drawings into a folder, all of them or none.

    Parameters
    ----------
    validation
        From `sprung.validate`.
    folder
        Made if it does not exist. Files of the same names in it are replaced.
    drawings
        From `draw_validation`; none without matplotlib.

    Returns
    -------
    tuple of Path
        Every file.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    files = {name: text.encode() for name, text in drawings.items()} | validation.files()
    write_whole(folder, files)
    return tuple(folder / name for name in files)

"""Modes that were identified without a vehicle model, for the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.text import Text

from sprung.errors import Fault
from sprung.modal import StabilisationDiagram
from sprung.modal_survey import LoadModes
from sprung.report.terminal.layout import hanging_text, render_rows, render_table, significant_figures
from sprung.report.terminal.result import fault_list
from sprung.tables import with_std

_MARGIN = 5
"""Columns left of the chart, for the order."""


@dataclass(frozen=True)
class Chart:
    """A stabilisation diagram as wide as the terminal."""

    diagram: StabilisationDiagram

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Render it for a terminal: frequency to the right, on a logarithmic scale, the order upwards."""
        vibrating = [pole for pole in self.diagram.poles if pole.pole.imag > 0]
        if not vibrating:
            return
        frequencies = np.array([abs(pole.pole) for pole in vibrating]) / (2 * np.pi)
        low, high = float(frequencies.min()) / 1.05, float(frequencies.max()) * 1.05
        width = max(min(options.max_width, 100) - _MARGIN, 20)
        columns = (width * np.log(frequencies / low) / np.log(high / low)).astype(int)
        yield hanging_text(
            "", Text("Stabilisation diagram: * stable pole, . pole that the previous order does not have", style="bold")
        )
        for order in reversed(self.diagram.orders):
            line = [" "] * width
            for pole, column in zip(vibrating, columns.tolist(), strict=True):
                if pole.order == order and line[column] != "*":
                    line[column] = "*" if pole.stable else "."
            yield Text(f"{order:>3}  {''.join(line)}".rstrip(), no_wrap=True, overflow="ignore")
        left, right = f"{low:.3g} Hz", f"{high:.3g} Hz"
        yield Text(
            " " * _MARGIN + left + " " * (width - len(left) - len(right)) + right, no_wrap=True, overflow="ignore"
        )
        chosen = ", ".join(f"{abs(pole.pole) / (2 * np.pi):.4g}" for pole in self.diagram.chosen)
        yield hanging_text("", f"Stable: {chosen} Hz" if chosen else "No stable pole.")


def modes_view(found: Mapping[str, LoadModes], faults: Sequence[Fault] = ()) -> RenderableType:
    """Return the view of the modes of every load, with frequencies by FFT and the faults of the recordings.

    Parameters
    ----------
    found
        By load.
    faults
        Of the recordings.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    parts: list[RenderableType] = []
    for load, modes in found.items():
        parts += [render_table(modes.table(load)), Text(), _peaks(load, modes), Text()]
        if any(mode.amplitudes for mode in modes):
            parts += [_amplitudes(load, modes), Text()]
        if modes.diagram is not None:
            parts += [Chart(modes.diagram), Text()]
        if modes.unresolved:
            parts += [
                Text("Not resolved", style="bold"),
                *(hanging_text("  - ", text) for text in modes.unresolved),
                Text(),
            ]
    if faults:
        parts += [fault_list(faults), Text()]
    return Group(*parts[:-1])


def _peaks(load: str, modes: LoadModes) -> RenderableType:
    """Return damped frequencies by FFT beside the identified ones, as in Table 3 of the paper."""
    headers = ("mode", "FFT f_d Hz", "f_d Hz", "difference %")
    rows = [
        (
            mode.name,
            "-" if mode.fft_frequency is None else f"{mode.fft_frequency:.3f}",
            "-" if mode.status == "unresolved" else f"{mode.damped_frequency:.3f}",
            "-" if mode.fft_difference is None else f"{mode.fft_difference:+.2f}",
        )
        for mode in modes
    ]
    return render_rows(f"Damped frequency by FFT, {load}", headers, rows, headers[1:])


def _amplitudes(load: str, modes: LoadModes) -> RenderableType:
    """Return frequency and damping at the largest and the smallest amplitude, and the trend between them."""
    headers = ("mode", "m/s²", "f_n Hz", "damping", "%/decade", "±")
    rows = []
    for mode in modes:
        if not mode.amplitudes:
            continue
        trend = ("-", "-") if mode.frequency_trend is None else with_std(*mode.frequency_trend)
        for (amplitude, frequency, frequency_std, ratio, ratio_std), change in zip(
            (mode.amplitudes[0], mode.amplitudes[-1]), (trend, ("", "")), strict=True
        ):
            name = mode.name if change is trend else ""
            values = with_std(frequency, frequency_std)[0], with_std(ratio, ratio_std)[0]
            rows.append((name, significant_figures(amplitude, 2), *values, *change))
    return render_rows(
        f"Frequency and damping at the largest and the smallest amplitude, {load}", headers, rows, headers[1:], ("±",)
    )

"""What the terminal shows of modes that were found without a vehicle model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.text import Text

from sprung.errors import Fault
from sprung.modal import StabilisationDiagram
from sprung.modal_survey import LoadModes
from sprung.report.terminal.layout import figures, hanging, laid_out, table
from sprung.report.terminal.result import fault_list
from sprung.tables import with_std

_MARGIN = 5
"""Columns for the order beside the chart."""


@dataclass(frozen=True)
class Chart:
    """A stabilisation diagram as wide as the terminal."""

    diagram: StabilisationDiagram

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Render it for a terminal: frequency to the right, on a logarithmic scale, the order upwards."""
        vibrating = [one for one in self.diagram.poles if one.pole.imag > 0]
        if not vibrating:
            return
        frequencies = np.array([abs(one.pole) for one in vibrating]) / (2 * np.pi)
        low, high = float(frequencies.min()) / 1.05, float(frequencies.max()) * 1.05
        width = max(min(options.max_width, 100) - _MARGIN, 20)
        columns = (width * np.log(frequencies / low) / np.log(high / low)).astype(int)
        yield hanging("", Text("Stabilisation: * there at the order before too, . not", style="bold"))
        for order in reversed(self.diagram.orders):
            line = [" "] * width
            for one, column in zip(vibrating, columns.tolist(), strict=True):
                if one.order == order and line[column] != "*":
                    line[column] = "*" if one.stable else "."
            yield Text(f"{order:>3}  {''.join(line)}".rstrip(), no_wrap=True, overflow="ignore")
        left, right = f"{low:.3g} Hz", f"{high:.3g} Hz"
        yield Text(
            " " * _MARGIN + left + " " * (width - len(left) - len(right)) + right, no_wrap=True, overflow="ignore"
        )
        chosen = ", ".join(f"{abs(one.pole) / (2 * np.pi):.4g}" for one in self.diagram.chosen)
        yield hanging("", f"Stays: {chosen} Hz" if chosen else "Nothing stays.")


def modes_view(found: Mapping[str, LoadModes], faults: Sequence[Fault] = ()) -> RenderableType:
    """Show the modes of every load, beside what a Fourier transform tells, and what is wrong with the recordings.

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
        parts += [laid_out(modes.table(load)), Text(), _peaks(load, modes), Text()]
        if any(mode.amplitudes for mode in modes):
            parts += [_amplitudes(load, modes), Text()]
        if modes.diagram is not None:
            parts += [Chart(modes.diagram), Text()]
        if modes.unresolved:
            parts += [Text("Not resolved", style="bold"), *(hanging("  - ", said) for said in modes.unresolved), Text()]
    if faults:
        parts += [fault_list(faults), Text()]
    return Group(*parts[:-1])


def _peaks(load: str, modes: LoadModes) -> RenderableType:
    """Show damped frequencies by FFT beside the identified ones, as Table 3 of the paper does."""
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
    return table(f"Damped frequency by FFT, {load}", headers, rows, headers[1:])


def _amplitudes(load: str, modes: LoadModes) -> RenderableType:
    """Show frequency and damping at the largest and the smallest amplitude that tell them, and how they change between."""
    headers = ("mode", "m/s²", "f_n Hz", "damping", "%/decade", "±")
    rows = []
    for mode in modes:
        if not mode.amplitudes:
            continue
        shift = ("-", "-") if mode.frequency_trend is None else with_std(*mode.frequency_trend)
        for (amplitude, frequency, unsure, ratio, ratio_unsure), change in zip(
            (mode.amplitudes[0], mode.amplitudes[-1]), (shift, ("", "")), strict=True
        ):
            name = mode.name if change is shift else ""
            told = with_std(frequency, unsure)[0], with_std(ratio, ratio_unsure)[0]
            rows.append((name, figures(amplitude, 2), *told, *change))
    return table(f"Against amplitude, {load}: at the largest, at the smallest", headers, rows, headers[1:], ("±",))

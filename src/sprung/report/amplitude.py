"""Frequency and damping of the body's modes against amplitude: from the records alone, and from the fitted vehicle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator
from numpy.typing import NDArray

from sprung.report.ink import AMBER, BLUE, FAINT, ORANGE, QUIET, SIGNAL, TEXT, svg_text
from sprung.validation import ModeAmplitude

Real = NDArray[np.float64]

_WIDTH, _HEIGHT = 10.5, 5.4
"""inches."""

_MARKERS = ("o", "s")

_LEAST_SPAN = 0.1
"""Part of a frequency that its axis spans at least: what is flat shall look flat."""


def svg_of_amplitudes(amplitudes: Sequence[ModeAmplitude], title: str) -> str:
    """Draw all modes beside each other, the same for the same input.

    Parameters
    ----------
    amplitudes
        At least one mode.
    title
        Whose they are.
    """
    return svg_text(lambda: figure_of_amplitudes(amplitudes, title), title)


def figure_of_amplitudes(amplitudes: Sequence[ModeAmplitude], title: str) -> Figure:
    """Draw all modes into a figure of their own: frequencies above, damping ratios below."""
    figure = Figure(figsize=(_WIDTH, _HEIGHT))
    figure.text(0.012, 0.985, title, va="top", fontsize=11, fontweight="bold", color=TEXT, parse_math=False)
    said = (
        "symbols: a damped sinusoid fitted to one and a half periods of a record at a time, with two standard errors; thin "
        "lines: the same of the simulated drops;\nthick line: of a free decay of the fitted vehicle in this mode alone; "
        "dashed: its linear part"
    )
    figure.text(0.012, 0.943, said, va="top", color=QUIET)
    grid = figure.add_gridspec(
        2, len(amplitudes), left=0.065, right=0.985, top=0.83, bottom=0.095, hspace=0.09, wspace=0.2
    )
    for column, one in enumerate(amplitudes):
        above = figure.add_subplot(grid[0, column])
        below = figure.add_subplot(grid[1, column], sharex=above)
        _mode(above, below, one)
        if column == 0:
            above.set_ylabel("frequency, Hz", color=TEXT)
            below.set_ylabel("damping ratio, %", color=TEXT)
        below.set_xlabel("amplitude at the sensor that moves most, mm", color=QUIET)
    return figure


def _mode(above: Axes, below: Axes, one: ModeAmplitude) -> None:
    above.set_title(one.mode, fontsize=9, color=TEXT, loc="left")
    largest = max((float(trace.amplitude.max(initial=0.0)) for trace in one.records), default=0.0)
    shown = one.model.amplitude <= 1.3 * largest
    model = 1e3 * one.model.amplitude[shown]
    above.plot(model, one.model.frequency[shown], color=BLUE, lw=1.4, label="fitted vehicle, this mode alone", zorder=2)
    below.plot(model, 100 * one.model.damping_ratio[shown], color=BLUE, lw=1.4, zorder=2)
    for trace, drop, colour, marker in zip(one.records, one.simulated, (ORANGE, AMBER), _MARKERS, strict=False):
        above.plot(1e3 * drop.amplitude, drop.frequency, color=colour, lw=0.7, zorder=2)
        below.plot(1e3 * drop.amplitude, 100 * drop.damping_ratio, color=colour, lw=0.7, zorder=2)
        look: dict[str, Any] = {
            "color": colour,
            "marker": marker,
            "ms": 3.5,
            "lw": 0,
            "elinewidth": 0.8,
            "label": trace.name,
        }
        amplitude = 1e3 * trace.amplitude
        above.errorbar(amplitude, trace.frequency, 2 * trace.frequency_std, zorder=3, **look)
        below.errorbar(amplitude, 100 * trace.damping_ratio, 200 * trace.damping_ratio_std, zorder=3, **look)
    for axes, level in ((above, one.frequency), (below, 100 * one.damping_ratio)):
        axes.axhline(level, color=SIGNAL, lw=0.8, ls=(0, (4, 3)), zorder=1)
        axes.tick_params(length=2, color=FAINT, labelsize=7, labelcolor=QUIET)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        for side in ("left", "bottom"):
            axes.spines[side].set(color=FAINT, linewidth=0.8)
    above.set_xscale("log")
    # The motion dies from left to right, as it does in a recording.
    above.invert_xaxis()
    above.xaxis.set_major_locator(LogLocator(10, subs=(1, 2, 5)))
    above.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    above.xaxis.set_minor_locator(NullLocator())
    above.xaxis.set_minor_formatter(NullFormatter())
    above.tick_params(labelbottom=False)
    _widen(above, _LEAST_SPAN * one.frequency)
    _widen(below, 10.0)
    # Frequencies rise to the right if at all: what names the curves stands above them on the left.
    low, high = above.get_ylim()
    above.set_ylim(low, high + 0.3 * (high - low))
    above.legend(frameon=False, fontsize=7, loc="upper left", borderaxespad=0.2)


def _widen(axes: Axes, least: float) -> None:
    low, high = axes.get_ylim()
    more = max(least - (high - low), 0.0) / 2
    axes.set_ylim(low - more, high + more)

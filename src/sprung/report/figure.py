"""One drop drawn: its channels in lanes one above the other, the whole recording beside its release and landing.

It draws with matplotlib, so `sprung.report.draw_check` loads it only when somebody wants a drawing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from sprung.pipeline import DropReport, Recorded
from sprung.report.ink import AMBER, BLUE, FAINT, ORANGE, QUIET, SIGNAL, TEXT, svg_text
from sprung.report.lanes import Lane, lanes_of, plain, thinned

Real = NDArray[np.float64]

_DECAY, _RELEASE, _LANDING, _FAULT = "#e3eef6", AMBER, BLUE, ORANGE

_WIDTH, _LANE, _ABOVE, _BELOW = 10.5, 0.62, 1.35, 0.5
"""inches: of the drawing, of each lane, of what stands above and below the lanes."""

_LEFT = 2.6
"""inches that the names of channels may take."""

_BINS = 800
"""Points across a panel beyond which nobody sees more of them."""

_ROW = 0.17
"""inches from one line of labels to the next."""


def svg_of(drop: DropReport, recorded: Recorded) -> str:
    """Draw one drop.

    Parameters
    ----------
    drop
        What is said of it.
    recorded
        Its whole recording.

    Returns
    -------
    str
        The same for the same input.
    """
    return svg_text(lambda: figure_of(drop, recorded), f"{drop.file}: {drop.kind}, {drop.load}")


def figure_of(drop: DropReport, recorded: Recorded) -> Figure:
    """Draw one drop into a figure of its own."""
    lanes = lanes_of(drop, recorded)
    height = _ABOVE + _LANE * len(lanes) + _BELOW
    figure = Figure(figsize=(_WIDTH, height))
    _head(figure, drop, height)
    time = recorded.time
    near = _near(drop, time)
    left = min(0.45 + 0.07 * max(len(lane.name) for lane in lanes), _LEFT) / _WIDTH
    inside = (_BELOW / height, _LANE * len(lanes) / height)
    whole = figure.add_axes((left, inside[0], (0.9 if near is None else 0.5) - left, inside[1]))
    _panel(whole, lanes, time, (float(time[0]), float(time[-1])))
    _shade(whole, drop)
    _names(whole, lanes)
    whole.annotate("m/s²", (0, 1), (-3, 3), "axes fraction", "offset points", ha="right", fontsize=6.5, color=QUIET)
    whole.set_xlabel("time on the recording's clock, s", color=QUIET)
    if near is not None:
        close = figure.add_axes((0.525, inside[0], 0.375, inside[1]))
        _panel(close, lanes, time, near)
        _shade(close, drop)
        _events(close, drop)
        close.tick_params(left=False, labelleft=False)
        close.set_xlabel("release and landing, s", color=QUIET)
        # A bar on the upper edge shows which part is enlarged.
        whole.plot(near, (0.5, 0.5), color=QUIET, lw=2.5, solid_capstyle="butt", clip_on=False)
        close.plot(near, (0.5, 0.5), color=QUIET, lw=2.5, solid_capstyle="butt", clip_on=False)
    _notes(whole if near is None else close, lanes)
    return figure


def _panel(axes: Axes, lanes: Sequence[Lane], time: Real, limits: tuple[float, float]) -> None:
    """Draw the lanes, the first on top, each in a strip of height 1."""
    inside = np.flatnonzero((time >= limits[0]) & (time <= limits[1]))
    part = slice(max(int(inside[0]) - 1, 0), int(inside[-1]) + 2)
    ticks: list[tuple[float, str]] = []
    for number, lane in enumerate(lanes):
        shown = thinned(lane.values[part], _BINS)
        axes.plot(
            time[part][shown],
            lane.height(lane.values[part][shown]) - number,
            color=SIGNAL if lane.used else FAINT,
            lw=0.8,
            solid_joinstyle="round",
        )
        marked = lane.marked[(lane.marked >= part.start) & (lane.marked < part.stop)]
        marked = marked[:: max(1, marked.size // _BINS)]
        if marked.size:
            axes.plot(time[marked], lane.height(lane.values[marked]) - number, ".", color=_FAULT, ms=4, mew=0)
        ticks += [(float(lane.height(value)) - number, label) for value, label in lane.ticks]
        if number:
            axes.axhline(0.5 - number, color="#e6e9eb", lw=0.6)
    axes.set(xlim=limits, ylim=(0.5 - len(lanes), 0.5))
    axes.set_yticks([place for place, _ in ticks], [label for _, label in ticks])
    axes.tick_params(length=2, color=FAINT, labelsize=6.5, labelcolor=QUIET, pad=2)
    axes.xaxis.set_tick_params(labelsize=7.5)
    for side in ("left", "right"):
        axes.spines[side].set_visible(False)
    for side in ("top", "bottom"):
        axes.spines[side].set(color=FAINT, linewidth=0.8)


def _near(drop: DropReport, time: Real) -> tuple[float, float] | None:
    """Give the part around release and landing that is worth enlarging; None where neither is known."""
    moments = [moment for moment in (drop.release, drop.landing, drop.last_lift_off, drop.start) if moment is not None]
    if drop.release is None or not moments:
        return None
    length = max(max(moments) - drop.release, 0.1)
    return max(drop.release - 0.3 * length, float(time[0])), min(max(moments) + 1.2 * length, float(time[-1]))


def _shade(axes: Axes, drop: DropReport) -> None:
    if drop.start is not None and drop.end is not None:
        axes.axvspan(drop.start, drop.end, color=_DECAY, lw=0, zorder=0)


def _names(axes: Axes, lanes: Sequence[Lane]) -> None:
    for number, lane in enumerate(lanes):
        axes.annotate(
            lane.name,
            (0, -number),
            (-26, 0),
            xycoords=("axes fraction", "data"),
            textcoords="offset points",
            ha="right",
            va="center",
            color=TEXT if lane.used else QUIET,
        ).set_parse_math(False)


def _notes(axes: Axes, lanes: Sequence[Lane]) -> None:
    for number, lane in enumerate(lanes):
        lines = [*((text, QUIET) for text in lane.notes), *((text, _FAULT) for text in lane.wrong)]
        for row, (text, colour) in enumerate(lines):
            axes.annotate(
                text,
                (1, -number),
                (6, 10.5 * ((len(lines) - 1) / 2 - row)),
                xycoords=("axes fraction", "data"),
                textcoords="offset points",
                va="center",
                fontsize=7,
                color=colour,
            )


def _events(axes: Axes, drop: DropReport) -> None:
    """Draw the moments as lines through all lanes, each with its label on a line of its own."""
    moments = [
        ("release", drop.release, _RELEASE, (0, (4, 2))),
        ("landing", drop.landing, _LANDING, (0, (1, 1.2))),
        ("decay", drop.start, _LANDING, "solid"),
    ]
    shown = [(name, moment, colour, dashes) for name, moment, colour, dashes in moments if moment is not None]
    for row, (name, moment, colour, dashes) in enumerate(shown):
        axes.axvline(moment, color=colour, lw=0.9, ls=dashes, zorder=3)
        above = 72 * _ROW * (len(shown) - row)
        axes.annotate(
            f"{name} {moment:.3f} s" if name != "decay" else f"decay from {moment:.3f} s",
            (moment, 1),
            (3, above - 9),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            color=colour,
            fontsize=7.5,
        )
        axes.annotate(
            "",
            (moment, 1),
            (0, above),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.9, "ls": dashes, "shrinkA": 0, "shrinkB": 0},
        )


def _head(figure: Figure, drop: DropReport, height: float) -> None:
    def line(row: float, text: str, **look: Any) -> None:
        figure.text(0.012, 1 - (0.12 + row * 0.2) / height, plain(text), va="top", parse_math=False, **look)

    line(0, drop.file, fontsize=11, fontweight="bold", color=TEXT)
    wheels = "" if drop.kind == " ".join(drop.wheels) else f" ({', '.join(drop.wheels)})"
    rate = "" if drop.rate is None else f", {drop.rate:.6g} samples per second"
    line(1.25, f"{drop.kind}{wheels}, load {drop.load}{rate}", color=TEXT)
    if drop.start is None or drop.end is None:
        line(2.25, f"left out: {', '.join(drop.faults)}", color=_FAULT)
    else:
        line(2.25, f"decay from {drop.start:.3f} s: {drop.why_start}", color=QUIET)
        line(3.15, f"to {drop.end:.3f} s: {drop.why_end}", color=QUIET)
    if drop.contradicted:
        line(4.05, f"the release shows {', '.join(drop.wheels_seen or ()) or 'no wheel'} to have fallen", color=_FAULT)

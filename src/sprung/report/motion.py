"""One drop in the coordinates of the body: measured against simulated as in figures 7 to 9 of the paper, what is left below."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from sprung.report.ink import BLUE, FAINT, ORANGE, QUIET, TEXT, svg_text
from sprung.report.lanes import thinned
from sprung.validation import MOTIONS, BodyMotion, DropValidation

Real = NDArray[np.float64]

_WIDTH, _HEIGHT = 10.5, 7.2
"""inches."""

_UNITS = ("m/s²", "rad/s²", "rad/s²")

_BINS = 800
"""Points across a panel beyond which nobody sees more of them."""


def svg_of_motion(motion: BodyMotion, drop: DropValidation) -> str:
    """Draw one drop, the same for the same input.

    Parameters
    ----------
    motion
        Measured and simulated.
    drop
        What is said of it.
    """
    return svg_text(lambda: figure_of_motion(motion, drop), f"{motion.name}: measured and simulated")


def figure_of_motion(motion: BodyMotion, drop: DropValidation) -> Figure:
    """Draw one drop into a figure of its own."""
    figure = Figure(figsize=(_WIDTH, _HEIGHT))
    figure.text(0.012, 0.985, motion.name, va="top", fontsize=11, fontweight="bold", color=TEXT, parse_math=False)
    figure.text(0.012, 0.95, _said(drop), va="top", color=QUIET, parse_math=False)
    grid = figure.add_gridspec(
        6, 1, height_ratios=[3, 1] * 3, left=0.085, right=0.985, top=0.90, bottom=0.07, hspace=0.12
    )
    errors = motion.errors
    first: Axes | None = None
    for i, name in enumerate(MOTIONS):
        above = figure.add_subplot(grid[2 * i], sharex=first)
        below = figure.add_subplot(grid[2 * i + 1], sharex=above)
        first = first or above
        _lines(above, motion, i)
        above.set_ylabel(f"{name}, {_UNITS[i]}", color=TEXT)
        if np.isnan(motion.measured[i]).all():
            said = "not told by the sensors in use"
        elif np.isnan(errors[i]):
            said = "no motion beyond the noise"
        else:
            said = f"error {100 * errors[i]:.1f} %"
        above.annotate(said, (1, 1), (-4, -4), "axes fraction", "offset points", ha="right", va="top", color=QUIET)
        left = motion.measured[i] - motion.simulated[i]
        shown = thinned(left, _BINS)
        below.plot(motion.time[shown], left[shown], color=ORANGE, lw=0.6)
        below.set_ylabel("left", color=QUIET, fontsize=7)
        for axes in (above, below):
            _plain(axes, last=axes is below and i == len(MOTIONS) - 1)
        if i == 0:
            above.legend(loc="upper center", ncols=2, frameon=False, fontsize=7.5)
    below.set_xlabel("time on the recording's clock, s", color=QUIET)
    below.set_xlim(float(motion.time[0]), float(motion.time[-1]))
    return figure


def _lines(axes: Axes, motion: BodyMotion, which: int) -> None:
    looks: tuple[dict[str, Any], ...] = (
        {"color": FAINT, "lw": 2.2, "label": "measured"},
        {"color": BLUE, "lw": 0.9, "label": "simulated"},
    )
    for values, look in zip((motion.measured[which], motion.simulated[which]), looks, strict=True):
        shown = thinned(values, _BINS)
        axes.plot(motion.time[shown], values[shown], solid_joinstyle="round", **look)


def _plain(axes: Axes, last: bool) -> None:
    axes.axhline(0, color="#e6e9eb", lw=0.6, zorder=0)
    axes.tick_params(length=2, color=FAINT, labelsize=7, labelcolor=QUIET, labelbottom=last)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set(color=FAINT, linewidth=0.8)


def _said(drop: DropValidation) -> str:
    text = f"all channels: error {100 * drop.fitted:.1f} % of the signal, {drop.residual:.2f} times the noise"
    if drop.predicted is not None and drop.predicted_residual is not None:
        text += f"; predicted by the other drops: {100 * drop.predicted:.1f} %, {drop.predicted_residual:.2f} times"
    return text

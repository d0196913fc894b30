"""One drop in the coordinates of the body: measured against simulated as in figures 7 to 9 of the paper, the residual below."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.assessment import MOTIONS, DropValidation
from sprung.report.drawing.axis import Axis, room
from sprung.report.drawing.picture import Curve, Panel, Picture, Rule
from sprung.results import Series

Real = NDArray[np.float64]

_UNITS = ("m/s²", "rad/s²", "rad/s²")


def motion_picture(name: str, series: Series, drop: DropValidation) -> Picture:
    """Show one drop in the coordinates of the body.

    Parameters
    ----------
    name
        The drop's.
    series
        As it was fitted.
    drop
        What is said of it.

    Returns
    -------
    Picture
    """
    measured, simulated = series.body_measured.astype(float), series.body_simulated.astype(float)
    panels: list[Panel] = []
    for i, motion in enumerate(MOTIONS):
        note = "not measured by the sensors in use" if np.isnan(measured[i]).all() else _note(motion, drop)
        panels += compared(motion, _UNITS[i], series.time, measured[i], simulated[i], note)
    x = Axis("time on the recording's clock, s", float(series.time[0]), float(series.time[-1]))
    told = "Vertical, pitch and roll acceleration of the body, measured and simulated, and below each the residual."
    return Picture(name, x, tuple(panels), told, zoomable=True)


def _note(motion: str, drop: DropValidation) -> str:
    """Say how far the fitted vehicle is from a motion, or why no error is given."""
    error: float | None = getattr(drop, motion)
    if error is not None:
        return f"error {100 * error:.1f} %"
    ratio = drop.over_noise.get(motion)
    return (
        "no motion beyond the noise" if ratio is None else f"{ratio:.1f} times the noise, too small for an error in %"
    )


def compared(channel: str, unit: str, time: Real, measured: Real, simulated: Real, note: str) -> tuple[Panel, Panel]:
    """Show two curves, and their difference, the residual, below them.

    Parameters
    ----------
    channel, unit
        What is shown, for the axes.
    time
        s, shape (time,).
    measured, simulated
        Shape (time,).
    note
        Written into the upper panel.
    """
    left = measured - simulated
    above = Panel(
        Axis(f"{channel}, {unit}", *room(measured, simulated)),
        (
            Rule(0.0, "quiet", lying=True),
            Curve(time, measured, "measured", "measured", 2.4),
            Curve(time, simulated, "simulated", "simulated"),
        ),
        note=note,
        channel=channel,
    )
    low, high = room(left, np.zeros(1))
    ticks = ((0.0, "0"), (float(f"{0.8 * high:.1g}"), f"{0.8 * high:.1g}")) if high > 0 else ()
    below = Panel(
        Axis(f"residual, {unit}", low, high, ticks=ticks),
        (Rule(0.0, "quiet", lying=True), Curve(time, left, "left", "residual", 0.8)),
        height=0.48,
        channel=channel,
    )
    return above, below

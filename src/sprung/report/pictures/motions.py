"""Motion of the body in one drop: measured and simulated as in figures 7 to 9 of the paper, the residual below."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.assessment import MOTIONS, DropValidation, motions_of
from sprung.report.drawing.axis import Axis, axis_limits
from sprung.report.drawing.picture import Curve, Panel, Picture, Rule
from sprung.results import Series
from sprung.vehicle import Layout

Real = NDArray[np.float64]

_UNITS = ("m/s²", "rad/s²", "rad/s²")


def motion_picture(name: str, series: Series, drop: DropValidation, layout: Layout) -> Picture:
    """Return the picture of the body's motion in one drop.

    Parameters
    ----------
    name
        The drop's.
    series
        As it was fitted.
    drop
        Its validation.
    layout
        Of the vehicle: a motion that it does not have is left out.

    Returns
    -------
    Picture
    """
    measured, simulated = series.body_measured.astype(float), series.body_simulated.astype(float)
    panels: list[Panel] = []
    motions = motions_of(layout)
    for motion in motions:
        i = MOTIONS.index(motion)
        note = "not measured by the sensors in use" if np.isnan(measured[i]).all() else _note(motion, drop)
        panels += comparison_panels(motion, _UNITS[i], series.time, measured[i], simulated[i], note)
    x = Axis("time on the recording's clock, s", float(series.time[0]), float(series.time[-1]))
    description = f"{motions_text(motions)} of the body, measured and simulated, and below each the residual."
    return Picture(name, x, tuple(panels), description, zoomable=True)


def motions_text(motions: Sequence[str]) -> str:
    """Return the accelerations of the body in words, at the beginning of a sentence.

    Examples
    --------
    >>> motions_text(("vertical", "pitch", "roll")), motions_text(("vertical",))
    ('Vertical, pitch and roll acceleration', 'Vertical acceleration')
    """
    *others, last = motions
    return f"{' and '.join(part for part in (', '.join(others), last) if part)} acceleration".capitalize()


def _note(motion: str, drop: DropValidation) -> str:
    """Return the error of a motion, or why no error is given."""
    error: float | None = getattr(drop, motion)
    if error is not None:
        return f"error {100 * error:.1f} %"
    ratio = drop.over_noise.get(motion)
    return (
        "no motion beyond the noise" if ratio is None else f"{ratio:.1f} times the noise, too small for an error in %"
    )


def comparison_panels(
    channel: str, unit: str, time: Real, measured: Real, simulated: Real, note: str
) -> tuple[Panel, Panel]:
    """Return a panel with two curves, and one with their difference below.

    Parameters
    ----------
    channel, unit
        Labels of the axes.
    time
        s, shape (time,).
    measured, simulated
        Shape (time,).
    note
        Text in the upper panel.
    """
    residual = measured - simulated
    above = Panel(
        Axis(f"{channel}, {unit}", *axis_limits(measured, simulated)),
        (
            Rule(0.0, "reference", horizontal=True),
            Curve(time, measured, "measured", "measured", 2.4),
            Curve(time, simulated, "simulated", "simulated"),
        ),
        note=note,
        channel=channel,
    )
    low, high = axis_limits(residual, np.zeros(1))
    ticks = ((0.0, "0"), (float(f"{0.8 * high:.1g}"), f"{0.8 * high:.1g}")) if high > 0 else ()
    below = Panel(
        Axis(f"residual, {unit}", low, high, ticks=ticks),
        (Rule(0.0, "reference", horizontal=True), Curve(time, residual, "residual", "residual", 0.8)),
        height=0.48,
        channel=channel,
    )
    return above, below

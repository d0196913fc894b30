"""Figures of one drop."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from matplotlib.axes import Axes

from sprung.checking import Check
from sprung.errors import InputError, Problem
from sprung.plot.drawing import check_name, draw
from sprung.report import channels_picture, landing_picture, motion_picture, recording_picture
from sprung.results import Result
from sprung.vehicle import layout_of


def fit(
    result: Result, drop: str, channels: Sequence[str] | None = None, *, axes: Iterable[Axes] | None = None
) -> tuple[Axes, ...]:
    """Draw measured and simulated motion in one drop, and below each the residual.

    Parameters
    ----------
    result
        From `sprung.identify` or `sprung.load`.
    drop
        Its name, such as ``empty_bounce``.
    channels
        Names of channels to draw, m/s². Unless given, the body's vertical (m/s²), pitch and roll acceleration (rad/s²), as far
        as the vehicle has these motions: the paper's figures 7 to 9.
    axes
        Two for each quantity, the second for the residual; a new figure unless given.

    Returns
    -------
    tuple of Axes
        Those with the figure.

    Raises
    ------
    InputError
        If there is no such drop or channel, or the list of channels is empty.
    """
    series = result.series[check_name(drop, list(result.series), "drop")]
    if channels is not None:
        if not channels:
            do = f"Name some of {', '.join(series.channels)}; None draws the motion of the body."
            raise InputError([Problem("channels", "none", "at least one channel", do)])
        names = [check_name(name, series.channels, "channel") for name in channels]
        return draw(channels_picture(drop, series, names, result.setup.units), axes)
    return draw(motion_picture(drop, series, result.validation[drop], layout_of(result.parameters)), axes)


def recording(
    of: Result | Check, drop: str, *, near: bool = False, axes: Iterable[Axes] | None = None
) -> tuple[Axes, ...]:
    """Draw a recording, one panel for each channel, with release, landing, free decay and faulty samples.

    Parameters
    ----------
    of
        From `sprung.identify`, `sprung.load` or `sprung.check`.
    drop
        Its name, such as ``empty_bounce``.
    near
        Whether to draw only the time around release and landing.
    axes
        One for each channel; a new figure unless given.

    Returns
    -------
    tuple of Axes
        Those with the figure.

    Raises
    ------
    InputError
        If there is no such drop, the result has no recording of it, or ``near`` is set and no release was detected.
    """
    recordings = (
        of.recordings
        if isinstance(of, Result)
        else {one.name: recorded for one, recorded in zip(of.drops, of.recorded, strict=True)}
    )
    check_name(drop, list(recordings), "drop")
    report = next(report for report in of.drops if report.name == drop)
    picture = landing_picture(report, recordings[drop]) if near else recording_picture(report, recordings[drop])
    if picture is None:
        do = "Draw the whole recording (near=False)."
        raise InputError([Problem(f"drop {drop}", "no release", "a recording with a detected release", do)])
    return draw(picture, axes)

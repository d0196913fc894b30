"""Pictures of one drop."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from matplotlib.axes import Axes

from sprung.checking import Check
from sprung.errors import InputError, Problem
from sprung.plot.drawing import chosen, drawn
from sprung.report import channels_picture, motion_picture, near_picture, whole_picture
from sprung.results import Result


def fit(
    result: Result, drop: str, channels: Sequence[str] | None = None, *, axes: Iterable[Axes] | None = None
) -> tuple[Axes, ...]:
    """Draw measured against simulated for one drop, and below each curve what is left of it.

    Parameters
    ----------
    result
        From `sprung.identify` or `sprung.load`.
    drop
        Its name, such as ``empty_bounce``.
    channels
        Names of channels to draw, m/s². Unless given, the body's vertical (m/s²), pitch and roll acceleration (rad/s²): the
        paper's figures 7 to 9.
    axes
        Two for each curve, the second for what is left; a figure of its own unless given.

    Returns
    -------
    tuple of Axes
        Those that were drawn into.

    Raises
    ------
    InputError
        If there is no such drop or channel.
    """
    series = result.series[chosen(drop, list(result.series), "drop")]
    if channels is not None:
        names = [chosen(name, series.channels, "channel") for name in channels]
        return drawn(channels_picture(drop, series, names), axes)
    return drawn(motion_picture(drop, series, result.validation[drop]), axes)


def recording(
    of: Result | Check, drop: str, *, near: bool = False, axes: Iterable[Axes] | None = None
) -> tuple[Axes, ...]:
    """Draw a whole recording, one panel for each channel: release, landing, the decay that is used, what is wrong.

    Parameters
    ----------
    of
        From `sprung.identify`, `sprung.load` or `sprung.check`.
    drop
        Its name, such as ``empty_bounce``.
    near
        Whether to draw only what is around release and landing.
    axes
        One for each channel; a figure of its own unless given.

    Returns
    -------
    tuple of Axes
        Those that were drawn into.

    Raises
    ------
    InputError
        If there is no such drop, its recording is not held, or its release is asked for and was not found.
    """
    recordings = (
        of.recordings
        if isinstance(of, Result)
        else {one.name: recorded for one, recorded in zip(of.drops, of.recorded, strict=True)}
    )
    chosen(drop, list(recordings), "drop")
    report = next(one for one in of.drops if one.name == drop)
    picture = near_picture(report, recordings[drop]) if near else whole_picture(report, recordings[drop])
    if picture is None:
        do = "Draw the whole recording instead."
        raise InputError([Problem(f"drop {drop}", "no release", "a recording that shows its release", do)])
    return drawn(picture, axes)

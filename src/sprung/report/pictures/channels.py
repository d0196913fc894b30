"""Channels of one drop: measured and fitted, the residual below."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sprung.report.drawing.axis import Axis
from sprung.report.drawing.picture import Panel, Picture
from sprung.report.pictures.motions import comparison_panels
from sprung.results import Series


def channels_picture(name: str, series: Series, channels: Sequence[str], units: Mapping[str, str]) -> Picture:
    """Return the picture of some channels of one drop.

    Parameters
    ----------
    name
        The drop's.
    series
        As it was fitted.
    channels
        Names of channels, each of which the drop has.
    units
        Of the readings, by channel.

    Returns
    -------
    Picture
        Two panels for each channel, in its unit over s.
    """
    panels: list[Panel] = []
    for channel in channels:
        i = series.channels.index(channel)
        note = "left out" if np.isnan(series.measured[i]).all() else ""
        panels += comparison_panels(channel, units[channel], series.time, series.measured[i], series.fitted[i], note)
    x = Axis("time on the recording's clock, s", float(series.time[0]), float(series.time[-1]))
    return Picture(f"{name}: measured and fitted", x, tuple(panels))

"""Spectra of the decays of one load: measured, as fitted, and where the identified modes lie."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import ModeEstimate
from sprung.report.drawing.axis import Axis
from sprung.report.drawing.picture import Curve, Panel, Picture, Rule, labelled_together
from sprung.report.pictures.decays import LoadDecays

Real = NDArray[np.float64]

_LOW, _BEYOND = 0.3, 2.5
"""Hz at which the axis begins, and how far it goes on above the highest mode."""

_FINER = 4
"""Times as many frequencies as samples tell apart: a curve through fewer looks broken."""

_FLOOR = 3e-4
"""Part of the largest value that is shown."""


def spectra_picture(decays: LoadDecays, modes: Sequence[ModeEstimate]) -> Picture:
    """Show the spectra of one load.

    Parameters
    ----------
    decays
        Of that load.
    modes
        Identified with it; those whose frequency is not determined are left out.

    Returns
    -------
    Picture
        m/s² per √Hz over Hz: a panel for the body's sensors, and one for those at the wheels.
    """
    told = [mode for mode in modes if mode.frequency_std is not None and mode.pole[1] > 0]
    rate = decays.rate
    length = _FINER * max(record.shape[1] for record in decays.measured)
    frequency = np.asarray(np.fft.rfftfreq(length, 1 / rate), dtype=float)
    powers = [_power(records, length) for records in (decays.measured, decays.fitted)]
    highest = max((mode.damped_frequency for mode in told), default=20.0)
    shown = (frequency >= _LOW) & (frequency <= min(_BEYOND * highest, rate / 2))
    x = Axis("frequency, Hz", _LOW, float(frequency[shown][-1]), log=True)
    rules = labelled_together([Rule(mode.damped_frequency, "mode", mode.name, dashed=True) for mode in told], x)
    panels = []
    for part, name in ((decays.on_body, "sensors on the body"), (~decays.on_body, "sensors at the wheels")):
        if not part.any():
            continue
        # One-sided, in the mean over drops and channels.
        sizes = [np.sqrt(2 * one[:, part].mean(axis=(0, 1)) / rate)[shown] for one in powers]
        top = 1.6 * float(sizes[0].max(initial=1e-12))
        curves = (
            Curve(frequency[shown], sizes[0], "measured", "measured", 2.2),
            Curve(frequency[shown], sizes[1], "simulated", "fitted vehicle"),
        )
        axis = Axis("m/s² per √Hz", max(float(sizes[0].min(initial=top)), _FLOOR * top), top, log=True)
        panels.append(Panel(axis, (*rules, *curves), note=name))
    return Picture(
        f"Spectra, {decays.load}", x, tuple(panels), "Spectra of the decays, with lines at the identified modes."
    )


def _power(records: Sequence[Real], length: int) -> Real:
    """Give |FFT|² over the number of samples, shape (record, channel, frequency)."""
    centred = [record - record.mean(axis=1, keepdims=True) for record in records]
    return np.array([np.abs(np.fft.rfft(one, length)) ** 2 / one.shape[1] for one in centred])

"""Spectra of the fitted records of one load, measured and fitted, with lines at the identified modes."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import ModeEstimate
from sprung.report.drawing.axis import Axis
from sprung.report.drawing.picture import Curve, Panel, Picture, Rule, merge_labels
from sprung.report.pictures.decays import LoadDecays

Real = NDArray[np.float64]

_LOW, _BEYOND = 0.3, 2.5
"""Lower end of the axis, Hz, and its upper end as a multiple of the highest mode."""

_FINER = 4
"""Zero padding: with fewer frequencies the curve looks broken."""

_FLOOR = 3e-4
"""Smallest value that is shown, as a part of the largest."""

_ROOM = 4.0
"""Upper end of the axis over the largest value, so that the note lies above the curves."""

_PLACES = {"body": "sensors on the body", "wheel": "sensors at the wheels", "pad": "sensors on the pads"}
"""What a panel shows, by the place of its sensors."""


def spectra_picture(decays: LoadDecays, modes: Sequence[ModeEstimate]) -> Picture:
    """Return the picture of the spectra of one load.

    Parameters
    ----------
    decays
        Of that load.
    modes
        Of the identified vehicle; those whose frequency is not determined are not drawn.

    Returns
    -------
    Picture
        SI per √Hz over Hz: panels for the sensors on the body, at the wheels and on pads, of each quantity that is measured.
    """
    determined = [mode for mode in modes if mode.frequency_std is not None and mode.pole[1] > 0]
    rate = decays.rate
    length = _FINER * max(record.shape[1] for record in decays.measured)
    frequency = np.asarray(np.fft.rfftfreq(length, 1 / rate), dtype=float)
    powers = [_power(records, length) for records in (decays.measured, decays.fitted)]
    highest = max((mode.damped_frequency for mode in determined), default=20.0)
    shown = (frequency >= _LOW) & (frequency <= min(_BEYOND * highest, rate / 2))
    x = Axis("frequency, Hz", _LOW, float(frequency[shown][-1]), log=True)
    rules = merge_labels([Rule(mode.damped_frequency, "mode", mode.name, dashed=True) for mode in determined], x)
    panels = []
    units = np.array(decays.units)
    places = np.array(decays.places)
    for unit, (place, name) in itertools.product(dict.fromkeys(decays.units), _PLACES.items()):
        part = (places == place) & (units == unit)
        if not part.any():
            continue
        # One-sided, mean over drops and channels.
        sizes = [np.sqrt(2 * power[:, part].mean(axis=(0, 1)) / rate)[shown] for power in powers]
        top = _ROOM * float(sizes[0].max(initial=1e-12))
        curves = (
            Curve(frequency[shown], sizes[0], "measured", "measured", 2.2),
            Curve(frequency[shown], sizes[1], "simulated", "fitted vehicle"),
        )
        axis = Axis(f"{unit} per √Hz", max(float(sizes[0].min(initial=top)), _FLOOR * top), top, log=True)
        panels.append(Panel(axis, (*rules, *curves), note=name))
    what = "forced responses" if decays.is_driven else "decays"
    return Picture(
        f"Spectra, {decays.title}", x, tuple(panels), f"Spectra of the {what}, with lines at the identified modes."
    )


def _power(records: Sequence[Real], length: int) -> Real:
    """Return |FFT|² over the number of samples, shape (record, channel, frequency)."""
    centred = [record - record.mean(axis=1, keepdims=True) for record in records]
    return np.array([np.abs(np.fft.rfft(record, length)) ** 2 / record.shape[1] for record in centred])

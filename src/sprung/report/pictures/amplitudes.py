"""Frequency and damping of the body's modes against amplitude: from the records alone, and from the fitted vehicle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.assessment import ModeAmplitude
from sprung.report.drawing.axis import Axis, room
from sprung.report.drawing.picture import Curve, Mark, Panel, Picture, Points, Role, Rule

Real = NDArray[np.float64]

_LEAST = 0.1
"""Part of a frequency that its axis spans at least: what is flat shall look flat."""

_ROLES: tuple[Role, Role] = ("first", "second")


def amplitude_pictures(amplitudes: Sequence[ModeAmplitude]) -> list[Picture]:
    """Show every mode, frequency above and damping ratio below.

    Parameters
    ----------
    amplitudes
        Of a result.

    Returns
    -------
    list of Picture
        One for each mode that some record shows.
    """
    return [_picture(one) for one in amplitudes if any(trace.amplitude.size for trace in one.records)]


def _picture(one: ModeAmplitude) -> Picture:
    largest = max(float(trace.amplitude.max(initial=0.0)) for trace in one.records)
    model = one.model
    shown = model.amplitude <= 1.3 * largest
    seen = 1e3 * np.concatenate([model.amplitude[shown], *(trace.amplitude for trace in one.records)])
    # The motion dies from left to right, as it does in a recording.
    x = Axis(
        "amplitude at the sensor that moves most, mm", float(seen.min()) / 1.15, float(seen.max()) * 1.15, True, True
    )
    panels = []
    for name, label, level, factor, least in (
        ("frequency", "frequency, Hz", one.frequency, 1.0, _LEAST * one.frequency),
        ("damping_ratio", "damping ratio, %", 100 * one.damping_ratio, 100.0, 10.0),
    ):
        whole = factor * getattr(model, name)[shown]
        marks: list[Mark] = [
            Rule(level, "quiet", lying=True, dashed=True),
            Curve(1e3 * model.amplitude[shown], whole, "simulated", "fitted vehicle, this mode alone", 1.6),
        ]
        values = [whole, np.array([level])]
        for trace, drop, role in zip(one.records, one.simulated, _ROLES, strict=False):
            marks.append(Curve(1e3 * drop.amplitude, factor * getattr(drop, name), role, width=0.8))
            measured, bars = factor * getattr(trace, name), 2 * factor * getattr(trace, f"{name}_std")
            hollow = role == "second"
            marks.append(Points(1e3 * trace.amplitude, measured, role, trace.name, hollow, bars))
            values += [measured - bars, measured + bars]
        panels.append(Panel(Axis(label, *room(*values, least=least)), tuple(marks), height=1.15))
    told = (
        f"Frequency and damping ratio of {one.mode} against its amplitude: from the records, from the simulated drops, and of "
        f"the fitted vehicle; dashed its linear part, {one.frequency:.3g} Hz."
    )
    return Picture(one.mode, x, tuple(panels), told)

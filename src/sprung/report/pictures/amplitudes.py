"""Frequency and damping of the body's modes against amplitude: from the recordings, and from the fitted vehicle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.assessment import ModeAmplitude
from sprung.report.drawing.axis import Axis, axis_limits
from sprung.report.drawing.picture import Curve, Mark, Panel, Picture, Points, Role, Rule

Real = NDArray[np.float64]

_LEAST = 0.1
"""Smallest span of the frequency axis, as a part of the frequency: a constant must look constant."""

_ROLES: tuple[Role, Role] = ("first", "second")


def amplitude_pictures(amplitudes: Sequence[ModeAmplitude]) -> list[Picture]:
    """Return the picture of each mode, frequency above and damping ratio below.

    Parameters
    ----------
    amplitudes
        Of a result.

    Returns
    -------
    list of Picture
        One for each mode that is seen in a recording.
    """
    return [_picture(mode) for mode in amplitudes if any(curve.amplitude.size for curve in mode.records)]


def _picture(mode: ModeAmplitude) -> Picture:
    largest = max(float(curve.amplitude.max(initial=0.0)) for curve in mode.records)
    model = mode.model
    shown = model.amplitude <= 1.3 * largest
    seen = 1e3 * np.concatenate([model.amplitude[shown], *(curve.amplitude for curve in mode.records)])
    # The motion decays from left to right, as in a recording.
    x = Axis(
        "amplitude at the sensor with the largest motion, mm",
        float(seen.min()) / 1.15,
        float(seen.max()) * 1.15,
        True,
        True,
    )
    panels = []
    for name, label, level, factor, least in (
        ("frequency", "frequency, Hz", mode.frequency, 1.0, _LEAST * mode.frequency),
        ("damping_ratio", "damping ratio, %", 100 * mode.damping_ratio, 100.0, 10.0),
    ):
        fitted = factor * getattr(model, name)[shown]
        marks: list[Mark] = [
            Rule(level, "reference", horizontal=True, dashed=True),
            Curve(1e3 * model.amplitude[shown], fitted, "simulated", "fitted vehicle, this mode alone", 1.6),
        ]
        values = [fitted, np.array([level])]
        for curve, simulated, role in zip(mode.records, mode.simulated, _ROLES, strict=False):
            marks.append(Curve(1e3 * simulated.amplitude, factor * getattr(simulated, name), role, width=0.8))
            measured, bars = factor * getattr(curve, name), 2 * factor * getattr(curve, f"{name}_std")
            hollow = role == "second"
            marks.append(Points(1e3 * curve.amplitude, measured, role, curve.name, hollow, bars))
            values += [measured - bars, measured + bars]
        panels.append(Panel(Axis(label, *axis_limits(*values, least=least)), tuple(marks), height=1.15))
    description = (
        f"Frequency and damping ratio of {mode.mode} against its amplitude: from the recordings, from the simulated drops, and "
        f"of the fitted vehicle; dashed: its linear part, {mode.frequency:.3g} Hz."
    )
    return Picture(mode.mode, x, tuple(panels), description)

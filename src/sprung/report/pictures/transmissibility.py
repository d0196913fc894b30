"""Transmissibility from the road to body and wheels, with its 95 % band."""

from __future__ import annotations

import numpy as np

from sprung.report.drawing.axis import Axis
from sprung.report.drawing.picture import Curve, Mark, Panel, Picture, Role, Rule
from sprung.ride import RideNumbers
from sprung.uncertainty import NORMAL_95

_ROLES: tuple[Role, ...] = ("simulated", "first")


def transmissibility_picture(numbers: RideNumbers) -> Picture:
    """Return the picture of the transmissibilities to the body over each axle and to its wheels.

    Parameters
    ----------
    numbers
        Of a vehicle.

    Returns
    -------
    Picture
        Dimensionless over Hz: a panel for the body, and one for the wheels; front and rear axle in each, with 95 % bands.
    """
    frequency = next(iter(numbers.curves.values())).frequency
    x = Axis("frequency, Hz", float(frequency[0]), float(frequency[-1]), log=True)
    panels = []
    for kind, note in (("body", "body over the axle"), ("wheel", "wheel")):
        own = {name: curve for name, curve in numbers.curves.items() if name.partition("_")[0] == kind}
        top = 1.15 * max(float(np.max(curve.gain + NORMAL_95 * curve.std)) for curve in own.values())
        marks: list[Mark] = [Rule(1.0, "reference", horizontal=True)]
        for (name, curve), role in zip(own.items(), _ROLES, strict=False):
            label = name.partition("_")[2]
            marks.append(Curve(curve.frequency, curve.gain, role, label, 1.6, band=NORMAL_95 * curve.std))
        panels.append(Panel(Axis("gain", 0.0, top), tuple(marks), height=1.3, note=note))
    peaks = "; ".join(
        f"{name.replace('_', ' ')} {peak['gain']:.3g} at {peak['frequency']:.3g} Hz"
        for name, peak in numbers.peaks.items()
    )
    return Picture("Transmissibility", x, tuple(panels), f"Transmissibility from the road, largest values: {peaks}.")

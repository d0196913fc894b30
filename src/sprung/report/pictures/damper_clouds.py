"""Curves of the dampers, with what the accelerometers say of their forces sample by sample behind them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.report.drawing.axis import Axis, axis_limits
from sprung.report.drawing.picture import Curve, Panel, Picture, Points, Rule
from sprung.results import DamperPoints, Result
from sprung.uncertainty import NORMAL_95
from sprung.vehicle import STATIONS

Real = NDArray[np.float64]

_SHOWN = 4000
"""Points of an axle that are drawn at most."""

_LINE = 200
"""Points of a drawn curve."""

_AXLES: Mapping[str, str] = {"f": "front", "r": "rear", "": ""}


def damper_cloud_pictures(result: Result, points: Sequence[DamperPoints]) -> tuple[Picture, ...]:
    """Return a picture of the dampers of each axle: force over velocity, rebound to the right and up.

    Parameters
    ----------
    result
        Of an identification.
    points
        From `sprung.results.damper_points`, of one drop or of several.

    Returns
    -------
    tuple of Picture
        N over m/s: every so many samples as points, and the curve of the model with its 95 % band over the same velocities;
        below, what the points differ from it.
    """
    axles = dict.fromkeys(STATIONS[one.wheel].axle for one in points)
    return tuple(_picture(result, axle, [one for one in points if STATIONS[one.wheel].axle == axle]) for axle in axles)


def _picture(result: Result, axle: str, points: Sequence[DamperPoints]) -> Picture:
    velocity, force = (np.concatenate([getattr(one, name) for one in points]) for name in ("velocity", "force"))
    every = max(1, -(-velocity.size // _SHOWN))
    x = np.linspace(velocity.min(), velocity.max(), _LINE)
    curve, band = _curve(result, axle, x)
    noise = float(np.sqrt(np.mean([one.noise**2 for one in points])))
    apart = np.concatenate([one.force - one.model for one in points])
    scatter = float(np.sqrt(np.mean(apart**2)))
    name = f"{_AXLES[axle]} dampers".strip()
    shown = (
        Rule(0.0, "reference", horizontal=True),
        Rule(0.0, "reference"),
        Points(velocity[::every], force[::every], "measured", "measured accelerations", size=0.4),
        Curve(x, curve, "simulated", "model, 95 % band", 1.6, band=band),
    )
    panel = Panel(Axis("force, N", *axis_limits(force, curve)), shown, height=2.1)
    below = Panel(
        Axis("deviation, N", *axis_limits(apart, band, -band)),
        (
            Rule(0.0, "reference", horizontal=True),
            Points(velocity[::every], apart[::every], "residual", size=0.4),
            Curve(x, np.zeros(_LINE), "simulated", width=1.6, band=band),
        ),
        height=0.9,
        note=f"{scatter:.2g} N rms, each uncertain by {noise:.2g} N",
    )
    across = Axis("velocity (rebound positive), m/s", *axis_limits(velocity, margin=0.02))
    description = (
        f"Force of the {name} over velocity from {x[0]:.2g} to {x[-1]:.2g} m/s: the model from {curve[0]:.0f} to "
        f"{curve[-1]:.0f} N; the points deviate from it by {scatter:.2g} N root-mean-square, each uncertain by {noise:.2g} N."
    )
    return Picture(name.capitalize(), across, (panel, below), description)


def _curve(result: Result, axle: str, velocity: Real) -> tuple[Real, Real]:
    """Return the force of the model and the half-height of its 95 % band."""
    curve = result.curves.get({"f": "damper_front", "r": "damper_rear"}.get(axle, "damper"))
    if curve is not None:
        force, std = curve.at(velocity)
        return np.asarray(force), NORMAL_95 * np.asarray(std)
    rate = result.parameters[f"c_s{axle}"]
    return (rate.value or 0.0) * velocity, NORMAL_95 * (rate.std or 0.0) * np.abs(velocity)

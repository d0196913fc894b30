"""Axes: about which of them the inertias that were found are, and what they are about others."""

from __future__ import annotations

import numpy as np

from sprung.estimation import FitStatistics
from sprung.uncertainty import NORMAL_95, Estimate
from sprung.vehicle import FULL, Heights, Layout

ABOUT_ROLL_AXIS = "I_xx_roll_axis"
"""Name of the sprung mass's roll inertia about the axis of roll, among the derived quantities."""


def axes_of(heights: Heights, assumed: bool = False, layout: Layout = FULL) -> str:
    """Return the axes to which I_xx and I_yy refer, as text; nothing of a vehicle that does not turn.

    Parameters
    ----------
    heights
        How high things are, as far as it was measured.
    assumed
        Whether they were not measured, but follow from the recordings.
    layout
        Of the vehicle.
    """
    turns = {"I_xx": layout.rolls, "I_yy": layout.pitches}
    inertias = " and ".join(name for name, does in turns.items() if does)
    are, refer, include = ("are", "refer", "include") if all(turns.values()) else ("is", "refers", "includes")
    if not inertias:
        return ""
    arm = -heights.wheel_arms[1]
    if assumed and arm != 0:
        where = "above" if arm > 0 else "below"
        return (
            f"no heights are given; {inertias} {are} about the centre of gravity of the sprung mass, which according to the "
            f"recordings is {abs(arm):.2f} m {where} the wheel centres, where the body is carried"
        )
    if assumed or not heights.has_effect:
        return (
            f"no heights are given; {inertias} {refer} to the actual {_axes(layout)} and {include} the lateral motion of "
            "the wheels"
        )
    axis = "it" if heights.roll_axis_height is None else f"an axis at {heights.roll_axis_height:g} m"
    at_wheels = heights.carried_at == "wheels" and heights.wheel_height is not None
    carried_at = f"at its wheels ({heights.wheel_height:g} m)" if at_wheels else "at the axis of roll"
    return (
        f"{inertias} {are} about the centre of gravity of the sprung mass ({heights.cg_height:g} m above the ground); the "
        f"body rolls about {axis} and is carried {carried_at}"
    )


def _axes(layout: Layout) -> str:
    return "roll and pitch axes" if layout == FULL else "roll axis" if layout.rolls else "pitch axis"


def about_roll_axis(fit: FitStatistics, heights: Heights) -> dict[str, Estimate]:
    """Return the roll inertia of the sprung mass about the roll axis, if this is not at the centre of gravity.

    Parameters
    ----------
    fit
        The fit.
    heights
        How high things are.

    Returns
    -------
    dict
        `ABOUT_ROLL_AXIS` with its estimate, or nothing.
    """
    if heights.cg_arm == 0 or not {"I_xx", "m_s"} <= set(fit.names):
        return {}
    gradient = np.zeros(len(fit.names))
    gradient[fit.names.index("I_xx")] = 1.0
    gradient[fit.names.index("m_s")] = heights.cg_arm**2
    value = float(gradient @ fit.values)
    std = fit.spread(gradient * fit.slopes, value)
    if std is None:
        return {ABOUT_ROLL_AXIS: Estimate(None, None, None, "kg m^2", "unidentifiable")}
    interval = (value - NORMAL_95 * std, value + NORMAL_95 * std)
    return {ABOUT_ROLL_AXIS: Estimate(value, std, interval, "kg m^2", "estimated", "curvature")}

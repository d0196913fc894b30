"""Mode shapes and fitted motions for the wire frame of the page; runs in the process that answers questions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sprung.app.result_view import load_result
from sprung.errors import InputError
from sprung.report import (
    LIGHT,
    SolidFrame,
    damper_cloud_pictures,
    mode_caption,
    picture_svg,
    solid_frame,
)
from sprung.results import DamperPoints, Result, damper_points, fitted_motion
from sprung.vehicle import layout_of

_RATE = 250.0
"""Samples of a shown motion per second: more than ten for the fastest wheel hop."""

_COLOURS = ("paper", "text", "hair", "reference", "residual", "simulated", "mode")
"""Colours of the wire frame; on paper and in saved pictures those of light ground."""


def scene(folder: str) -> dict[str, Any]:
    """Return the wire frame, the modes and the names of the drops of a result.

    Parameters
    ----------
    folder
        The results folder.

    Returns
    -------
    dict
        Places in m, rise of the nodes in each mode (real and imaginary part, the largest 1), names of the fitted drops, and why
        no drop can be shown, if none can.
    """
    result = load_result(folder)
    series = load_result(folder, series=True).series if result.verdict.state != "reject" else {}
    frame = solid_frame(result)
    why = ""
    if result.verdict.state == "reject":
        why = "The result is rejected: it has no estimates, and there is no motion to show. Its report has the reasons."
    else:
        missing = [name for name, estimate in result.parameters.items() if estimate.value is None]
        if missing:
            why = (
                f"Modes can be shown, but neither drops nor dampers: {', '.join(missing)} are not determined. The report says "
                "what would determine them."
            )
    return {
        "places": np.round(frame.places, 4).tolist(),
        "rows": np.round(frame.rows, 5).tolist(),
        "edges": frame.nodes.edges,
        "struts": frame.nodes.struts,
        "hubs": frame.nodes.hubs,
        "wheel": round(frame.wheel, 4),
        "wheelbase": round(frame.wheelbase, 4),
        "colours": {name: LIGHT[name] for name in _COLOURS},
        "modes": [
            {
                "load": load,
                "name": mode.name,
                "caption": mode_caption(mode),
                "frequency": mode.damped_frequency,
                "creeps": mode.pole[1] == 0,
                **shape,
            }
            for load, modes in result.modes.items()
            for mode in modes
            if mode.motion and (shape := _shape(frame, mode.motion)) is not None
        ],
        "drops": [] if why else [drop.name for drop in result.drops if drop.name in series],
        "why": why,
    }


def _shape(frame: SolidFrame, motion: tuple[tuple[float, float], ...]) -> dict[str, Any] | None:
    shape = np.array([complex(*part) for part in motion])
    rise: NDArray[np.complex128] = frame.rows[:, : len(shape)] @ shape
    largest = rise[np.abs(rise).argmax()]
    if not largest:
        return None
    rise = rise / largest
    return {"real": np.round(rise.real, 4).tolist(), "imaginary": np.round(rise.imag, 4).tolist()}


def drop_motion(folder: str, drop: str) -> dict[str, Any]:
    """Return the rise of the nodes of the wire frame in a drop.

    Parameters
    ----------
    folder
        The results folder.
    drop
        Name of a drop that was fitted.

    Returns
    -------
    dict
        Times in s, rises in mm by node and time, and how the motion was found.

    Raises
    ------
    InputError
        If the motion is not determined.
    """
    result = load_result(folder, series=True)
    found = fitted_motion(result, drop)
    frame = solid_frame(result)
    every = max(1, round(1 / (_RATE * float(np.mean(np.diff(found.time))))))
    layout = layout_of(tuple(result.vehicle.parameters))
    shown = (*layout.coordinates, "z_e")
    moved = np.zeros((len(shown), len(found.time)))
    for i, name in enumerate(shown):
        if name in found.coordinates:
            moved[i] = found.motion.displacement[found.coordinates.index(name)]
    rises = 1000 * (frame.rows[:, : len(shown)] @ moved)[:, ::every]
    how = (
        "free decay of the identified vehicle"
        if found.is_linear
        else f"integrated from the fitted readings; they differ by {100 * found.deviation:.1f} % from a free decay of the "
        "linear vehicle"
    )
    return {
        "time": np.round(found.time[::every], 4).tolist(),
        "rises": np.round(rises, 3).tolist(),
        "how": how,
        "load": found.load,
    }


def dampers(folder: str, drop: str = "") -> dict[str, Any]:
    """Return the pictures of the dampers with the points of the measured accelerations.

    Parameters
    ----------
    folder
        The results folder.
    drop
        Name of a drop; empty for all that were fitted.

    Returns
    -------
    dict
        ``pictures``: SVG elements, one for each axle.

    Raises
    ------
    InputError
        If the forces of no drop are determined.
    """
    result: Result = load_result(folder, series=True)
    points: list[DamperPoints] = []
    refused: InputError | None = None
    for name in [drop] if drop else list(result.series):
        try:
            points += damper_points(result, name)
        except InputError as error:
            refused = error
    if not points:
        raise refused or InputError([])
    return {"pictures": [picture_svg(picture) for picture in damper_cloud_pictures(result, points)]}

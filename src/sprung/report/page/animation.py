"""Mode shapes for the animation of the page: wire frames, and the complex displacement of each node."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from sprung.estimation import ModeEstimate
from sprung.report.drawing.picture import Real
from sprung.report.pictures.wire_frame import WireFrame


def mode_drawings(car: WireFrame, modes: Sequence[ModeEstimate]) -> Iterator[dict[str, Any]]:
    """Yield what a template needs to draw each mode.

    Parameters
    ----------
    car
        The wire frame.
    modes
        With their shapes.
    """
    for mode in modes:
        swing = car.swing(mode.motion)
        moved = car.places - np.stack([np.zeros(len(swing)), swing.real], axis=1)
        yield {
            "name": mode.name,
            "width": f"{car.width:.0f}",
            "height": f"{car.height:.0f}",
            "swing": " ".join(f"{part.real:.2f},{part.imag:.2f}" for part in swing.tolist()),
            "creeps": mode.pole[1] == 0,
            "view": car.view,
            "rest": _lines(car.nodes.edges, car.places),
            "edges": _lines(car.nodes.edges, moved),
            "struts": _lines(car.nodes.struts, moved),
            "circles_at_rest": _circles(car, car.places),
            "circles": _circles(car, moved),
            "caption": mode_caption(mode),
            "description": f"{mode.name}: wire frame in the shape of this mode",
        }


def wire_json(car: WireFrame) -> str:
    """Return the wire frame at rest as JSON for the script of the page."""
    places = [[round(x, 1), round(y, 1)] for x, y in car.places.tolist()]
    nodes, circles = car.nodes, [node for node, _ in car.circles]
    return json.dumps(
        {"places": places, "edges": nodes.edges, "struts": nodes.struts, "circles": circles}, separators=(",", ":")
    )


def _lines(pairs: Sequence[tuple[int, int]], places: Real) -> str:
    return "".join(f"M{places[i, 0]:.1f} {places[i, 1]:.1f}L{places[j, 0]:.1f} {places[j, 1]:.1f}" for i, j in pairs)


def _circles(car: WireFrame, places: Real) -> list[tuple[str, ...]]:
    """Return centre and radius of every circle."""
    return [(*(f"{part:.1f}" for part in places[node].tolist()), f"{radius:.1f}") for node, radius in car.circles]


def mode_caption(mode: ModeEstimate) -> str:
    """Return frequency and damping ratio of a mode, below its picture.

    Parameters
    ----------
    mode
        Of a load.

    Returns
    -------
    str
        In Hz and percent.
    """
    if mode.pole[1] == 0:
        return "overdamped"
    description = (
        "damping not determined"
        if mode.damping_ratio_std is None
        else f"damping ratio {100 * mode.damping_ratio:.1f} %"
    )
    return f"{mode.frequency:.4g} Hz, {description}"

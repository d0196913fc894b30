"""The modes as the page's script moves them: still pictures, and how far each node of them swings."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from sprung.estimation import ModeEstimate
from sprung.report.drawing.picture import Real
from sprung.report.pictures.wire_car import BODY_EDGES, STRUTS, WireCar


def cars_of(car: WireCar, modes: Sequence[ModeEstimate]) -> Iterator[dict[str, Any]]:
    """Give what a template needs to draw each mode.

    Parameters
    ----------
    car
        The wire car.
    modes
        With their motions.
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
            "rest": _lines(BODY_EDGES, car.places),
            "edges": _lines(BODY_EDGES, moved),
            "struts": _lines(STRUTS, moved),
            "circles": [
                (*(f"{part:.1f}" for part in moved[node].tolist()), f"{radius:.1f}") for node, radius in car.circles
            ],
            "said": _said(mode),
            "told": f"{mode.name}: a small car of wire in the shape of this mode",
        }


def wire_json(car: WireCar) -> str:
    """Give the wire car at rest for the page's script."""
    places = [[round(x, 1), round(y, 1)] for x, y in car.places.tolist()]
    return json.dumps(
        {"places": places, "edges": BODY_EDGES, "struts": STRUTS, "circles": [node for node, _ in car.circles]},
        separators=(",", ":"),
    )


def _lines(pairs: Sequence[tuple[int, int]], places: Real) -> str:
    return "".join(f"M{places[i, 0]:.1f} {places[i, 1]:.1f}L{places[j, 0]:.1f} {places[j, 1]:.1f}" for i, j in pairs)


def _said(mode: ModeEstimate) -> str:
    if mode.pole[1] == 0:
        return "overdamped: it creeps back"
    told = (
        "damping not determined"
        if mode.damping_ratio_std is None
        else f"damping ratio {100 * mode.damping_ratio:.1f} %"
    )
    return f"{mode.frequency:.4g} Hz, {told}"

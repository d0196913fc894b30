"""The stabilisation diagram: poles over model order, and the stable ones."""

from __future__ import annotations

import numpy as np

from sprung.modal import StabilisationDiagram
from sprung.report.drawing.axis import Axis
from sprung.report.drawing.picture import Panel, Picture, Points, Rule, merge_labels


def stability_picture(load: str, diagram: StabilisationDiagram) -> Picture:
    """Return the picture of a stabilisation diagram.

    Parameters
    ----------
    load
        Name of the load.
    diagram
        The diagram.

    Returns
    -------
    Picture
        One panel, order over Hz.
    """
    vibrating = [pole for pole in diagram.poles if pole.pole.imag > 0]
    frequency = np.array([abs(pole.pole) for pole in vibrating]) / (2 * np.pi)
    order = np.array([pole.order for pole in vibrating], dtype=float)
    stable = np.array([pole.stable for pole in vibrating], dtype=bool)
    points = (
        Points(frequency[~stable], order[~stable], "reference", "not at the previous order", hollow=True, size=0.8),
        Points(frequency[stable], order[stable], "simulated", "at the previous order too"),
    )
    low, high = (frequency.min() / 1.15, frequency.max() * 1.15) if frequency.size else (0.5, 20.0)
    x = Axis("natural frequency, Hz", float(low), float(high), log=True)
    stable_frequencies = [abs(pole.pole) / (2 * np.pi) for pole in diagram.chosen if pole.pole.imag > 0]
    rules = merge_labels([Rule(value, "mode", f"{value:.4g}", dashed=True) for value in stable_frequencies], x)
    most = max(diagram.orders, default=2)
    panel = Panel(Axis("model order", 0, most + 2), (*rules, *points), height=1.9)
    description = (
        f"Poles of models of order 2 to {most}; lines at stable ones: "
        f"{', '.join(f'{value:.4g}' for value in stable_frequencies)} Hz."
    )
    return Picture(f"Stabilisation, {load}", x, (panel,), description)

"""The stabilisation diagram: poles over the order of a model, and what stays."""

from __future__ import annotations

import numpy as np

from sprung.modal import StabilisationDiagram
from sprung.report.drawing.axis import Axis
from sprung.report.drawing.picture import Panel, Picture, Points, Rule, labelled_together


def stability_picture(load: str, diagram: StabilisationDiagram) -> Picture:
    """Show a stabilisation diagram.

    Parameters
    ----------
    load
        Whose decays it is of.
    diagram
        The diagram.

    Returns
    -------
    Picture
        One panel, order over Hz.
    """
    vibrating = [one for one in diagram.poles if one.pole.imag > 0]
    frequency = np.array([abs(one.pole) for one in vibrating]) / (2 * np.pi)
    order = np.array([one.order for one in vibrating], dtype=float)
    stable = np.array([one.stable for one in vibrating], dtype=bool)
    points = (
        Points(frequency[~stable], order[~stable], "quiet", "new at this order", hollow=True, size=0.8),
        Points(frequency[stable], order[stable], "simulated", "at the order before too"),
    )
    low, high = (frequency.min() / 1.15, frequency.max() * 1.15) if frequency.size else (0.5, 20.0)
    x = Axis("natural frequency, Hz", float(low), float(high), log=True)
    stays = [abs(one.pole) / (2 * np.pi) for one in diagram.chosen if one.pole.imag > 0]
    rules = labelled_together([Rule(one, "mode", f"{one:.4g}", dashed=True) for one in stays], x)
    most = max(diagram.orders, default=2)
    panel = Panel(Axis("order of the model", 0, most + 2), (*rules, *points), height=1.9)
    told = (
        f"Poles of models of order 2 to {most}; lines where poles stay: {', '.join(f'{one:.4g}' for one in stays)} Hz."
    )
    return Picture(f"Stabilisation, {load}", x, (panel,), told)

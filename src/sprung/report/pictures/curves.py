"""Force curves of dampers, springs and tyres, with their 95 % bands over the range that the drops reached."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from sprung.estimation import ForceCurve
from sprung.report.drawing.axis import Axis, axis_limits
from sprung.report.drawing.picture import Curve, Mark, Panel, Picture, Points, Role, Rule
from sprung.uncertainty import NORMAL_95

_POINTS = 300
"""Points of a drawn curve."""

_MARGIN = 0.12
"""Part of the reached range by which a curve is continued on either side."""

_AXLES: tuple[tuple[str, Role], ...] = (("front", "simulated"), ("rear", "first"))


class _Figure(NamedTuple):
    """One figure: prefix of the curves' names, title, labels of the axes, factor of x, and sign of both axes."""

    part: str
    title: str
    x: str
    y: str
    factor: float
    sign: float


_FIGURES = (
    _Figure("damper", "Dampers", "velocity (rebound positive), m/s", "force, N", 1.0, 1.0),
    # Springs and tyres are drawn as they are tested: compression to the right, load upwards.
    _Figure("spring", "Springs", "compression from rest, mm", "load above rest, N", 1e3, -1.0),
    _Figure("tyre", "Tyres", "deflection, mm", "load, N", 1e3, -1.0),
)


def curve_pictures(curves: Mapping[str, ForceCurve]) -> dict[str, Picture]:
    """Return the pictures of the force curves, front and rear in one.

    Parameters
    ----------
    curves
        Of a result, by name.

    Returns
    -------
    dict
        By ``damper``, ``spring`` and ``tyre``, those that there are. Dampers as from a dynamometer, N over m/s, rebound to the
        right and up; springs and tyres N over mm, compression to the right. Solid with the 95 % band over the reached range,
        whose ends are rings; dashed beyond it.
    """
    return {figure.part: picture for figure in _FIGURES if (picture := _picture(figure, curves)) is not None}


def _picture(figure: _Figure, curves: Mapping[str, ForceCurve]) -> Picture | None:
    own = [(axle, role, curves[f"{figure.part}_{axle}"]) for axle, role in _AXLES if f"{figure.part}_{axle}" in curves]
    if not own:
        return None
    marks: list[Mark] = [Rule(0.0, "reference", horizontal=True), Rule(0.0, "reference")]
    drawn = [mark for axle, role, curve in own for mark in _marks(figure, axle, role, curve)]
    lines = [mark for mark in drawn if isinstance(mark, Curve)]
    inside = [mark for mark in lines if mark.band is not None]
    x = Axis(figure.x, *axis_limits(*(mark.x for mark in lines), margin=0.0))
    bands = [mark.y + sign * mark.band for mark in inside for sign in (-1, 1) if mark.band is not None]
    y = Axis(figure.y, *axis_limits(*(mark.y for mark in lines), *bands))
    panel = Panel(y, (*marks, *drawn), height=2.3)
    return Picture(figure.title, x, (panel,), f"{figure.title}: {'; '.join(_sentences(figure, own))}.")


def _marks(figure: _Figure, axle: str, role: Role, curve: ForceCurve) -> Iterator[Mark]:
    low, high = curve.reached
    margin = _MARGIN * (high - low)
    for start, end, is_reached in ((low - margin, low, False), (low, high, True), (high, high + margin, False)):
        inner = curve.x[(curve.x > start) & (curve.x < end)]
        x = np.union1d(np.linspace(start, end, _POINTS if is_reached else 2), inner)[:: int(figure.sign)]
        force, std = curve.at(x)
        places = figure.sign * figure.factor * x
        band = NORMAL_95 * np.asarray(std) if is_reached else None
        label = axle if is_reached else ""
        yield Curve(
            places, figure.sign * np.asarray(force), role, label, 1.6 if is_reached else 0.9, not is_reached, band
        )
    ends = np.array(curve.reached)
    places = figure.sign * figure.factor * ends
    yield Points(places, figure.sign * np.asarray(curve.at(ends).force), role, hollow=True)


def _sentences(figure: _Figure, own: list[tuple[str, Role, ForceCurve]]) -> Iterator[str]:
    """Yield what each curve shows, for readers who do not see it."""
    for axle, _, curve in own:
        ends = np.sort(figure.sign * figure.factor * np.array(curve.reached))
        unit = figure.x.rpartition(", ")[2]
        low, high = figure.sign * np.sort(figure.sign * np.array(curve.reached))
        forces = [figure.sign * float(curve.at(float(end)).force) for end in (low, high)]
        yield (
            f"{axle} from {ends[0]:.3g} {unit}, {forces[0]:.3g} N, to {ends[1]:.3g} {unit}, {forces[1]:.3g} N, "
            "which the drops reached"
        )

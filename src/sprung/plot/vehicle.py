"""Figures of the identified vehicle."""

from __future__ import annotations

from collections.abc import Iterable

from matplotlib.axes import Axes

from sprung.errors import InputError, Problem
from sprung.plot.drawing import axes_or_new, check_name, draw, draw_matrix
from sprung.report import amplitude_pictures, curve_pictures, parameters_picture
from sprung.results import Result, other_quantities
from sprung.study import Validation
from sprung.vehicle import FULL, layout_of


def parameters(result: Result, *, axes: Axes | None = None) -> Axes:
    """Draw the 95 % interval of every estimated parameter, in percent of its value.

    Parameters
    ----------
    result
        From `sprung.identify` or `sprung.load`.
    axes
        Into which it is drawn; a new figure unless given.

    Returns
    -------
    Axes
    """
    picture = parameters_picture({**result.parameters, **other_quantities(result.derived)})
    [drawn] = draw(picture, None if axes is None else [axes])
    return drawn


def correlation(result: Result, *, axes: Axes | None = None) -> Axes:
    """Draw the correlation matrix of the estimated parameters.

    Parameters
    ----------
    result
        From `sprung.identify` or `sprung.load`.
    axes
        Into which it is drawn; a new figure unless given.

    Returns
    -------
    Axes

    Raises
    ------
    InputError
        If nothing was estimated.
    """
    if not result.correlation.names:
        do = "Read the reasons of the verdict."
        raise InputError([Problem("result", "no estimated parameters", "two or more", do)])
    axes = axes_or_new(axes)
    draw_matrix(result.correlation.names, result.correlation.matrix, axes)
    axes.set_title("Correlation of the estimated parameters", fontsize=10, fontweight="bold", loc="left")
    return axes


def amplitude(
    of: Result | Validation, mode: str = "body bounce", *, axes: Iterable[Axes] | None = None
) -> tuple[Axes, ...]:
    """Draw frequency and damping ratio of a mode of the body against its amplitude.

    Parameters
    ----------
    of
        From `sprung.identify` with ``amplitude=True``, `sprung.load` or `sprung.validate`.
    mode
        ``body bounce``, ``body pitch`` or ``body roll``.
    axes
        One for the frequency, Hz, and one for the damping ratio, %, over the amplitude in mm; a new figure unless given.

    Returns
    -------
    tuple of Axes
        Those with the figure.

    Raises
    ------
    InputError
        If the result has no amplitude curves, or none of this mode.
    """
    amplitudes = of.amplitude if isinstance(of, Result) else of.amplitudes
    if not amplitudes:
        raise InputError([_without_amplitudes(of)])
    pictures = {picture.title: picture for picture in amplitude_pictures(amplitudes)}
    return draw(pictures[check_name(mode, list(pictures), "mode")], axes)


def _without_amplitudes(of: Result | Validation) -> Problem:
    """Return why there are no amplitude curves."""
    result = of if isinstance(of, Result) else of.result
    needed = "vertical motion, pitch and roll of the body"
    if layout_of(result.parameters) != FULL:
        found = f"no amplitude curves: they need {needed}, which a part of a vehicle does not have together"
        return Problem("result", found, "a result of a whole vehicle", "Read the modes in result.modes.")
    do = f"Identify with amplitude=True; the sensors on the body have to show {needed}."
    return Problem("result", "no amplitude curves", "a result with amplitude curves", do)


def curve(result: Result, part: str = "damper", *, axes: Axes | None = None) -> Axes:
    """Draw the force curves of the dampers, springs or tyres, front and rear, with their 95 % bands.

    Parameters
    ----------
    result
        From `sprung.identify` or `sprung.load`.
    part
        ``damper`` (N over m/s, rebound to the right and up), ``spring`` or ``tyre`` (N over mm, compression to the right).
    axes
        Into which it is drawn; a new figure unless given.

    Returns
    -------
    Axes
        Solid over the range that the drops reached, whose ends are rings, dashed beyond it.

    Raises
    ------
    InputError
        If the result has no such curve.
    """
    pictures = curve_pictures(result.curves)
    if not pictures:
        found = "no force curves: the identified vehicle is linear, or was rejected"
        do = "Read result.fit.model and result.verdict; a linear rate is a parameter, such as c_sf."
        raise InputError([Problem("result", found, "a result with force curves", do)])
    [drawn] = draw(pictures[check_name(part, list(pictures), "force curve")], None if axes is None else [axes])
    return drawn

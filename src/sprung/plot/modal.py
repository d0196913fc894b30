"""Figures of modes: spectra, stabilisation diagrams, mode shapes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from matplotlib.axes import Axes

from sprung.errors import InputError, Problem
from sprung.modal import StabilisationDiagram, stabilisation_diagram
from sprung.modal_survey import LoadModes
from sprung.plot.drawing import axes_or_new, check_name, draw
from sprung.report import (
    LIGHT,
    LoadDecays,
    decays_by_load,
    spectra_picture,
    stability_picture,
    wire_frame,
)
from sprung.results import Result


def spectra(result: Result, load: str | None = None, *, axes: Iterable[Axes] | None = None) -> tuple[Axes, ...]:
    """Draw the spectra of the records of one load, measured and fitted, with the identified modes.

    Parameters
    ----------
    result
        From `sprung.identify` or `sprung.load`.
    load
        Its name; the first one unless given.
    axes
        One for each panel: the sensors on the body, those at the wheels, those on pads; a new figure unless given.

    Returns
    -------
    tuple of Axes
        Those with the figure; m/s² per √Hz over Hz.

    Raises
    ------
    InputError
        If there is no such load.
    """
    decays = _decays(result, load)
    return draw(spectra_picture(decays, result.modes[decays.load]), axes)


def stabilisation(
    of: LoadModes | Mapping[str, LoadModes] | StabilisationDiagram | Result,
    load: str | None = None,
    *,
    axes: Axes | None = None,
) -> Axes:
    """Draw a stabilisation diagram: natural frequencies of models of increasing order, and the stable ones.

    Parameters
    ----------
    of
        From `sprung.modes` with ``diagram=True``, all of it or one load; or a result, from whose decays the diagram is made.
    load
        Its name, where there are several; the first one unless given.
    axes
        Into which it is drawn; a new figure unless given.

    Returns
    -------
    Axes
        Order over Hz.

    Raises
    ------
    InputError
        If there is no such load, the modes were computed without a diagram, or the result has no free decay.
    """
    name, diagram = _diagram(of, load)
    [drawn] = draw(stability_picture(name, diagram), None if axes is None else [axes])
    return drawn


def mode(result: Result, name: str, load: str | None = None, *, phase: float = 0.0, axes: Axes | None = None) -> Axes:
    """Draw a mode shape of the identified vehicle as a wire frame, at rest and displaced.

    Parameters
    ----------
    result
        From `sprung.identify` or `sprung.load`.
    name
        Such as ``body bounce``.
    load
        On the vehicle; the first one unless given.
    phase
        Of the vibration, rad; at 0 the node with the largest motion is at its top.
    axes
        Into which it is drawn; a new figure unless given.

    Returns
    -------
    Axes
        Without scales: a mode shape has no amplitude.

    Raises
    ------
    InputError
        If there is no such mode or load, the phase is not finite, or the result was rejected.
    """
    if result.verdict.state == "reject":
        do = "Read result.verdict.reasons; sprung.modes finds modes without a vehicle model."
        raise InputError([Problem(f"mode {name}", "a rejected result, which has no modes", "accept or doubtful", do)])
    if not np.isfinite(phase):
        raise InputError([Problem("phase", f"{phase:g}", "a finite angle in rad", "Give a number, such as 0.")])
    load = check_name(load or next(iter(result.modes)), list(result.modes), "load")
    modes = {mode.name: mode for mode in result.modes[load]}
    shown = modes[check_name(name, list(modes), "mode")]
    car, axes = wire_frame(result), axes_or_new(axes)
    rise = (car.swing(shown.motion) * np.exp(1j * phase)).real
    moved = car.places - np.stack([np.zeros(len(rise)), rise], axis=1)
    for i, j in car.nodes.edges:
        axes.plot(*car.places[[i, j]].T, color=LIGHT["measured"], lw=0.8, ls="--")
        axes.plot(*moved[[i, j]].T, color=LIGHT["text"], lw=1.4)
    for i, j in car.nodes.struts:
        axes.plot(*moved[[i, j]].T, color=LIGHT["simulated"], lw=1.6)
    around = np.linspace(0, 2 * np.pi, 60)
    for node, radius in car.circles:
        circle = radius * np.stack([np.cos(around), np.sin(around)])
        axes.plot(*(car.places[node][:, None] + circle), color=LIGHT["measured"], lw=0.8, ls="--")
        axes.plot(*(moved[node][:, None] + circle), color=LIGHT["residual"], lw=1.4)
    axes.set_aspect("equal")
    axes.set(xlim=(0, car.width), ylim=(car.height, 0))
    axes.set_axis_off()
    frequency = "not determined" if shown.frequency_std is None else f"{shown.frequency:.4g} Hz"
    axes.set_title(f"{name}, {load}: {frequency}", fontsize=9, parse_math=False)
    return axes


def _decays(result: Result, load: str | None, free: bool = False) -> LoadDecays:
    """Return the records of a load, its free decays where there are any; only these if `free`."""
    by_load: dict[str, LoadDecays] = {}
    for decays in decays_by_load(result):
        if not (free and decays.is_driven):
            by_load.setdefault(decays.load, decays)
    if free and not by_load and result.series:
        do = "Record drops, pushes or passes: poles of free decays need no vehicle model."
        raise InputError([Problem("result", "forced responses on pads", "free decays", do)])
    if not by_load:
        raise InputError([Problem("result", "no series", "a result with its series", "Load it from its folder.")])
    return by_load[check_name(load or next(iter(by_load)), list(by_load), "load")]


def _diagram(
    of: LoadModes | Mapping[str, LoadModes] | StabilisationDiagram | Result, load: str | None
) -> tuple[str, StabilisationDiagram]:
    match of:
        case StabilisationDiagram():
            return load or "", of
        case Result():
            decays = _decays(of, load, free=True)
            records = [record - record.mean(axis=1, keepdims=True) for record in decays.measured]
            return decays.load, stabilisation_diagram(records, decays.rate)
        case LoadModes():
            if of.diagram is None:
                do = "Call sprung.modes with diagram=True."
                raise InputError([Problem("modes", "no diagram", "modes with a stabilisation diagram", do)])
            return load or ", ".join(of.drops), of.diagram
        case _:
            name = check_name(load or next(iter(of)), list(of), "load")
            return _diagram(of[name], name)

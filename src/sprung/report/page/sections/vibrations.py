"""Spectra, stabilisation, modes, and modes against amplitude."""

from __future__ import annotations

from sprung.errors import InputError
from sprung.modal import stabilisation_diagram
from sprung.report.excitations import records_text
from sprung.report.page.animation import mode_drawings, wire_json
from sprung.report.page.sections.context import Context
from sprung.report.pictures.amplitudes import amplitude_pictures
from sprung.report.pictures.decays import decays_by_load
from sprung.report.pictures.spectra import spectra_picture
from sprung.report.pictures.stability import stability_picture
from sprung.report.pictures.wire_frame import wire_frame
from sprung.report.terminal.validation import AMPLITUDES, amplitude_table
from sprung.results import Result, modes_table


def spectra(result: Result) -> Context | None:
    """Return the spectra of every load, with the identified modes."""
    pictures = [spectra_picture(decays, result.modes[decays.load]) for decays in decays_by_load(result)]
    lines = "" if result.verdict.state == "reject" else " Lines: damped frequencies of the identified modes."
    fitted = [drop for drop in result.drops if drop.name in result.series]
    text = f"Spectra of the {records_text(fitted)}, mean over drops and sensors: measured, and of the fitted vehicle.{lines}"
    return {"text": text, "pictures": pictures} if pictures else None


def stabilisation(result: Result) -> Context | None:
    """Return the stabilisation diagram of the free decays of every load, which needs no vehicle model."""
    pictures, notes = [], []
    for decays in decays_by_load(result):
        if decays.is_driven:
            continue
        try:
            records = [record - record.mean(axis=1, keepdims=True) for record in decays.measured]
            pictures.append(stability_picture(decays.load, stabilisation_diagram(records, decays.rate)))
        except InputError as error:
            notes += [f"{decays.load}: no diagram can be drawn ({problem.found})." for problem in error.problems]
    text = (
        "Poles of state-space models of increasing order, fitted to the free decays without a vehicle model. Lines mark the "
        "poles that are stable from order to order. Wheel modes that the noise does not resolve appear as one."
    )
    return {"text": text, "pictures": pictures, "notes": notes} if pictures or notes else None


def modes(result: Result) -> Context:
    """Return the mode shapes of the identified vehicle, animated, and the tables of modes."""
    load, first = next(iter(result.modes.items()), ("", ()))
    car = wire_frame(result)
    if result.verdict.state == "reject":
        return {"why_not": "the verdict is reject; sprung modal finds modes without a vehicle model"}
    shaped = [mode for mode in first if mode.frequency_std is not None]
    return {
        "cars": list(mode_drawings(car, shaped)),
        "wire": wire_json(car),
        "load": load,
        "missing": ", ".join(mode.name for mode in first if mode.frequency_std is None),
        "tables": [modes_table(load, modes) for load, modes in result.modes.items()],
    }


def amplitude(result: Result) -> Context | None:
    """Return frequency and damping of the body's modes against amplitude."""
    if not result.amplitude:
        return None
    load = result.amplitude[0].load
    text = (
        f"Body modes, {load}. {AMPLITUDES} The frequency of a linear vehicle does not depend on the amplitude; with dry "
        "friction it rises as the motion decays."
    )
    pictures = amplitude_pictures(result.amplitude)
    return {"text": text, "pictures": pictures, "tables": [amplitude_table(load, result.amplitude)]}

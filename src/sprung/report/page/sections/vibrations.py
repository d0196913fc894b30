"""Spectra, stabilisation, modes, and modes against amplitude."""

from __future__ import annotations

from sprung.errors import InputError
from sprung.modal import stabilisation_diagram
from sprung.report.page.animation import cars_of, wire_json
from sprung.report.page.sections.context import Context
from sprung.report.pictures.amplitudes import amplitude_pictures
from sprung.report.pictures.decays import decays_by_load
from sprung.report.pictures.spectra import spectra_picture
from sprung.report.pictures.stability import stability_picture
from sprung.report.pictures.wire_car import wire_car
from sprung.report.terminal.validation import AMPLITUDES, amplitude_table
from sprung.results import Result, modes_table


def spectra(result: Result) -> Context | None:
    """Show the spectra of every load, with the identified modes."""
    pictures = [spectra_picture(one, result.modes[one.load]) for one in decays_by_load(result)]
    lines = "" if result.verdict.state == "reject" else " Lines: the damped frequencies of the identified modes."
    said = f"Spectra of the decays, in the mean over drops and sensors, and those of the fitted vehicle.{lines}"
    return {"said": said, "pictures": pictures} if pictures else None


def stabilisation(result: Result) -> Context | None:
    """Show poles over the order of a model that knows nothing of vehicles."""
    pictures, notes = [], []
    for one in decays_by_load(result):
        try:
            records = [record - record.mean(axis=1, keepdims=True) for record in one.measured]
            pictures.append(stability_picture(one.load, stabilisation_diagram(records, one.rate)))
        except InputError as error:
            notes += [f"{one.load}: no diagram can be drawn ({problem.found})." for problem in error.problems]
    said = (
        "State-space models of increasing order, fitted to the decays without a vehicle model. The poles of a mode keep their "
        "frequency from order to order; a vertical line marks each. Wheel modes closer than the noise resolves appear as one."
    )
    return {"said": said, "pictures": pictures, "notes": notes} if pictures or notes else None


def modes(result: Result) -> Context:
    """Show the modes of the identified vehicle, moving, and their tables."""
    load, first = next(iter(result.modes.items()), ("", ()))
    car = wire_car(result)
    if result.verdict.state == "reject":
        return {"why_not": "the verdict is reject; `sprung modal` finds modes without a vehicle model"}
    shaped = [mode for mode in first if mode.frequency_std is not None]
    return {
        "cars": list(cars_of(car, shaped)),
        "wire": wire_json(car),
        "load": load,
        "missing": ", ".join(mode.name for mode in first if mode.frequency_std is None),
        "tables": [modes_table(load, modes) for load, modes in result.modes.items()],
    }


def amplitude(result: Result) -> Context | None:
    """Show equivalent frequency and damping of the body's modes against amplitude."""
    if not result.amplitude:
        return None
    load = result.amplitude[0].load
    said = (
        f"Body modes, {load}. {AMPLITUDES} A linear vehicle has one frequency at every amplitude; where springs rub, the "
        "frequency rises as the motion dies."
    )
    pictures = amplitude_pictures(result.amplitude)
    return {"said": said, "pictures": pictures, "tables": [amplitude_table(load, result.amplitude)]}

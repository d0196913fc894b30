"""Modal analysis of the records of one load: modes, names, spectral peaks, amplitude dependence, stabilisation diagram."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import UNNAMED
from sprung.modal import (
    APPROXIMATE,
    AmplitudeDependence,
    ModeSet,
    amplitude_dependence,
    confirm_modes,
    find_spectral_peaks,
    identify_modes,
    modal_phase_collinearity,
    stabilisation_diagram,
)
from sprung.modal_survey.load_modes import IdentifiedMode, LoadModes
from sprung.progress import Progress, Step, silent
from sprung.vehicle import Sensor
from sprung.vibration import Mode, name_modes_at_sensors, paper_name

Real = NDArray[np.float64]


def modal_analysis(
    records: Sequence[Real],
    rate: float,
    method: str,
    order: int | None,
    channels: tuple[str, ...],
    drops: tuple[str, ...],
    *,
    sensors: Sequence[Sensor] = (),
    a: float | None = None,
    amplitude: bool = False,
    diagram: bool = False,
    load: str = "",
    progress: Progress = silent,
) -> LoadModes:
    """Identify the modes of the records of one load.

    Parameters
    ----------
    records
        Shape (channel, time) each.
    rate
        Samples per second.
    method, order, amplitude, diagram
        As for `modes`.
    channels, drops
        Names of channels and records.
    sensors
        Places of the channels, from which modes are named; without sensors modes are numbered.
    a
        Front axle to the body's centre of gravity, m, if known.
    load
        Name of the load, for the messages of progress.
    progress
        Called with each step that begins.

    Returns
    -------
    LoadModes
    """
    of_load = f" of load {load}" if load else ""
    progress(Step(f"identifying the modes{of_load}"))
    identified = identify_modes(records, rate, method, order)
    stabilisation = stabilisation_diagram(records, rate) if diagram else None
    # Without a campaign nothing else distinguishes a spurious mode.
    if not sensors and order is None and method not in APPROXIMATE:
        identified = confirm_modes(identified, records, rate, stabilisation)
    if sensors:
        names = _names(identified, name_modes_at_sensors(identified, sensors, a))
    else:
        names = [f"mode {number}" for number in range(1, len(identified) + 1)]
    peaks = find_spectral_peaks(records, rate, identified)
    if amplitude:
        progress(Step(f"following the modes{of_load} through the decays"))
    dependences = amplitude_dependence(records, rate, identified) if amplitude else ()
    dependence_of = {id(dependence.mode): dependence for dependence in dependences}
    modes = tuple(
        _with_amplitudes(_identified_mode(mode, name, peak), dependence_of.get(id(mode)))
        for mode, name, peak in zip(identified, names, peaks, strict=True)
    )
    if diagram:
        progress(Step(f"computing the stabilisation diagram{of_load}"))
    rejected = tuple((pole.pole, pole.reason) for pole in identified.rejected)
    unresolved = _unresolved(modes, sensors, len(drops))
    return LoadModes(modes, method, channels, drops, rejected, unresolved, stabilisation)


def _names(identified: ModeSet, named: Sequence[Mode]) -> list[str]:
    """Return the names of named modes in the order of the identified ones."""
    remaining = list(named)
    names = []
    for mode in identified:
        position = next(i for i, candidate in enumerate(remaining) if candidate.pole == mode.pole)
        names.append(remaining.pop(position).name or UNNAMED)
    return names


def _unresolved(modes: Sequence[IdentifiedMode], sensors: Sequence[Sensor], drops: int) -> tuple[str, ...]:
    """Return a sentence for modes that the records do not determine, and one for wheel modes that they do not separate."""
    sentences = []
    undetermined = [mode for mode in modes if mode.status == "unresolved"]
    if undetermined:
        names = ", ".join(f"{mode.name} near {mode.frequency:.3g} Hz" for mode in undetermined)
        sentences.append(f"These records do not determine {names}: other drops, or less noise, would.")
    wheels = len({sensor.on for sensor in sensors} - {"body"})
    wheel_modes = [mode for mode in modes if not mode.name.startswith("body")]
    if len(wheel_modes) < wheels:
        shown = "1 drop of this load shows" if drops == 1 else f"{drops} drops of this load show"
        sentences.append(
            f"{wheels} wheels have {wheels} modes of hop and tramp, of which {shown} {len(wheel_modes)}: each may stand for "
            "several close ones, and its name for one of them. Drops of other wheels would separate them."
        )
    return tuple(sentences)


def _identified_mode(mode: Mode, name: str, peak: float | None) -> IdentifiedMode:
    resolved, uncertainty = mode.is_resolved, mode.uncertainty
    return IdentifiedMode(
        name=name,
        paper_name=paper_name(name),
        pole=(mode.pole.real, mode.pole.imag),
        frequency=mode.frequency,
        frequency_std=mode.frequency_std if resolved else None,
        damped_frequency=mode.damped_frequency,
        damping_ratio=mode.damping_ratio,
        damping_ratio_std=mode.damping_ratio_std if resolved else None,
        damped_frequency_std=mode.damped_frequency_std if resolved else None,
        fft_frequency=peak,
        fft_difference=None if peak is None else 100 * (peak / mode.damped_frequency - 1),
        shape=_pairs(mode.shape),
        shape_std=_pairs(uncertainty.shape) if uncertainty is not None and resolved else None,
        collinearity=float(modal_phase_collinearity(mode.shape)),
        status="resolved" if resolved else "unresolved",
    )


def _with_amplitudes(mode: IdentifiedMode, dependence: AmplitudeDependence | None) -> IdentifiedMode:
    if dependence is None:
        return mode
    columns = (
        *(dependence.amplitude, dependence.frequency, dependence.frequency_std),
        *(dependence.damping_ratio, dependence.damping_ratio_std),
    )
    trend = dependence.frequency_trend
    return replace(
        mode,
        amplitudes=tuple(tuple(row) for row in np.column_stack(columns).tolist()),
        frequency_trend=None if trend is None else (100 * trend[0], 100 * trend[1]),
        damping_trend=dependence.damping_trend,
    )


def _pairs(values: NDArray[np.complex128]) -> tuple[tuple[float, float], ...]:
    return tuple((float(value.real), float(value.imag)) for value in values)

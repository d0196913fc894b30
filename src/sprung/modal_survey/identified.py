"""What is said of modes that were found without a vehicle model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.estimation import UNNAMED, ModeEstimate
from sprung.modal import (
    APPROXIMATE,
    AmplitudeDependence,
    ModeSet,
    StabilisationDiagram,
    amplitude_dependence,
    confirm_modes,
    find_spectral_peaks,
    identify_modes,
    modal_phase_collinearity,
    stabilisation_diagram,
)
from sprung.modal_survey.table import found_modes_table
from sprung.progress import Progress, Step, silent
from sprung.tables import Table, escaped
from sprung.vehicle import Sensor
from sprung.vibration import Mode, name_modes_at_sensors, paper_name

Real = NDArray[np.float64]


@shown
@dataclass(frozen=True)
class IdentifiedMode(ModeEstimate):
    """One mode found in the records, without a vehicle model.

    Attributes
    ----------
    damped_frequency_std
        Hz; None where the method does not tell, or the records do not determine the mode, as all other uncertainties.
    fft_frequency, fft_difference
        Where the Fourier transform has its peak, Hz, and by how much that differs from `damped_frequency`, %: the paper's
        Table 3; None where there is no peak.
    shape, shape_std
        At the channels, largest entry 1: real and imaginary part of each, and their standard uncertainties.
    collinearity
        Modal phase collinearity of the shape, dimensionless: 1 where all channels move in phase or in opposition.
    status
        "resolved", or "unresolved" where the records do not determine the mode on its own.
    amplitudes
        Where it was asked for, the mode in windows of the records, the largest amplitude first: amplitude at the channel that
        moves most, m/s², frequency and its standard uncertainty, Hz, damping ratio and its own.
    frequency_trend, damping_trend
        Change of the frequency, %, and of the damping ratio with ten times the amplitude, each with its standard uncertainty;
        None where it was not asked for or not told.
    """

    damped_frequency_std: float | None = None
    fft_frequency: float | None = None
    fft_difference: float | None = None
    shape: tuple[tuple[float, float], ...] = ()
    shape_std: tuple[tuple[float, float], ...] | None = None
    collinearity: float = 1.0
    status: str = "resolved"
    amplitudes: tuple[tuple[float, ...], ...] = ()
    frequency_trend: tuple[float, float] | None = None
    damping_trend: tuple[float, float] | None = None


@shown
@dataclass(frozen=True, eq=False)
class LoadModes(Sequence[IdentifiedMode]):
    """The modes of one load, a sequence in the order of undamped natural frequency.

    Attributes
    ----------
    modes
        The modes.
    method
        By which they were found.
    channels
        In the order of the shapes.
    drops
        Short names of the drops that were used.
    rejected
        What was met and is no mode: pole, 1/s, and why not.
    unresolved
        What the records cannot tell apart, one sentence each.
    diagram
        Poles over the order of a model, where it was asked for.
    """

    modes: tuple[IdentifiedMode, ...]
    method: str
    channels: tuple[str, ...]
    drops: tuple[str, ...]
    rejected: tuple[tuple[complex, str], ...] = ()
    unresolved: tuple[str, ...] = ()
    diagram: StabilisationDiagram | None = None

    @overload
    def __getitem__(self, index: int) -> IdentifiedMode: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[IdentifiedMode, ...]: ...
    def __getitem__(self, index: int | slice) -> IdentifiedMode | tuple[IdentifiedMode, ...]:
        """Give one mode, or several."""
        return self.modes[index]

    def __len__(self) -> int:
        """Count the modes."""
        return len(self.modes)

    def __iter__(self) -> Iterator[IdentifiedMode]:
        """Go through the modes."""
        return iter(self.modes)

    def table(self, load: str) -> Table:
        """Show them as a table.

        Parameters
        ----------
        load
            What the load is called.
        """
        return found_modes_table(load, self.method, len(self.drops), self.modes)

    def _repr_html_(self) -> str:
        """Show them in a notebook."""
        return self.table(", ".join(self.drops)).html() + "".join(f"<p>{escaped(one)}</p>\n" for one in self.unresolved)

    def document(self) -> dict[str, Any]:
        """Say for machines how the modes were found."""
        return {
            "method": self.method,
            "channels": list(self.channels),
            "drops": list(self.drops),
            "rejected": [{"pole": [pole.real, pole.imag], "reason": reason} for pole, reason in self.rejected],
            "unresolved": list(self.unresolved),
            "diagram": None if self.diagram is None else _diagram_document(self.diagram),
        }


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
    """Identify the modes of some records and everything that is said of them.

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
        Where the channels are, by which modes are named; without any they are numbered.
    a
        Front axle to the body's centre of gravity, m, if known.
    load
        On the vehicle, for what is told of the steps.
    progress
        Called with each step that begins.
    """
    of_load = f" of load {load}" if load else ""
    progress(Step(f"identifying the modes{of_load}"))
    found = identify_modes(records, rate, method, order)
    drawn = stabilisation_diagram(records, rate) if diagram else None
    # Of recordings alone nothing else is known by which an invented mode would stand out.
    if not sensors and order is None and method not in APPROXIMATE:
        found = confirm_modes(found, records, rate, drawn)
    names = (
        _names(found, name_modes_at_sensors(found, sensors, a))
        if sensors
        else [f"mode {i + 1}" for i in range(len(found))]
    )
    peaks = find_spectral_peaks(records, rate, found)
    if amplitude:
        progress(Step(f"following the modes{of_load} through the decays"))
    traces = {id(trace.mode): trace for trace in amplitude_dependence(records, rate, found)} if amplitude else {}
    estimates = tuple(
        _followed(_estimate(mode, name, peak), traces.get(id(mode)))
        for mode, name, peak in zip(found, names, peaks, strict=True)
    )
    if diagram:
        progress(Step(f"computing the stabilisation diagram{of_load}"))
    return LoadModes(
        estimates,
        method,
        channels,
        drops,
        tuple((one.pole, one.reason) for one in found.rejected),
        _unresolved(estimates, sensors, len(drops)),
        drawn,
    )


def _diagram_document(diagram: StabilisationDiagram) -> dict[str, Any]:
    return {
        "criteria": asdict(diagram.criteria),
        "orders": list(diagram.orders),
        "poles": [
            {
                "order": one.order,
                "pole": [one.pole.real, one.pole.imag],
                "stable": one.stable,
                "coherence": one.coherence,
                "collinearity": one.collinearity,
            }
            for one in diagram.poles
        ],
        "chosen": [
            {"pole": [one.pole.real, one.pole.imag], "scatter": one.scatter, "first": one.first, "count": one.count}
            for one in diagram.chosen
        ],
        "rejected": [{"pole": [one.pole.real, one.pole.imag], "reason": one.reason} for one in diagram.rejected],
    }


def _names(found: ModeSet, named: Sequence[Mode]) -> list[str]:
    """Bring names into the order of the modes they were given to."""
    left = list(named)
    names = []
    for mode in found:
        own = next(i for i, one in enumerate(left) if one.pole == mode.pole)
        names.append(left.pop(own).name or UNNAMED)
    return names


def _unresolved(modes: Sequence[IdentifiedMode], sensors: Sequence[Sensor], drops: int) -> tuple[str, ...]:
    """Say what these records cannot tell apart."""
    said = []
    unsure = [mode for mode in modes if mode.status == "unresolved"]
    if unsure:
        names = ", ".join(f"{mode.name} near {mode.frequency:.3g} Hz" for mode in unsure)
        said.append(f"These records do not determine {names}: other drops, or less noise, would.")
    wheels = len({sensor.on for sensor in sensors} - {"body"})
    told = [mode for mode in modes if not mode.name.startswith("body")]
    if len(told) < wheels:
        these = "1 drop of this load shows" if drops == 1 else f"{drops} drops of this load show"
        said.append(
            f"{wheels} wheels have {wheels} modes of hop and tramp, of which {these} {len(told)}: each may stand for several "
            "close ones, and its name for one of them. Drops of other wheels would separate them."
        )
    return tuple(said)


def _estimate(mode: Mode, name: str, peak: float | None) -> IdentifiedMode:
    told = mode.resolved
    spread = mode.uncertainty
    return IdentifiedMode(
        name=name,
        paper_name=paper_name(name),
        pole=(mode.pole.real, mode.pole.imag),
        frequency=mode.frequency,
        frequency_std=mode.frequency_std if told else None,
        damped_frequency=mode.damped_frequency,
        damping_ratio=mode.damping_ratio,
        damping_ratio_std=mode.damping_ratio_std if told else None,
        damped_frequency_std=mode.damped_frequency_std if told else None,
        fft_frequency=peak,
        fft_difference=None if peak is None else 100 * (peak / mode.damped_frequency - 1),
        shape=_pairs(mode.shape),
        shape_std=_pairs(spread.shape) if spread is not None and told else None,
        collinearity=float(modal_phase_collinearity(mode.shape)),
        status="resolved" if told else "unresolved",
    )


def _followed(mode: IdentifiedMode, trace: AmplitudeDependence | None) -> IdentifiedMode:
    if trace is None:
        return mode
    columns = trace.amplitude, trace.frequency, trace.frequency_std, trace.damping_ratio, trace.damping_ratio_std
    shift = trace.frequency_trend
    return replace(
        mode,
        amplitudes=tuple(tuple(row) for row in np.column_stack(columns).tolist()),
        frequency_trend=None if shift is None else (100 * shift[0], 100 * shift[1]),
        damping_trend=trace.damping_trend,
    )


def _pairs(values: NDArray[np.complex128]) -> tuple[tuple[float, float], ...]:
    return tuple((float(value.real), float(value.imag)) for value in values)

"""Tables of the reproduction: what the paper prints beside what is computed here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from sprung.display import shown
from sprung.paper.misprints import Misprint


@shown
@dataclass(frozen=True, slots=True)
class ParameterRow:
    """One row of Table 2, or of the bus.

    Attributes
    ----------
    name, unit
        Of the parameter.
    known
        Simulated value, SI.
    paper
        Identified value that the paper prints, SI.
    identified
        Value identified here, SI.
    given
        Whether it was known beforehand.
    """

    name: str
    unit: str
    known: float
    paper: float
    identified: float
    given: bool = False

    @property
    def error_percent(self) -> float:
        """Error of the value identified here, %."""
        return 100 * (self.identified / self.known - 1)


@shown
@dataclass(frozen=True, slots=True)
class ModalValues:
    """Frequencies and damping ratio of a mode.

    Attributes
    ----------
    natural_frequency, damped_frequency
        Hz.
    damping_ratio
        Dimensionless.
    """

    natural_frequency: float
    damped_frequency: float
    damping_ratio: float


@shown
@dataclass(frozen=True, slots=True)
class ModeRow:
    """One row of Table 3: values in the paper and of the model of Tables 4 and 5.

    Attributes
    ----------
    mode
        Name by its shape.
    paper_name
        Name in the paper.
    paper
        Printed values.
    computed
        Values of the model of Tables 4 and 5.
    """

    mode: str
    paper_name: str
    paper: ModalValues
    computed: ModalValues


@shown
@dataclass(frozen=True, slots=True)
class NoisePoint:
    """Largest error of any parameter at one level of sensor noise; medians over seeds, %.

    Attributes
    ----------
    noise
        m/s² rms in every channel.
    paper_method
        Of the paper's method.
    joint_fit
        Of the joint fit to the same recordings; None without one.
    """

    noise: float
    paper_method: float
    joint_fit: float | None


@shown
@dataclass(frozen=True, slots=True)
class PaperReproduction:
    """The reproduction of the paper.

    Attributes
    ----------
    table2
        The simulation: Table 1 car, identified from noise-free recordings of one bump.
    table3
        The school bus: modal parameters.
    bus
        Table 5's bus, identified from noise-free simulated drops with the paper's load on the body alone.
    misprints
        Errors in the printed paper.
    noise
        Sensitivity of the paper's method to noise.
    """

    table2: tuple[ParameterRow, ...]
    table3: tuple[ModeRow, ...]
    bus: tuple[ParameterRow, ...]
    misprints: tuple[Misprint, ...]
    noise: tuple[NoisePoint, ...]

    def document(self) -> dict[str, Any]:
        """Return everything as plain values, with the errors in percent, for ``--json``."""

        def rows(table: Sequence[ParameterRow]) -> list[dict[str, Any]]:
            return [{**asdict(row), "error_percent": row.error_percent} for row in table]

        return {**asdict(self), "table2": rows(self.table2), "bus": rows(self.bus)}

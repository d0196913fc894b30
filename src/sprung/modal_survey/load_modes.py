"""The modes of one load, identified without a vehicle model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.estimation import ModeEstimate
from sprung.modal import (
    StabilisationDiagram,
)
from sprung.modal_survey.table import identified_modes_table
from sprung.tables import Table, escaped

Real = NDArray[np.float64]


@shown
@dataclass(frozen=True)
class IdentifiedMode(ModeEstimate):
    """A mode identified from records, without a vehicle model.

    Attributes
    ----------
    damped_frequency_std
        Hz; None where the method gives none or the records do not determine the mode, as for all other uncertainties.
    fft_frequency, fft_difference
        Peak of the Fourier transform, Hz, and its difference from `damped_frequency`, %: the paper's Table 3; None where there
        is no peak.
    shape, shape_std
        At the channels, largest entry 1: real and imaginary part of each, and their standard uncertainties.
    collinearity
        Modal phase collinearity of the shape, dimensionless: 1 where all channels move in phase or in opposition.
    status
        "resolved", or "unresolved" where the records do not determine the mode on its own.
    amplitudes
        On request, the mode in windows of the records, the largest amplitude first: amplitude at the channel that moves most,
        m/s², frequency and its standard uncertainty, Hz, damping ratio and its own.
    frequency_trend, damping_trend
        Change of the frequency, %, and of the damping ratio with ten times the amplitude, each with its standard uncertainty;
        None where not requested or not determined.
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
        Name of the method.
    channels
        Names, in the order of the shapes.
    drops
        Short names of the drops that were used.
    rejected
        Poles that were not accepted as modes: pole, 1/s, and reason.
    unresolved
        Modes that the records do not determine or separate, one sentence each.
    diagram
        The stabilisation diagram, on request.
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
        """Return one mode, or several."""
        return self.modes[index]

    def __len__(self) -> int:
        """Return the number of modes."""
        return len(self.modes)

    def __iter__(self) -> Iterator[IdentifiedMode]:
        """Iterate over the modes."""
        return iter(self.modes)

    def table(self, load: str) -> Table:
        """Return the modes as a table.

        Parameters
        ----------
        load
            Name of the load.
        """
        return identified_modes_table(load, self.method, len(self.drops), self.modes)

    def _repr_html_(self) -> str:
        """Return the table for a notebook."""
        return self.table(", ".join(self.drops)).html() + "".join(
            f"<p>{escaped(sentence)}</p>\n" for sentence in self.unresolved
        )

    def document(self) -> dict[str, Any]:
        """Return how the modes were identified, for machines."""
        return {
            "method": self.method,
            "channels": list(self.channels),
            "drops": list(self.drops),
            "rejected": [{"pole": [pole.real, pole.imag], "reason": reason} for pole, reason in self.rejected],
            "unresolved": list(self.unresolved),
            "diagram": None if self.diagram is None else _diagram_document(self.diagram),
        }


def _diagram_document(diagram: StabilisationDiagram) -> dict[str, Any]:
    return {
        "criteria": asdict(diagram.criteria),
        "orders": list(diagram.orders),
        "poles": [
            {
                "order": pole.order,
                "pole": [pole.pole.real, pole.pole.imag],
                "stable": pole.stable,
                "coherence": pole.coherence,
                "collinearity": pole.collinearity,
            }
            for pole in diagram.poles
        ],
        "chosen": [
            {"pole": [cluster.pole.real, cluster.pole.imag]}
            | {"scatter": cluster.scatter, "first": cluster.first, "count": cluster.count}
            for cluster in diagram.chosen
        ],
        "rejected": [{"pole": [pole.pole.real, pole.pole.imag], "reason": pole.reason} for pole in diagram.rejected],
    }

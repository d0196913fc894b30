"""The result: everything an identification gives, one frozen record, and its way to a folder and back."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from sprung.errors import Fault
from sprung.estimate import Estimate
from sprung.identification import Correlation, Inflater, ModeEstimate, Scale, Unidentifiable
from sprung.pipeline.check import DropReport
from sprung.pipeline.extras import Attempt
from sprung.pipeline.seals import SEALS, arrays_seal, document_seal
from sprung.recording import write_whole
from sprung.validation import DropValidation, Verdict

SCHEMA: Literal[1] = 1
"""Version of results.json; a change that an old reader would misread raises it."""


@dataclass(frozen=True, eq=False)
class Series:
    """What the figures draw of one drop.

    Attributes
    ----------
    channels
        Channel names.
    time
        On the file's own clock, s, shape (time,).
    measured, fitted
        m/s², positive up, shape (channel, time); NaN in channels that were left out.
    """

    channels: tuple[str, ...]
    time: NDArray[np.float64]
    measured: NDArray[np.float64]
    fitted: NDArray[np.float64]


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class VehicleName(_Frozen):
    """Whose result it is."""

    name: str


class FitReport(_Frozen):
    """How the fit went.

    Attributes
    ----------
    samples, drops
        Samples (over all channels) and drops that were fitted.
    noise
        Estimated noise of each channel, m/s² root-mean-square.
    model
        Extras beyond the paper's seven degrees of freedom.
    tracks
        Whether springs and dampers of an axle share their half-distance.
    why
        What decided that.
    axes
        About which axes the inertias are; empty where an older sprung wrote the result.
    since
        Whether drops were used from their release on, or from when the last tyre was down.
    path
        What was tried on the way to the model, and what it gained; empty where an older sprung wrote the result.
    method
        What estimated it.
    iterations, converged, starts, starts_agreeing
        Steps from the winning start, whether the last one promised nothing more, and how many starts ended alike.
    inflation
        By how much coloured residuals, or drops that contradict each other, enlarged every variance: a factor, 1 for neither.
    inflated_by
        Which of them; None where an older sprung wrote the result.
    most_coloured
        The channel whose residuals are most coloured, where they enlarged the variances.
    misfit
        Model error of each channel as a part of its signal; 0 where none is significant.
    """

    samples: int
    drops: int
    noise: dict[str, float]
    model: tuple[str, ...]
    tracks: Literal["shared", "separate"]
    why: str
    axes: str = ""
    since: Literal["release", "landing"] = "landing"
    path: tuple[Attempt, ...] = ()
    method: str
    iterations: int
    converged: bool
    starts: int
    starts_agreeing: int
    inflation: float
    inflated_by: Inflater | None = None
    most_coloured: str | None = None
    misfit: dict[str, float]


class Result(_Frozen):
    """Everything an identification gives; the contract's results.json, and the series beside it.

    Attributes
    ----------
    schema_version, version
        Of results.json, and of the sprung that wrote it.
    vehicle
        Whose result it is.
    verdict
        ``state`` and ``reasons``.
    parameters
        By name: value, std, interval95, unit, status, interval_from.
    derived
        The same of derived quantities: those whose profile was asked for, such as ``total_mass``, and ``I_xx_roll_axis``, the
        roll inertia about the axis of roll, where its height is given.
    scale
        Whether absolute scale is known, and what is left without it.
    unidentifiable
        Combinations that the data do not determine.
    correlation
        Of the estimated parameters.
    modes
        By load: the modes of the identified vehicle, lowest first.
    fit, drops, faults
        How the fit went, what was used of each drop, and what was wrong.
    validation
        By drop name: how well the fitted vehicle explains the drop, and how well the other drops predict it; empty where an
        older sprung wrote the result.
    next_step
        What to measure next, in a sentence; None where the verdict is reject, or an older sprung wrote the result.
    series
        By drop name: what the figures draw.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True, populate_by_name=True)

    schema_version: Literal[1] = Field(default=SCHEMA, alias="schema")
    version: str = Field(alias="sprung")
    vehicle: VehicleName
    verdict: Verdict
    parameters: dict[str, Estimate]
    derived: dict[str, Estimate] = Field(default_factory=dict)
    scale: Scale
    unidentifiable: tuple[Unidentifiable, ...]
    correlation: Correlation
    modes: dict[str, tuple[ModeEstimate, ...]]
    fit: FitReport
    drops: tuple[DropReport, ...]
    faults: tuple[Fault, ...]
    validation: dict[str, DropValidation] = Field(default_factory=dict)
    next_step: str | None = None
    series: Mapping[str, Series] = Field(default_factory=dict, exclude=True, repr=False)

    def to_json(self) -> str:
        """Write the contract's results.json as text, with the checksums by which `sprung.load` knows that nobody changed it."""
        document = self.model_dump(mode="json", by_alias=True)
        seals = {"document": document_seal(document), "series": arrays_seal(self._arrays())}
        return json.dumps({**document, SEALS: seals}, indent=2, ensure_ascii=False, allow_nan=False) + "\n"

    def save(self, folder: str | Path) -> Path:
        """Write results.json and series.npz, whole or not at all.

        Parameters
        ----------
        folder
            Made if it is missing.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        InputError
            If the folder cannot be written.
        """
        write_whole(Path(folder), {"series.npz": packed(self._arrays()), "results.json": self.to_json().encode()})
        return Path(folder)

    def _arrays(self) -> dict[str, NDArray[Any]]:
        arrays: dict[str, NDArray[Any]] = {}
        for name, series in self.series.items():
            arrays[f"{name}/channels"] = np.array(series.channels)
            arrays[f"{name}/time"] = series.time
            arrays[f"{name}/measured"] = series.measured
            arrays[f"{name}/fitted"] = series.fitted
        return arrays


def packed(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Give the bytes of an .npz file of arrays by name."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
    return buffer.getvalue()

"""The result: everything an identification gives, one frozen record, and its way to a folder and back."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from sprung.errors import Fault
from sprung.estimate import Estimate
from sprung.identification import Correlation, Inflater, ModeEstimate, Scale, Unidentifiable
from sprung.pipeline.amplitude import Amplitudes
from sprung.pipeline.check import DropReport
from sprung.pipeline.displays import modes_table, parameters_table, ratios_table
from sprung.pipeline.seals import SEALS, arrays_seal, document_seal
from sprung.pipeline.series import Recorded, Series, arrays_of, packed
from sprung.pipeline.setup import Setup
from sprung.pipeline.way import Attempt
from sprung.recording import write_whole
from sprung.tables import escaped
from sprung.validation import DropValidation, Verdict

SCHEMA: Literal[1] = 1
"""Version of results.json; a change that an old reader would misread raises it."""


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
    setup
        What it began with: what was known, settings, files and versions; None where an older sprung wrote the result.
    amplitude
        Frequency and damping of the body's modes against amplitude; empty where it was not asked for.
    omissions
        What decorates a result and could not be made, a sentence each, such as the amplitude curves.
    series
        By drop name: what was fitted.
    recordings
        By drop name, of all drops: the whole recording.
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
    setup: Setup | None = None
    amplitude: Amplitudes = ()
    omissions: tuple[str, ...] = ()
    series: Mapping[str, Series] = Field(default_factory=dict, exclude=True, repr=False)
    recordings: Mapping[str, Recorded] = Field(default_factory=dict, exclude=True, repr=False)

    def _repr_html_(self) -> str:
        """Show the verdict, the parameters and the modes in a notebook."""
        parts = [
            self.verdict._repr_html_(),
            parameters_table(self.vehicle.name, {**self.parameters, **self.derived}).html(),
        ]
        parts += [f"<p>Not determined: {escaped(one.text)}.</p>\n" for one in self.unidentifiable]
        if not self.scale.known and self.scale.per_total_mass:
            parts.append(ratios_table(self.scale.per_total_mass).html())
        return "".join([*parts, *(modes_table(load, modes).html() for load, modes in self.modes.items())])

    def to_json(self) -> str:
        """Write the contract's results.json as text, with the checksums by which `sprung.load` knows that nobody changed it."""
        document = self.model_dump(mode="json", by_alias=True)
        seals = {"document": document_seal(document), "series": arrays_seal(arrays_of(self.series, self.recordings))}
        return json.dumps({**document, SEALS: seals}, indent=2, ensure_ascii=False, allow_nan=False) + "\n"

    def save(self, folder: str | Path, *, overwrite: bool = False) -> Path:
        """Write results.json and series.npz, whole or not at all.

        Parameters
        ----------
        folder
            Made if it is missing. Files that sprung wrote there are replaced.
        overwrite
            Whether other files of the same names, and files that were changed since sprung wrote them, are replaced too.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        InputError
            If such files would be overwritten, with their list, or the folder cannot be written.
        """
        write_whole(Path(folder), self.files(), overwrite=overwrite)
        return Path(folder)

    def files(self) -> dict[str, bytes]:
        """Give what `save` writes, by file name: series.npz and, last, results.json.

        Returns
        -------
        dict
            Content by name.
        """
        series = packed(arrays_of(self.series, self.recordings))
        return {"series.npz": series, "results.json": self.to_json().encode()}

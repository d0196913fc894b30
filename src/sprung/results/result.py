"""The result: everything an identification gives, one frozen record, and its way to a folder and back."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Field

from sprung.assessment import DropValidation, Verdict
from sprung.checking import DropReport, PlottedRecording
from sprung.display import shown
from sprung.errors import Fault
from sprung.estimation import Correlation, Inflater, ModeEstimate, Scale, Unidentifiable
from sprung.files import atomic_write
from sprung.results.amplitude import Amplitudes
from sprung.results.checksums import SEALS, arrays_seal, document_seal
from sprung.results.plain import plain_document
from sprung.results.series import Series, arrays_of, packed
from sprung.results.setup import Setup
from sprung.results.tables import characteristics_tables, modes_table, other_quantities, parameters_table, ratios_table
from sprung.results.vehicle import identified_vehicle
from sprung.selection import SelectionStep
from sprung.tables import escaped
from sprung.uncertainty import Covariance, Estimate, NamedValues
from sprung.vehicle import Vehicle

if TYPE_CHECKING:
    import pandas as pd

SCHEMA: Literal[1] = 1
"""Version of results.json; a change that an old reader would misread raises it."""


_EXACTLY = ConfigDict(extra="forbid", arbitrary_types_allowed=True)
"""How a saved result is checked when it is read: a key that it does not have is an error."""


@shown
@dataclass(frozen=True, slots=True, kw_only=True)
class TestedVehicle:
    """The vehicle that was tested.

    Attributes
    ----------
    name
        For people to read.
    identification
        Chassis, registration or test number, as the campaign file has it; None where it has none.
    """

    __pydantic_config__ = _EXACTLY

    name: str
    identification: str | None = None


@shown
@dataclass(frozen=True, slots=True, kw_only=True)
class FitReport:
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
    loglikelihood
        Natural logarithm of the likelihood at its maximum, of all samples and what was known with an uncertainty:
        -½ Σ (ln 2πσ² + r²/σ²) with the estimated noise σ of each channel and the residuals r; None where an older sprung
        wrote the result.
    unknowns
        How many numbers were estimated from the samples: free parameters of the vehicle, the noise of each channel, the initial
        state of each drop, the offset of each channel in each drop, and offsets of clocks; None likewise.
    """

    __pydantic_config__ = _EXACTLY

    samples: int
    drops: int
    noise: dict[str, float]
    model: tuple[str, ...]
    tracks: Literal["shared", "separate"]
    why: str
    axes: str = ""
    since: Literal["release", "landing"] = "landing"
    path: tuple[SelectionStep, ...] = ()
    method: str
    iterations: int
    converged: bool
    starts: int
    starts_agreeing: int
    inflation: float
    inflated_by: Inflater | None = None
    most_coloured: str | None = None
    misfit: dict[str, float]
    loglikelihood: float | None = None
    unknowns: int | None = None


@shown
@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Result:
    """Everything an identification gives; the contract's results.json, and the series beside it.

    Attributes
    ----------
    schema_version, version
        Of results.json, and of the sprung that wrote it.
    tested_vehicle
        Which vehicle was tested: ``vehicle`` in results.json.
    verdict
        ``state`` and ``reasons``.
    parameters
        By name: value, std, interval95, unit, status, interval_from. Where the verdict is reject, only what was known exactly
        has a value.
    derived
        The same of quantities that follow from the parameters: masses, static loads and centre of gravity of the empty vehicle,
        ride and hop frequency and damping ratio of each axle (`sprung.vehicle.CHARACTERISTICS` and ``WHEEL_LOADS``);
        ``I_xx_roll_axis``, the roll inertia about the axis of roll, where its height is given; and those whose profile was
        asked for, such as ``wheelbase``.
    scale
        Whether absolute scale is known, and what is left without it.
    unidentifiable
        Combinations that the data do not determine.
    correlation
        Of the estimated parameters.
    modes
        By load: the modes of the identified vehicle, lowest first; none where the verdict is reject.
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
        Frequency and damping of the body's modes against amplitude; empty where it was not asked for, or the verdict is reject.
    omissions
        What decorates a result and could not be made, a sentence each, such as the amplitude curves.
    series
        By drop name: what was fitted.
    recordings
        By drop name, of all drops: the whole recording.
    """

    __pydantic_config__ = _EXACTLY

    schema_version: Annotated[Literal[1], Field(alias="schema")] = SCHEMA
    version: Annotated[str, Field(alias="sprung")]
    tested_vehicle: Annotated[TestedVehicle, Field(alias="vehicle")]
    verdict: Verdict
    parameters: dict[str, Estimate]
    derived: dict[str, Estimate] = field(default_factory=dict)
    scale: Scale
    unidentifiable: tuple[Unidentifiable, ...]
    correlation: Correlation
    modes: dict[str, tuple[ModeEstimate, ...]]
    fit: FitReport
    drops: tuple[DropReport, ...]
    faults: tuple[Fault, ...]
    validation: dict[str, DropValidation] = field(default_factory=dict)
    next_step: str | None = None
    setup: Setup | None = None
    amplitude: Amplitudes = ()
    omissions: tuple[str, ...] = ()
    series: Mapping[str, Series] = field(default_factory=dict, repr=False)
    recordings: Mapping[str, PlottedRecording] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        for mapping in ("parameters", "derived", "modes", "validation", "series", "recordings"):
            object.__setattr__(self, mapping, NamedValues(getattr(self, mapping)))

    def __repr__(self) -> str:
        said = ", ".join(f"{name} {found}" for name, found in self.parameters.items())
        lines = textwrap.wrap(said, 84, initial_indent="    ", subsequent_indent="    ")
        most = 7
        kept = lines if len(lines) <= most else [*lines[: most - 1], "    ..."]
        loads = ", ".join(self.modes)
        return "\n".join(
            [f"Result of {self.name}: {self.verdict.state}", *kept, f"    modes: {loads}; {len(self.drops)} drops"]
        )

    @property
    def covariance(self) -> Covariance:
        """Covariance of the estimated parameters, those whose status is ``estimated``, SI."""
        names = self.correlation.names
        std = np.array([self.parameters[name].std or 0.0 for name in names])
        return Covariance(names, np.array(self.correlation.matrix).reshape(len(names), len(names)) * np.outer(std, std))

    @property
    def loglikelihood(self) -> float | None:
        """Natural logarithm of the maximum of the likelihood: see `FitReport`; None where an older sprung wrote the result."""
        return self.fit.loglikelihood

    @property
    def aic(self) -> float | None:
        """Akaike's information criterion, 2 k - 2 ln L with k = ``fit.unknowns``, all estimated numbers; None as above."""
        if self.fit.loglikelihood is None or self.fit.unknowns is None:
            return None
        return 2 * self.fit.unknowns - 2 * self.fit.loglikelihood

    @property
    def bic(self) -> float | None:
        """The Bayesian information criterion, k ln n - 2 ln L with n = ``fit.samples`` and k as in `aic`; None as above."""
        if self.fit.loglikelihood is None or self.fit.unknowns is None:
            return None
        return self.fit.unknowns * math.log(self.fit.samples) - 2 * self.fit.loglikelihood

    def to_dataframe(self) -> pd.DataFrame:
        """Return parameters and derived quantities as a table: value, std, lower and upper 95 % limit, unit, status."""
        import pandas as pd  # noqa: PLC0415 (slow to import, and nothing else here needs it)

        rows = {
            name: (found.value, found.std, *(found.interval95 or (None, None)), found.unit, found.status)
            for name, found in {**self.parameters, **self.derived}.items()
        }
        columns = ["value", "std", "lower95", "upper95", "unit", "status"]
        table = pd.DataFrame.from_dict(rows, orient="index", columns=columns)
        return table.astype(dict.fromkeys(columns[:4], float)).rename_axis("parameter")

    @property
    def name(self) -> str:
        """Name of the vehicle that was tested."""
        return self.tested_vehicle.name

    @property
    def vehicle(self) -> Vehicle:
        """The identified vehicle: its parameters are the estimates.

        Raises
        ------
        InputError
            If the verdict is reject, or a parameter is not determined.
        """
        return identified_vehicle(
            self.name, self.verdict, self.parameters, {} if self.setup is None else self.setup.heights
        )

    def _repr_html_(self) -> str:
        """Show the verdict, the parameters and the modes in a notebook; of a rejected result the verdict alone."""
        if self.verdict.state == "reject":
            return self.verdict._repr_html_() + "".join(f"<p>{escaped(one.text)}.</p>\n" for one in self.unidentifiable)
        parts = [
            self.verdict._repr_html_(),
            parameters_table(self.name, {**self.parameters, **other_quantities(self.derived)}).html(),
        ]
        parts += [table.html() for table in characteristics_tables(self.name, self.derived)]
        parts += [f"<p>Not determined: {escaped(one.text)}.</p>\n" for one in self.unidentifiable]
        if not self.scale.known and self.scale.per_total_mass:
            parts.append(ratios_table(self.scale.per_total_mass).html())
        return "".join([*parts, *(modes_table(load, modes).html() for load, modes in self.modes.items())])

    def document(self) -> dict[str, Any]:
        """Return the contract's results.json as plain values, without the checksums."""
        return plain_document(self, "series", "recordings")

    def to_json(self) -> str:
        """Write the contract's results.json as text, with the checksums by which `sprung.load` knows that nobody changed it."""
        document = self.document()
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
        atomic_write(Path(folder), self.files(), overwrite=overwrite)
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

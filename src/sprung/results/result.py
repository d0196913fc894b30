"""The result of an identification: one frozen record, saved as results.json and series.npz."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import Field

from sprung.assessment import DropValidation, Verdict
from sprung.checking import DropReport, PlottedRecording
from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.errors import Fault
from sprung.estimation import Correlation, ForceCurve, ModeEstimate, Scale, Unidentifiable
from sprung.results.amplitude import AmplitudeCurves
from sprung.results.checksums import CHECKSUMS, arrays_checksum, document_checksum
from sprung.results.plain import plain_document
from sprung.results.records import EXACT_KEYS, FitReport, SensorEstimate, TestedVehicle, TraceStep
from sprung.results.series import Series, arrays_of, npz_bytes
from sprung.results.setup import Setup
from sprung.results.tables import (
    TRACE_TITLE,
    characteristics_tables,
    modes_table,
    other_quantities,
    parameters_table,
    ratios_table,
    trace_table,
)
from sprung.results.vehicle import identified_vehicle
from sprung.tables import escaped
from sprung.uncertainty import Covariance, Estimate, NamedValues
from sprung.vehicle import Vehicle

if TYPE_CHECKING:
    import pandas as pd

SCHEMA: Literal[1] = 1
"""Version of results.json; a change that an old reader would misread raises it."""

_MAX_LINES = 7
"""Lines of parameters in the text of a result."""


@shown
@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Result:
    """Result of an identification: the contract's results.json, and the series beside it.

    Attributes
    ----------
    schema_version, version
        Of results.json, and of the sprung that wrote it.
    tested_vehicle
        The vehicle that was tested: ``vehicle`` in results.json.
    verdict
        ``state`` and ``reasons``.
    parameters
        By name: value, std, interval95, unit, status, interval_from. Where the verdict is reject, only what was known exactly
        has a value.
    derived
        The same of quantities that follow from the parameters: masses, static loads and centre of gravity of the empty vehicle,
        ride and hop frequency and damping ratio of each axle (`sprung.vehicle.CHARACTERISTICS` and ``WHEEL_LOADS``);
        ``I_xx_roll_axis``, the roll inertia about the roll axis, where its height is given; and those whose likelihood profile
        was requested, such as ``wheelbase``.
    scale
        Whether the absolute scale is known, and the ratios that are determined without it.
    unidentifiable
        Combinations of parameters that the data do not determine.
    correlation
        Of the estimated parameters.
    modes
        By load: the modes of the identified vehicle, lowest first; none where the verdict is reject.
    fit, drops, faults
        Summary of the fit, the part of each drop that was used, and the faults of recordings and campaign.
    sensors
        What was found of the gain, place and delay of each sensor that are stated with an uncertainty, channel by channel; none
        of exact sensors, or where the verdict is reject.
    validation
        By drop name: how well the fitted vehicle explains the drop, and how well the other drops predict it.
    next_step
        Recommended next measurement, one sentence; None where the verdict is reject.
    setup
        Input of the identification: what was known, settings, files and versions.
    additional_terms
        One sentence: what the vehicle has besides springs and dampers, with sizes and standard errors; empty where it has
        nothing, or the verdict is reject.
    curves
        By name: force of a damper against its velocity, of a spring or tyre against its travel, with its standard error:
        ``damper_front``, ``damper_rear``, ``spring_front``, ``spring_rear``, ``tyre_front``, ``tyre_rear``, where the model has
        more than a linear rate there; none where the verdict is reject.
    amplitude
        Frequency and damping of the body's modes against amplitude; empty where not requested, or the verdict is reject.
    trace
        How the result was reached: model terms and corrections that were tried, accepted or rejected, in order.
    omissions
        Optional parts that could not be computed or drawn, such as the amplitude curves, one sentence each.
    series
        By drop name: what was fitted.
    recordings
        By drop name, of all drops: the whole recording.
    """

    __pydantic_config__ = EXACT_KEYS

    schema_version: Annotated[Literal[1], Field(alias="schema")] = SCHEMA
    version: Annotated[str, Field(alias="sprung")]
    tested_vehicle: Annotated[TestedVehicle, Field(alias="vehicle")]
    verdict: Verdict
    parameters: dict[str, Estimate]
    derived: dict[str, Estimate]
    scale: Scale
    unidentifiable: tuple[Unidentifiable, ...]
    correlation: Correlation
    modes: dict[str, tuple[ModeEstimate, ...]]
    fit: FitReport
    drops: tuple[DropReport, ...]
    faults: tuple[Fault, ...]
    validation: dict[str, DropValidation]
    next_step: str | None
    setup: Setup
    sensors: tuple[SensorEstimate, ...] = ()
    additional_terms: str = ""
    curves: dict[str, ForceCurve] = field(default_factory=dict)
    amplitude: AmplitudeCurves = ()
    trace: tuple[TraceStep, ...] = ()
    omissions: tuple[str, ...] = ()
    series: Mapping[str, Series] = field(default_factory=dict, repr=False)
    recordings: Mapping[str, PlottedRecording] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        for mapping in ("parameters", "derived", "modes", "curves", "validation", "series", "recordings"):
            object.__setattr__(self, mapping, NamedValues(getattr(self, mapping)))

    def __repr__(self) -> str:
        values = ", ".join(f"{name} {estimate}" for name, estimate in self.parameters.items())
        lines = textwrap.wrap(values, 84, initial_indent="    ", subsequent_indent="    ")
        if len(lines) > _MAX_LINES:
            lines = [*lines[: _MAX_LINES - 1], "    ..."]
        head = f"Result of {self.name}: {self.verdict.state}"
        return "\n".join([head, *lines, f"    modes: {', '.join(self.modes)}; {len(self.drops)} drops"])

    @property
    def covariance(self) -> Covariance:
        """Covariance of the estimated parameters, those whose status is ``estimated``, SI."""
        names = self.correlation.names
        std = np.array([self.parameters[name].std or 0.0 for name in names])
        return Covariance(names, np.array(self.correlation.matrix).reshape(len(names), len(names)) * np.outer(std, std))

    @property
    def loglikelihood(self) -> float:
        """Natural logarithm of the maximum of the likelihood: see `FitReport`."""
        return self.fit.loglikelihood

    @property
    def aic(self) -> float:
        """:term:`Akaike's information criterion`, 2 k - 2 ln L with k = ``fit.unknowns`` estimated quantities."""
        return 2 * self.fit.unknowns - 2 * self.fit.loglikelihood

    @property
    def bic(self) -> float:
        """:term:`Bayesian information criterion`, k ln n - 2 ln L with n = ``fit.samples`` and k as in `aic`."""
        return self.fit.unknowns * math.log(self.fit.samples) - 2 * self.fit.loglikelihood

    def to_dataframe(self) -> pd.DataFrame:
        """Return parameters and derived quantities as a table: value, std, lower and upper 95 % limit, unit, status."""
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional, and nothing else here needs it)

        rows = {
            name: (estimate.value, estimate.std, *(estimate.interval95 or (None, None)), estimate.unit, estimate.status)
            for name, estimate in {**self.parameters, **self.derived}.items()
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
        return identified_vehicle(self.name, self.verdict, self.parameters, self.setup.heights)

    def _repr_html_(self) -> str:
        """Return verdict, parameters, modes and trace as HTML for a notebook; of a rejected result verdict and trace."""
        trace = f"<details><summary>{TRACE_TITLE}</summary>\n{trace_table(self.trace).html(False)}</details>\n"
        last = trace if self.trace else ""
        if self.verdict.state == "reject":
            texts = [f"<p>{escaped(combination.text)}.</p>\n" for combination in self.unidentifiable]
            return "".join([self.verdict._repr_html_(), *texts, last])
        tables = [parameters_table(self.name, {**self.parameters, **other_quantities(self.derived)})]
        tables += characteristics_tables(self.name, self.derived)
        parts = [self.verdict._repr_html_(), *(table.html() for table in tables)]
        parts += [f"<p>{escaped(self.additional_terms)}</p>\n"] if self.additional_terms else []
        parts += [f"<p>Not determined: {escaped(combination.text)}.</p>\n" for combination in self.unidentifiable]
        if not self.scale.known and self.scale.per_total_mass:
            parts.append(ratios_table(self.scale.per_total_mass).html())
        return "".join([*parts, *(modes_table(load, modes).html() for load, modes in self.modes.items()), last])

    def document(self) -> dict[str, Any]:
        """Return the contract's results.json as plain values, without the checksums."""
        return plain_document(self, "series", "recordings")

    def to_json(self) -> str:
        """Return the contract's results.json as text, with the checksums by which `sprung.load` detects changes."""
        document = self.document()
        checksums = {
            "document": document_checksum(document),
            "series": arrays_checksum(arrays_of(self.series, self.recordings)),
        }
        return json.dumps({**document, CHECKSUMS: checksums}, indent=2, ensure_ascii=False, allow_nan=False) + "\n"

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
        from sprung.files import atomic_write  # noqa: PLC0415 (only saving needs it)

        atomic_write(Path(folder), self.files(), overwrite=overwrite)
        return Path(folder)

    def files(self) -> dict[str, bytes]:
        """Return what `save` writes, by file name: series.npz and, last, results.json.

        Returns
        -------
        dict
            Content by name.
        """
        series = npz_bytes(arrays_of(self.series, self.recordings))
        return {"series.npz": series, "results.json": self.to_json().encode()}

"""Identification of a whole fleet: every campaign below a folder, one row for each, and what the rows tell together."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sprung.batch import (
    DONE,
    BatchCounts,
    Columns,
    Row,
    Task,
    choose_executor,
    folder_lock,
    read_rows,
    run_batch,
    write_table,
)
from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.fleets.campaigns import FleetSource, campaign_key, find_campaigns
from sprung.fleets.estimates import NEEDED
from sprung.fleets.rows import COLUMNS, identify_row
from sprung.fleets.survey import FleetType, survey_types
from sprung.progress import Progress, Step, silent
from sprung.vehicle import Tracks

if TYPE_CHECKING:
    import pandas as pd

CONTENT = "a fleet"
"""Content of the rows, as the files state it."""

HIERARCHICAL_FOLDER = "hierarchical"
"""Subfolder with the estimates of each vehicle together with those of the others, ``estimates.parquet``."""

HIERARCHICAL_COLUMNS: Columns = {
    "type": "text",
    "campaign": "text",
    "label": "text",
    "parameter": "text",
    "unit": "text",
    "single": "number",
    "single_std": "number",
    "hierarchical": "number",
    "hierarchical_std": "number",
    "deviating": "integer",
}
"""Columns of the estimates of each vehicle, SI: from its own test, and together with the others of its type."""


@shown
@dataclass(frozen=True, eq=False)
class Fleet:
    """A fleet that has been identified.

    Attributes
    ----------
    folder
        With the rows, ``*.parquet``.
    counts
        Campaigns with a result and with a message, and none left.
    computed
        Number of campaigns that this call identified; the rows of the others were there.
    gone
        Campaigns with a row that are not among the given ones any more.
    verdicts
        Number of campaigns by verdict.
    failures
        Messages by campaign, of those without a result; a line for each problem.
    rejected
        First reasons of the verdict by campaign, of those that are rejected.
    types
        What the vehicles of each type tell together.
    small_types
        Number of vehicles by name, of types with too few of them.
    parts
        By name, of those whose vehicles are not all of one part of a vehicle (``[vehicle] model``): number of vehicles by
        part, each of which is a type of its own.
    doubtful
        First reasons of the verdict by campaign, of those that are doubtful.
    """

    folder: Path
    counts: BatchCounts
    computed: int
    gone: tuple[str, ...]
    verdicts: Mapping[str, int]
    failures: Mapping[str, str]
    rejected: Mapping[str, str]
    types: tuple[FleetType, ...]
    small_types: Mapping[str, int] = field(default_factory=dict)
    parts: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    doubtful: Mapping[str, str] = field(default_factory=dict)

    def to_dataframe(self) -> pd.DataFrame:
        """Return the rows as a table, without columns that are empty in all of them."""
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional)

        return pd.DataFrame(
            read_rows(self.folder, ("campaign", "key", "status", "message", "seconds", *COLUMNS))
        ).dropna(axis="columns", how="all")

    def document(self) -> dict[str, Any]:
        """Return the fleet as plain values: fleet.json."""
        return {
            "folder": str(self.folder),
            "campaigns": {"done": self.counts.done, "failed": self.counts.failed, "computed": self.computed},
            "gone": list(self.gone),
            "verdicts": dict(self.verdicts),
            "failures": dict(self.failures),
            "rejected": dict(self.rejected),
            "doubtful": dict(self.doubtful),
            "types": [one.document() for one in self.types],
            "small_types": dict(self.small_types),
            "parts": {name: dict(counts) for name, counts in self.parts.items()},
        }


def fleet(
    source: FleetSource,
    output: str | os.PathLike[str],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    tracks: Tracks | None = None,
    extras: str | Sequence[str] | None = None,
    fall: bool | None = None,
    one_type: bool = False,
    retry: bool = False,
    progress: Progress = silent,
) -> Fleet:
    """Identify every campaign of a fleet and write a row for each; called again, it goes on where it stopped.

    Parameters
    ----------
    source
        A folder: every ``campaign.toml`` below it. A text file with one campaign in each line. Or a sequence of paths.
    output
        Folder of the rows, made if it is missing. A campaign whose content, options and version of sprung are those
        of its row is not identified again; a changed one is, and its new row replaces the old one.
    workers
        Number of processes on this machine; by default one for each processor.
    scheduler
        Address of the scheduler of an existing Dask cluster, such as ``tcp://10.0.0.7:8786``, instead of this machine.
    tracks, extras, fall
        As for `sprung.identify`, for every campaign.
    one_type
        Whether all vehicles are of one type. By default those of one name (``[vehicle] name``) are. Different parts of a
        vehicle (``[vehicle] model``) are different types in any case.
    retry
        Whether campaigns that could not be identified are tried again although nothing has changed.
    progress
        Called with a `sprung.batch.BatchStep`, at most a few times per second.

    Returns
    -------
    Fleet

    Raises
    ------
    InputError
        If there is no campaign, the output folder cannot be used or another process writes to it, or the cluster does not
        answer. A campaign that cannot be used is no error: its row has the message.
    """
    paths = find_campaigns(source)
    options: dict[str, Any] = {"tracks": tracks, "extras": _listed(extras), "fall": fall}
    folder = Path(output)
    # The workers come first: where a cluster does not answer, no folder is made.
    with closing(choose_executor(identify_row, workers, scheduler)) as executor, folder_lock(folder):
        summary = run_batch(
            _tasks(paths, options),
            executor,
            folder,
            COLUMNS,
            CONTENT,
            total=len(paths),
            retry=retry,
            progress=progress,
        )
        progress(Step("comparing the vehicles"))
        found = survey_types(_with_arrays(read_rows(folder, NEEDED)), one_type)
        rows = [row for one in found.types for row in one.rows()]
        write_table(folder / HIERARCHICAL_FOLDER, "estimates", rows, HIERARCHICAL_COLUMNS)
        outcomes = _outcomes(folder)
    verdicts, failures, rejected, doubtful = outcomes
    done = (folder, summary.counts, summary.computed, summary.gone)
    return Fleet(*done, verdicts, failures, rejected, *found, doubtful=doubtful)


def _listed(extras: str | Sequence[str] | None) -> list[str] | None:
    return [extras] if isinstance(extras, str) else None if extras is None else list(extras)


def _tasks(paths: Sequence[Path], options: dict[str, Any]) -> Iterator[Task]:
    for path in paths:
        yield Task(path.as_posix(), campaign_key(path, options), (str(path), options))


class _Outcomes(NamedTuple):
    """What came of the campaigns, as the fields of `Fleet` state it."""

    verdicts: Mapping[str, int]
    failures: Mapping[str, str]
    rejected: Mapping[str, str]
    doubtful: Mapping[str, str]


def _outcomes(folder: Path) -> _Outcomes:
    verdicts: Counter[str] = Counter()
    failures: dict[str, str] = {}
    reasons: dict[str, dict[str, str]] = {"reject": {}, "doubtful": {}}
    for row in read_rows(folder, ("campaign", "status", "message", "verdict", "reasons")):
        campaign = row["campaign"]
        if row["status"] != DONE:
            # A message about the campaign file itself begins with its path, which is the key here.
            failures[campaign] = row["message"].removeprefix(f"{Path(campaign)}: ")
            continue
        verdicts[row["verdict"]] += 1
        if row["verdict"] in reasons:
            reasons[row["verdict"]][campaign] = next(iter(row["reasons"] or ()), "")
    return _Outcomes(dict(verdicts), failures, reasons["reject"], reasons["doubtful"])


def _with_arrays(rows: Iterable[Row]) -> Iterator[Row]:
    """Yield rows with their numbers as arrays, which take an eighth of the memory of lists."""
    for row in rows:
        arrays = {name: None if row[name] is None else np.array(row[name]) for name in ("position", "covariance")}
        yield {**row, **arrays}

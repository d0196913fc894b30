"""Monte Carlo of a planned test: many simulated campaigns, each identified, and how good the estimates are."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, closing
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.analysis import identify_campaign
from sprung.batch import (
    DONE,
    BatchCounts,
    Row,
    Task,
    canonical_text,
    choose_executor,
    content_key,
    folder_lock,
    read_rows,
    run_batch,
)
from sprung.campaign import parse_known_values, read_vehicle
from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.errors import InputError, Problem, Problems
from sprung.fleets import COLUMNS, row_of
from sprung.progress import Progress, silent
from sprung.simulation import simulate
from sprung.study.monte_carlo_summary import ParameterAccuracy, Share, accuracy_of, share
from sprung.vehicle import Vehicle, evaluate_quantity

if TYPE_CHECKING:
    import pandas as pd

_SUM = 8
"""Digits of a checksum that tells two studies apart."""

VERDICTS = ("accept", "doubtful", "reject")


@shown
@dataclass(frozen=True, eq=False)
class MonteCarlo:
    """Accuracy of a planned test, from simulated campaigns.

    Attributes
    ----------
    vehicle
        Name of the vehicle.
    folder
        With one row for each campaign, ``*.parquet``; None where they were not kept.
    counts
        Campaigns with a result and with a message, and none left.
    computed
        Number of campaigns that this call simulated and identified; the rows of the others were there.
    parameters
        Bias, scatter, stated uncertainty and coverage of each parameter, by name.
    verdicts
        Part of the campaigns with each verdict.
    failures
        Messages of campaigns without a result, by their numbers.
    """

    vehicle: str
    folder: Path | None
    counts: BatchCounts
    computed: int
    parameters: Mapping[str, ParameterAccuracy]
    verdicts: Mapping[str, Share]
    failures: Mapping[str, str]

    def document(self) -> dict[str, Any]:
        """Return the study as plain values."""
        return {
            "vehicle": self.vehicle,
            "folder": None if self.folder is None else str(self.folder),
            "campaigns": {"done": self.counts.done, "failed": self.counts.failed, "computed": self.computed},
            "verdicts": {name: asdict(one) for name, one in self.verdicts.items()},
            "parameters": {name: asdict(one) for name, one in self.parameters.items()},
            "failures": dict(self.failures),
        }

    def to_dataframe(self) -> pd.DataFrame:
        """Return the table of the parameters."""
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional)

        flat = {
            name: {
                **asdict(one),
                "coverage": one.coverage.part,
                "coverage_low": one.coverage.low,
                "coverage_high": one.coverage.high,
            }
            for name, one in self.parameters.items()
        }
        return pd.DataFrame.from_dict(flat, orient="index").rename_axis("parameter")


def monte_carlo(
    vehicle: Vehicle | str | os.PathLike[str],
    test: Mapping[str, Any] | None = None,
    n: int = 200,
    jobs: int | None = None,
    *,
    output: str | os.PathLike[str] | None = None,
    scheduler: str | None = None,
    seed: int = 1,
    retry: bool = False,
    progress: Progress = silent,
) -> MonteCarlo:
    """Simulate and identify many campaigns of a planned test.

    Parameters
    ----------
    vehicle
        The true vehicle, or the path of its vehicle file, whose sensors, loads, drops, known quantities and model
        hold where the test does not state them.
    test
        Arguments of `sprung.simulate`, such as ``sensors``, ``loads``, ``drops``, ``rate``, ``noise`` and ``known``. Known
        quantities with an uncertainty have another error in every campaign; those without value have the vehicle's.
        Sensors that are stated with uncertainties have other gains, tilts, places and delays in every campaign.
    n
        Number of campaigns.
    jobs
        Number of processes on this machine; by default one for each processor.
    output
        Folder of the rows, one for each campaign. A study of the same vehicle and test that is called again with it
        goes on where it stopped. None: nothing is kept.
    scheduler
        Address of the scheduler of an existing Dask cluster instead of this machine.
    seed
        Of all noise and errors.
    retry
        Whether campaigns that could not be identified are tried again.
    progress
        Called with a `sprung.batch.BatchStep`, at most a few times per second.

    Returns
    -------
    MonteCarlo

    Raises
    ------
    InputError
        If vehicle or test cannot be used, the folder has the campaigns of another study or cannot be written to, or the cluster
        does not answer.

    Examples
    --------
    >>> from sprung.vehicle import TABLE_1_CAR
    >>> drops = [{"wheels": ("fl", "fr")}, {"wheels": ("fl", "rl")}]
    >>> found = monte_carlo(TABLE_1_CAR, {"drops": drops, "known": {"total_mass": {"std": 5}}}, n=4, jobs=1)
    >>> found.counts.done, found.verdicts["accept"].part, abs(found.parameters["k_sf"].bias) < 2
    (4, 1.0, True)
    """
    if n < 1:
        raise InputError([Problem("study: campaigns", str(n), "1 or more", "200 show a coverage to 1.5 %.")])
    true, arguments = _resolved(vehicle, test or {})
    what = canonical_text([true, arguments, seed])
    _simulated(true, arguments, seed, 0)  # whatever is wrong with the test is wrong with all campaigns
    with ExitStack() as stack:
        # The workers come first: where a cluster does not answer, no folder is made.
        executor = stack.enter_context(closing(choose_executor(identify_simulated, jobs, scheduler)))
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()) if output is None else output)
        stack.enter_context(folder_lock(folder))
        summary = run_batch(
            _tasks(true, arguments, seed, n, what),
            executor,
            folder,
            COLUMNS,
            _content(true, arguments, seed),
            total=n,
            retry=retry,
            progress=progress,
        )
        names = tuple(true.parameters)
        columns = [column for name in names for column in (name, f"{name}_std")]
        numbers = {str(i + 1) for i in range(n)}
        rows = [
            row
            for row in read_rows(folder, ("campaign", "status", "message", "verdict", *columns))
            if row["campaign"] in numbers
        ]
    done = [row for row in rows if row["status"] == DONE]
    return MonteCarlo(
        vehicle=true.name,
        folder=None if output is None else folder,
        counts=summary.counts,
        computed=summary.computed,
        parameters={name: accuracy_of(name, true.parameters[name], done) for name in names},
        verdicts={verdict: share(sum(row["verdict"] == verdict for row in done), len(done)) for verdict in VERDICTS},
        failures={row["campaign"]: row["message"] for row in rows if row["status"] != DONE},
    )


def _resolved(vehicle: Vehicle | str | os.PathLike[str], test: Mapping[str, Any]) -> tuple[Vehicle, dict[str, Any]]:
    """Return the true vehicle and the arguments of its simulation, with what a vehicle file says."""
    arguments = {name: value for name, value in test.items() if value is not None}
    if not isinstance(vehicle, Vehicle):
        file = read_vehicle(vehicle)
        vehicle = file.vehicle
        stated = {"sensors": file.sensors, "loads": file.loads, "drops": file.drops, "known": file.all_known}
        whole = {"model": file.model, "push": file.push, "bump": file.bump}
        arguments = {**{name: value for name, value in stated.items() if value}, **whole, **arguments}
    # Sensors that are stated are known to their standard uncertainties, as `sprung.plan` takes them.
    arguments.setdefault("sensor_errors", "sensors" in arguments)
    unknown = {"seed", "progress"} & arguments.keys()
    if unknown:
        found = ", ".join(sorted(unknown))
        raise InputError([Problem("study: test", found, "other arguments of sprung.simulate", "Leave it out.")])
    arguments["known"] = {name: _with_value(name, value, vehicle) for name, value in arguments.get("known", {}).items()}
    problems = Problems()
    arguments["known"] = parse_known_values(arguments["known"], "study: known", problems)
    problems.raise_if_any()
    return vehicle, arguments


def _with_value(name: str, value: Any, vehicle: Vehicle) -> Any:
    """Return a known quantity with the vehicle's own value where it has none."""
    if not isinstance(value, Mapping) or "value" in value:
        return value
    return {"value": _true_value(name, vehicle), **value}


def _true_value(name: str, vehicle: Vehicle) -> float:
    names, values = tuple(vehicle.parameters), np.array(list(vehicle.parameters.values()))
    return float(evaluate_quantity(name, names, values)[0])


def _tasks(vehicle: Vehicle, arguments: dict[str, Any], seed: int, n: int, what: str) -> Iterator[Task]:
    for i in range(n):
        key = content_key([version("sprung"), what, str(i)])
        yield Task(str(i + 1), key, (vehicle, arguments, seed, i))


def _content(vehicle: Vehicle, arguments: Mapping[str, Any], seed: int) -> str:
    """Describe a study so that two descriptions show what differs: what is long has a checksum of its own."""
    numbers = {name: value for name, value in arguments.items() if type(value) in (int, float)}
    others = {name: value for name, value in arguments.items() if name not in numbers}
    stated = "".join(f"{name} {value:g}, " for name, value in sorted(numbers.items()))
    sums = [content_key([canonical_text(part)])[:_SUM] for part in (vehicle, others)]
    return f"a Monte Carlo study (vehicle {vehicle.name}, checksum {sums[0]}; {stated}other options {sums[1]}; seed {seed})"


def identify_simulated(argument: tuple[Vehicle, dict[str, Any], int, int]) -> Row:
    """Simulate one campaign of a study, identify it, and return its row.

    Parameters
    ----------
    argument
        Vehicle, arguments of `sprung.simulate`, seed of the study and number of the campaign from 0.

    Returns
    -------
    Row
        With the columns of `sprung.fleets.COLUMNS`, SI.
    """
    return row_of(identify_campaign(_simulated(*argument)))


def _simulated(vehicle: Vehicle, arguments: Mapping[str, Any], seed: int, number: int) -> Any:
    noise, errors = np.random.SeedSequence([seed, number]).spawn(2)
    random = np.random.default_rng(errors)
    known = {
        name: replace(one, value=one.value + one.std * random.standard_normal()) if one.std else one
        for name, one in arguments["known"].items()
    }
    return simulate(vehicle, **{**arguments, "known": known}, seed=int(noise.generate_state(1)[0]))

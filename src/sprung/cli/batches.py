"""Commands for many campaigns: fleets, and Monte Carlo of a planned test."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Optional

import typer

import sprung
from sprung.batch import BatchStep
from sprung.cli import completion
from sprung.cli.app import Force, Json, app
from sprung.cli.output import complain, say, say_json, working
from sprung.errors import InputError, Problem
from sprung.progress import Progress, Step

_EVERY = 1.0
"""Time between two lines of progress for machines, s."""

Workers = Annotated[
    Optional[int],  # noqa: UP045 (typer reads it)
    typer.Option(
        "--workers", min=1, help="Number of processes on this machine.", show_default="one for each processor"
    ),
]
Scheduler = Annotated[
    Optional[str],  # noqa: UP045 (typer reads it)
    typer.Option(
        "--scheduler", metavar="ADDRESS", help="Scheduler of an existing Dask cluster, such as tcp://10.0.0.7:8786."
    ),
]
Retry = Annotated[
    bool, typer.Option("--retry", help="Try campaigns that could not be identified again, although nothing changed.")
]


@app.command(epilog="Example: [bold]sprung fleet measurements -o fleet --workers 4[/bold]")
def fleet(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="FOLDER|LIST",
            help="Folder with campaigns at any depth, or a text file with the path of one campaign in each line.",
        ),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", metavar="OUT", help="Folder of the rows (*.parquet), fleet.html and fleet.json."
        ),
    ],
    workers: Workers = None,
    scheduler: Scheduler = None,
    fall: Annotated[
        Optional[bool],  # noqa: UP045 (typer reads it)
        typer.Option(
            "--fall/--no-fall",
            help="Use the drops from their release on, not only from the last landing: smaller uncertainties, slower.",
            show_default="where an uncertainty is above 2 % without it",
        ),
    ] = None,
    one_type: Annotated[
        bool,
        typer.Option(
            "--one-type",
            help="Compare all vehicles of one [vehicle] model with each other, not only those of the same name.",
        ),
    ] = False,
    retry: Retry = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Identify every campaign of a fleet, one row for each, and compare the vehicles; started again, it goes on."""
    with _progress(as_json) as progress:
        found = sprung.fleet(
            source,
            output,
            workers=workers,
            scheduler=scheduler,
            fall=fall,
            one_type=one_type,
            retry=retry,
            progress=progress,
        )
        if not found.counts.done:
            expected, do = "a campaign that can be identified", "Correct it: its row is replaced by the next run."
            raise InputError(
                Problem(campaign, f"no result ({' '.join(message.splitlines())})", expected, do)
                for campaign, message in found.failures.items()
            )
        progress(Step("drawing the page"))
        written = sprung.report.write_fleet(found, output, overwrite=force)
    if as_json:
        say_json({**found.document(), "written": [str(path) for path in written]})
    else:
        say(sprung.report.text_of(sprung.report.fleet_view(found)))
        say(f"\nWritten: {output / '*.parquet'}, {', '.join(map(str, written))}\n")


@app.command(epilog="Example: [bold]sprung study vehicle.toml --campaigns 200 -o study[/bold]")
def study(
    vehicle: Annotated[
        Path,
        typer.Argument(
            metavar="VEHICLE.toml",
            help="Vehicle file with the true parameters; sensors, loads, drops and known quantities are optional.",
            autocompletion=completion.campaigns,
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="OUT", help="Folder of the rows (*.parquet).")],
    campaigns: Annotated[int, typer.Option("--campaigns", metavar="N", min=1, help="Number of campaigns.")] = 200,
    workers: Workers = None,
    scheduler: Scheduler = None,
    rate: Annotated[float, typer.Option(max=1e5, help="Sampling rate, Hz.")] = 500.0,
    noise: Annotated[float, typer.Option(max=1e3, help="Sensor noise, m/s² root-mean-square.")] = 0.02,
    seed: Annotated[int, typer.Option(min=0, help="Seed of all noise and errors.")] = 1,
    retry: Retry = False,
    as_json: Json = False,
) -> None:
    """Simulate and identify a planned test many times: bias, scatter, coverage, and the chance to be accepted."""
    with _progress(as_json) as progress:
        found = sprung.study.monte_carlo(
            vehicle,
            {"rate": rate, "noise": noise},
            campaigns,
            workers,
            output=output,
            scheduler=scheduler,
            seed=seed,
            retry=retry,
            progress=progress,
        )
    if as_json:
        say_json(found.document())
    else:
        say(sprung.report.text_of(sprung.report.monte_carlo_view(found)))
        say(f"\nWritten: {output / '*.parquet'}\n")


@contextmanager
def _progress(as_json: bool) -> Iterator[Progress]:
    """Show progress in a terminal; with JSON, one line with the counts on standard error every second."""
    if not as_json:
        with working("finding the campaigns") as progress:
            yield progress
        return
    last: list[float] = []

    def report(step: Step) -> None:
        if isinstance(step, BatchStep) and (not last or not step.counts.left or time.monotonic() - last[-1] >= _EVERY):
            last[:] = [time.monotonic()]
            complain(json.dumps(step.counts.document()))

    yield report

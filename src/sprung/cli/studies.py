"""Commands for studies: comparison, planning, simulation, the paper, the schema."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated, Optional

import typer

import sprung
from sprung.cli import completion
from sprung.cli.app import Force, Json, app
from sprung.cli.output import REJECTED, say, say_json, working
from sprung.progress import Step


@app.command(epilog="Example: [bold]sprung compare before/results after/results[/bold]")
def compare(
    results: Annotated[
        list[Path],
        typer.Argument(
            metavar="RESULTS...",
            help="Two or more results folders, or their results.json; the first is the reference.",
            autocompletion=completion.results,
        ),
    ],
    as_json: Json = False,
) -> None:
    """Compare results, with the significance of each difference."""
    found = sprung.compare(results)
    if as_json:
        say_json(found.document())
    else:
        say(sprung.report.text_of(sprung.report.comparison_view(found)))
    if found.rejected:
        raise typer.Exit(REJECTED)


@app.command(epilog="Example: [bold]sprung simulate vehicle.toml -o campaign --noise 0.05[/bold]")
def simulate(
    vehicle: Annotated[
        Path,
        typer.Argument(
            metavar="VEHICLE.toml",
            help="Vehicle file with the parameters; sensors, loads and drops are optional.",
            autocompletion=completion.campaigns,
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Campaign folder to write.")],
    rate: Annotated[float, typer.Option(max=1e5, help="Sampling rate, Hz.")] = 500.0,
    noise: Annotated[float, typer.Option(max=1e3, help="Sensor noise, m/s² root-mean-square.")] = 0.02,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the noise.")] = 1,
    sensor_errors: Annotated[
        bool,
        typer.Option("--sensor-errors", help="Draw gain, tilt, place and delay of each sensor from its uncertainties."),
    ] = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Simulate a campaign from a vehicle file: drops off blocks, as the sensors record them."""
    with working("reading the vehicle") as progress:
        campaign = sprung.simulate(
            vehicle, rate=rate, noise=noise, seed=seed, sensor_errors=sensor_errors, progress=progress
        )
        progress(Step("writing the campaign"))
        written = sprung.write(campaign, output, overwrite=force)
    if as_json:
        say_json({"campaign": str(written), "drops": [drop.file for drop in campaign.drops]})
    else:
        recordings = f"{len(campaign.drops)} recording{'s' * (len(campaign.drops) > 1)}"
        say(f"Written: {written}, {recordings}\nNext:    sprung identify {shlex.quote(str(written))}\n")


@app.command(epilog="Example: [bold]sprung plan vehicle.toml --wanted 0.5[/bold]")
def plan(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="VEHICLE.toml|CAMPAIGN",
            help="Vehicle file with assumed parameters, or a campaign to continue.",
            autocompletion=completion.campaigns,
        ),
    ],
    wanted: Annotated[float, typer.Option(help="Largest acceptable standard uncertainty of any parameter, %.")] = 1.0,
    rate: Annotated[
        Optional[float],  # noqa: UP045 (typer reads it)
        typer.Option(max=1e5, help="Sampling rate, Hz, for a vehicle file (default: 500)."),
    ] = None,
    noise: Annotated[
        Optional[float],  # noqa: UP045 (typer reads it)
        typer.Option(max=1e3, help="Sensor noise, m/s² root-mean-square, for a vehicle file (default: 0.02)."),
    ] = None,
    terms: Annotated[
        bool,
        typer.Option(
            "--terms", help="Add which sizes of mounts, knees, friction and other model terms would be found."
        ),
    ] = False,
    as_json: Json = False,
) -> None:
    """Plan the next measurement: expected uncertainties from a test and from its alternatives."""
    with working("reading") as progress:
        planned = sprung.plan(source, wanted=wanted, rate=rate, noise=noise, terms=terms, progress=progress)
    if as_json:
        say_json(planned.document())
    else:
        say(sprung.report.text_of(sprung.report.plan_view(planned)))
    if planned.rejected:
        raise typer.Exit(REJECTED)


@app.command(epilog="Example: [bold]sprung paper --json[/bold]")
def paper(as_json: Json = False) -> None:
    """Reproduce the paper's tables, its misprints, and the sensitivity of its method to noise."""
    with working("reproducing the paper") as progress:
        reproduction = sprung.paper.reproduce(progress=progress)
    if as_json:
        say_json(reproduction.document())
    else:
        say(sprung.report.text_of(sprung.report.paper_view(reproduction)))


@app.command(epilog="Example: [bold]sprung schema > campaign.schema.json[/bold]")
def schema(as_json: Json = False) -> None:  # noqa: ARG001 (always JSON)
    """Print the JSON Schema of campaign.toml, with which editors complete keys and mark errors."""
    say_json(sprung.schema_text())

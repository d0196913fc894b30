"""The command that writes a vehicle for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Optional

import typer

import sprung
from sprung.cli import completion
from sprung.cli.app import Force, Json, app
from sprung.cli.output import REJECTED, complain, say, say_json, working
from sprung.errors import InputError, Problem


@app.command(epilog="Example: [bold]sprung export results --to fmu -o car.fmu[/bold]")
def export(
    results: Annotated[
        Path,
        typer.Argument(
            metavar="RESULTS", help="Results folder, or its results.json.", autocompletion=completion.results
        ),
    ],
    to: Annotated[
        str,
        typer.Option(
            metavar="FORMAT",
            autocompletion=completion.export_formats,
            help="state-space, commonroad, modelica, mjcf, fmu, draws, markdown or latex.",
        ),
    ],
    output: Annotated[
        Optional[Path],  # noqa: UP045 (typer reads it)
        typer.Option(
            "-o",
            "--output",
            metavar="FILE",
            help="File to write (default: in the results folder, named by the vehicle).",
        ),
    ] = None,
    load: Annotated[
        Optional[str],  # noqa: UP045 (typer reads it)
        typer.Option(help="Load on the vehicle, by its name in the campaign (default: none)."),
    ] = None,
    amplitude: Annotated[
        Optional[float],  # noqa: UP045 (typer reads it)
        typer.Option(help="state-space: amplitude of suspension travel at which nonlinear elements are linearised, m."),
    ] = None,
    frequency: Annotated[
        Optional[float],  # noqa: UP045 (typer reads it)
        typer.Option(help="state-space: frequency of this motion, Hz (default: lowest natural frequency)."),
    ] = None,
    approximate: Annotated[
        bool,
        typer.Option("--approximate", help="commonroad, mjcf: approximate what the format cannot hold, and list it."),
    ] = False,
    number: Annotated[
        Optional[int],  # noqa: UP045 (typer reads it)
        typer.Option(help="draws: number of draws (default: 200)."),
    ] = None,
    seed: Annotated[
        Optional[int],  # noqa: UP045 (typer reads it)
        typer.Option(help="draws: seed of the random numbers."),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Write the identified vehicle for another program: state space, simulation models, draws, tables."""
    with working("writing the export"):
        found: Any = sprung.load(results, series=False)
        if output is not None and output.name in {drop.file for drop in found.drops}:
            # Simulated recordings are files that sprung wrote, too, and might be replaced otherwise.
            what = "the name of a recording of this campaign"
            raise InputError([Problem(str(output), what, "a name for the export", "Choose another name.")])
        is_parquet = to == "draws" and output is not None and output.suffix == ".parquet"
        options = sprung.export.ExportOptions(
            load=load,
            amplitude=amplitude,
            frequency=frequency,
            approximate=approximate or None,
            number=number,
            seed=seed,
            table="parquet" if is_parquet else None,
        )
        file = sprung.export.export(found, to, options)
        folder = results.parent if results.suffix == ".json" else results
        written = file.save(folder if output is None else output, overwrite=force)
    if as_json:
        say_json({"format": to, "written": str(written), "notes": list(file.notes)})
    else:
        for note in file.notes:
            complain(note)
        say(f"Written: {written}\n")
    if found.verdict.state == "reject":
        raise typer.Exit(REJECTED)

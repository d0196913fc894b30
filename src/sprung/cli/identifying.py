"""The commands that identify a vehicle, and show what came out."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Optional

import typer

import sprung
from sprung.cli.app import CampaignFile, Json, app
from sprung.cli.completing import parameters, results
from sprung.cli.output import REJECTED, say, say_json, working


@app.command(epilog="Example: [bold]sprung identify campaign.toml -o results[/bold]")
def identify(
    campaign: CampaignFile,
    output: Annotated[
        Optional[Path],  # noqa: UP045 (typer reads it)
        typer.Option("-o", "--output", metavar="DIR", help="Where to write results.json, series.npz and report.html."),
    ] = None,
    profile: Annotated[
        Optional[list[str]],  # noqa: UP045 (typer reads it)
        typer.Option(
            metavar="NAME",
            autocompletion=parameters,
            help="Take the 95 % interval of a parameter from the whole likelihood, for one that is weakly determined; "
            "can be given more than once; all for every one.",
        ),
    ] = None,
    fall: Annotated[
        Optional[bool],  # noqa: UP045 (typer reads it)
        typer.Option(
            "--fall/--no-fall",
            help="Use the drops from their release on, not only from when the last tyre is down: sharper, and slower.",
            show_default="where the decays leave a parameter uncertain by more than 2 %",
        ),
    ] = None,
    report: Annotated[
        bool, typer.Option("--report/--no-report", help="Write report.html, for people to look at.")
    ] = True,
    as_json: Json = False,
) -> None:
    """Identify every parameter and write the results folder (default: results/ beside the campaign)."""
    with working("reading the recordings") as progress:
        read = sprung.read(campaign)
        folder = output or (read.path or campaign).parent / "results"
        result = sprung.identify(read, profile=profile or (), fall=fall, amplitude=report, progress=progress)
        progress("writing the results")
        written = sprung.report.write_results(result, folder, report)
    conclude(result, written, as_json)


def conclude(result: Any, written: Sequence[Path], as_json: bool) -> None:
    """Print a result and leave with the status that belongs to its verdict."""
    if as_json:
        say_json(result.to_json())
    else:
        say(sprung.report.text_of(sprung.report.result_view(result)))
        say(f"\nWritten: {', '.join(map(str, written))}\n")
    if result.verdict.state == "reject":
        raise typer.Exit(REJECTED)


@app.command(epilog="Example: [bold]sprung report results --pdf[/bold]")
def report(
    folder: Annotated[
        Path,
        typer.Argument(
            metavar="DIR", help="The results folder, with results.json and series.npz.", autocompletion=results
        ),
    ],
    pdf: Annotated[bool, typer.Option("--pdf", help="Write report.pdf too.")] = False,
    as_json: Json = False,
) -> None:
    """Write the report of a result again, from its folder alone."""
    with working("writing the report"):
        written = sprung.report.write_report(folder, pdf)
    if as_json:
        say_json({"written": [str(path) for path in written]})
    else:
        say(f"Written: {', '.join(map(str, written))}\n")


@app.command(epilog="Example: [bold]sprung validate campaign.toml -o validation[/bold]")
def validate(
    campaign: CampaignFile,
    output: Annotated[
        Optional[Path],  # noqa: UP045 (typer reads it)
        typer.Option(
            "-o", "--output", metavar="DIR", help="Where to write numbers, series and drawings (default: nowhere)."
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Hold the identified vehicle against each drop: fitted, predicted by the other drops, and against amplitude."""
    with working("reading the recordings") as progress:
        found = sprung.validate(sprung.read(campaign), progress=progress)
    written: tuple[Path, ...] = ()
    if output is not None:
        with working("drawing"):
            drawings = sprung.report.draw_validation(found)
            written = sprung.report.write_validation(found, output.resolve(), drawings)
    if as_json:
        say_json(found.document())
    else:
        say(sprung.report.text_of(sprung.report.validation_view(found)))
        if written:
            say(f"\nWritten: {len(written)} files in {written[0].parent}\n")
    if found.result.verdict.state == "reject":
        raise typer.Exit(REJECTED)


@app.command(epilog="Example: [bold]sprung demo[/bold]")
def demo(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Where to write the example.")] = Path("sprung-demo"),
    as_json: Json = False,
) -> None:
    """Write an example campaign, the paper's school bus, and identify it."""
    with working("dropping the school bus") as progress:
        written = sprung.write(sprung.study.demo_campaign(), folder)
        result = sprung.identify(sprung.read(written), amplitude=True, progress=progress)
        files = sprung.report.write_results(result, folder / "results")
    conclude(result, files, as_json)
    if not as_json:
        say(
            f"\nThe recordings and what was known beforehand:     {written}\n"
            f"Everything that was found, to look at:            {folder / 'results' / 'report.html'}\n"
            f"and for other programs:                           {folder / 'results' / 'results.json'}\n"
            f"Change something there and run again:             sprung identify {shlex.quote(str(written))}\n"
        )

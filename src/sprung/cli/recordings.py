"""Commands for recordings: check, modal analysis, draft of a campaign file."""

from __future__ import annotations

import shlex
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Optional

import typer

import sprung
from sprung.cli import completion
from sprung.cli.app import Force, Json, app
from sprung.cli.output import complain, say, say_json, working
from sprung.errors import Fault, InputError, record_failure


@app.command(epilog="Example: [bold]sprung check campaign.toml[/bold]")
def check(
    campaign: Annotated[
        Path,
        typer.Argument(
            metavar="CAMPAIGN",
            help="campaign.toml, also incomplete, or its folder; or a folder that contains only recordings.",
            autocompletion=completion.campaigns,
        ),
    ],
    output: Annotated[
        Optional[Path],  # noqa: UP045 (typer reads it)
        typer.Option("-o", "--output", metavar="DIR", help="Output folder (default: check/ beside the campaign)."),
    ] = None,
    page: Annotated[
        bool, typer.Option("--page/--no-page", help="Write check.html, with a figure of every drop.")
    ] = True,
    drawings: Annotated[
        bool, typer.Option("--drawings/--no-drawings", help="Write an SVG file of each drop too.")
    ] = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Check the recordings without identification: usable drops, faults, missing data. Needs no geometry."""
    with working("reading the recordings") as progress:
        found = sprung.check(campaign, progress=progress)
    if not found.usable:
        raise InputError(fault.as_problem("a usable decay in at least one drop") for fault in found.faults)
    beside = campaign if campaign.is_dir() else campaign.parent
    folder = output or beside / "check"
    written: tuple[Path, ...] = ()
    omissions: list[str] = []
    if page or drawings:
        with working("drawing"), record_failure(omissions, "The page of the check", "written"):
            written = sprung.report.write_check(found, folder, page=page, drawings=drawings, overwrite=force)
    for omission in omissions:
        complain(omission)
    pages = [path for path in written if path.name == sprung.report.CHECK_FILE]
    drawn = [str(path.resolve()) for path in written if path not in pages]
    if as_json:
        say_json({**found.document(), "page": str(pages[0].resolve()) if pages else None, "drawings": drawn})
    else:
        say(sprung.report.text_of(sprung.report.check_view(found, pages[0] if pages else None)))


@app.command(epilog="Example: [bold]sprung modal campaign.toml --method svm[/bold]")
def modal(
    campaign: Annotated[
        Path,
        typer.Argument(
            metavar="CAMPAIGN",
            help="campaign.toml or its folder; or a recording, or a folder that contains only recordings.",
            autocompletion=completion.campaigns,
        ),
    ],
    method: Annotated[
        str,
        typer.Option(
            autocompletion=completion.methods,
            help="Method: ml (maximum likelihood, with uncertainties), ml-frequency, era, era-dc, ssi-cov, ssi-data, itd, "
            "arma, svm, svm-printed, svm-rows (the paper's State Variable Method), lscf, rfp, peaks, emd.",
        ),
    ] = "ml",
    order: Annotated[
        Optional[int],  # noqa: UP045 (typer reads it)
        typer.Option(
            min=1, help="Model order: number of poles, two for each mode (default: as many as the recordings contain)."
        ),
    ] = None,
    amplitude: Annotated[
        bool,
        typer.Option("--amplitude", help="Compute frequency and damping of each mode against amplitude."),
    ] = False,
    start: Annotated[
        Optional[float],  # noqa: UP045 (typer reads it)
        typer.Option(
            help="Start of the free decay in recordings without a campaign, s on their clock "
            "(default: the landing of each detected drop, else the largest sample)."
        ),
    ] = None,
    diagram: Annotated[bool, typer.Option("--diagram", help="Show a stabilisation diagram too.")] = False,
    as_json: Json = False,
) -> None:
    """Identify natural frequencies, damping ratios and mode shapes of each load, without a vehicle model."""
    with working("reading the recordings") as progress:
        if sprung.is_recordings(campaign):
            found = sprung.modes(
                campaign,
                method=method,
                order=order,
                start=start,
                amplitude=amplitude,
                diagram=diagram,
                progress=progress,
            )
            faults: tuple[Fault, ...] = ()
        else:
            read = sprung.read(campaign, progress=progress)
            found = sprung.modes(
                read, method=method, order=order, start=start, amplitude=amplitude, diagram=diagram, progress=progress
            )
            faults = sprung.check(read, progress=progress).faults
    if as_json:
        say_json(
            {
                "modes": {load: [asdict(mode) for mode in modes] for load, modes in found.items()},
                "modal": {load: modes.document() for load, modes in found.items()},
            }
        )
    else:
        say(sprung.report.text_of(sprung.report.modes_view(found, faults)))


@app.command(epilog="Example: [bold]sprung new measurements[/bold]")
def new(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Folder with the recordings.")],
    output: Annotated[
        Optional[Path],  # noqa: UP045 (typer reads it)
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            help="Folder of campaign.toml, or of one folder per setting (default: FOLDER).",
        ),
    ] = None,
    settings: Annotated[
        bool,
        typer.Option(
            "--settings/--no-settings",
            help="One campaign for each setting of the vehicle that the recordings' names state, or one for all recordings.",
        ),
    ] = True,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Draft campaign.toml from recordings: detect drops and sensors, and mark missing data."""
    with working("detecting drops") as progress:
        drafted = sprung.draft_campaigns(folder, output, progress, settings=settings, overwrite=force)
        written = [draft.write(overwrite=force) for draft in drafted]
    if as_json:
        documents = [draft.document() for draft in drafted]
        say_json(documents[0] if len(documents) == 1 else {"campaigns": documents})
    else:
        view = sprung.report.draft_view(*drafted)
        listed = "\n         ".join(map(str, written))
        say(sprung.report.text_of(view))
        say(
            f"\nWritten: {listed}\nNext:    complete the missing data, then run: sprung check {shlex.quote(str(written[0]))}\n"
        )

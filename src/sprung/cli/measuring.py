"""The commands for everything around: recordings, plans, simulations, the paper."""

from __future__ import annotations

import shlex
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Optional

import typer

import sprung
from sprung.cli import completing
from sprung.cli.app import Force, Json, app
from sprung.cli.output import REJECTED, complain, say, say_json, working
from sprung.errors import Fault, InputError, Omissions, Problem
from sprung.progress import Step


@app.command(epilog="Example: [bold]sprung check campaign.toml[/bold]")
def check(
    campaign: Annotated[
        Path,
        typer.Argument(
            metavar="CAMPAIGN",
            help="campaign.toml, complete or not, or the folder it is in; or a folder of nothing but recordings.",
            autocompletion=completing.campaigns,
        ),
    ],
    output: Annotated[
        Optional[Path],  # noqa: UP045 (typer reads it)
        typer.Option("-o", "--output", metavar="DIR", help="Where to write (default: check/ beside the campaign)."),
    ] = None,
    page: Annotated[bool, typer.Option("--page/--no-page", help="Write check.html, with every drop drawn.")] = True,
    drawings: Annotated[
        bool, typer.Option("--drawings/--no-drawings", help="Draw each drop as an SVG file too.")
    ] = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Judge the recordings, identify nothing: what is usable, what is wrong, what is missing. Needs no geometry."""
    with working("reading the recordings") as progress:
        found = sprung.check(campaign, progress=progress)
    if not found.usable:
        raise InputError(
            Problem(fault.where, fault.what, "a usable decay in at least one drop", fault.do) for fault in found.faults
        )
    beside = campaign if campaign.is_dir() else campaign.parent
    folder = (output or beside / "check").resolve()
    written: tuple[Path, ...] = ()
    omissions = Omissions()
    if page or drawings:
        with working("drawing"), omissions.record_failure("The page of the check", "written"):
            written = sprung.report.write_check(found, folder, page=page, drawings=drawings, overwrite=force)
    for omission in omissions.sentences:
        complain(omission)
    pages = [path for path in written if path.name == sprung.report.CHECK_FILE]
    drawn = [str(path) for path in written if path not in pages]
    if as_json:
        say_json({**found.document(), "page": str(pages[0]) if pages else None, "drawings": drawn})
    else:
        say(sprung.report.text_of(sprung.report.check_view(found, pages[0] if pages else None)))


@app.command(epilog="Example: [bold]sprung compare before/results after/results[/bold]")
def compare(
    results: Annotated[
        list[Path],
        typer.Argument(
            metavar="RESULTS...",
            help="Two results folders or more, or their results.json; the first is the reference.",
            autocompletion=completing.results,
        ),
    ],
    as_json: Json = False,
) -> None:
    """Put results side by side, with the significance of each difference: before and after, left and right of a line."""
    found = sprung.compare(results)
    if as_json:
        say_json(found.document())
    else:
        say(sprung.report.text_of(sprung.report.comparison_view(found)))
    if found.rejected:
        raise typer.Exit(REJECTED)


@app.command(epilog="Example: [bold]sprung modal campaign.toml --method svm[/bold]")
def modal(
    campaign: Annotated[
        Path,
        typer.Argument(
            metavar="CAMPAIGN",
            help="campaign.toml, or the folder it is in; or a recording, or a folder of nothing but them.",
            autocompletion=completing.campaigns,
        ),
    ],
    method: Annotated[
        str,
        typer.Option(
            autocompletion=completing.methods,
            help="ml, the likeliest modes, with uncertainty; or one of ml-frequency, era, era-dc, ssi-cov, ssi-data, itd, "
            "arma, svm, svm-printed, svm-rows (the paper's State Variable Method), lscf, rfp, peaks, emd.",
        ),
    ] = "ml",
    order: Annotated[
        Optional[int],  # noqa: UP045 (typer reads it)
        typer.Option(
            min=1, help="How many poles to look for, two for each mode (default: as many as the records hold)."
        ),
    ] = None,
    amplitude: Annotated[
        bool,
        typer.Option(
            "--amplitude", help="Follow each mode through the decays: frequency and damping against amplitude."
        ),
    ] = False,
    start: Annotated[
        Optional[float],  # noqa: UP045 (typer reads it)
        typer.Option(
            help="Of recordings alone: where the free decay begins, s on their clock "
            "(default: after the landing of each drop that is found, else at the largest reading)."
        ),
    ] = None,
    diagram: Annotated[bool, typer.Option("--diagram", help="Draw a stabilisation diagram beside it.")] = False,
    as_json: Json = False,
) -> None:
    """Find natural frequencies, damping ratios and shapes per load; no vehicle model."""
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
                read, method=method, order=order, amplitude=amplitude, diagram=diagram, progress=progress
            )
            faults = sprung.check(read, progress=progress).faults
    if as_json:
        say_json(
            {
                "modes": {load: [asdict(mode) for mode in one] for load, one in found.items()},
                "modal": {load: one.document() for load, one in found.items()},
            }
        )
    else:
        say(sprung.report.text_of(sprung.report.modes_view(found, faults)))


@app.command(epilog="Example: [bold]sprung simulate vehicle.toml -o campaign --noise 0.05[/bold]")
def simulate(
    vehicle: Annotated[
        Path,
        typer.Argument(
            metavar="VEHICLE.toml",
            help="Its parameters; sensors, loads and drops where not the usual ones.",
            autocompletion=completing.campaigns,
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="The campaign folder to write.")],
    rate: Annotated[float, typer.Option(max=1e5, help="Samples per second.")] = 500.0,
    noise: Annotated[float, typer.Option(max=1e3, help="Sensor noise, m/s² root-mean-square.")] = 0.02,
    seed: Annotated[int, typer.Option(min=0, help="Of the noise.")] = 1,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Write a campaign folder from a vehicle file: drops from blocks, as the sensors would record them."""
    with working("reading the vehicle") as progress:
        campaign = sprung.simulate(vehicle, rate=rate, noise=noise, seed=seed, progress=progress)
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
            help="A vehicle as it is thought to be, or a campaign to go on from.",
            autocompletion=completing.campaigns,
        ),
    ],
    wanted: Annotated[float, typer.Option(help="Percent that no parameter's uncertainty is to exceed.")] = 1.0,
    rate: Annotated[
        Optional[float],  # noqa: UP045 (typer reads it)
        typer.Option(max=1e5, help="Samples per second, with a vehicle file (default: 500)."),
    ] = None,
    noise: Annotated[
        Optional[float],  # noqa: UP045 (typer reads it)
        typer.Option(max=1e3, help="Sensor noise, m/s² root-mean-square, with a vehicle file (default: 0.02)."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Say what to measure next: how well each parameter would be known from a test, and from its alternatives."""
    with working("reading") as progress:
        drawn_up = sprung.plan(source, wanted=wanted, rate=rate, noise=noise, progress=progress)
    if as_json:
        say_json(drawn_up.document())
    else:
        say(sprung.report.text_of(sprung.report.plan_view(drawn_up)))
    if drawn_up.rejected:
        raise typer.Exit(REJECTED)


@app.command(epilog="Example: [bold]sprung new measurements[/bold]")
def new(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="The folder with the recordings.")],
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Draft campaign.toml from recordings: find the drops in them, tell the sensors, mark what is missing."""
    with working("looking for drops") as progress:
        drafted = sprung.draft(folder, progress=progress, overwrite=force)
        written = drafted.write(overwrite=force)
    if as_json:
        say_json(drafted.document())
    else:
        say(sprung.report.text_of(sprung.report.draft_view(drafted)))
        say(
            f"\nWritten: {written}\nNext:    fill in what is missing there, then sprung check {shlex.quote(str(written))}\n"
        )


@app.command(epilog="Example: [bold]sprung paper --json[/bold]")
def paper(as_json: Json = False) -> None:
    """Show the paper's tables beside ours, its misprints, and where its method breaks."""
    with working("reproducing the paper") as progress:
        reproduction = sprung.paper.reproduce(progress=progress)
    if as_json:
        say_json(reproduction.document())
    else:
        say(sprung.report.text_of(sprung.report.paper_view(reproduction)))


@app.command(epilog="Example: [bold]sprung schema > campaign.schema.json[/bold]")
def schema(as_json: Json = False) -> None:  # noqa: ARG001 (it is JSON anyhow)
    """Print the JSON Schema of campaign.toml, by which editors complete its keys and mark mistakes."""
    say_json(sprung.schema_text())

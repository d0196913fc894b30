"""Commands that identify a vehicle, and show the result."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Optional

import typer

import sprung
from sprung.cli.app import CampaignFile, Force, Json, app
from sprung.cli.completion import parameters, results
from sprung.cli.output import DEFECT, REJECTED, complain, say, say_json, working
from sprung.errors import InputError, record_failure
from sprung.progress import Progress, Step


@app.command(epilog="Example: [bold]sprung identify campaign.toml -o results[/bold]")
def identify(
    campaign: CampaignFile,
    output: Annotated[
        Optional[Path],  # noqa: UP045 (typer reads it)
        typer.Option(
            "-o", "--output", metavar="DIR", help="Output folder for results.json, series.npz and report.html."
        ),
    ] = None,
    profile: Annotated[
        Optional[list[str]],  # noqa: UP045 (typer reads it)
        typer.Option(
            metavar="NAME",
            autocompletion=parameters,
            help="Compute the 95 % interval of a weakly determined parameter from its likelihood profile; "
            "repeatable; all for every parameter.",
        ),
    ] = None,
    fall: Annotated[
        Optional[bool],  # noqa: UP045 (typer reads it)
        typer.Option(
            "--fall/--no-fall",
            help="Use the drops from their release on, not only from the last landing: smaller uncertainties, slower.",
            show_default="where an uncertainty is above 2 % without it",
        ),
    ] = None,
    report: Annotated[bool, typer.Option("--report/--no-report", help="Write report.html.")] = True,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Identify all parameters and write the results folder (default: results/ beside the campaign)."""
    folder = output or (campaign if campaign.is_dir() else campaign.parent) / "results"
    _check_folders((folder, sprung.report.REPORT_FILES if report else sprung.report.RESULT_FILES), force=force)
    with working("reading the recordings") as progress:
        read = sprung.read(campaign, progress=progress)
        saved = identify_and_save(read, folder, report, force, progress, as_json, profile=profile or (), fall=fall)
    print_and_exit(saved.result, saved.files, as_json)


def _check_folders(*folders: tuple[Path, Any], force: bool) -> None:
    """Raise, before any work is done, if folders cannot be written to, or hold files that are not as sprung wrote them."""
    problems = [
        problem
        for folder, files in folders
        for problem in sprung.files.overwriting_problems(folder, () if force else files)
    ]
    if problems:
        raise InputError(problems)


def identify_and_save(
    campaign: Any, folder: Path, report: bool, force: bool, progress: Progress, as_json: bool, **options: Any
) -> Any:
    """Identify a campaign and save the result; then add amplitude curves and report, which may fail or be interrupted."""
    run = sprung.analysis.identify_campaign(campaign, progress=progress, **options)
    progress(Step("writing results.json and series.npz"))
    try:
        saved = sprung.report.save_result(sprung.analysis.result_of(run), folder, overwrite=force)
    except InputError:
        _show(sprung.analysis.result_of(run), as_json)  # shown at least, if it cannot be saved
        raise
    if not report:
        return saved
    try:
        result = sprung.analysis.with_amplitudes(run, progress)
        progress(Step("drawing the report"))
        return sprung.report.add_report(result, folder, overwrite=force)
    except KeyboardInterrupt:
        complain(
            f"The results are complete: {', '.join(map(str, saved.files))}\n"
            f"The report is missing; write it with: sprung report {shlex.quote(str(folder))}"
        )
        raise


def print_and_exit(result: Any, written: Sequence[Path], as_json: bool) -> None:
    """Print a result and exit with the status of its verdict."""
    for omission in result.omissions:
        complain(omission)
    _show(result, as_json)
    if not as_json:
        say(f"\nWritten: {', '.join(map(str, written))}\n")
    if result.verdict.state == "reject":
        raise typer.Exit(REJECTED)


def _show(result: Any, as_json: bool) -> None:
    """Print a result."""
    if as_json:
        say_json(result.to_json())
    else:
        say(sprung.report.text_of(sprung.report.result_view(result)))


@app.command(epilog="Example: [bold]sprung report results --pdf[/bold]")
def report(
    folder: Annotated[
        Path,
        typer.Argument(metavar="DIR", help="Results folder, with results.json and series.npz.", autocompletion=results),
    ],
    pdf: Annotated[bool, typer.Option("--pdf", help="Write report.pdf too.")] = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Write the report of a saved result."""
    with working("writing the report"):
        saved = sprung.report.write_report(folder, pdf, overwrite=force)
    for omission in saved.result.omissions:
        complain(omission)
    if as_json:
        say_json({"written": [str(path) for path in saved.files]})
    else:
        say(f"Written: {', '.join(map(str, saved.files))}\n")
    if pdf and len(saved.files) < 2:
        raise typer.Exit(DEFECT)


@app.command(epilog="Example: [bold]sprung validate campaign.toml -o validation[/bold]")
def validate(
    campaign: CampaignFile,
    output: Annotated[
        Optional[Path],  # noqa: UP045 (typer reads it)
        typer.Option(
            "-o", "--output", metavar="DIR", help="Output folder for numbers, series and drawings (default: none)."
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Cross-validate the identified vehicle: each drop fitted, and predicted from the other drops."""
    if output is not None:
        _check_folders((output, ("validation.npz", "validation.json")), force=force)
    with working("reading the recordings") as progress:
        found = sprung.validate(sprung.read(campaign, progress=progress), progress=progress)
        omissions = list(found.result.omissions)
        written: tuple[Path, ...] = ()
        if output is not None:
            folder = output.resolve()
            written = sprung.report.write_validation(found, folder, {}, overwrite=force)
            progress(Step("drawing"))
            with record_failure(omissions, "The validation"):
                drawings = sprung.report.draw_validation(found)
                written = sprung.report.write_validation(found, folder, drawings, overwrite=force)
    for omission in omissions:
        complain(omission)
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
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder for the example.")] = Path("sprung-demo"),
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Write an example campaign, the paper's school bus, identify it, and compare the estimates with the true values."""
    with working("simulating the drops of the school bus") as progress:
        campaign = sprung.study.demo_campaign()
        _check_folders(
            (folder, sprung.campaign.campaign_files(campaign)),
            (folder / "results", sprung.report.REPORT_FILES),
            force=force,
        )
        written = sprung.write(campaign, folder, overwrite=force)
        read = sprung.read(written, progress=progress)
        saved = identify_and_save(read, folder / "results", True, force, progress, as_json)
    print_and_exit(saved.result, saved.files, as_json)
    if not as_json:
        truth = sprung.study.true_values(saved.result, sprung.study.DEMO_VEHICLE)
        say(f"\n{sprung.report.text_of(sprung.report.truth_view(truth))}")
        say(
            f"\nCampaign file:                 {written}\n"
            f"Report:                        {folder / 'results' / 'report.html'}\n"
            f"Results for other programs:    {folder / 'results' / 'results.json'}\n"
            f"Edit the campaign file, then:  sprung identify {shlex.quote(str(written))}\n"
        )

"""Command for ride and inspection numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Optional

import typer

import sprung
from sprung.cli import completion
from sprung.cli.app import Json, app
from sprung.cli.output import REJECTED, complain, say, say_json, working
from sprung.errors import InputError, Problem

_KMH = 3.6
"""km/h in 1 m/s."""


@app.command(epilog="Example: [bold]sprung ride results --road C --speed 100 --seat -1.4,0.4[/bold]")
def ride(
    results: Annotated[
        Path,
        typer.Argument(
            metavar="RESULTS", help="Results folder, or its results.json.", autocompletion=completion.results
        ),
    ],
    road: Annotated[
        Optional[list[str]],  # noqa: UP045 (typer reads it)
        typer.Option(metavar="CLASS", help="Road of ISO 8608, A to H; several times for several (default: A to E)."),
    ] = None,
    speed: Annotated[
        Optional[list[float]],  # noqa: UP045 (typer reads it)
        typer.Option(metavar="KMH", help="Speed, km/h; several times for several (default: 80)."),
    ] = None,
    seat: Annotated[
        Optional[list[str]],  # noqa: UP045 (typer reads it)
        typer.Option(
            metavar="X,Y[,Z]",
            help="Place on the body, m: forward of the front axle, left of the centreline and, for horizontal motion, above "
            "the ground; several times for several (default: over the axles and between them).",
        ),
    ] = None,
    load: Annotated[str, typer.Option(metavar="NAME", help="Load of the campaign.")] = "empty",
    tracks: Annotated[
        Optional[str],  # noqa: UP045 (typer reads it)
        typer.Option(
            metavar="KIND",
            help="Left and right track: isotropic, same or independent (default: isotropic; same where roll is not "
            "determined).",
        ),
    ] = None,
    hours: Annotated[float, typer.Option(metavar="H", help="Duration of the drive, for the vibration dose, h.")] = 1.0,
    as_json: Json = False,
) -> None:
    """Compute ride and inspection numbers: transmissibility, comfort on roads, EUSAMA, EGEA, damping ratios, quarter cars."""
    with working("reading the result"):
        result = sprung.load(results, series=False)
        if result.verdict.state == "reject":
            if as_json:
                verdict = {"state": "reject", "reasons": list(result.verdict.reasons)}
                say_json({"vehicle": result.name, "verdict": verdict})
            reasons = "".join(f"\n  - {reason}" for reason in result.verdict.reasons)
            complain(f"The result of {result.name} is rejected: there are no ride numbers.{reasons}")
            raise typer.Exit(REJECTED)
        numbers = sprung.ride.ride_numbers(
            result,
            roads=road or sprung.ride.USUAL_ROADS,
            speeds=[one / _KMH for one in speed] if speed else (sprung.ride.USUAL_SPEED,),
            places=_places(seat) if seat else None,
            load=load,
            tracks=tracks,
            duration=3600.0 * hours,
        )
    if as_json:
        say_json(numbers.document())
    else:
        say(sprung.report.text_of(sprung.report.ride_view(numbers)))


def _places(texts: list[str]) -> dict[str, tuple[float, ...]]:
    """Return places by name from their coordinates as text."""
    places, problems = {}, []
    for number, text in enumerate(texts, start=1):
        try:
            places["seat" if len(texts) == 1 else f"seat {number}"] = tuple(map(float, text.split(",")))
        except ValueError:
            expected = "x,y or x,y,z in m, such as -1.4,0.4"
            problems.append(Problem("--seat", f"'{text}'", expected, "Write numbers with commas and without blanks."))
    if problems:
        raise InputError(problems)
    return places

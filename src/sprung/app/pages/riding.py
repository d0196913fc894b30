"""Ride and inspection numbers of a result: `sprung ride`, its options as a form."""

from __future__ import annotations

import re

from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from sprung.app.commands import Value, arguments
from sprung.app.forms import Form, read_form
from sprung.app.queries import queries_of
from sprung.app.result_files import results_path
from sprung.app.tool_pages import read_number, read_numbers, required, show_tool, start_tool
from sprung.errors import InputError, Problem, Problems

_ROADS = "ABCDEFGH"
_TRACKS = ("isotropic", "same", "independent")
_SLOWEST, _FASTEST = 1.8, 540.0
"""km/h: the limits of the command."""

_PLACE = "two or three coordinates in m, such as -1.4 0.4"


async def show(request: Request) -> Response:
    """Answer with the form, and with the numbers that the address names."""
    query = request.query_params
    return await _page(request, {name: query.getlist(name) for name in query})


async def compute(request: Request) -> Response:
    """Compute the numbers."""
    form = await read_form(request)
    results = required(request, "results")
    try:
        command = arguments(request.app.state.workspace, "ride", results, options=_options(form))
    except InputError as error:
        return await _page(request, dict(form), error.problems)
    fields = {name: values for name, values in form.items() if any(values)}
    return start_tool(request, command, f"Ride numbers of {results or 'this folder'}", {"results": results, **fields})


def _options(form: Form) -> dict[str, Value]:
    problems = Problems()
    options: dict[str, Value] = {"road": [road for road in form.get("road", []) if road and road in _ROADS] or None}
    with problems.collect():
        expected = f"speeds from {_SLOWEST:g} to {_FASTEST:g} km/h"
        speeds = read_numbers(form.text("speed"), "Speeds", _SLOWEST, _FASTEST, expected)
        options["speed"] = [f"{speed:g}" for speed in speeds] or None
    seats = []
    for line in form.text("seat").splitlines():
        if line.strip():
            with problems.collect():
                seats.append(",".join(f"{one:g}" for one in _place(line)))
    options["seat"] = seats or None
    with problems.collect():
        hours = "a duration from 0.01 to 24 h"
        options["hours"] = read_number(form.text("hours"), "Duration of the drive", 0.01, 24, hours)
    tracks = form.text("tracks")
    options["tracks"] = tracks if tracks in _TRACKS else None
    options["load"] = form.text("load") or None
    problems.raise_if_any()
    return options


def _place(line: str) -> tuple[float, ...]:
    """Return the coordinates in a line: separated by blanks or semicolons, or by commas where decimals follow a point."""
    parts = [part for part in re.split(r"[;\s]+|,(?=\s)", line.strip()) if part]
    if len(parts) == 1 and (line.count(",") > 1 or "." in line):
        parts = line.split(",")
    numbers = read_numbers(" ".join(parts), "Seats", -30, 30, _PLACE)
    if len(numbers) not in {2, 3}:
        raise InputError([Problem("Seats", f"'{line.strip()}'", _PLACE, "Write one place in each line.")])
    return numbers


async def _page(request: Request, fields: dict[str, list[str]], problems: tuple[Problem, ...] = ()) -> Response:
    results = required(request, "results")
    folder = results_path(request.app.state.workspace, results)
    result = await queries_of(request).ask("form", "result_view:summary", folder=str(folder))
    return show_tool(
        request,
        "ride.html",
        problems=problems,
        results=results,
        result=result,
        roads=_ROADS,
        tracks=_TRACKS,
        loads=result["loads"],
        fields=fields,
    )


routes = (Route("/ride", show), Route("/ride", compute, methods=["POST"]))

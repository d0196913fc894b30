"""The identified vehicle for other programs: `sprung export`, every format."""

from __future__ import annotations

import posixpath
from dataclasses import dataclass

from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from sprung.app.commands import Value, arguments
from sprung.app.forms import Form, read_form
from sprung.app.queries import queries_of
from sprung.app.result_files import results_path
from sprung.app.tool_pages import document_of, job_of, read_number, required, show_tool, start_tool
from sprung.app.workspace import OutsideError, Workspace, inside
from sprung.errors import InputError, Problem, Problems


@dataclass(frozen=True, slots=True)
class _Format:
    """A format that the page offers: its name in the command, what it is, its options, and whether it needs all parameters."""

    name: str
    title: str
    text: str
    options: tuple[str, ...]
    needs_vehicle: bool = True


_FORMATS = (
    _Format(
        "state-space",
        "State space (MAT)",
        "Matrices A, B, C and D of the linearised vehicle, for MATLAB, Octave and python-control.",
        ("load", "amplitude", "frequency"),
    ),
    _Format("modelica", "Modelica", "A model with every term of the vehicle, for OpenModelica and Dymola.", ("load",)),
    _Format("fmu", "FMU", "A functional mock-up unit (FMI) with every term, for co-simulation.", ("load",)),
    _Format("mjcf", "MuJoCo", "A multibody model (MJCF).", ("load", "approximate")),
    _Format("commonroad", "CommonRoad", "Parameters of the multi-body vehicle model.", ("load", "approximate")),
    _Format(
        "draws",
        "Draws of the parameters",
        "Vehicles drawn from the joint distribution of the parameters, one in each row, for Monte Carlo studies.",
        ("number", "seed", "table"),
    ),
    _Format("markdown", "Markdown", "Tables of the result, to be pasted into a text.", (), False),
    _Format("latex", "LaTeX", "Tables of the result, for a paper.", (), False),
)


async def show(request: Request) -> Response:
    """Answer with the formats, and with the file that the address names a job for."""
    return await _page(request, dict(request.query_params))


async def export(request: Request) -> Response:
    """Write the vehicle in one format."""
    form = await read_form(request)
    results, to = required(request, "results"), form.text("to")
    known = {one.name: one for one in _FORMATS}
    fields = {name: values[0] for name, values in form.items()}
    try:
        if to not in known:
            expected = ", ".join(known)
            raise InputError([Problem("Format", f"'{to}'", expected, "Press the button of a format.")])
        options: dict[str, Value] = {"to": to, **_options(form, known[to]), "json": True}
        parquet = to == "draws" and form.text("table") == "parquet"
        output = inside(results, "draws.parquet") if parquet else None
        command = arguments(request.app.state.workspace, "export", results, output=output, options=options)
    except InputError as error:
        return await _page(request, fields, error.problems)
    return start_tool(request, command, f"Export to {known[to].title}", {"results": results, **fields})


def _options(form: Form, to: _Format) -> dict[str, Value]:
    problems = Problems()
    found: dict[str, Value] = {}
    limits = {
        "amplitude": ("Amplitude of suspension travel", 1e-6, 1.0, "an amplitude from 0.000001 to 1 m"),
        "frequency": ("Frequency", 0.01, 100.0, "a frequency from 0.01 to 100 Hz"),
        "number": ("Number of draws", 1, 1e6, "a whole number from 1 to 1000000"),
        "seed": ("Seed", 0, 2**32, "a whole number from 0"),
    }
    for name in to.options:
        if name in limits:
            with problems.collect():
                found[name] = read_number(form.text(name), *limits[name])
    for name in ("number", "seed"):
        value = found.get(name)
        if isinstance(value, float):
            if value != int(value):
                problems.add(limits[name][0], f"{value:g}", limits[name][3], "Write a number without decimals.")
            found[name] = int(value)
    problems.raise_if_any()
    if "load" in to.options:
        found["load"] = form.text("load") or None
    if "approximate" in to.options:
        found["approximate"] = form.text("approximate") == "yes" or None
    found["force"] = form.text("force") == "yes" or None
    return found


async def _page(request: Request, fields: dict[str, str], problems: tuple[Problem, ...] = ()) -> Response:
    results = required(request, "results")
    workspace: Workspace = request.app.state.workspace
    folder = results_path(workspace, results)
    result = await queries_of(request).ask("form", "result_view:summary", folder=str(folder))
    document = document_of(job_of(request))
    written = document.get("written") if isinstance(document, dict) else None
    return show_tool(
        request,
        "export.html",
        problems=problems,
        results=results,
        result=result,
        formats=_FORMATS,
        loads=result["loads"],
        fields=fields,
        file=_file(workspace, written),
        notes=document.get("notes", []) if isinstance(document, dict) else [],
    )


def _file(workspace: Workspace, written: object) -> str:
    """Return the file that a command has written, by its name in the folder of the page; empty if it is not there."""
    if not isinstance(written, str):
        return ""
    name = posixpath.normpath(written.replace("\\", "/"))
    try:
        return name if workspace.path(name).is_file() else ""
    except OutsideError:
        return ""


routes = (Route("/export", show), Route("/export", export, methods=["POST"]))

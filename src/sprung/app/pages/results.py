"""The page of a result: verdict, what to measure next, parameters, the report, and what can be done with it."""

from __future__ import annotations

from markupsafe import Markup
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from sprung.app.commands import arguments, as_typed
from sprung.app.queries import queries_of
from sprung.app.result_files import campaign_of, results_folders, results_path, stored_result
from sprung.app.tool_pages import required, show_tool, start_tool
from sprung.app.workspace import inside

_FILES = (
    ("report.html", "Report, one page that opens offline"),
    ("report.pdf", "Report on paper"),
    ("results.json", "Everything for other programs"),
    ("series.npz", "Time series"),
)


async def show(request: Request) -> Response:
    """Answer with the page of a result."""
    workspace = request.app.state.workspace
    name = required(request, "results")
    folder = results_path(workspace, name)
    result = await queries_of(request).ask("form", "result_view:summary", folder=str(folder))
    files = [(inside(name, file), text) for file, text in _FILES if workspace.path(inside(name, file)).is_file()]
    names = {entry.name for entry in workspace.listing().entries}
    campaign = campaign_of(stored_result(workspace, name), name, names)
    lines = [as_typed(arguments(workspace, "report", name))]
    if campaign:
        lines.insert(0, as_typed(arguments(workspace, "identify", campaign, output=name)))
    return show_tool(
        request,
        "results.html",
        results=name,
        title=name or workspace.folder.name,
        result=result,
        files=files,
        report=next((file for file, _ in files if file.endswith("report.html")), ""),
        campaign=campaign,
        others=[one for one in results_folders(workspace) if one.name != name],
        parameters=Markup(result["parameters"]),  # noqa: S704 (`Table.html` escapes its cells)
        lines=lines,
    )


async def write(request: Request) -> Response:
    """Write the report of a result that has none, or has an older one."""
    workspace = request.app.state.workspace
    name = required(request, "results")
    command = arguments(workspace, "report", name)
    return start_tool(request, command, f"Write the report of {name or 'this folder'}", {"results": name})


routes = (Route("/report", show), Route("/report", write, methods=["POST"]))

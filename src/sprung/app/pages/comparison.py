"""Two or more results compared: `sprung compare`."""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from sprung.app.commands import arguments
from sprung.app.forms import read_form
from sprung.app.result_files import results_folders
from sprung.app.tool_pages import show_tool, start_tool
from sprung.errors import InputError, Problem


def show(request: Request) -> Response:
    """Answer with the results that can be compared, and with the comparison that the address names."""
    return _page(request, request.query_params.getlist("results"))


async def compare(request: Request) -> Response:
    """Compare the chosen results; the reference is the first of them."""
    form = await read_form(request)
    chosen, reference = form.get("results", []), form.text("reference")
    ordered = [*(name for name in chosen if name == reference), *(name for name in chosen if name != reference)]
    try:
        if len(ordered) < 2:
            found = "one result" if ordered else "no result"
            raise InputError([Problem("Results", found, "two or more", "Mark those that are to be compared.")])
        command = arguments(request.app.state.workspace, "compare", *ordered)
    except InputError as error:
        return _page(request, ordered, error.problems)
    names = ", ".join(name or "this folder" for name in ordered)
    return start_tool(request, command, f"Compare {names}", {"results": ordered})


def _page(request: Request, chosen: list[str], problems: tuple[Problem, ...] = ()) -> Response:
    folders = results_folders(request.app.state.workspace)
    return show_tool(request, "compare.html", problems=problems, folders=folders, chosen=chosen)


routes = (Route("/compare", show), Route("/compare", compare, methods=["POST"]))

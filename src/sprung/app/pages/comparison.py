"""Two or more results compared: `sprung compare`."""

from __future__ import annotations

from markupsafe import Markup
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from sprung.app.commands import arguments
from sprung.app.forms import read_form
from sprung.app.queries import queries_of
from sprung.app.result_files import results_folders
from sprung.app.tool_pages import document_of, job_of, show_tool, start_tool
from sprung.errors import InputError, Problem


async def show(request: Request) -> Response:
    """Answer with the results that can be compared, and with the comparison that the address names."""
    document = document_of(job_of(request))
    found = {"text": "", "picture": ""}
    if document is not None:
        found = await queries_of(request).ask("form", "comparison_view:show", document=document)
    return _page(request, request.query_params.getlist("results"), found)


async def compare(request: Request) -> Response:
    """Compare the chosen results; the reference is the first of them."""
    form = await read_form(request)
    chosen, reference = form.get("results", []), form.text("reference")
    ordered = [*(name for name in chosen if name == reference), *(name for name in chosen if name != reference)]
    try:
        if len(ordered) < 2:
            found = "one result" if ordered else "no result"
            raise InputError([Problem("Results", found, "two or more", "Mark those that are to be compared.")])
        command = arguments(request.app.state.workspace, "compare", *ordered, options={"json": True})
    except InputError as error:
        return _page(request, ordered, {"text": "", "picture": ""}, error.problems)
    names = ", ".join(name or "this folder" for name in ordered)
    return start_tool(request, command, f"Compare {names}", {"results": ordered})


def _page(request: Request, chosen: list[str], found: dict[str, str], problems: tuple[Problem, ...] = ()) -> Response:
    return show_tool(
        request,
        "compare.html",
        problems=problems,
        folders=results_folders(request.app.state.workspace),
        chosen=chosen,
        text=found["text"],
        picture=Markup(found["picture"]),  # noqa: S704 (`picture_svg` escapes its texts)
    )


routes = (Route("/compare", show), Route("/compare", compare, methods=["POST"]))

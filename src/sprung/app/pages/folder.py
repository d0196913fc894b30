"""The first page: what is in the folder, recordings that are added to it, and drafts of campaigns."""

from __future__ import annotations

import time
from urllib.parse import urlencode

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from sprung.app.commands import arguments, as_typed, start
from sprung.app.folder_content import folder_content
from sprung.app.forms import read_form
from sprung.app.queries import queries_of
from sprung.app.rendering import render
from sprung.app.tool_pages import show_tool


def show(request: Request) -> Response:
    """Answer with the page of the folder."""
    content = folder_content(request.app.state.workspace)
    if content.campaigns or content.recordings:
        queries_of(request).warm("form")  # the next page needs it
    return render(request, "folder.html", content=content, now=time.time(), size=size_text, date=date_text)


async def draft(request: Request) -> Response:
    """Start the draft of a campaign for a folder of recordings."""
    state = request.app.state
    form = await read_form(request)
    folder = form.text("folder")
    options = {
        "settings": None if form.text("settings") == "yes" else False,
        "force": form.text("force") == "yes" or None,
    }
    command = arguments(state.workspace, "new", folder, options=options)
    job = start(state.jobs, state.workspace, command, f"Draft a campaign of {folder or state.workspace.folder.name}")
    return RedirectResponse(f"/draft?{urlencode({'folder': folder, 'job': job.id})}", 303)


def drafted(request: Request) -> Response:
    """Answer with the page of a draft: the job, and then the campaigns that it wrote."""
    workspace = request.app.state.workspace
    folder = request.query_params.get("folder", "")
    workspace.path(folder)
    content = folder_content(workspace)
    inside = [campaign for campaign in content.campaigns if campaign.name.startswith(f"{folder}/" if folder else "")]
    line = as_typed(arguments(workspace, "new", folder))
    return show_tool(request, "draft.html", folder=folder, campaigns=inside, line=line)


def size_text(size: float) -> str:
    """Return a size for people.

    Examples
    --------
    >>> [size_text(size) for size in (0, 950, 12_345, 1_270_000, 5_000_000_000)]
    ['0 B', '950 B', '12 kB', '1.3 MB', '5.0 GB']
    """
    unit = "B"
    for larger in ("kB", "MB", "GB"):
        if round(size) < 1000:
            break
        size, unit = size / 1000, larger
    return f"{size:.1f} {unit}" if unit != "B" and size < 10 else f"{size:.0f} {unit}"


def date_text(seconds: float) -> str:
    """Return a time, s since 1970, as local day and time."""
    return time.strftime("%Y-%m-%d %H:%M", time.localtime(seconds))


routes = (
    Route("/", show),
    Route("/draft", drafted),
    Route("/draft", draft, methods=["POST"]),
)

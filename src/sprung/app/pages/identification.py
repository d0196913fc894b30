"""The pages of a campaign's check and identification: their jobs, and what they found."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from urllib.parse import urlencode

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from sprung.app.commands import arguments, as_typed
from sprung.app.forms import Form, read_form
from sprung.app.jobs import Job
from sprung.app.pages.folder import date_text
from sprung.app.result_files import results_path, stored_result
from sprung.app.tool_pages import required, show_tool, start_tool
from sprung.app.workspace import Workspace, inside, parent_of

_TITLES = {"check": "Check", "identify": "Identify"}


def show_check(request: Request) -> Response:
    """Answer with the check of a campaign's recordings: the page that was written last, or the job that writes it."""
    workspace: Workspace = request.app.state.workspace
    name = required(request, "campaign")
    page = inside(parent_of(name), "check/check.html")
    path = workspace.path(page)
    written = path.stat().st_mtime if path.is_file() else 0.0
    changed = max((entry.modified for entry in _sources(workspace, name)), default=0.0)
    return _show(
        request,
        "check.html",
        name,
        page=page if written else "",
        written=date_text(written),
        stale=bool(written) and changed > written,
        line=as_typed(arguments(workspace, "check", name)),
    )


async def check(request: Request) -> Response:
    """Start the check of a campaign's recordings."""
    form = await read_form(request)
    return _start(request, "check", {"force": form.text("force") == "yes" or None})


def show_identification(request: Request) -> Response:
    """Answer with the options of an identification, or the job that does it."""
    workspace: Workspace = request.app.state.workspace
    name = required(request, "campaign")
    output = request.query_params.get("output") or inside(parent_of(name), "results")
    results_path(workspace, output)
    verdict = _verdict_in(workspace, output)
    return _show(
        request,
        "identify.html",
        name,
        output=output,
        verdict=verdict,
        existing_date=date_text(workspace.path(inside(output, "results.json")).stat().st_mtime) if verdict else "",
        line=as_typed(arguments(workspace, "identify", name, output=output)),
    )


async def identify(request: Request) -> Response:
    """Start an identification."""
    form = await read_form(request)
    options = {
        "profile": _profiled(form) or None,
        "fall": {"yes": True, "no": False}.get(form.text("fall")),
        "force": form.text("force") == "yes" or None,
    }
    output = form.text("output").strip("/") or inside(parent_of(required(request, "campaign")), "results")
    return _start(request, "identify", options, output)


def _profiled(form: Form) -> list[str]:
    """Return the parameters whose likelihood profile is asked for: words, which cannot be taken for options."""
    words = form.text("profile").replace(",", " ").split()
    return [word for word in words if word.replace("_", "").isalnum()]


def _start(request: Request, command: str, options: Mapping[str, Any], output: str | None = None) -> Response:
    name = required(request, "campaign")
    line = arguments(request.app.state.workspace, command, name, output=output, options=options)
    query = {"campaign": name} | ({"output": output} if output else {})
    return start_tool(request, line, f"{_TITLES[command]} {name}", query)


def _show(request: Request, template: str, name: str, **context: Any) -> Response:
    """Answer with a page; without a job in its address it shows the one that runs for this campaign, if there is one."""
    workspace: Workspace = request.app.state.workspace
    command = request.url.path.strip("/")
    if not workspace.path(name).is_file():
        return RedirectResponse(f"/campaign?{urlencode({'campaign': name})}", 303)  # which says that there is none
    if "job" not in request.query_params:
        running = _running(request, command, name)
        if running is not None:
            return RedirectResponse(f"/{command}?{urlencode({'campaign': name, 'job': running.id})}", 303)
    return show_tool(request, template, campaign=name, **context)


def _running(request: Request, command: str, name: str) -> Job | None:
    """Return the job that has been started for a campaign in another tab, or before this page was loaded again."""
    wanted = arguments(request.app.state.workspace, command, name)
    jobs: tuple[Job, ...] = request.app.state.jobs.all()
    return next((job for job in jobs if not job.is_over and job.arguments[: len(wanted)] == wanted), None)


def _sources(workspace: Workspace, name: str) -> list[Any]:
    """Return the campaign file and the files beside it."""
    folder = parent_of(name)
    return [entry for entry in workspace.listing(folder, 0).entries if not entry.is_folder]


def _verdict_in(workspace: Workspace, folder: str) -> str:
    """Return the state of the verdict of the result in a folder; empty where there is none."""
    verdict = stored_result(workspace, folder).get("verdict")
    return str(verdict.get("state", "")) if isinstance(verdict, dict) else ""


routes = (
    Route("/check", show_check),
    Route("/check", check, methods=["POST"]),
    Route("/identify", show_identification),
    Route("/identify", identify, methods=["POST"]),
)

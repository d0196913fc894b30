"""The pages of a campaign's check and identification: their jobs, and what they found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any
from urllib.parse import urlencode

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from sprung.app.commands import arguments, as_typed, output_of
from sprung.app.forms import Form, read_form
from sprung.app.jobs import Job, Jobs
from sprung.app.pages.folder import date_text
from sprung.app.result_files import default_results, results_path, stored_result
from sprung.app.tool_pages import job_of, required, show_tool, start_tool
from sprung.app.workspace import OutsideError, Workspace, inside, parent_of
from sprung.errors import InputError, Problem

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
    job = job_of(request)
    output = output_of(job.arguments) if job else request.query_params.get("output", "")
    output = output or default_results(workspace, name)
    results_path(workspace, output)
    return _identification_page(request, name, output)


def _identification_page(
    request: Request, name: str, output: str, entered: str = "", problems: Sequence[Problem] = ()
) -> Response:
    """Answer with the page; `entered` is a results folder that cannot be used, for the reason among the problems."""
    workspace: Workspace = request.app.state.workspace
    verdict = _verdict_in(workspace, output)
    return _show(
        request,
        "identify.html",
        name,
        problems=problems,
        output=output,
        entered=entered or output,
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
    workspace: Workspace = request.app.state.workspace
    name, entered = required(request, "campaign"), form.text("output")
    default = default_results(workspace, name)
    output = entered.removesuffix("/") or default
    try:
        check_output(workspace, request.app.state.jobs, name, output)
    except InputError as error:
        return _identification_page(request, name, default, entered, error.problems)
    return _start(request, "identify", options, output)


def check_output(workspace: Workspace, jobs: Jobs, campaign: str, output: str) -> None:
    """Check that a folder can take a result: in the folder of the page, without other files, and not about to be written."""
    where, do = "Results folder", "Enter another one, such as results-2."
    try:
        path = results_path(workspace, output)
    except OutsideError as error:
        expected = f"the name of a folder in {workspace.folder.name}"
        raise InputError([Problem(where, f"'{output}'", expected, do)]) from error
    own = {entry.name.rpartition("/")[2] for entry in (workspace.listing(output, 0).entries if path.is_dir() else ())}
    others = {
        inside(parent_of(campaign), folder) for folder in ("check", "validation")
    }  # of the commands of these names
    if path.is_file() or output in others or (own and "results.json" not in own):
        expected = "a new folder, or one with a result"
        raise InputError([Problem(where, f"'{output}', a place of other files", expected, do)])
    begin = arguments(workspace, "identify", campaign)
    for job in jobs.all():
        is_other = job.arguments[0] == "identify" and job.arguments[: len(begin)] != begin
        if is_other and not job.is_over and output_of(job.arguments) == output:
            raise InputError([Problem(where, f"'{output}', into which “{job.title}” writes", "another folder", do)])


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
    if "job" not in request.query_params and request.method != "POST":
        running = _running(request, command, name)
        if running is not None:
            output = output_of(running.arguments)
            query = {"campaign": name} | ({"output": output} if output else {}) | {"job": running.id}
            return RedirectResponse(f"/{command}?{urlencode(query)}", 303)
    return show_tool(request, template, campaign=name, **context)


def _running(request: Request, command: str, name: str) -> Job | None:
    """Return the job that has been started for a campaign in another tab, or before this page was loaded again.

    Where the address names a results folder, only the one that writes into it.
    """
    wanted_output = request.query_params.get("output")
    wanted = arguments(request.app.state.workspace, command, name)
    jobs: tuple[Job, ...] = request.app.state.jobs.all()
    own = [job for job in jobs if not job.is_over and job.arguments[: len(wanted)] == wanted]
    return next((job for job in own if wanted_output in {None, output_of(job.arguments)}), None)


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

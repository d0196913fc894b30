"""Validation of a campaign and the plan of its next measurement: `sprung validate` and `sprung plan`."""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from sprung.app.commands import arguments
from sprung.app.forms import Form, read_form
from sprung.app.jobs import Job
from sprung.app.tool_pages import job_of, read_number, required_campaign, show_tool, start_tool
from sprung.app.workspace import Workspace, inside, parent_of
from sprung.errors import InputError, Problem


def show_validation(request: Request) -> Response:
    """Answer with the validation that the address names: the text of the command, and its drawings."""
    campaign = required_campaign(request)
    workspace: Workspace = request.app.state.workspace
    folder = _validation_folder(campaign)
    drawings = [
        entry.name
        for entry in (workspace.listing(folder, 0).entries if workspace.path(folder).is_dir() else ())
        if entry.name.endswith(".svg")
    ]
    return show_tool(request, "validate.html", campaign=campaign, folder=folder, drawings=_of_job(request, drawings))


async def validate(request: Request) -> Response:
    """Cross-validate a campaign; numbers and drawings are written beside it."""
    campaign = required_campaign(request)
    folder = _validation_folder(campaign)
    command = arguments(request.app.state.workspace, "validate", campaign, output=folder)
    return start_tool(request, command, f"Validate {campaign}", {"campaign": campaign})


def _validation_folder(campaign: str) -> str:
    return inside(parent_of(campaign), "validation")


def _of_job(request: Request, drawings: list[str]) -> list[str]:
    """Return the drawings in the order of the drops, if the job has made them; those of the modes come last."""
    job = job_of(request)
    if job is None or job.state != "done":
        return []
    return sorted(drawings, key=lambda name: (name.endswith("/amplitude.svg"), name))


def show_plan(request: Request) -> Response:
    """Answer with the plan that the address names."""
    return _plan_page(request, dict(request.query_params))


async def plan(request: Request) -> Response:
    """Plan the next measurement of a campaign, or the first of a vehicle."""
    form = await read_form(request)
    campaign = required_campaign(request)
    fields = {name: form.text(name) for name in ("wanted", "rate", "noise", "terms")}
    try:
        command = arguments(request.app.state.workspace, "plan", campaign, options=_options(form))
    except InputError as error:
        return _plan_page(request, fields, error.problems)
    return start_tool(request, command, f"Plan the next measurement of {campaign}", {"campaign": campaign, **fields})


def _options(form: Form) -> dict[str, float | bool | None]:
    wanted = "a largest acceptable uncertainty from 0.001 to 100 %"
    return {
        "wanted": read_number(form.text("wanted"), "Acceptable uncertainty", 0.001, 100, wanted),
        "rate": read_number(form.text("rate"), "Sampling rate", 1, 1e5, "a sampling rate from 1 to 100000 Hz"),
        "noise": read_number(form.text("noise"), "Noise", 1e-9, 1e3, "a noise up to 1000 m/s² rms"),
        "terms": form.text("terms") == "yes" or None,
    }


def _plan_page(request: Request, fields: dict[str, str], problems: tuple[Problem, ...] = ()) -> Response:
    job = job_of(request)
    return show_tool(
        request,
        "plan.html",
        problems=problems,
        campaign=required_campaign(request),
        fields=fields,
        next_step=_next_step(job),
    )


def _next_step(job: Job | None) -> str:
    """Return the recommended measurement: the line of the plan that begins with it, and those that continue it."""
    if job is None or job.state != "done":
        return ""
    _, mark, text = job.output.rpartition("\nNext: ")
    return " ".join(text.split()) if mark else ""


routes = (
    Route("/validate", show_validation),
    Route("/validate", validate, methods=["POST"]),
    Route("/plan", show_plan),
    Route("/plan", plan, methods=["POST"]),
)

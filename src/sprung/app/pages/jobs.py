"""State, output and cancelling of jobs: a page for people, JSON for the scripts of other pages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from urllib.parse import urlsplit

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, RedirectResponse, Response
from starlette.routing import Route

from sprung.app.commands import as_typed
from sprung.app.jobs import Job
from sprung.app.rendering import render, wants_page


def all_jobs(request: Request) -> Response:
    """Answer with every job, the newest first."""
    jobs: tuple[Job, ...] = request.app.state.jobs.all()
    return _page(request, jobs) if wants_page(request) else JSONResponse([job.document() for job in jobs])


def one_job(request: Request) -> Response:
    """Answer with everything that is known of a job."""
    job = _job(request)
    if wants_page(request):
        return _page(request, (job,), single=True)
    more = {
        "command": as_typed(job.arguments),
        "steps": [asdict(step) for step in job.steps],
        "output": job.output,
        "messages": job.messages,
    }
    return JSONResponse({**job.document(), **more})


def cancel(request: Request) -> Response:
    """Stop a job, and answer with its state, or with the page on which the button was."""
    job: Job = request.app.state.jobs.cancel(_job(request).id)
    if not wants_page(request):
        return JSONResponse(job.document())
    before = urlsplit(request.headers.get("referer", ""))
    same = before.netloc == request.headers["host"]
    back = f"{before.path}?{before.query}" if same and not before.path.startswith("//") else f"/jobs/{job.id}"
    return RedirectResponse(back, 303)


def _page(request: Request, jobs: Sequence[Job], single: bool = False) -> Response:
    shown = [(job, as_typed(job.arguments)) for job in jobs]
    return render(request, "jobs.html", jobs=shown, single=single)


def _job(request: Request) -> Job:
    try:
        job: Job = request.app.state.jobs.get(request.path_params["id"])
    except KeyError:
        raise HTTPException(404, "There is no such job; the server may have been started again since.") from None
    return job


routes = (
    Route("/jobs", all_jobs),
    Route("/jobs/{id}", one_job),
    Route("/jobs/{id}/cancel", cancel, methods=["POST"]),
)

"""State, output and cancelling of jobs."""

from __future__ import annotations

from dataclasses import asdict

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from sprung.app.jobs import Job


def all_jobs(request: Request) -> Response:
    """Answer with the state of every job, the newest first."""
    return JSONResponse([job.document() for job in request.app.state.jobs.all()])


def one_job(request: Request) -> Response:
    """Answer with everything that is known of a job."""
    job = _job(request)
    steps = [asdict(step) for step in job.steps]
    more = {"arguments": list(job.arguments), "steps": steps, "output": job.output, "messages": job.messages}
    return JSONResponse({**job.document(), **more})


def cancel(request: Request) -> Response:
    """Stop a job, and answer with its state."""
    return JSONResponse(request.app.state.jobs.cancel(_job(request).id).document())


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

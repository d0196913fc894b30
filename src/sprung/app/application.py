"""The ASGI application: the pages, what they share, and what is answered to an error."""

from __future__ import annotations

import asyncio
from http import HTTPStatus

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.types import ASGIApp

from sprung.app import events, uploads
from sprung.app.access import Access, Keys
from sprung.app.jobs import Jobs, TooManyJobsError
from sprung.app.pages import (
    assets,
    campaign,
    comparison,
    exporting,
    files,
    folder,
    identification,
    motion,
    planning,
    recordings,
    results,
    riding,
)
from sprung.app.pages import jobs as job_pages
from sprung.app.queries import Queries, QueryError
from sprung.app.rendering import render, wants_page
from sprung.app.workspace import ChangedError, OutsideError, Workspace
from sprung.errors import SprungError

LARGEST_BODY = 4_000_000
"""Largest body of a form in bytes: twice the largest campaign.toml, with every character that needs it escaped."""

_PAGES = (
    *(assets, folder, campaign, identification, files, job_pages),
    *(results, comparison, planning, exporting, riding, motion, recordings),
)
"""Modules with the routes of pages, in the order in which they are matched."""

_STATUS: dict[type[Exception], int] = {
    OutsideError: 404,
    ChangedError: 409,
    TooManyJobsError: 429,
    QueryError: 503,
    SprungError: 400,
}

_TITLES = {
    400: "This cannot be used",
    404: "Not found",
    409: "Changed meanwhile",
    413: "Too large",
    429: "Too many jobs",
    500: "A defect of sprung",
    503: "Busy",
}
"""Headings of the pages that are shown instead of others, by HTTP status."""


def create_application(workspace: Workspace, jobs: Jobs, queries: Queries, keys: Keys, port: int) -> ASGIApp:
    """Return the application.

    Parameters
    ----------
    workspace, jobs, queries
        In handlers, ``request.app.state.workspace`` and so on.
    keys
        Token and cookie.
    port
        Port on which the server listens.
    """
    routes = [route for module in (events, uploads, *_PAGES) for route in module.routes]
    application = Starlette(
        routes=routes,
        exception_handlers={
            SprungError: _sprung_error,
            HTTPException: _http_error,
            Exception: _defect,
        },
    )
    application.state.workspace = workspace
    application.state.jobs = jobs
    application.state.queries = queries
    application.state.streams = 0
    application.state.uploads = asyncio.Semaphore(uploads.AT_ONCE)
    return Access(application, keys, port, {"/": LARGEST_BODY, uploads.PATH: uploads.LARGEST})


def _sprung_error(request: Request, error: Exception) -> Response:
    status = next(status for kind, status in _STATUS.items() if isinstance(error, kind))
    return message(request, status, str(error))


def _http_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)  # noqa: S101 (registered for these)
    return message(request, error.status_code, error.detail)


def _defect(request: Request, error: Exception) -> Response:
    return message(request, 500, f"This is a defect of sprung ({type(error).__name__}: {error}). Nothing was written.")


def message(request: Request, status: int, text: str) -> Response:
    """Return the answer to a request that failed: a page, or plain text for a script."""
    if wants_page(request):
        return render(
            request,
            "message.html",
            status,
            title=_TITLES.get(status, HTTPStatus(status).phrase),
            lines=text.splitlines(),
        )
    return PlainTextResponse(f"{text}\n", status)

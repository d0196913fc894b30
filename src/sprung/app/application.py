"""The ASGI application: the pages, what they share, and what is answered to an error."""

from __future__ import annotations

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Mount
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp

from sprung.app import events, uploads
from sprung.app.access import Access, Keys
from sprung.app.jobs import Jobs, TooManyJobsError
from sprung.app.pages import files, jobs
from sprung.app.rendering import FOLDER
from sprung.app.workspace import ChangedError, OutsideError, Workspace
from sprung.errors import SprungError

LARGEST_BODY = 8_000_000
"""Largest body of a form in bytes; a campaign.toml has at most half of it."""

_PAGES = (files, jobs)
"""Modules with the routes of pages, in the order in which they are matched."""

_STATUS: dict[type[Exception], int] = {OutsideError: 404, ChangedError: 409, TooManyJobsError: 429, SprungError: 400}


def create_application(workspace: Workspace, jobs: Jobs, keys: Keys, port: int) -> ASGIApp:
    """Return the application.

    Parameters
    ----------
    workspace, jobs
        In handlers, ``request.app.state.workspace`` and ``request.app.state.jobs``.
    keys
        Token and cookie.
    port
        Port on which the server listens.
    """
    routes = [route for module in (events, uploads, *_PAGES) for route in module.routes]
    static = [Mount(f"/{name}", StaticFiles(directory=FOLDER / name)) for name in ("scripts", "styles")]
    application = Starlette(
        routes=[*static, *routes],
        exception_handlers={
            SprungError: _sprung_error,
            HTTPException: _http_error,
            Exception: _defect,
        },
    )
    application.state.workspace = workspace
    application.state.jobs = jobs
    application.state.streams = 0
    return Access(application, keys, port, {"/": LARGEST_BODY, uploads.PATH: uploads.LARGEST})


def _sprung_error(request: Request, error: Exception) -> Response:
    status = next(status for kind, status in _STATUS.items() if isinstance(error, kind))
    return message(request, status, str(error))


def _http_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)  # noqa: S101 (registered for these)
    return message(request, error.status_code, error.detail)


def _defect(request: Request, error: Exception) -> Response:
    return message(request, 500, f"This is a defect of sprung ({type(error).__name__}: {error}). Nothing was written.")


def message(request: Request, status: int, text: str) -> Response:  # noqa: ARG001 (a page for browsers needs it)
    """Return the answer to a request that failed."""
    return PlainTextResponse(f"{text}\n", status)

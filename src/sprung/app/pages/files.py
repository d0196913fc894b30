"""Files of the folder as they are: to download, and reports to read."""

from __future__ import annotations

import mimetypes

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import Route

from sprung.app.access import REPORT_POLICY

_SHOWN = {".html": "text/html; charset=utf-8", ".svg": "image/svg+xml", ".png": "image/png"}
"""Kinds of files that a browser shows; all others are downloaded, also PDF, which browsers do not show in a sandbox."""


def file(request: Request) -> Response:
    """Answer with a file. A page or picture from the folder runs as a site of its own: it can read or request nothing."""
    path = request.app.state.workspace.path(request.path_params["name"])
    if not path.is_file():
        raise HTTPException(404, f"There is no file {request.path_params['name']}.")
    kind = _SHOWN.get(path.suffix.lower())
    return FileResponse(
        path,
        media_type=kind or mimetypes.guess_type(path.name)[0] or "application/octet-stream",
        filename=path.name,
        content_disposition_type="inline" if kind and "download" not in request.query_params else "attachment",
        headers={"Content-Security-Policy": REPORT_POLICY},
    )


routes = (Route("/files/{name:path}", file),)

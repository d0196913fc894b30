"""Pages from templates: every text is escaped."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from starlette.requests import Request
from starlette.responses import HTMLResponse

FOLDER = Path(__file__).parent
"""Folder with the templates, scripts and style sheets."""


@functools.cache
def environment() -> Environment:
    """Return the environment of the templates."""
    return Environment(
        loader=FileSystemLoader(FOLDER / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def render(request: Request, template: str, status: int = 200, **context: Any) -> HTMLResponse:
    """Return a page.

    Parameters
    ----------
    request
        The request, which the template sees as ``request``.
    template
        File in the folder of templates.
    status
        HTTP status.
    **context
        Variables of the template, besides ``workspace_name``, and ``here``, the path of the page.

    Returns
    -------
    HTMLResponse
    """
    common = {
        "request": request,
        "workspace_name": request.app.state.workspace.folder.name,
        "here": request.url.path,
    }
    text = environment().get_template(template).render(**common, **context)
    return HTMLResponse(text, status)


def wants_page(request: Request) -> bool:
    """Return whether a request shows a page in the browser; scripts ask for JSON instead."""
    return "text/html" in request.headers.get("accept", "")

"""Recordings side by side: channels of several campaigns or files in one picture."""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from sprung.app.rendering import render


def show(request: Request) -> Response:
    """Answer with the page; its script asks for what it shows."""
    return render(request, "recordings.html")


routes = (Route("/recordings", show),)

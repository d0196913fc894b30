"""Recordings side by side: channels of several campaigns or files in one picture, with a time offset for each file."""

from __future__ import annotations

import json
import math
from typing import Any

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from sprung.app.commands import check_links
from sprung.app.folder_content import folder_content
from sprung.app.forms import read_form
from sprung.app.queries import queries_of
from sprung.app.rendering import render

_MOST_FILES = 20
"""Most files of one question."""


def show(request: Request) -> Response:
    """Answer with the page; its script asks for channels and samples."""
    content = folder_content(request.app.state.workspace)
    return render(request, "recordings.html", folders=content.recordings)


async def channels(request: Request) -> Response:
    """Answer with the channels of some recordings, or why they cannot be read."""
    names = request.query_params.getlist("file")[:_MOST_FILES]
    paths = {name: _path(request, name) for name in names}
    return JSONResponse(await queries_of(request).ask("recording", "recordings_view:channels", files=paths))


async def visible(request: Request) -> Response:
    """Answer with what is to be drawn of some channels of a recording."""
    query = request.query_params
    answer = await queries_of(request).ask(
        "recording",
        "recordings_view:visible",
        path=_path(request, query.get("file", "")),
        wanted=query.getlist("channel"),
        low=_number(query.get("low", "")),
        high=_number(query.get("high", "")),
        pixels=min(int(_number(query.get("pixels", "800"))), 4000),
    )
    return JSONResponse(answer)


async def visible_csv(request: Request) -> Response:
    """Answer with every sample that is visible, as a CSV file to save."""
    form = await read_form(request)
    try:
        wanted: Any = json.loads(form.text("visible"))
        parts = [
            {
                "file": str(part["file"]),
                "path": _path(request, str(part["file"])),
                "offset": _number(part["offset"]),
                "channels": [str(channel) for channel in part["channels"]],
            }
            for part in wanted["parts"][:_MOST_FILES]
        ]
        low, high = _number(wanted["low"]), _number(wanted["high"])
    except (ValueError, LookupError, TypeError) as error:
        raise HTTPException(400, "The form does not say what is visible. Load the page again.") from error
    text = await queries_of(request).ask("recording", "recordings_view:visible_csv", parts=parts, low=low, high=high)
    headers = {"Content-Disposition": 'attachment; filename="visible.csv"'}
    return Response("\ufeff" + text, media_type="text/csv; charset=utf-8", headers=headers)


def _path(request: Request, name: str) -> str:
    path = request.app.state.workspace.path(name)
    if path.suffix.lower() in {".mme", ".chn"}:  # the channels are in files of their own beside it
        check_links(request.app.state.workspace, name)
    if not path.is_file():
        raise HTTPException(404, f"There is no file {name}.")
    return str(path)


def _number(value: object) -> float:
    number = float(value) if isinstance(value, int | float | str) and value != "" else math.nan
    if not math.isfinite(number):
        raise HTTPException(400, f"{value!r} is no number.")
    return number


routes = (
    Route("/recordings", show),
    Route("/recordings/channels", channels),
    Route("/recordings/visible", visible),
    Route("/recordings/visible.csv", visible_csv, methods=["POST"]),
)

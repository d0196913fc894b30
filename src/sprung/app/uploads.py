"""Recordings that are dropped on the page: written whole into a folder, and never over a file that is there."""

from __future__ import annotations

import os
import shutil
from contextlib import suppress
from pathlib import Path

from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from sprung.app.workspace import NEW, Workspace, unwritable
from sprung.files import new_token, temporary_path

PATH = "/upload/"
"""Beginning of the addresses to which files are sent."""

LARGEST = 2 << 30
"""Largest file, bytes."""

_SPARE = 200 << 20
"""Space that remains free on the disk, bytes."""

AT_ONCE = 4
"""Number of uploads that are received at the same time; the others wait."""


async def upload(request: Request) -> Response:
    """Receive one file, its bytes as the body: ``PUT /upload/FOLDER/NAME``."""
    workspace: Workspace = request.app.state.workspace
    name = request.path_params["name"]
    if request.headers.get("content-type", "application/octet-stream") != "application/octet-stream":
        raise HTTPException(415, "A file is sent as application/octet-stream.")
    path = workspace.new_path(name)
    length = int(request.headers["content-length"])
    if length > shutil.disk_usage(path.parent).free - _SPARE:
        raise HTTPException(507, f"{name} has {length} bytes, for which the disk has no room.")
    async with request.app.state.uploads:
        await _receive(request, workspace, path)
    return JSONResponse({"name": name, "size": length}, 201)


async def _receive(request: Request, workspace: Workspace, path: Path) -> None:
    """Write the body of a request to a hidden file, and give it its name when it is whole."""
    new = temporary_path(path, new_token(), "new")
    try:
        with new.open("xb") as file:
            async for piece in request.stream():
                await run_in_threadpool(file.write, piece)
            file.flush()
            await run_in_threadpool(os.fsync, file.fileno())
        workspace.install(new, path, NEW)
    except OSError as error:
        raise unwritable(path.name, error) from error
    except ClientDisconnect as error:
        raise HTTPException(400, f"{path.name} did not arrive whole; nothing was written.") from error
    finally:
        with suppress(OSError):
            new.unlink(missing_ok=True)


routes = (Route(f"{PATH}{{name:path}}", upload, methods=["PUT"]),)

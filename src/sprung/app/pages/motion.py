"""Mode shapes and fitted motions as a wire frame in space, and the dampers with the measured accelerations behind them."""

from __future__ import annotations

from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from sprung.app.commands import arguments, as_typed
from sprung.app.queries import queries_of
from sprung.app.rendering import render
from sprung.app.result_files import results_path
from sprung.app.tool_pages import required


async def show(request: Request) -> Response:
    """Answer with the page; its script asks for what it shows."""
    name = required(request, "results")
    workspace = request.app.state.workspace
    folder = results_path(workspace, name)
    result = await queries_of(request).ask("form", "result_view:summary", folder=str(folder))
    lines = [as_typed(arguments(workspace, "report", name))]
    return render(request, "motion.html", results=name, result=result, lines=lines)


async def scene(request: Request) -> Response:
    """Answer with the wire frame, the modes and the names of the drops."""
    return JSONResponse(await _asked(request, "scene"))


async def drop(request: Request) -> Response:
    """Answer with the motion in one drop."""
    return JSONResponse(await _asked(request, "drop_motion", drop=required(request, "drop")))


async def dampers(request: Request) -> Response:
    """Answer with the pictures of the dampers."""
    return JSONResponse(await _asked(request, "dampers", drop=request.query_params.get("drop", "")))


async def _asked(request: Request, question: str, **more: str) -> Any:
    folder = results_path(request.app.state.workspace, required(request, "results"))
    return await queries_of(request).ask("recording", f"motion_view:{question}", folder=str(folder), **more)


routes = (
    Route("/motion", show),
    Route("/motion/scene", scene),
    Route("/motion/drop", drop),
    Route("/motion/dampers", dampers),
)

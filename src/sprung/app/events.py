"""Server-sent events: the state of every job that changes, for pages that are open."""

from __future__ import annotations

import asyncio
import json
import secrets
from collections.abc import AsyncIterator

from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route
from starlette.types import Receive, Scope, Send

from sprung.app.jobs import Jobs

OPEN = 50
"""Most streams that are open at the same time: a browser opens one for each tab."""

_QUIET = 10.0
"""Time after which a comment is sent that keeps the connection, s."""

_SHORTEST = 0.1
"""Least time between two events of a stream, s: a fit reports many steps."""

_RUN = secrets.token_hex(4)
"""This server: the numbers of changes of an earlier one mean nothing to it."""


async def events(request: Request) -> Response:
    """Answer with a stream of states; one that was interrupted goes on after its Last-Event-ID.

    With ``?job=ID`` it contains only that job and ends with it: a browser opens at most six connections to one server.
    """
    state = request.app.state
    if state.streams >= OPEN:
        return Response(f"{OPEN} pages follow the jobs already.", 503, {"Retry-After": "5"})
    run, _, number = request.headers.get("last-event-id", "").partition("-")
    wanted = request.query_params.get("job")
    last = int(number) if run == _RUN and number.isdecimal() and len(number) < 16 else 0
    if wanted is not None and all(job.is_over and job.change <= last for job in state.jobs.all() if job.id == wanted):
        return Response(status_code=204)  # the browser does not connect again

    return _CountedStream(_states(state.jobs, last, wanted), state)


class _CountedStream(StreamingResponse):
    """A stream that is counted while it is open, however it ends."""

    media_type = "text/event-stream"

    def __init__(self, content: AsyncIterator[str], state: State) -> None:
        super().__init__(content)
        self._state = state

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        self._state.streams += 1
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._state.streams -= 1


async def _states(jobs: Jobs, last: int, wanted: str | None) -> AsyncIterator[str]:
    """Yield an event for every changed job, or the wanted one, until it is over or the server stops."""
    loop, changed = asyncio.get_running_loop(), asyncio.Event()
    end = jobs.listen(lambda: loop.call_soon_threadsafe(changed.set))
    try:
        yield "retry: 1000\n\n"
        while not jobs.is_closing:
            changed.clear()
            for job in jobs.changed_since(last):
                last = job.change
                if wanted in {None, job.id}:
                    yield f"id: {_RUN}-{last}\nevent: job\ndata: {json.dumps(job.document())}\n\n"
                    if wanted and job.is_over:
                        return
            await asyncio.sleep(_SHORTEST)
            try:
                await asyncio.wait_for(changed.wait(), _QUIET)
            except TimeoutError:
                yield ": still here\n\n"
    finally:
        end()


routes = (Route("/events", events),)

"""The server: one address on this machine, until Ctrl-C."""

from __future__ import annotations

import asyncio
import errno
import os
import socket
import sys
import threading
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h11
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from sprung.app.access import Keys
from sprung.app.application import create_application
from sprung.app.jobs import Jobs
from sprung.app.queries import Queries
from sprung.app.workspace import Workspace
from sprung.errors import InputError, Problem

ADDRESS = "127.0.0.1"
"""The only address on which the server listens."""

CONNECTIONS = 8192
"""Open files that the server needs at most: as many connections, nearly."""

HEADER_TIME = 20.0
"""Time in which a client must send the head of a request, s."""


def serve(
    folder: str | os.PathLike[str],
    *,
    port: int = 0,
    open_browser: bool = True,
    announce: Callable[[str], None] = print,
) -> None:
    """Serve the page of a folder until the process is interrupted.

    Parameters
    ----------
    folder
        Folder of recordings and campaigns; nothing outside it is read or written.
    port
        Port on 127.0.0.1; 0 for any that is free.
    open_browser
        Whether the page is opened in the browser of this user.
    announce
        Called with the address, which contains its token, once the server listens.

    Raises
    ------
    InputError
        If there is no such folder, or the port is taken.
    """
    if not Path(folder).is_dir():
        do = "Name the folder of the recordings, or make it first."
        raise InputError([Problem(str(folder), "no folder", "a folder", do)])
    workspace = Workspace(folder)
    with _listen(port) as listening:
        port = listening.getsockname()[1]
        keys, jobs, queries = Keys(), Jobs(), Queries()
        workspace.recover()
        _allow_many_connections()
        application = create_application(workspace, jobs, queries, keys, port)
        config = uvicorn.Config(
            application,
            http=_Protocol,
            ws="none",
            log_config=None,
            access_log=False,
            server_header=False,
            proxy_headers=False,
            lifespan="off",  # a second interrupt would break it off with a traceback, and it has nothing to do
            timeout_graceful_shutdown=1,
            backlog=2048,
        )
        address = f"http://{ADDRESS}:{port}/?token="

        def listens() -> None:
            announce(f"{address}{keys.token}")
            if open_browser and _has_screen():
                threading.Thread(target=webbrowser.open, args=(f"{address}{keys.ticket()}",), daemon=True).start()

        try:
            _Server(config, jobs, listens).run([listening])
        finally:
            jobs.close()
            queries.close()


class _Protocol(H11Protocol):
    """HTTP, with a limit of the time in which the head of a request must arrive."""

    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: Any) -> None:
        super().connection_made(transport)
        self._watch()

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        self._watch()

    def connection_lost(self, exc: Exception | None) -> None:
        super().connection_lost(exc)
        if self._deadline is not None:
            self._deadline.cancel()

    def _watch(self) -> None:
        """Close the connection in a while, unless a whole head has arrived."""
        waits = self.conn.their_state is h11.IDLE
        if waits and self._deadline is None:
            self._deadline = self.loop.call_later(HEADER_TIME, self.transport.close)
        elif not waits and self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None


class _Server(uvicorn.Server):
    """A server that says when it listens, and ends its streams when it stops."""

    def __init__(self, config: uvicorn.Config, jobs: Jobs, listens: Callable[[], None]) -> None:
        super().__init__(config)
        self._jobs = jobs
        self._listens = listens

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self._listens()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        self._jobs.refuse_more()
        await super().shutdown(sockets)


def _listen(port: int) -> socket.socket:
    """Return a socket that listens on a port of this machine."""
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    if sys.platform == "win32":
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)
    else:  # a port whose last connections are being closed is free
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((ADDRESS, port))
    except OSError as error:
        listening.close()
        taken = error.errno == errno.EADDRINUSE
        found = "a port that another program uses" if taken else f"a port that cannot be used ({error.strerror})"
        do = "Leave --port out: any free port is then used. Or choose another one."
        raise InputError([Problem(f"--port {port}", found, "a free port", do)]) from error
    return listening


def _allow_many_connections() -> None:
    """Raise the limit of open files, of which every connection is one, as far as the system permits without privileges."""
    try:
        import resource  # noqa: PLC0415 (not on Windows)

        hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard if 0 < hard < CONNECTIONS else CONNECTIONS, hard))
    except (ImportError, OSError, ValueError):
        return


def _has_screen() -> bool:
    """Whether a browser has a screen to open on; in a terminal over a network it would be one of text."""
    return sys.platform in {"win32", "darwin"} or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))

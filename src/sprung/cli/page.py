"""Command of the local page."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from sprung.cli.app import Json, app
from sprung.cli.output import complain, say, say_json
from sprung.cli.signals import Terminated
from sprung.errors import InputError, Problem

_LIBRARIES = ("starlette", "uvicorn")
"""What the page needs besides what every command needs."""


@app.command("app", epilog="Example: [bold]sprung app measurements[/bold]")
def local_page(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Folder of recordings and campaigns; the page sees nothing else.")
    ] = Path(),
    port: Annotated[
        int,
        typer.Option(
            "--port", metavar="N", min=0, max=65535, show_default="any that is free", help="Port on 127.0.0.1."
        ),
    ] = 0,
    browser: Annotated[
        bool,
        typer.Option("--browser/--no-browser", help="Open the page in your browser; its address is printed anyway."),
    ] = True,
    as_json: Json = False,
) -> None:
    """Open a page on this machine: recordings, campaigns, results; the same commands, in a browser. Ctrl-C ends it."""
    missing = [name for name in _LIBRARIES if find_spec(name) is None]
    if missing:
        found = f"an installation without {' and '.join(missing)}"
        do = 'Install what it needs with: pip install "sprung[app]"'
        raise InputError([Problem("sprung app", found, "the libraries of the page", do)])
    from sprung.app import serve  # noqa: PLC0415 (an extra, which other commands do not need)

    def announce(address: str) -> None:
        if as_json:
            say_json({"address": address})
        else:
            say(f"{address}\n")
            complain("Open this address in a browser of this machine. Ctrl-C ends the page.")

    try:
        serve(folder, port=port, open_browser=browser, announce=announce)
    except KeyboardInterrupt as stopped:
        if isinstance(stopped, Terminated):
            raise
    complain("The page has ended.")

"""The command line's application: its group of commands, and what several of them take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

import sprung
from sprung.cli.output import say
from sprung.cli.stopping import was_stopped


class Commands(TyperGroup):
    """The commands; Ctrl-C and SIGTERM end any of them with the shell's own status and without a traceback."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command that was asked for."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as stopped:
            raise SystemExit(was_stopped(stopped)) from None


app = typer.Typer(
    cls=Commands,
    help="Find the physical parameters of a two-axle road vehicle from drop tests.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)

CampaignFile = Annotated[Path, typer.Argument(metavar="CAMPAIGN", help="campaign.toml, or the folder it is in.")]
Force = Annotated[
    bool,
    typer.Option(
        "--force", help="Overwrite files that sprung did not write, or that were changed since it wrote them."
    ),
]
Json = Annotated[bool, typer.Option("--json", help="One JSON document on standard output, and nothing else.")]


def _version(wanted: bool) -> None:
    if wanted:
        say(f"sprung {sprung.__version__}\n")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version and leave.")
    ] = False,
) -> None:
    """Find the physical parameters of a two-axle road vehicle from drop tests."""

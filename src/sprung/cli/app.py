"""The application: the group of commands, and arguments that several of them share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer
from typer.core import TyperGroup

import sprung
from sprung.cli.completion import campaigns
from sprung.cli.help_text import Command, group_help
from sprung.cli.output import say
from sprung.cli.signals import report_stop

ORDER = (
    "demo",
    "new",
    "check",
    "identify",
    "report",
    "export",
    "validate",
    "modal",
    "plan",
    "study",
    "compare",
    "ride",
    "fleet",
    "app",
    "simulate",
    "paper",
    "schema",
)
"""The commands in the order of work: an example, then from recordings to results."""


class Commands(TyperGroup):
    """The group of commands; Ctrl-C and SIGTERM end any of them without a traceback, with the status that shells use."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of the commands in the order of work."""
        names = super().list_commands(ctx)
        return sorted(names, key=lambda name: ORDER.index(name) if name in ORDER else len(ORDER))

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write the help of the program."""
        options = [parameter for parameter in self.get_params(ctx) if parameter.param_type_name == "option"]
        commands = [self.commands[name] for name in self.list_commands(ctx)]
        usage = f"{ctx.command_path} COMMAND [OPTIONS] [ARGUMENTS]"
        formatter.write(group_help(usage, self.help or "", options, commands))

    def invoke(self, ctx: Any) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as stopped:
            raise SystemExit(report_stop(stopped)) from None


Function = TypeVar("Function", bound=Callable[..., Any])


class Program(typer.Typer):
    """The program, whose commands write their own help."""

    def command(self, name: str | None = None, **options: Any) -> Callable[[Function], Function]:
        """Add a command."""
        return super().command(name, **{"cls": Command, **options})


app = Program(
    cls=Commands,
    help="Find the physical parameters of a two-axle road vehicle from drop tests.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

CampaignFile = Annotated[
    Path, typer.Argument(metavar="CAMPAIGN", help="campaign.toml, or its folder.", autocompletion=campaigns)
]
Force = Annotated[
    bool,
    typer.Option("--force", help="Overwrite files that sprung did not write, or that were changed since."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document, and nothing else, on standard output.")]


def _version(wanted: bool) -> None:
    if wanted:
        say(f"sprung {sprung.__version__}\n")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Find the physical parameters of a two-axle road vehicle from drop tests."""

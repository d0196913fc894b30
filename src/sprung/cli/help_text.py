"""The text of ``--help``, for any width of the terminal, with an example for every command."""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Iterable, Iterator
from textwrap import wrap
from typing import Any

from typer.core import TyperCommand

_LONGEST = 90
"""Longest line, columns."""

_BESIDE = 60
"""Smallest width, columns, with explanations beside the names; on a narrower terminal they are below."""


class Command(TyperCommand):
    """A command whose help fits any terminal."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write the help of the command."""
        arguments = [parameter for parameter in self.params if parameter.param_type_name == "argument"]
        options = [parameter for parameter in self.get_params(ctx) if parameter.param_type_name == "option"]
        required = [str(argument.metavar) if argument.required else f"[{argument.metavar}]" for argument in arguments]
        required += [f"{option.opts[0]} {option.metavar}" for option in options if option.required]
        usage = " ".join((str(ctx.command_path), *required, "[OPTIONS]"))
        formatter.write("\n".join(_page(usage, self.help, arguments, options)))
        formatter.write(f"\n\n{_lines(plain(self.epilog), indent=2)}\n")


def readable(message: str) -> str:
    """Return a message, wrapped between words for the terminal; unchanged for a file or pipe.

    Parameters
    ----------
    message
        Any; paths are not broken.

    Returns
    -------
    str
    """
    if not sys.stderr.isatty():
        return message
    width = shutil.get_terminal_size().columns
    return "\n".join(_lines(line, further=2, width=width) for line in message.splitlines())


def plain(text: str | None) -> str:
    """Return a help text without markup for bold type."""
    return re.sub(r"\[/?bold\]", "", text or "")


def group_help(usage: str, text: str, options: Iterable[Any], commands: Iterable[Any]) -> str:
    """Return the help of the program: its commands, each with an example.

    Parameters
    ----------
    usage, text
        Usage line and description.
    options
        Of the program itself.
    commands
        In the order of the help.

    Returns
    -------
    str
    """
    lines = [*_page(usage, text, (), options), "", "Commands, in the order of work:"]
    for command in commands:
        example = plain(command.epilog).removeprefix("Example: ")
        lines += [
            "",
            *_explained(command.name, plain(command.help), 10),
            _lines(example, 12 if _width() >= _BESIDE else 6),
        ]
    return "\n".join((*lines, "", _lines("sprung COMMAND --help explains a command and its options."), ""))


def _page(usage: str, text: str | None, arguments: Iterable[Any], options: Iterable[Any]) -> Iterator[str]:
    yield _lines(f"Usage: {usage}".rstrip(), further=7)
    yield ""
    yield _lines(plain(text))
    for title, parameters in (("Arguments", arguments), ("Options", options)):
        named = [(_flags(shown), _meaning(shown)) for shown in parameters if not getattr(shown, "hidden", False)]
        if named:
            yield f"\n{title}:"
        beside = max((len(flags) for flags, _ in named), default=0)
        for flags, meaning in named:
            yield from _explained(flags, meaning, min(beside, 24))


def _flags(parameter: Any) -> str:
    """Return the flags of a parameter: ``-o, --output DIR``."""
    if parameter.param_type_name == "argument":
        return str(parameter.metavar)
    value = "" if parameter.is_flag or parameter.count else f" {parameter.metavar or parameter.name.upper()}"
    return f"{', '.join(sorted((*parameter.opts, *parameter.secondary_opts), key=_short_first))}{value}"


def _short_first(flag: str) -> bool:
    return flag.startswith("--")


def _meaning(parameter: Any) -> str:
    text = plain(parameter.help)
    if isinstance(parameter.show_default, str):
        return f"{text} (default: {parameter.show_default})"
    if parameter.param_type_name == "option" and parameter.required:
        return f"{text} (required)"
    if parameter.is_flag if parameter.param_type_name == "option" else False:
        return (
            f"{text} (default: {parameter.opts[0]})" if parameter.default is True and parameter.secondary_opts else text
        )
    given = isinstance(parameter.default, str | int | float) or hasattr(parameter.default, "suffix")  # a path
    return (
        f"{text} (default: {parameter.default})"
        if given and parameter.default != "" and not callable(parameter.default)
        else text
    )


def _explained(name: str, text: str, beside: int) -> Iterator[str]:
    """Yield a name with its explanation beside it, or below it where there is no room."""
    width = _width()
    if width < _BESIDE or len(name) > beside:
        yield f"  {name}"
        yield _lines(text, beside + 4 if width >= _BESIDE else 6)
    else:
        yield f"  {name:<{beside}}" + _lines(text, beside + 4)[beside + 2 :]


def _lines(text: str, indent: int = 0, further: int | None = None, width: int = 0) -> str:
    """Return a text, wrapped between words."""
    first, others = " " * indent, " " * (indent if further is None else further)
    shown = wrap(
        text,
        width or _width(),
        initial_indent=first,
        subsequent_indent=others,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return "\n".join(shown)


def _width() -> int:
    return min(shutil.get_terminal_size().columns, _LONGEST)

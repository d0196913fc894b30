"""The text of ``--help``: formatted for the width of the terminal, with an example for every command."""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Iterable, Iterator
from textwrap import wrap
from typing import Any

from typer.core import TyperCommand

_LONGEST = 90
"""Largest number of columns of a line of help."""

_BESIDE = 60
"""Number of columns from which a description is beside its name; on a narrower terminal it is below."""


class Command(TyperCommand):
    """A command whose help is formatted for the terminal."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write the help of the command."""
        arguments = [one for one in self.params if one.param_type_name == "argument"]
        options = [one for one in self.get_params(ctx) if one.param_type_name == "option"]
        given = [str(one.metavar) if one.required else f"[{one.metavar}]" for one in arguments]
        given += [f"{one.opts[0]} {one.metavar}" for one in options if one.required]
        usage = " ".join((str(ctx.command_path), *given, "[OPTIONS]"))
        formatter.write("\n".join(_page(usage, self.help, arguments, options)))
        formatter.write(f"\n\n{_lines(plain(self.epilog), indent=2)}\n")


def readable(message: str) -> str:
    """Wrap a message between words if it is printed on a terminal; paths are not broken.

    Parameters
    ----------
    message
        Lines, which are left as they are where nobody watches.

    Returns
    -------
    str
    """
    if not sys.stderr.isatty():
        return message
    width = shutil.get_terminal_size().columns
    return "\n".join(_lines(line, further=2, width=width) for line in message.splitlines())


def plain(text: str | None) -> str:
    """Return a help text without the marks for bold type."""
    return re.sub(r"\[/?bold\]", "", text or "")


def group_help(usage: str, text: str, options: Iterable[Any], commands: Iterable[Any]) -> str:
    """Write the help of the program: its commands in the order given, each with an example.

    Parameters
    ----------
    usage, text
        How it is called, and what it does.
    options
        Of the program itself.
    commands
        Its commands.

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
        named = [(_flags(one), _meaning(one)) for one in parameters if not getattr(one, "hidden", False)]
        if named:
            yield f"\n{title}:"
        beside = max((len(flags) for flags, _ in named), default=0)
        for flags, meaning in named:
            yield from _explained(flags, meaning, min(beside, 24))


def _flags(one: Any) -> str:
    """Return how a parameter is given: ``-o, --output DIR``."""
    if one.param_type_name == "argument":
        return str(one.metavar)
    value = "" if one.is_flag or one.count else f" {one.metavar or one.name.upper()}"
    return f"{', '.join(sorted((*one.opts, *one.secondary_opts), key=_short_first))}{value}"


def _short_first(flag: str) -> bool:
    return flag.startswith("--")


def _meaning(one: Any) -> str:
    text = plain(one.help)
    if isinstance(one.show_default, str):
        return f"{text} (default: {one.show_default})"
    if one.param_type_name == "option" and one.required:
        return f"{text} (required)"
    if one.is_flag if one.param_type_name == "option" else False:
        return f"{text} (default: {one.opts[0]})" if one.default is True and one.secondary_opts else text
    given = isinstance(one.default, str | int | float) or hasattr(one.default, "suffix")  # a path
    return f"{text} (default: {one.default})" if given and one.default != "" and not callable(one.default) else text


def _explained(name: str, text: str, beside: int) -> Iterator[str]:
    """Return a name with its description beside it, or below it if there is no space."""
    width = _width()
    if width < _BESIDE or len(name) > beside:
        yield f"  {name}"
        yield _lines(text, beside + 4 if width >= _BESIDE else 6)
    else:
        yield f"  {name:<{beside}}" + _lines(text, beside + 4)[beside + 2 :]


def _lines(text: str, indent: int = 0, further: int | None = None, width: int = 0) -> str:
    """Wrap a text between words."""
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

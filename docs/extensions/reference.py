"""Generated references: commands from their help texts, public names from their docstrings."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
from collections.abc import Iterable, Iterator
from types import ModuleType
from typing import TYPE_CHECKING, Any

import campaign_keys
import paper_tables
import typer
from sphinx.pycode import ModuleAnalyzer

import sprung
from sprung.cli.program import app as commands
from sprung.vehicle import LAYOUTS, PARAMETERS, parameters_of_term, terms_of

if TYPE_CHECKING:
    from sphinx.application import Sphinx

ROOMS = (
    "plot",
    "report",
    "export",
    "study",
    "paper",
    "analysis",
    "modal_survey",
    "ride",
    "results",
    "checking",
    "drafting",
    "faults",
    "selection",
    "assessment",
    "planning",
    "estimation",
    "modal",
    "preprocess",
    "simulation",
    "campaign",
    "formats",
    "files",
    "vibration",
    "optimisation",
    "vehicle",
    "tables",
    "uncertainty",
    "units",
    "errors",
)
"""The rooms whose public names are listed, from the top down."""


def command_reference() -> str:
    """Return one section for each command: description, usage, arguments, options and an example."""
    group: Any = typer.main.get_command(commands)
    return "\n\n".join("\n\n".join(_command(name, group.commands[name])) for name in group.list_commands(None))


def _command(name: str, command: Any) -> Iterator[str]:
    arguments = [parameter for parameter in command.params if parameter.param_type_name == "argument"]
    options = [parameter for parameter in command.params if parameter.param_type_name == "option"]
    usage = " ".join(parameter.metavar if parameter.required else f"[{parameter.metavar}]" for parameter in arguments)
    text, example = _plain(command.help), re.sub(r"\[/?bold\]", "", command.epilog or "").removeprefix("Example: ")
    yield f"## sprung {name}"
    yield text
    yield f"```text\nsprung {name} [OPTIONS] {usage}".rstrip() + "\n```"
    for parameter in (*arguments, *options):
        flags = [parameter.metavar] if parameter in arguments else [*parameter.opts, *parameter.secondary_opts]
        value = (
            f" {parameter.metavar or parameter.name.upper()}"
            if parameter in options and not _is_flag(parameter)
            else ""
        )
        shown = (
            ""
            if parameter.default in (None, False, (), []) or not isinstance(parameter.default, int | float | str)
            else parameter.default
        )
        default = f" (default: {shown})" if shown != "" and not _is_flag(parameter) else ""
        yield f"`{', '.join(flags)}{value}`\n: {_plain(parameter.help)}{default}"
    yield f"Example: `{example}`"


def _is_flag(option: Any) -> bool:
    return bool(getattr(option, "is_flag", False))


def _plain(text: str | None) -> str:
    """Return a help text as Markdown, with its own angle brackets and asterisks escaped."""
    return re.sub(r"([*_<>\[\]])", r"\\\1", re.sub(r"\[/?bold\]", "", text or "")).strip()


def parameter_table() -> str:
    """Return a table of all parameters: unit, meaning and model term."""
    term_of = {
        name: term
        for layout in LAYOUTS.values()
        for term in terms_of(layout)
        for tracks in ("shared", "separate")
        for name in parameters_of_term(term, tracks, layout)
    }
    rows = [
        f"| `{name}` | {parameter.unit} | {parameter.meaning} | {term_of.get(name, '')} |"
        for name, parameter in PARAMETERS.items()
    ]
    return "\n".join(("| name | unit | meaning | model term |", "| --- | --- | --- | --- |", *rows))


def api_reference() -> str:
    """Return the directives for the names that the package exports."""
    names = [name for name in sprung.__all__ if not inspect.ismodule(getattr(sprung, name))]
    return _listed("sprung", names)


def rooms_reference() -> str:
    """Return the directives for the names that each room exports."""
    return "\n\n".join(_room(importlib.import_module(f"sprung.{name}")) for name in ROOMS)


def exported(room: ModuleType) -> list[str]:
    """Return the names that a room exports: its `__all__`, or the public names of a room of one file."""
    own = [name for name, value in vars(room).items() if getattr(value, "__module__", None) == room.__name__]
    return list(getattr(room, "__all__", [name for name in own if not name.startswith("_")]))


def _room(room: ModuleType) -> str:
    # Names that the package exports are described on the page of the package.
    here = [name for name in exported(room) if getattr(sprung, name, None) is not getattr(room, name)]
    exported_by_package = ", ".join(f"`{name}`" for name in exported(room) if name not in here)
    also = (
        f"\n\nExported by the package, and described on the page [Python](api.md): {exported_by_package}."
        if exported_by_package
        else ""
    )
    return f"## {room.__name__}\n\n{inspect.getdoc(room)}{also}\n\n{_listed(room.__name__, here)}"


def _listed(module: str, names: Iterable[str]) -> str:
    directives = "\n\n".join(_directive(module, name) for name in names)
    return f"```{{eval-rst}}\n{directives}\n```"


def _directive(module: str, name: str) -> str:
    value = getattr(importlib.import_module(module), name)
    if inspect.isclass(value):
        return f".. autoclass:: {module}.{name}\n   :members:\n   :exclude-members: model_config"
    if inspect.isroutine(value):
        return f".. autofunction:: {module}.{name}"
    text = "\n".join(f"   {line}" for line in text_of_constant(module, name).splitlines())
    return f".. py:data:: {module}.{name}\n\n{text}"


def text_of_constant(module: str, name: str) -> str:
    """Return the text below the definition of a constant; empty if there is none."""
    room = importlib.import_module(module)
    inside = [found.name for found in pkgutil.walk_packages(getattr(room, "__path__", []), f"{module}.")]
    for place in (module, *inside):
        if not hasattr(importlib.import_module(place), name):
            continue
        analyzer = ModuleAnalyzer.for_module(place)
        analyzer.analyze()
        if ("", name) in analyzer.attr_docs:
            return "\n".join(analyzer.attr_docs["", name]).strip()
    return ""


_WRITTEN = {
    "<!-- commands -->": command_reference,
    "<!-- parameters -->": parameter_table,
    "<!-- api -->": api_reference,
    "<!-- rooms -->": rooms_reference,
    **campaign_keys.WRITTEN,
    **paper_tables.WRITTEN,
}


def _fill(_app: Sphinx, _page: str, source: list[str]) -> None:
    for mark, write in _WRITTEN.items():
        if mark in source[0]:
            source[0] = source[0].replace(mark, write())


_NAMES = re.compile(r"(\w+(?:, \w+)+)( : .*)?")
_UNDERLINE = re.compile(r"-{3,}")


def _prepare(_app: Sphinx, what: str, _name: str, _value: object, _options: object, lines: list[str]) -> None:
    """Convert a docstring to a form that Napoleon and reStructuredText interpret as intended."""
    # |pole| is a magnitude, not a substitution.
    lines[:] = [re.sub(r"(?<!\\)\|", r"\\|", line) for line in lines]
    if what in ("attribute", "property"):
        lines[:0] = ["..", ""]  # an empty comment: otherwise the text before a colon is interpreted as a type
    elif any(map(_UNDERLINE.fullmatch, lines)):
        lines[:] = _repeat_descriptions(lines)


def _repeat_descriptions(lines: list[str]) -> list[str]:
    """Repeat a description that several names share: Napoleon would interpret them as one name and its type."""
    found: list[str] = []
    place = 0
    while place < len(lines):
        names = _NAMES.fullmatch(lines[place])
        end = next((k for k in range(place + 1, len(lines)) if lines[k] and not lines[k].startswith(" ")), len(lines))
        text = lines[place + 1 : end]
        if names is None or not text or not text[0].startswith(" "):
            found.append(lines[place])
            place += 1
            continue
        for name in names[1].split(", "):
            found += [name + (names[2] or ""), *text]
        place = end
    return found


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect the generated parts to the reading of pages."""
    app.connect("source-read", _fill)
    app.connect("autodoc-process-docstring", _prepare, priority=400)  # before Napoleon
    return {"parallel_read_safe": True, "parallel_write_safe": True}

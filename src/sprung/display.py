"""How records show themselves: a few lines in a console, a table in a notebook."""

from __future__ import annotations

import html
import textwrap
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import MISSING, Field, fields, is_dataclass
from typing import Any, TypeVar, cast

Record = TypeVar("Record")

LINES, WIDTH = 10, 88
"""Of the text of a record: lines at the most, and characters in each."""

_BRIEF = 60
"""Characters of one value in a line of text."""

_LISTED = 4
"""Entries of a sequence that are written out where they are short."""


def shown(cls: type[Record]) -> type[Record]:
    """Let a record show itself by its fields that differ from their defaults, large ones by their size.

    Parameters
    ----------
    cls
        A dataclass, or a mapping. A ``_repr_html_`` of its own stays, and a ``__repr__`` where the dataclass has repr=False.
        Where it has a method ``__shown__``, that gives what to show, by name.

    Returns
    -------
    type
        The same class.
    """
    own = cast("Any", cls)
    if not is_dataclass(cls) or own.__dataclass_params__.repr:
        own.__repr__ = text_of_record
    if "_repr_html_" not in vars(cls):
        own._repr_html_ = html_of_record
    return cls


def text_of_record(record: object) -> str:
    """Return a record in at most ten lines.

    Parameters
    ----------
    record
        A dataclass, or a mapping.

    Returns
    -------
    str
    """
    equals = ": " if isinstance(record, Mapping) else "="
    said = ", ".join(f"{name}{equals}{value}" for name, value in _entries(record))
    lines = textwrap.wrap(
        f"{type(record).__name__}({said})",
        WIDTH,
        subsequent_indent="    ",
        break_on_hyphens=False,
        break_long_words=True,
    )
    return "\n".join(lines if len(lines) <= LINES else [*lines[: LINES - 1], "    ...)"])


def html_of_record(record: object) -> str:
    """Return a record as a table of its fields, for a notebook.

    Parameters
    ----------
    record
        A dataclass, or a mapping.

    Returns
    -------
    str
        HTML.
    """
    rows = "\n".join(
        f'<tr><th scope="row">{html.escape(name)}</th><td>{html.escape(value)}</td></tr>'
        for name, value in _entries(record)
    )
    return f"<table>\n<caption>{type(record).__name__}</caption>\n<tbody>\n{rows}\n</tbody>\n</table>\n"


def _entries(record: object) -> Iterator[tuple[str, str]]:
    shown_as = record.__shown__() if hasattr(record, "__shown__") else record
    if isinstance(shown_as, Mapping):
        yield from ((str(name), _brief(value)) for name, value in shown_as.items())
        return
    for one in fields(cast("Any", record)):
        value = getattr(record, one.name)
        if one.repr and not one.name.startswith("_") and not _is_default(one, value):
            yield one.name, _brief(value)


def _is_default(one: Field[Any], value: object) -> bool:
    default = (
        one.default
        if one.default is not MISSING
        else one.default_factory()
        if callable(one.default_factory)
        else MISSING
    )
    return default is value or (isinstance(value, str | float | int | tuple | dict) and value == default)


def _brief(value: object) -> str:
    """Return a value in one short line, large ones by their size."""
    if isinstance(value, str | int | bool | None):
        text = repr(value)
    elif isinstance(value, float):
        text = f"{value:.6g}"
    elif hasattr(value, "shape") and hasattr(value, "dtype"):
        text = f"array of shape {value.shape}"
    elif isinstance(value, Mapping):
        text = _mapped(value)
    elif is_dataclass(value) or (isinstance(value, tuple) and hasattr(value, "_fields")):
        # Small records are shown whole, large ones by what they are.
        written = type(value).__str__ is not object.__str__ and type(value).__repr__ is text_of_record
        text = (
            str(value) if written else repr(value) if type(value).__repr__ is text_of_record else type(value).__name__
        )
        text = text if len(text) <= _BRIEF and "\n" not in text else type(value).__name__
    elif isinstance(value, Sequence | Set):
        text = _several(list(value))
    else:
        text = str(value)
    text = " ".join(text.split())
    return text if len(text) <= _BRIEF else f"{text[: _BRIEF - 3]}..."


def _mapped(values: Mapping[Any, Any]) -> str:
    """Return few short entries with their names, of others the first names and how many there are."""
    text = f"{{{', '.join(f'{name}: {_brief(value)}' for name, value in list(values.items())[: _LISTED + 1])}}}"
    if len(values) <= _LISTED and len(text) <= _BRIEF:
        return text
    names = [str(name) for name in values]
    return f"{len(names)} by name: {', '.join(names[:_LISTED])}{', ...' if len(names) > _LISTED else ''}"


def _several(values: list[object]) -> str:
    plain = all(isinstance(one, str | int | float | bool | None) for one in values)
    if len(values) > _LISTED:
        return f"{len(values)} of {type(values[0]).__name__}"
    inside = ", ".join(_brief(one) if plain else type(one).__name__ for one in values)
    return f"({inside})"

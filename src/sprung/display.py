"""Display of records: a few lines in a console, a table in a notebook."""

from __future__ import annotations

import html
import textwrap
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import MISSING, Field, fields, is_dataclass
from typing import Any, TypeVar, cast

Record = TypeVar("Record")

LINES, WIDTH = 10, 88
"""Largest number of lines of a record, and of characters in each."""

_BRIEF = 60
"""Largest number of characters of a value."""

_LISTED = 4
"""Largest number of entries of a sequence that are written out."""


def shown(cls: type[Record]) -> type[Record]:
    """Return a class with a console and a notebook display: fields that differ from their defaults, large ones by their size.

    Parameters
    ----------
    cls
        A dataclass, or a mapping. Its own ``_repr_html_`` is kept, and its ``__repr__`` where the dataclass has repr=False.
        A method ``__shown__`` returns the entries by name instead of the fields.

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


def enumerated(texts: Sequence[str], word: str = "and") -> str:
    """Return several texts in one, with commas between them and a word before the last one.

    Parameters
    ----------
    texts
        Any number of them.
    word
        Such as ``and`` or ``or``.

    Returns
    -------
    str

    Examples
    --------
    >>> enumerated(["fl", "fr", "rl"], "or"), enumerated(["fl"])
    ('fl, fr or rl', 'fl')
    """
    return f" {word} ".join(part for part in (", ".join(texts[:-1]), *texts[-1:]) if part)


def count_text(count: int, noun: str) -> str:
    """Return a number and its noun, in the plural unless the number is 1.

    Parameters
    ----------
    count
        Not negative.
    noun
        In the singular, with a regular plural.

    Returns
    -------
    str

    Examples
    --------
    >>> count_text(1, "campaign"), count_text(0, "campaign")
    ('1 campaign', '0 campaigns')
    """
    return f"{count} {noun}{'' if count == 1 else 's'}"


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
    text = ", ".join(f"{name}{equals}{value}" for name, value in _entries(record))
    lines = textwrap.wrap(
        f"{type(record).__name__}({text})",
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
    entries = record.__shown__() if hasattr(record, "__shown__") else record
    if isinstance(entries, Mapping):
        yield from ((str(name), _brief(value)) for name, value in entries.items())
        return
    for field in fields(cast("Any", record)):
        value = getattr(record, field.name)
        if field.repr and not field.name.startswith("_") and not _is_default(field, value):
            yield field.name, _brief(value)


def _is_default(field: Field[Any], value: object) -> bool:
    default = field.default
    if default is MISSING and callable(field.default_factory):
        default = field.default_factory()
    return default is value or (isinstance(value, str | float | int | tuple | dict) and value == default)


def _brief(value: object) -> str:
    """Return a value as one short line, large ones by their size."""
    if isinstance(value, str | int | bool | None):
        text = repr(value)
    elif isinstance(value, float):
        text = f"{value:.6g}"
    elif hasattr(value, "shape") and hasattr(value, "dtype"):
        text = f"array of shape {value.shape}"
    elif isinstance(value, Mapping):
        text = _brief_mapping(value)
    elif is_dataclass(value) or (isinstance(value, tuple) and hasattr(value, "_fields")):
        # Small records are written out, large ones by their type.
        displayed = type(value).__repr__ is text_of_record
        text = str(value) if displayed else type(value).__name__
        text = text if len(text) <= _BRIEF and "\n" not in text else type(value).__name__
    elif isinstance(value, Sequence | Set):
        text = _brief_sequence(list(value))
    else:
        text = str(value)
    text = " ".join(text.split())
    return text if len(text) <= _BRIEF else f"{text[: _BRIEF - 3]}..."


def _brief_mapping(values: Mapping[Any, Any]) -> str:
    """Return a mapping: few short entries in full, others by their number and first names."""
    text = f"{{{', '.join(f'{name}: {_brief(value)}' for name, value in list(values.items())[: _LISTED + 1])}}}"
    if len(values) <= _LISTED and len(text) <= _BRIEF:
        return text
    names = [str(name) for name in values]
    return f"{len(names)} by name: {', '.join(names[:_LISTED])}{', ...' if len(names) > _LISTED else ''}"


def _brief_sequence(values: list[object]) -> str:
    plain = all(isinstance(value, str | int | float | bool | None) for value in values)
    if len(values) > _LISTED:
        return f"{len(values)} of {type(values[0]).__name__}"
    inside = ", ".join(_brief(value) if plain else type(value).__name__ for value in values)
    return f"({inside})"

"""Where everything stands in the text of a TOML file, so that one value can be replaced and the rest stays as it was written.

The text must be valid TOML: `tomllib` decides that, before anything here is called.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

Place: TypeAlias = tuple[str | int, ...]
"""Where in the document: keys, and indices that count from 0."""

_GAP = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_BLANK = re.compile(r"[ \t]*")
_HEADER = re.compile(r"\[(\[?)((?:\"(?:\\.|[^\"\\])*\"|'[^']*'|[^\]\"'])*)\]\]?")
_KEY = re.compile(r"((?:\"(?:\\.|[^\"\\])*\"|'[^']*'|[^=\"'])+)=")
_PLAIN = re.compile(
    r'"""(?:\\.|[^\\])*?"""(?:"{0,2})'
    r"|'''.*?'''(?:'{0,2})"
    r'|"(?:\\.|[^"\\\n])*"'
    r"|'[^'\n]*'"
    r"|\d{4}-\d\d-\d\d[ Tt]\d\d:[^\s,\]}#]*"
    r"|[^\s,\[\]{}#]+",
    re.DOTALL,
)
_PLAIN_NAME = re.compile(r"\[?\s*([A-Za-z0-9_-]+)\s*(?:\]|= 0)")
_LINE_END = re.compile(r"[^\n]*(?:\n|\Z)")


@dataclass(frozen=True, slots=True)
class Value:
    """A value, and the values in it.

    Attributes
    ----------
    start, end
        Offsets in the text.
    kind
        ``[`` of an array, ``{`` of an inline table, empty for any other.
    parts
        Elements of an array by their index, entries of an inline table by their key.
    """

    start: int
    end: int
    kind: str = ""
    parts: Mapping[str | int, Part] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Part:
    """An element of an array, or an entry of an inline table.

    Attributes
    ----------
    start
        Offset of its key, or of the element.
    value
        What it holds.
    """

    start: int
    value: Value


@dataclass(frozen=True, slots=True)
class Entry:
    """A line ``key = value``, which may extend over several lines of the text.

    Attributes
    ----------
    place
        In the document.
    start, end
        Offsets of its first line and of the line after it.
    equals
        Offset of its equals sign.
    value
        What it holds.
    """

    place: Place
    start: int
    end: int
    equals: int
    value: Value


@dataclass(frozen=True, slots=True)
class Section:
    """A header with its entries; the first section of a document has no header.

    Attributes
    ----------
    place
        In the document; with an index at its end for one of several in double brackets.
    start, body
        Offsets of the line of its header and of the line after it.
    entries
        In the order of the text.
    """

    place: Place
    start: int
    body: int
    entries: tuple[Entry, ...]

    @property
    def last(self) -> int:
        """Offset of the line after the last entry, or after the header."""
        return self.entries[-1].end if self.entries else self.body


def scan(text: str) -> tuple[Section, ...]:
    """Return the sections of a document in the order of its text.

    Parameters
    ----------
    text
        Valid TOML.
    """
    sections: list[Section] = []
    counts: dict[Place, int] = {}
    place: Place = ()
    start = body = 0
    entries: list[Entry] = []
    position = _skip(text, 0)
    while position < len(text):
        line = text.rfind("\n", 0, position) + 1
        header = _HEADER.match(text, position) if text[position] == "[" else None
        if header is None:
            entry = _entry(text, position, line, place)
            entries.append(entry)
            position = _skip(text, entry.end)
            continue
        sections.append(Section(place, start, body, tuple(entries)))
        place = _numbered(_names(f"[{header[2]}]"), bool(header[1]), counts)
        start, body, entries = line, _next_line(text, header.end()), []
        position = _skip(text, body)
    return (*sections, Section(place, start, body, tuple(entries)))


def entries_by_place(sections: tuple[Section, ...]) -> dict[Place, Value]:
    """Return every value of a document, also those in arrays and inline tables, by its place."""
    return {
        place: value
        for section in sections
        for entry in section.entries
        for place, value in _inside(entry.place, entry.value)
    }


def _inside(place: Place, value: Value) -> Iterator[tuple[Place, Value]]:
    yield place, value
    for key, part in value.parts.items():
        yield from _inside((*place, key), part.value)


def _numbered(names: tuple[str, ...], is_array: bool, counts: dict[Place, int]) -> Place:
    """Return the place of a header: arrays of tables on its way are those that were begun last."""
    place: Place = ()
    for depth, name in enumerate(names):
        place = (*place, name)
        if is_array and depth == len(names) - 1:
            counts[place] = counts.get(place, -1) + 1
        if place in counts:
            place = (*place, counts[place])
    return place


def _names(header: str) -> tuple[str, ...]:
    """Return the names of a header or of a dotted key, given as a document of its own."""
    if plain := _PLAIN_NAME.fullmatch(header):
        return (plain[1],)  # nearly all of them, and much quicker
    node: Any = tomllib.loads(header)
    names: list[str] = []
    while isinstance(node, dict) and node:
        name, node = next(iter(node.items()))
        names.append(name)
    return tuple(names)


def _entry(text: str, position: int, line: int, place: Place) -> Entry:
    key = _KEY.match(text, position)
    assert key is not None  # noqa: S101 (the text is valid TOML)
    value = _value(text, _skip_blank(text, key.end()))
    names = _names(f"{key[1]} = 0")
    return Entry((*place, *names), line, _next_line(text, value.end), key.end() - 1, value)


def _value(text: str, start: int) -> Value:
    kind = text[start]
    if kind not in "[{":
        plain = _PLAIN.match(text, start)
        assert plain is not None  # noqa: S101 (the text is valid TOML)
        return Value(start, plain.end())
    parts: dict[str | int, Part] = {}
    position = _skip(text, start + 1)
    while text[position] not in "]}":
        begin, name = position, (len(parts),)
        if kind == "{":
            key = _KEY.match(text, position)
            assert key is not None  # noqa: S101 (the text is valid TOML)
            name, position = _names(f"{key[1]} = 0"), _skip(text, key.end())  # type: ignore[assignment]
        inner = _value(text, position)
        for outer in reversed(name[1:]):  # a dotted key in an inline table
            inner = Value(inner.start, inner.end, "", {outer: Part(begin, inner)})
        parts[name[0]] = Part(begin, inner)
        position = _skip(text, inner.end)
        if text[position] == ",":
            position = _skip(text, position + 1)
    return Value(start, position + 1, kind, parts)


def _skip(text: str, position: int) -> int:
    """Return the next position that is neither blank nor in a comment."""
    match = _GAP.match(text, position)
    return match.end() if match else position


def _skip_blank(text: str, position: int) -> int:
    match = _BLANK.match(text, position)
    return match.end() if match else position


def _next_line(text: str, position: int) -> int:
    match = _LINE_END.match(text, position)
    return match.end() if match else position

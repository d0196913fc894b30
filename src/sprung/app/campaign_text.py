"""Changes of a campaign file as text: what is changed is written, everything else stays letter by letter as it was."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from sprung.app.toml_spans import Place, Section, Value, entries_by_place, scan
from sprung.errors import InputError, Problem

ORDER = ("schema", "vehicle", "test", "known", "model", "sensor", "load", "drop")
"""Keys and sections of a campaign file in their usual order."""


@dataclass(frozen=True, slots=True)
class Change:
    """One change of a document.

    Attributes
    ----------
    place
        Keys, and indices that count from 0, such as ``("sensor", 2, "unit")``. An index one beyond the last adds an entry.
    value
        The new value as TOML, such as ``"g"`` in quotes or ``2.55``; for an entry of sections in double brackets its lines
        without the header. None removes what is there.
    """

    place: Place
    value: str | None


def apply_changes(text: str, changes: Iterable[Change]) -> str:
    """Return a document with changes; each refers to the document as the changes before it left it.

    Parameters
    ----------
    text
        Valid TOML.
    changes
        In this order.

    Returns
    -------
    str
        TOML. Comments, order, line ends and the way in which numbers are written remain.

    Raises
    ------
    InputError
        If a change cannot be made, for instance because its place is not in the document.
    """
    mark = "\ufeff" if text.startswith("\ufeff") else ""
    windows = "\r\n" in text and "\n" not in text.replace("\r\n", "")
    text = text.removeprefix(mark).replace("\r\n", "\n") if windows else text.removeprefix(mark)
    for change in changes:
        text = _applied(text, change)
    return mark + (text.replace("\n", "\r\n") if windows else text)


def _applied(text: str, change: Change) -> str:
    """Apply one change, and require that it has changed nothing else."""
    wanted = _changed(tomllib.loads(text), change)
    new = _edited(text, change)
    try:
        if new is not None and tomllib.loads(new) == wanted:
            return new
    except tomllib.TOMLDecodeError:
        pass
    found = "a way of writing this entry that the form cannot change"
    raise InputError([Problem(str_place(change.place), found, "one that it can", "Change it in the text of the file.")])


def str_place(place: Place) -> str:
    """Return a place as text: ``sensor[3].position``, counting from 1."""
    return "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in place).lstrip(".")


def _changed(document: dict[str, Any], change: Change) -> dict[str, Any]:
    """Return the content of a document with a change."""
    *path, last = change.place
    node: Any = document
    try:
        for part, following in zip(path, change.place[1:], strict=True):
            empty: Any = [] if isinstance(following, int) else {}
            node = node.setdefault(part, empty) if isinstance(node, dict) else node[part]
        if change.value is None:
            del node[last]
            if _is_section(change.place) and not node:
                del document[str(path[0])]  # no header is left
        elif isinstance(node, list) and last == len(node):
            node.append(_content(change))
        else:
            node[last] = _content(change)
    except (LookupError, TypeError) as error:
        found, do = "no such entry", "Load the page again: the file has changed."
        raise InputError([Problem(str_place(change.place), found, "an entry of the file", do)]) from error
    return document


def _is_section(place: Place) -> bool:
    return len(place) == 2 and isinstance(place[1], int)


def _content(change: Change) -> Any:
    """Return what the text of a new value means."""
    assert change.value is not None  # noqa: S101 (asked before)
    try:
        if _is_section(change.place):
            return tomllib.loads(change.value)
        ((_, content),) = tomllib.loads(f"x = {change.value}").items()
    except ValueError as error:  # no TOML, or more than one entry
        raise InputError([Problem(str_place(change.place), change.value, f"TOML ({error})", "Correct it.")]) from error
    return content


def _edited(text: str, change: Change) -> str | None:
    """Return the text with a change; None where it is written in a way that is not provided for."""
    sections = scan(text)
    values = entries_by_place(sections)
    place = change.place
    if change.value is None:
        return _without(text, place, sections, values)
    if place in values:
        value = values[place]
        return text[: value.start] + change.value + text[value.end :]
    if _is_section(place):
        return _with_section(text, place, f"[[{place[0]}]]\n{change.value.rstrip(chr(10))}\n", sections)
    if place[:-1] in values:
        return _with_part(text, values[place[:-1]], place[-1], change.value)
    return _with_new(text, change, sections)


def _with_new(text: str, change: Change, sections: tuple[Section, ...]) -> str | None:
    """Add an entry to a section, or what it is in."""
    place, value = change.place, str(change.value)
    last = place[-1]
    if isinstance(last, int):  # the first element of an array that is not there yet
        return _edited(text, Change(place[:-1], f"[{value}]")) if last == 0 else None
    home = next((section for section in sections if section.place == place[:-1]), None)
    return _with_home(text, place, value, sections) if home is None else _with_entry(text, home, last, value)


def _with_entry(text: str, section: Section, key: str, value: str) -> str:
    """Add an entry after the last one of a section, its equals sign below that one's."""
    column = 0
    if section.entries:
        last = section.entries[-1]
        column = last.equals - last.start
    line = f"{_key(key).ljust(max(column - 1, 0))} = {value}\n"
    before = text[: section.last]
    return before + ("\n" if before and not before.endswith("\n") else "") + line + text[section.last :]


def _with_home(text: str, place: Place, value: str, sections: tuple[Section, ...]) -> str | None:
    """Add an entry whose section is not there yet."""
    if len(place) == 2:
        return _with_section(text, place[:1], f"[{_key(str(place[0]))}]\n{_key(str(place[1]))} = {value}\n", sections)
    # As an inline table in the section above: motion_ratio = { spring_front = 0.7 }
    return _edited(text, Change(place[:-1], f"{{ {_key(str(place[-1]))} = {value} }}"))


def _with_part(text: str, within: Value, key: str | int, value: str) -> str | None:
    """Add an element to an array, or an entry to an inline table, after the last one."""
    if not within.kind:
        return None
    new = f"{_key(key)} = {value}" if isinstance(key, str) else value
    if within.parts:
        at = max(part.value.end for part in within.parts.values())
        return f"{text[:at]}, {new}{text[at:]}"
    ends = ("{ ", " }") if within.kind == "{" else ("[", "]")
    return text[: within.start] + ends[0] + new + ends[1] + text[within.end :]


def _with_section(text: str, place: Place, lines: str, sections: tuple[Section, ...]) -> str:
    """Add a section after the last one of its kind, or of the kinds that usually precede it."""
    rank = ORDER.index(str(place[0])) if place[0] in ORDER else len(ORDER)
    before = [s for s in sections if not s.place or s.place[0] not in ORDER or ORDER.index(str(s.place[0])) <= rank]
    same = [section for section in sections if section.place[:1] == place[:1]]
    at = _end_of(text, (same or before)[-1], sections)
    head, tail = text[:at], text[at:]
    if head and not head.endswith("\n"):
        head += "\n"
    gap = "\n" if head.strip() and not head.endswith("\n\n") else ""
    return head + gap + lines + ("\n" if tail.strip() else "") + tail


def _end_of(text: str, section: Section, sections: tuple[Section, ...]) -> int:
    """Return where the next section begins, with the comments directly above its header."""
    later = [other.start for other in sections if other.start > section.start or (other.place and not section.place)]
    if not later:
        return len(text)
    at = min(later)
    while at > section.last:
        line = text.rfind("\n", 0, at - 1) + 1
        if not text[line:at].lstrip().startswith("#") or line < section.last:
            break
        at = line
    return at


def _without(text: str, place: Place, sections: tuple[Section, ...], values: dict[Place, Value]) -> str | None:
    """Remove an entry with its line, a part of an array or inline table, or a section."""
    for section in sections:
        for entry in section.entries:
            if entry.place == place:
                return text[: entry.start] + text[entry.end :]
    if place[:-1] in values and place in values:
        return _without_part(text, values[place[:-1]], place[-1])
    own = [section for section in sections if section.place[: len(place)] == place]
    if not own:
        return None
    # Its sections of its own, such as [[load.items]], follow it directly, or the result is refused.
    return text[: own[0].start] + text[_end_of(text, own[-1], sections) :]


def _without_part(text: str, within: Value, key: str | int) -> str:
    """Remove a part of an array or inline table, with the comma behind it, or before it if it is the last."""
    keys = list(within.parts)
    index = keys.index(key)
    if len(keys) == 1:
        return text[: within.start] + ("{}" if within.kind == "{" else "[]") + text[within.end :]
    if index + 1 < len(keys):
        return text[: within.parts[key].start] + text[within.parts[keys[index + 1]].start :]
    return text[: within.parts[keys[index - 1]].value.end] + text[within.parts[key].value.end :]


def _key(key: str) -> str:
    """Return a key as TOML writes it."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else quoted(key)


def quoted(text: str) -> str:
    """Return a text as a TOML string in double quotes."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")

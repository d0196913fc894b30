"""Sections that are added to a campaign file and removed from it by buttons of its form."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from sprung.app.campaign_text import Change, apply_changes, quoted
from sprung.app.load_description import superseded
from sprung.campaign import placeholder
from sprung.errors import InputError, Problem

_PLACE = placeholder("[x, y, z], m: forward of the front axle, left of the centreline, above the ground")
_ITEM = f"{{ mass = {quoted(placeholder('kg'))}, position = {quoted(_PLACE)} }}"
_NEW = {
    "sensor": f'channel  = {quoted(placeholder("name of the column in the recordings"))}\non       = "body"\n'
    f"position = {quoted(_PLACE)}",
    "drop": f"file = {quoted(placeholder('name of the recording'))}",
}


def apply_action(text: str, action: str) -> str:
    """Return a campaign file after a button of its form was pressed.

    Parameters
    ----------
    text
        Of the file.
    action
        ``add sensor``, ``add load``, ``add drop FILE``, ``add item load.1``, ``add known NAME``; ``remove`` and the name of a
        group or field, such as ``remove sensor.2``.

    Returns
    -------
    str

    Raises
    ------
    InputError
        If there is no such action, or no such section.
    """
    verb, _, what = action.partition(" ")
    kind, _, rest = what.partition(" ")
    document = tomllib.loads(text.removeprefix("\ufeff"))
    if verb == "remove" and what:
        return apply_changes(text, _removal(tuple(int(part) if part.isdecimal() else part for part in what.split("."))))
    if verb == "add" and kind in {"sensor", "load", "drop"}:
        entries = document.get(kind, [])
        number = len(entries) if isinstance(entries, list) else 0
        return apply_changes(text, [Change((kind, number), _new(kind, rest, entries))])
    if verb == "add" and kind == "item":
        change = _new_item(document, rest)
        text = apply_changes(text, [change])
        return apply_changes(text, superseded(tomllib.loads(text.removeprefix("\ufeff")), [change]))
    if verb == "add" and kind == "known" and rest:
        return apply_changes(
            text, [Change(("known", rest), quoted(placeholder("a value, or a value and its uncertainty")))]
        )
    raise InputError([Problem("form", repr(action), "an action of the form", "Load the page again.")])


def _removal(place: tuple[str | int, ...]) -> Sequence[Change]:
    return [Change(place, None)]


def _new(kind: str, rest: str, entries: Sequence[Any]) -> str:
    """Return the lines of a new section."""
    if kind == "load":
        names = {entry.get("name") for entry in entries if isinstance(entry, dict)}
        name = next(name for number in range(1, len(entries) + 2) if (name := f"load {number}") not in names)
        return f"name  = {quoted(name)}\nitems = [{_ITEM}]"
    return f"file = {quoted(rest)}" if kind == "drop" and rest else _NEW[kind]


def _new_item(document: Mapping[str, Any], load: str) -> Change:
    """Return the change that adds an item to a load; the first one replaces what marks that items are missing."""
    index = int(load.removeprefix("load.")) if load.removeprefix("load.").isdecimal() else -1
    loads = document.get("load", [])
    if not 0 <= index < len(loads):
        raise InputError([Problem(load, "no such load", "a load of the file", "Load the page again.")])
    items = loads[index].get("items")
    if isinstance(items, list) and items:
        return Change(("load", index, "items", len(items)), _ITEM)
    return Change(("load", index, "items"), f"[{_ITEM}]")

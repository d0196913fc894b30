"""Names, units and rates in a file of nested names: to which vectors a text or a number applies.

A text or a number applies to the vectors in the innermost struct or group around it that holds any, unless a nearer one
applies: ``car.axle.unit`` to the vectors of ``car.axle``; ``car.Properties.SampleRate``, beside which no vector stands, to all
of ``car``.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Collection

    from sprung.formats.nested import Content, Number, Path, Text

Entry = TypeVar("Entry", "Text", "Number")

NAMES = frozenset(("name", "label", "channel", "channelname", "column", "columnname", "signal", "signalname"))
NAMES |= {"variable", "variablename", "title", "longname"}
UNITS = frozenset(("unit", "unitstr", "unitstring", "unitsymbol", "unitlabel", "einheit", "einheiten", "engunit"))
UNITS |= {"variableunit", "channelunit", "yunit"}
GENERIC = frozenset(("", "data", "value", "values", "sample", "samples", "raw", "y", "signal"))
"""Generic names: of the content of the group in which they stand."""


def normalise_name(name: str) -> str:
    """Return a name in small letters without separators, so that ``Sample_Rate`` and ``sampleRate`` are equal.

    Parameters
    ----------
    name
        As written in the file.

    Returns
    -------
    str
    """
    return re.sub(r"[\s_.-]", "", name).lower()


def matches_any(name: str, words: Collection[str]) -> bool:
    """Return whether a name, normalised, is one of some words or their plural.

    Parameters
    ----------
    name
        As written in the file.
    words
        In the singular.
    """
    return normalise_name(name) in words or (normalise_name(name).endswith("s") and normalise_name(name)[:-1] in words)


class MetadataScope:
    """Scopes of the texts and numbers of one file.

    Parameters
    ----------
    content
        Content of the file.
    """

    def __init__(self, content: Content) -> None:
        self._texts = content.texts
        held = [number.path for number in content.numbers if normalise_name(number.path[-1]) in GENERIC]
        self._groups = {block.path[:depth] for block in content.blocks for depth in range(len(block.path))}
        self._groups |= {path[:-1] for path in held}

    def innermost_group(self, path: Path) -> Path:
        """Return the path of the innermost group around a name that holds vectors."""
        depth = len(path) - 1
        while depth > 0 and path[:depth] not in self._groups:
            depth -= 1
        return path[:depth]

    def nearest(self, entries: Collection[Entry], to: Path) -> Entry | None:
        """Return the nearest of the entries whose scope contains the vector of that path; None where there is none."""
        applying = [
            entry
            for entry in entries
            if to[: len(self.innermost_group(entry.path))] == self.innermost_group(entry.path)
        ]
        return min(applying, key=lambda entry: (-len(self.innermost_group(entry.path)), len(entry.path)), default=None)

    def named_path(self, path: Path) -> Path:
        """Return the path that ends with a vector's name: ``ch1`` for ``ch1.data``, or what ``ch1.name`` states."""
        if not path or normalise_name(path[-1]) not in GENERIC:
            return path
        for text in self._texts:
            beside = text.path[:-1] == path[:-1] and matches_any(text.path[-1], NAMES)
            if beside and len(text.words) == 1 and text.words[0].strip():
                return (*path[:-2], text.words[0].strip())
        return path[:-1] or path

    def column_names(self, path: Path, count: int) -> tuple[str, ...] | None:
        """Return the names of a matrix's columns: a list of words of that length, preferably one that is called names."""
        lists = {text: _listed(text, count) for text in self._texts if text.path}
        lists = {text: words for text, words in lists.items() if not matches_any(text.path[-1], UNITS)}
        fitting = [text for text, words in lists.items() if words]
        named = [text for text in fitting if matches_any(text.path[-1], NAMES)]
        near = self.nearest(named, path) or self.nearest(fitting, path)
        return lists[near] if near else None

    def unit_of(self, path: Path, name: str) -> str | None:
        """Return the unit stated for one vector, as ``acc_unit`` or ``units.acc`` state it for ``acc``; None without one."""
        name = normalise_name(name)
        for text in self._texts:
            by_group = (
                len(text.path) > 1 and matches_any(text.path[-2], UNITS) and normalise_name(text.path[-1]) == name
            )
            own = normalise_name(text.path[-1])
            by_own_name = own in {f"{name}unit", f"{name}units", f"unit{name}", f"units{name}"}
            if (by_group or by_own_name) and len(text.words) == 1 and self.nearest([text], path):
                return text.words[0].strip() or None
        return None

    def unit_lists(self) -> tuple[Text, ...]:
        """Return all texts that are called units."""
        return tuple(text for text in self._texts if text.path and matches_any(text.path[-1], UNITS))


def split_list(text: Text) -> tuple[str, ...]:
    """Return the words of a list, also where they stand in one text: ``s, m/s^2``.

    Parameters
    ----------
    text
        As written in the file.

    Returns
    -------
    tuple of str
    """
    words = re.split(r"[,;|\t\n]", text.words[0]) if len(text.words) == 1 else text.words
    return tuple(word.strip() for word in words)


def _listed(text: Text, count: int) -> tuple[str, ...] | None:
    """Return a list of as many names as there are columns, that of a time left out; None where the number differs."""
    words = split_list(text) if matches_any(text.path[-1], NAMES) else text.words
    if len(words) == count + 1 and normalise_name(words[0]) in {"t", "time"}:
        words = words[1:]
    return words if len(words) == count > 1 and all(words) else None

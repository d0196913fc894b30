"""Settings of the vehicle itself, and loads, that the names of recordings state by numbers: ``damped_500_100``.

A number behind a word of a damper, a spring or a pressure is a setting. A further number is a load, unless it counts the
recordings.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import PurePath

_PARTS = ("damp", "dämpf", "daempf", "shock", "amort", "ammort", "smorz", "spring", "feder", "ressort", "molla", "pressure",
          "druck", "pression",
          "tyre", "tire", "reifen", "stabilis", "antiroll", "valve", "ventil", "preload", "vorspann")  # fmt: skip
"""Beginnings of words of what is set at a vehicle."""

_CHOICES = ("setting", "settings", "setup", "config", "configuration", "variant", "variante", "einstellung", "stufe", "stage",
            "click", "clicks", "klick", "klicks", "notch", "raste", "arb", "stabi")  # fmt: skip
"""Words behind which even a number that counts is a setting."""

_NO_PARTS = ("federweg", "springer")
_WITHOUT = ("ohne", "no", "without", "sans", "senza", "sin", "kein", "keine")
_SETTING_UNITS = ("bar", "psi", "kpa", "mbar", "clicks", "click", "klicks", "ma")
_OTHER_UNITS = (
    "s",
    "sec",
    "sek",
    "min",
    "ms",
    "hz",
    "khz",
    "mm",
    "cm",
    "m",
    "kg",
    "lb",
    "lbs",
    "t",
    "g",
    "kmh",
    "v",
    "x",
)
"""Units of a number that is neither a setting nor a load without a unit."""

_LEAST_LOAD, _LONGEST_LOAD = 10, 5
"""Smallest number without a unit that may be a load, as below it repeats are counted; and its digits, as a date has more."""

_PIECES = re.compile(r"(?P<number>\d+(?:\.\d+)?)(?:\s?(?P<unit>[^\W\d_]+))?|(?P<word>[^\W\d_]+)")


@dataclass(frozen=True)
class NamedCondition:
    """What the name of a recording states of the vehicle.

    Attributes
    ----------
    setting
        Name of its setting, such as ``damped_500``; None where the recordings do not differ in it.
    load
        Number that stands for a load; ``empty`` where other recordings have one, None where none has.
    """

    setting: str | None = None
    load: str | None = None


@dataclass(frozen=True)
class _Numbers:
    """A word of a name and the numbers behind it."""

    part: str
    """What is set, or the unit in which it is stated."""
    word: str
    """The word for it; empty where there is only the unit."""
    numbers: tuple[str, ...]


def conditions_named(paths: Sequence[str]) -> dict[str, NamedCondition]:
    """Return what the names of recordings, and of their folders, state of the vehicle.

    Parameters
    ----------
    paths
        Of all recordings, relative to the folder.

    Returns
    -------
    dict
        By path.

    Examples
    --------
    >>> found = conditions_named(["test 1_1, damped_500.lvm", "test 1_2, damped_500_40.lvm", "Damped_800.lvm", "undamped.lvm"])
    >>> [(own.setting, own.load) for own in found.values()]
    [('damped_500', 'empty'), ('damped_500', '40'), ('damped_800', 'empty'), ('damped_0', 'empty')]
    """
    stated = {path: _numbers_in(path) for path in paths}
    parts = dict.fromkeys(part for own in stated.values() for part in own)
    differing = [part for part in parts if _is_setting([own[part] for own in stated.values() if part in own])]
    words = {part: _usual_word(part, stated.values()) for part in differing}
    loads = _loads(stated)
    return {
        path: NamedCondition(_setting(own, words) if differing else None, loads.get(path))
        for path, own in stated.items()
    }


def by_setting(conditions: Mapping[str, NamedCondition]) -> dict[str | None, tuple[str, ...]]:
    """Return the recordings of each setting, the settings in the order of their numbers.

    Parameters
    ----------
    conditions
        By path.
    """
    groups: defaultdict[str | None, list[str]] = defaultdict(list)
    for path, own in conditions.items():
        groups[own.setting].append(path)
    order = sorted(groups, key=lambda name: [float(number) for number in re.findall(r"\d+(?:\.\d+)?", name or "")])
    return {setting: tuple(groups[setting]) for setting in order}


def _numbers_in(path: str) -> dict[str, _Numbers]:
    """Return, by the part that is set, its word and the numbers behind it; the file's name first, then the folders'."""
    found: dict[str, _Numbers] = {}
    for text in (PurePath(path).stem, *reversed(PurePath(path).parts[:-1])):
        for own in _read(text):
            if own.numbers:
                found.setdefault(own.part, own)
    return found


def _read(text: str) -> list[_Numbers]:
    """Return the words of a name that state a setting, in their order."""
    found: list[_Numbers] = []
    before, is_open = "", False
    for piece in _PIECES.finditer(text.lower()):
        number, unit = piece["number"], piece["unit"]
        if number is not None and is_open and unit not in _OTHER_UNITS:
            found[-1] = replace(found[-1], numbers=(*found[-1].numbers, number))
        elif number is not None and unit in _SETTING_UNITS:
            found.append(_Numbers(unit, "", (number,)))
        word = piece["word"] or unit
        if word is None or (number is not None and word in (*_OTHER_UNITS, *_SETTING_UNITS)):
            continue
        part = _part_of(word)
        is_open = part is not None
        if part is not None:
            plain = next(
                (word.removeprefix(no) for no in ("un", "non") if _part_of(word.removeprefix(no)) == part), word
            )
            found.append(_Numbers(part, plain, ("0",) if plain != word or before in _WITHOUT else ()))
        before = word
    return found


def _part_of(word: str) -> str | None:
    """Return what a word says is set; None where it says nothing of it."""
    if word in _CHOICES:
        return word
    plain = word.removeprefix("un").removeprefix("non").removeprefix("ge")
    return None if plain in _NO_PARTS else next((part for part in _PARTS if plain.startswith(part)), None)


def _is_setting(stated: Sequence[_Numbers]) -> bool:
    """Return whether the recordings differ in the first number behind a word, and it does not count them."""
    first = [float(own.numbers[0]) for own in stated]
    if len(set(first)) < 2:
        return False
    return stated[0].part in _CHOICES or not _counts([own.numbers[0] for own in stated])


def _counts(numbers: Sequence[str]) -> bool:
    """Return whether numbers count: each once, without a gap."""
    if any("." in number for number in numbers):
        return False
    values = sorted(int(number) for number in numbers)
    return len(values) > 1 and all(later - earlier == 1 for earlier, later in pairwise(values))


def _usual_word(part: str, stated: Iterable[Mapping[str, _Numbers]]) -> str:
    return Counter(own[part].word for own in stated if part in own).most_common(1)[0][0]


def _setting(own: Mapping[str, _Numbers], words: Mapping[str, str]) -> str:
    named = [
        f"{word}_{own[part].numbers[0]}" if word else f"{own[part].numbers[0]}{part}"
        for part, word in words.items()
        if part in own
    ]
    return "-".join(named) or "other"


def _loads(stated: Mapping[str, Mapping[str, _Numbers]]) -> dict[str, str]:
    """Return the second number behind the word of a setting by the recording, where it stands for a load."""
    found: dict[str, str] = {}
    for part in dict.fromkeys(part for own in stated.values() for part in own):
        second = {
            path: own[part].numbers[1]
            for path, own in stated.items()
            if len(own[part].numbers if part in own else ()) > 1
        }
        large = {path: number for path, number in second.items() if _is_large(number)}
        if not _counts(list(large.values())):
            found |= large
    differ = len({found.get(path) for path in stated}) > 1
    return {path: found.get(path, "empty") for path in stated} if differ else {}


def _is_large(number: str) -> bool:
    """Return whether a number may be a load: it counts no repeats, and is no date."""
    return not number.startswith("0") and len(number) <= _LONGEST_LOAD and float(number) >= _LEAST_LOAD

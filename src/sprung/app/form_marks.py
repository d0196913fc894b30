"""What is said of the places of a campaign file: problems, and what is still to be written there."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sprung.app.toml_spans import Place
from sprung.campaign import CheckedDocument, find_placeholders
from sprung.errors import Problem

_WHERE = re.compile(r"^[^:]+: (\w+(?:\[\d+\])?(?:\.\w+(?:\[\d+\])?)*)")
"""The place in a problem, as `sprung.campaign` writes it: ``campaign.toml: sensor[3].position (body_rl)``."""


@dataclass
class Marks:
    """What is said of places, until a field or a group takes it."""

    problems: dict[str, list[Problem]] = field(default_factory=dict)
    missing: dict[str, str] = field(default_factory=dict)
    keys: dict[tuple[str, str], dict[str, None]] = field(default_factory=dict)
    general: list[Problem] = field(default_factory=list)
    placeholders: set[Place] = field(default_factory=set)

    def take_within(self, name: str) -> tuple[tuple[Problem, ...], tuple[str, ...]]:
        """Return the problems and the gaps of a place and of everything in it that no field has, once."""
        section, index, *_ = f"{name}.".split(".")
        inside = [key for key in self.keys.get((section, index), ()) if f"{key}.".startswith(f"{name}.")]
        problems = tuple(problem for key in inside for problem in self.problems.pop(key, ()))
        return problems, tuple(self.missing.pop(key) for key in inside if key in self.missing)

    def add(self, name: str, mark: Problem | str) -> None:
        """Add a problem of a place, or what is missing there."""
        section, index, *_ = f"{name}.".split(".")
        for start in ((section, ""), (section, index)):
            self.keys.setdefault(start, {})[name] = None
        if isinstance(mark, str):
            self.missing[name] = mark
        else:
            self.problems.setdefault(name, []).append(mark)


def marks_of(document: Mapping[str, Any], checked: CheckedDocument, path: Path) -> Marks:
    """Return what is said of the places of a campaign file.

    Parameters
    ----------
    document
        What the file holds.
    checked
        Its check.
    path
        Of the file; its recordings, which are only looked for, are beside it.
    """
    marks = Marks()
    for problem in checked.problems:
        found = _WHERE.match(problem.where)
        if found is None:
            marks.general.append(problem)
        else:
            marks.add(_name_of(found[1]), problem)
    for name, problem in _absent_files(document, path).items():
        marks.add(name, problem)
    for entry in checked.missing:
        found = _WHERE.match(entry.problem.where)
        if found is not None and entry.needed:
            marks.add(_name_of(found[1]), entry.problem.expected)
    for place, what in find_placeholders(document):
        marks.placeholders.add(place)
        marks.add(name_of(place), what)
    return marks


def _absent_files(document: Mapping[str, Any], path: Path) -> dict[str, Problem]:
    """Return a problem for each recording that is not beside the campaign file."""
    found: dict[str, Problem] = {}
    drops = document.get("drop")
    for index, drop in enumerate(drops if isinstance(drops, list) else ()):
        file = drop.get("file") if isinstance(drop, dict) else None
        if isinstance(file, str) and not file.startswith("TODO:") and not (path.parent / file).is_file():
            where, do = f"{path.name}: drop[{index + 1}].file", "Correct the name, or put the recording there."
            problem = Problem(where, f"'{file}', which is not there", "a recording beside the campaign file", do)
            found[f"drop.{index}.file"] = problem
    return found


def name_of(place: Place) -> str:
    """Return a place as the name of a field: ``sensor.2.position``, counting from 0."""
    return ".".join(map(str, place))


def _name_of(where: str) -> str:
    """Return the name of a field from a place that counts from 1: ``sensor[3].position``."""
    return re.sub(r"\[(\d+)\]", lambda match: f".{int(match[1]) - 1}", where)

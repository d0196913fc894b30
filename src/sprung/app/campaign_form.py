"""A campaign file as a form: sections and fields with what the file says, and the problems beside them."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from sprung.app.form_fields import ENTRIES, Kind, Spec, is_used, restricted, section_specs
from sprung.app.toml_spans import Place, entries_by_place, scan
from sprung.campaign import CheckedDocument, check_document, find_placeholders
from sprung.errors import Problem
from sprung.vehicle import LAYOUTS

MANY = 60
"""Number of entries of a kind beyond which seldom used keys are shown only where they are stated: a form has a largest size."""

_WHERE = re.compile(r"^[^:]+: (\w+(?:\[\d+\])?(?:\.\w+(?:\[\d+\])?)*)")
"""The place in a problem, as `sprung.campaign` writes it: ``campaign.toml: sensor[3].position (body_rl)``."""


@dataclass(frozen=True, slots=True)
class Part:
    """One input of a field.

    Attributes
    ----------
    name
        In the form: the place in the file, with dots.
    label
        Its own, in a field of several.
    value
        What the file says, as it is written there.
    """

    name: str
    label: str
    value: str


@dataclass(frozen=True, slots=True)
class Field:
    """A key of the campaign file, with what it says.

    Attributes
    ----------
    name
        Its place in the file, with dots.
    place
        The same for a program.
    spec
        What is expected.
    parts
        Its inputs; one, unless it has several numbers.
    choices
        Words that it may be, for this part of a vehicle.
    chosen
        Those of several words that are stated, or meant where nothing is.
    missing
        What is still to be written there; empty where nothing is missing.
    problems
        What is wrong with it.
    stated
        Whether the file has the key.
    is_table
        Whether its value is written as a table, such as ``{ value = 5 }``.
    """

    name: str
    place: Place
    spec: Spec
    parts: tuple[Part, ...]
    choices: tuple[str, ...] = ()
    chosen: tuple[str, ...] = ()
    missing: str = ""
    problems: tuple[Problem, ...] = ()
    stated: bool = False
    is_table: bool = False

    @property
    def kind(self) -> Kind:
        """Kind of the value."""
        return self.spec.kind

    @property
    def is_folded(self) -> bool:
        """Whether it may be folded away: seldom used, not stated, and without a problem."""
        return self.spec.rare and not (self.stated or self.problems or self.missing)


@dataclass(frozen=True, slots=True)
class Group:
    """A section of the file, or an item of a load.

    Attributes
    ----------
    name
        Its place with dots, such as ``sensor.2``.
    section
        ``vehicle``, ``test``, ``known``, ``model``, ``sensor``, ``load``, ``item`` or ``drop``.
    title
        For people.
    fields
        In their usual order.
    items
        Of a load.
    problems
        That belong to no field of it.
    """

    name: str
    section: str
    title: str
    fields: tuple[Field, ...]
    items: tuple[Group, ...] = ()
    problems: tuple[Problem, ...] = ()


@dataclass(frozen=True, slots=True)
class CampaignForm:
    """A campaign file as a form.

    Attributes
    ----------
    groups
        Sections in their usual order.
    problems
        That belong to none of them.
    missing
        Number of gaps without which nothing can be identified.
    faulty
        Number of all problems.
    addable
        Known quantities that the form does not show yet: name and label.
    """

    groups: tuple[Group, ...]
    problems: tuple[Problem, ...]
    missing: int
    faulty: int
    addable: tuple[tuple[str, str], ...] = ()

    def fields(self) -> Iterator[Field]:
        """Yield all fields."""
        for group in self.groups:
            yield from group.fields
            for item in group.items:
                yield from item.fields


@dataclass
class _Marks:
    """What is said of places, until a field takes it."""

    problems: dict[str, list[Problem]] = field(default_factory=dict)
    keys: dict[tuple[str, str], dict[str, None]] = field(default_factory=dict)
    missing: dict[str, str] = field(default_factory=dict)
    general: list[Problem] = field(default_factory=list)

    def take_within(self, name: str) -> tuple[Problem, ...]:
        """Return the problems of a place and of everything in it that no field has, once."""
        section, index, *_ = f"{name}.".split(".")
        inside = [key for key in self.keys.get((section, index), ()) if f"{key}.".startswith(f"{name}.")]
        return tuple(problem for key in inside for problem in self.problems.pop(key, ()))

    def add(self, name: str, problem: Problem) -> None:
        """Add a problem of a place."""
        section, index, *_ = f"{name}.".split(".")
        for start in ((section, ""), (section, index)):
            self.keys.setdefault(start, {})[name] = None
        self.problems.setdefault(name, []).append(problem)


def campaign_form(text: str, path: Path) -> tuple[CampaignForm, CheckedDocument]:
    """Return a campaign file as a form, and its check.

    Parameters
    ----------
    text
        Of the file.
    path
        Of the file; its recordings, which are only looked for, are beside it.

    Raises
    ------
    tomllib.TOMLDecodeError
        If the text is no TOML.
    """
    text = text.removeprefix("\ufeff")
    document = tomllib.loads(text)
    checked = check_document(document, path)
    absent = _absent_files(document, path)
    marks = _marks(document, checked, absent)
    values = {place: text[value.start : value.end] for place, value in entries_by_place(scan(text)).items()}
    groups = tuple(_groups(document, values, marks))
    left = [problem for problems in marks.problems.values() for problem in problems]
    faulty = len(checked.problems) + len(absent)
    shown = {each.place[1] for group in groups if group.section == "known" for each in group.fields}
    addable = tuple((spec.key, spec.label) for spec in section_specs("known") if spec.key not in shown)
    missing = sum(entry.needed for entry in checked.missing)
    return CampaignForm(groups, (*marks.general, *left), missing, faulty, addable), checked


def _marks(document: Mapping[str, Any], checked: CheckedDocument, absent: Mapping[str, Problem]) -> _Marks:
    marks = _Marks()
    for problem in checked.problems:
        found = _WHERE.match(problem.where)
        if found is None:
            marks.general.append(problem)
        else:
            marks.add(_name_of(found[1]), problem)
    for name, problem in absent.items():
        marks.add(name, problem)
    for entry in checked.missing:
        found = _WHERE.match(entry.problem.where)
        if found is not None:
            marks.missing[_name_of(found[1])] = entry.problem.expected
    for place, what in find_placeholders(document):
        # A form has no notation to explain.
        marks.missing[name_of(place)] = re.sub(r": a number or \{.*|; or remove (?:this|the) line.*", "", what)
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


@dataclass(frozen=True)
class _Source:
    """What the fields are filled from: values as written, what is said of them, and the words that are possible."""

    values: Mapping[Place, str]
    marks: _Marks
    wheels: Sequence[str]
    loads: Sequence[str]


def _groups(document: Mapping[str, Any], values: Mapping[Place, str], marks: _Marks) -> Iterator[Group]:
    model = _table(document.get("vehicle")).get("model", "full")
    wheels = LAYOUTS[model if model in LAYOUTS else "full"].wheels
    source = _Source(values, marks, wheels, ["empty", *_load_names(document)])
    names = {"vehicle": "Vehicle", "known": "Known quantities", "model": "Model", "test": "Test, for the record"}
    for section, title in names.items():
        yield _group((section,), section, title, _table(document.get(section)), source)
    for section in ENTRIES:
        entries = document.get(section)
        listed = entries if isinstance(entries, list) else []
        for index, entry in enumerate(listed):
            title = _title(section, index, _table(entry))
            yield _group((section, index), section, title, _table(entry), source, len(listed) > MANY)


def _table(node: Any) -> Mapping[str, Any]:
    return node if isinstance(node, dict) else {}


def _load_names(document: Mapping[str, Any]) -> list[str]:
    loads = document.get("load")
    names = [_table(load).get("name") for load in loads] if isinstance(loads, list) else []
    return [name for name in names if isinstance(name, str) and name != "empty"]


def _title(section: str, index: int, entry: Mapping[str, Any]) -> str:
    key = {"sensor": "channel", "load": "name", "drop": "name"}[section]
    name = entry.get(key) or entry.get("file")
    own = f": {name}" if isinstance(name, str) and not name.startswith("TODO:") else ""
    return f"{section.capitalize()} {index + 1}{own}"


def _group(
    place: Place, section: str, title: str, entry: Mapping[str, Any], source: _Source, many: bool = False
) -> Group:
    specs = [
        spec
        for spec in section_specs(section)
        if is_used(spec.key, entry) or not (spec.rare and (many or section == "known"))
    ]
    fields = tuple(_field(place, spec, entry, source) for spec in specs)
    listed = entry.get("items") if section == "load" else None
    items = tuple(
        _group((*place, "items", index), "item", f"Item {index + 1}", _table(item), source)
        for index, item in enumerate(listed if isinstance(listed, list) else ())
    )
    return Group(name_of(place), section, title, fields, items, source.marks.take_within(name_of(place)))


def _field(group: Place, spec: Spec, entry: Mapping[str, Any], source: _Source) -> Field:
    place = (*group, *spec.key.split("."))
    name = name_of(place)
    node: Any = entry
    for key in spec.key.split("."):
        node = _table(node).get(key)
    missing = source.marks.missing.get(name, "")
    node = None if isinstance(node, str) and node.startswith("TODO:") else node
    chosen: tuple[str, ...] = ()
    if spec.kind == "several":
        stated = node if isinstance(node, list) else source.wheels if spec.key == "wheels" and not missing else ()
        chosen = tuple(word for word in stated if isinstance(word, str))
    choices = restricted(spec, source.wheels)
    if (group[0], spec.key) == ("sensor", "position") and entry.get("on", "body") != "body":
        spec = replace(spec, rare=True)  # only sensors on the body have one
    if (group[0], spec.key) == ("drop", "load"):
        spec, choices = replace(spec, kind="choice"), tuple(source.loads)
    stated_words = (
        chosen if spec.kind == "several" else (node,) if spec.kind == "choice" and isinstance(node, str) else ()
    )
    choices = (
        *choices,
        *(word for word in stated_words if word not in choices),
    )  # also one that is wrong stays until changed
    return Field(
        name,
        place,
        spec,
        tuple(_parts(place, spec, node, source.values)),
        choices,
        chosen,
        missing,
        source.marks.take_within(name),
        is_used(spec.key, entry),
        isinstance(node, dict),
    )


def _parts(place: Place, spec: Spec, node: Any, values: Mapping[Place, str]) -> Iterator[Part]:
    """Yield the inputs of a field with what the file says."""
    name = name_of(place)
    if spec.kind == "measured":
        table = isinstance(node, dict)
        value = values.get((*place, "value"), "") if table else _written(node, values.get(place, ""))
        yield Part(f"{name}.value", spec.label, value)
        yield Part(f"{name}.std", "standard uncertainty", values.get((*place, "std"), "") if table else "")
    elif spec.kind == "vector":
        for index, label in enumerate(spec.parts):
            written = values.get((*place, index), "") if isinstance(node, list) else ""
            yield Part(f"{name}.{index}", label, written)
    elif spec.kind == "lines":
        yield Part(name, "", "\n".join(map(str, node)) if isinstance(node, list) else "")
    else:
        yield Part(name, "", "" if spec.kind == "several" else _written(node, values.get(place, "")))


def _written(node: Any, literal: str) -> str:
    """Return a value for an input: text without its quotes, anything else as it is written."""
    if node is None:
        return ""
    return node if isinstance(node, str) else literal

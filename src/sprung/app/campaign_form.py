"""A campaign file as a form: sections and fields with what the file says, and the problems beside them."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sprung.app.form_fields import ENTRIES, Kind, Spec, is_used, restricted, section_specs
from sprung.app.form_marks import Marks, marks_of, name_of
from sprung.app.toml_spans import Place, entries_by_place, scan
from sprung.campaign import CheckedDocument, check_document
from sprung.errors import Problem
from sprung.vehicle import LAYOUTS

MANY = 60
"""Number of entries of a kind beyond which seldom used keys are shown only where they are stated: a form has a largest size."""

_LOAD = "the pieces of this load (Add an item), or its totals (More)"
"""What is missing of a load: a form has no notation to explain."""

_REMOVABLE = re.compile(r"; (?:or )?remove (?:this|the) line.*")
"""What a placeholder says where it may also be removed."""


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
    may_be_left_out
        Whether what is missing may also remain unknown.
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
    may_be_left_out: bool = False
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
    problems, gaps
        That belong to no field of it.
    """

    name: str
    section: str
    title: str
    fields: tuple[Field, ...]
    items: tuple[Group, ...] = ()
    problems: tuple[Problem, ...] = ()
    gaps: tuple[str, ...] = ()


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
        Number of fields and groups with a gap without which nothing can be identified.
    faulty
        Number of all problems.
    addable
        Known quantities that the form does not show yet: name and label.
    placeholders
        Places of the texts that stand for what is missing.
    """

    groups: tuple[Group, ...]
    problems: tuple[Problem, ...]
    missing: int
    faulty: int
    addable: tuple[tuple[str, str], ...] = ()
    placeholders: frozenset[Place] = frozenset()

    def fields(self) -> Iterator[Field]:
        """Yield all fields."""
        for group in self.groups:
            yield from group.fields
            for item in group.items:
                yield from item.fields


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
    marks = marks_of(document, checked, path)
    values = {
        place: "" if place in marks.placeholders else text[value.start : value.end]
        for place, value in entries_by_place(scan(text)).items()
    }
    faulty = len(marks.general) + sum(map(len, marks.problems.values()))
    groups = tuple(_groups(document, values, marks))
    left = [problem for problems in marks.problems.values() for problem in problems]
    shown = {each.place[1] for group in groups if group.section == "known" for each in group.fields}
    addable = tuple((spec.key, spec.label) for spec in section_specs("known") if spec.key not in shown)
    parts = [part for group in groups for part in (group, *group.items)]
    missing = sum(bool(part.gaps) + sum(bool(each.missing) for each in part.fields) for part in parts)
    form = CampaignForm(groups, (*marks.general, *left), missing, faulty, addable, frozenset(marks.placeholders))
    return form, checked


@dataclass(frozen=True)
class _Source:
    """What the fields are filled from: values as written, what is said of them, and the words that are possible."""

    values: Mapping[Place, str]
    marks: Marks
    wheels: Sequence[str]
    loads: Sequence[str]


def _groups(document: Mapping[str, Any], values: Mapping[Place, str], marks: Marks) -> Iterator[Group]:
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
    problems, gaps = source.marks.take_within(name_of(place))
    if section == "load" and gaps:
        gaps = (_LOAD,)
    return Group(name_of(place), section, title, fields, items, problems, tuple(map(_in_a_form, gaps)))


def _field(group: Place, spec: Spec, entry: Mapping[str, Any], source: _Source) -> Field:
    place = (*group, *spec.key.split("."))
    name = name_of(place)
    node: Any = entry
    for key in spec.key.split("."):
        node = _table(node).get(key)
    problems, gaps = source.marks.take_within(name)
    missing = "; ".join(gaps)
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
        _in_a_form(missing),
        _REMOVABLE.search(missing) is not None,
        problems,
        is_used(spec.key, entry),
        isinstance(node, dict),
    )


def _in_a_form(missing: str) -> str:
    """Return what is missing without the notation of a file, which a form does without."""
    return re.sub(r": a number or \{.*", "", _REMOVABLE.sub("", missing))


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

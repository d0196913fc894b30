"""From a TOML file to the records it describes, as far as they can be understood."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from pydantic import ValidationError

from sprung.campaign.file_kind import find_parameters_section
from sprung.campaign.placeholders import find_placeholders
from sprung.campaign.schema import CampaignFile, VehicleFileSchema
from sprung.campaign.schema_file import SCHEMA
from sprung.campaign.schema_problems import Place, format_place, problems_from_validation
from sprung.errors import InputError, Problem, Problems

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping

    from pydantic_core import ErrorDetails

File = TypeVar("File", bound=CampaignFile)
File_co = TypeVar("File_co", bound=CampaignFile, covariant=True)


_UNKNOWN: Mapping[str, Any] = {"load": "", "wheels": [], "items": [], "excitation": "drop"}
"""What stands for "not known" in a key that holds text or a list, and what is assumed of an excitation; None does elsewhere."""


@dataclass(frozen=True)
class ParsedFile(Generic[File_co]):
    """What could be understood of a file, so that the rest of it can still be checked.

    Attributes
    ----------
    name
        The file's.
    document
        All of it, as TOML gives it.
    file
        What is left of it without its faulty entries.
    lost
        The entries left out, such as ("sensor", 2).
    placeholders
        The gaps that are still to be filled, by their place: each as the problem that it is for an identification. What such a
        place holds counts as not known.
    """

    name: str
    document: Mapping[str, Any]
    file: File_co
    lost: frozenset[Place]
    placeholders: Mapping[Place, Problem]

    def complete(self, section: str) -> bool:
        """Return whether no entry of a section was left out or has an unknown name."""
        if not self.lost:
            return True
        known = type(self.file).model_json_schema()["properties"]
        misnamed = any(place[0] not in known for place in self.lost)
        return (section in self.document or not misnamed) and all(place[0] != section for place in self.lost)

    def numbered(self, section: str) -> Iterator[int]:
        """Yield the index in the document of every valid entry of ``sensor``, ``load`` or ``drop``."""
        written = () if (section,) in self.lost else self.document.get(section, ())
        return (index for index in range(len(written)) if (section, index) not in self.lost)

    def where(self, *place: str | int) -> str:
        """Return a place in the file as text: ``campaign.toml: sensor[3].position (body_rl)``, counting from 1."""
        return format_place(self.name, place, self.document)


def parse_document(model: type[File], document: Mapping[str, Any], name: str, problems: Problems) -> ParsedFile[File]:
    """Parse a document into the records of its model, entry by entry.

    Parameters
    ----------
    model
        The file's schema.
    document
        What the file holds, as TOML gives it.
    name
        The file's.
    problems
        Takes up every fault found in it; gaps are none.

    Returns
    -------
    Draft
        What remains when the faulty entries are left out.

    Raises
    ------
    InputError
        If nothing of it can be understood, as it is of a newer schema, or of the other kind of file.
    """
    number = document.get("schema", SCHEMA)
    if number != SCHEMA:
        newer = isinstance(number, int) and number > SCHEMA
        do = "Update sprung: the file was written for a newer version." if newer else f"Write schema = {SCHEMA}."
        found, expected = f"schema {number!r}", f"schema {SCHEMA}, which this version of sprung reads"
        raise InputError([Problem(f"{name}: schema", found, expected, do)])
    section = None if issubclass(model, VehicleFileSchema) else find_parameters_section(document)
    if section is not None:
        found = f"[{section}], which makes it a vehicle file"
        do = "Plan its test with `sprung plan`, or simulate its recordings with `sprung simulate`."
        raise InputError([Problem(f"{name}: {section}", found, "a campaign file", do)])
    found, do = "a placeholder", "Replace the text by the value."
    placeholders = {
        place: Problem(format_place(name, place, document), found, what, do)
        for place, what in find_placeholders(document)
    }
    known = _with_unknowns(document, placeholders)
    details: list[ErrorDetails] = []
    try:
        return ParsedFile(name, document, _validated(model, known), frozenset(), placeholders)
    except ValidationError as error:
        details = error.errors(include_url=False)
    lost = frozenset(detail["loc"][:2] for detail in details)
    wrong = [detail for detail in details if not _within(detail["loc"], placeholders)]
    for problem in problems_from_validation(model, wrong, name, document):
        problems.add(problem.where, problem.found, problem.expected, problem.do)
    return ParsedFile(name, document, _validated(model, _without(known, lost)), lost, placeholders)


def _with_unknowns(part: Any, placeholders: Collection[Place], place: Place = ()) -> Any:
    """Replace every placeholder by the value for "not known"."""
    if place in placeholders:
        return _UNKNOWN.get(str(place[-1]))
    if isinstance(part, dict):
        return {key: _with_unknowns(value, placeholders, (*place, key)) for key, value in part.items()}
    if isinstance(part, list):
        return [_with_unknowns(value, placeholders, (*place, index)) for index, value in enumerate(part)]
    return part


def _within(place: Place, placeholders: Collection[Place]) -> bool:
    """Return whether a fault lies within a placeholder."""
    return any(place[: len(placeholder)] == placeholder for placeholder in placeholders)


def _validated(model: type[File], document: Mapping[str, Any]) -> File:
    # By way of JSON, because only there strict typing (no number from "5" or true) takes lists for tuples.
    return model.model_validate_json(json.dumps(document, default=str), strict=True)


def _without(document: Mapping[str, Any], lost: Collection[Place]) -> dict[str, Any]:
    kept: dict[str, Any] = {}
    for key, value in document.items():
        if (key,) in lost:
            continue
        if isinstance(value, dict):
            kept[key] = {name: inner for name, inner in value.items() if (key, name) not in lost}
        elif isinstance(value, list):
            kept[key] = [inner for index, inner in enumerate(value) if (key, index) not in lost]
        else:
            kept[key] = value
    return kept

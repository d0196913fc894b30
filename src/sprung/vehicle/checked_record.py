"""Records of a campaign file: frozen dataclasses whose values are checked when they are made."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields
from functools import cache, wraps
from typing import Any, TypeVar, cast, dataclass_transform

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from sprung.display import shown
from sprung.errors import InputError, Problem, did_you_mean

Record = TypeVar("Record")

UNKNOWN_KEY = "unexpected_keyword_argument"
"""Error type of the validation for a key that the record does not have."""

_CHECKED = ConfigDict(extra="forbid", use_attribute_docstrings=True)


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(Field,))
def checked_record(model: type[Record]) -> type[Record]:
    """Make a class a frozen dataclass that checks its values; the text below each field describes it.

    Parameters
    ----------
    model
        The class, its fields annotated.

    Returns
    -------
    type
        The dataclass. Its fields are given by keyword.

    Raises
    ------
    InputError
        By the constructor of the class returned, if a value is wrong; with every problem.
    """
    made = dataclass(frozen=True, kw_only=True, slots=True, config=_CHECKED)(model)
    construct = cast("Callable[..., None]", made.__init__)

    @wraps(construct)
    def constructor(self: Any, **keys: Any) -> None:
        try:
            construct(self, **keys)
        except ValidationError as error:
            label = next((str(value) for key, value in keys.items() if key in {"channel", "name", "file"}), "")
            where = f"{model.__name__} {label}".strip()
            raise InputError(problems_of_record(made, error, where)) from None

    type.__setattr__(made, "__init__", constructor)
    return shown(cast("type[Record]", made))


def parse_record(model: type[Record], keys: Mapping[str, Any]) -> Record:
    """Return the record that a mapping of its keys describes, with records for the tables in it.

    Parameters
    ----------
    model
        A class made by `checked_record`.
    keys
        As a campaign file holds them.

    Returns
    -------
    Record

    Raises
    ------
    pydantic.ValidationError
        If they describe no valid record; see `problems_of_record`.
    """
    return cast("Record", _adapter(cast("Any", model)).validate_python(dict(keys)))


@cache
def _adapter(model: Any) -> TypeAdapter[Any]:
    return TypeAdapter(model)


def problems_of_record(model: type, error: ValidationError, where: str) -> Iterator[Problem]:
    """Yield the problems of the values of a record.

    Parameters
    ----------
    model
        The record's class.
    error
        Of its validation.
    where
        Name of the record in the problems.

    Yields
    ------
    Problem
    """
    for fault in error.errors(include_url=False):
        place, message = ".".join(str(part) for part in (where, *fault["loc"])), fault["msg"]
        if fault["type"] == UNKNOWN_KEY:
            # The keys of a nested record are not known here.
            known = [field.name for field in fields(model)] if len(fault["loc"]) == 1 else []
            do = did_you_mean(str(fault["loc"][-1]), known) if known else "Correct it."
            yield Problem(place, f"the unknown key '{fault['loc'][-1]}'", "a key that sprung knows", do)
        elif fault["type"] == "value_error":
            sentence = message.removeprefix("Value error, ")
            do = f"{sentence[0].upper()}{sentence[1:]}."
            yield Problem(place, "inconsistent values", "consistent values", do)
        elif fault["type"].startswith("missing"):
            yield Problem(place, "nothing", "a value", f"Add {fault['loc'][-1]} = ... to it.")
        else:
            yield Problem(place, repr(fault["input"]), message.removeprefix("Input should be "), "Correct it.")

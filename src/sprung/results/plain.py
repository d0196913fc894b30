"""Conversion of records to plain values for JSON, and back with validation."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any, TypeVar, cast

from pydantic import TypeAdapter

Record = TypeVar("Record")


def plain_document(record: object, *without: str) -> dict[str, Any]:
    """Return a record's fields by the names they have in JSON, as plain values.

    Parameters
    ----------
    record
        A dataclass.
    *without
        Fields to leave out.
    """
    document = _adapter(cast("Any", type(record))).dump_python(record, mode="json", by_alias=True, exclude=set(without))
    return cast("dict[str, Any]", document)


def record_from(cls: type[Record], document: Mapping[str, Any]) -> Record:
    """Return the record that plain values describe.

    Parameters
    ----------
    cls
        A dataclass.
    document
        Values by the names they have in JSON.

    Raises
    ------
    pydantic.ValidationError
        If they do not describe one: every reason.
    """
    return cast("Record", _adapter(cast("Any", cls)).validate_python(document))


@cache
def _adapter(cls: Any) -> TypeAdapter[Any]:
    return TypeAdapter(cls)

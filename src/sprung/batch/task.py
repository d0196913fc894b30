"""Tasks of a batch: one campaign each, with a key from its content, and what comes of it."""

from __future__ import annotations

import hashlib
import json
import time
import traceback
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, Literal, TypeAlias

from sprung.display import shown
from sprung.errors import SprungError

Row: TypeAlias = dict[str, Any]
"""Values of one campaign by column: text, numbers, and lists of either."""

Work: TypeAlias = Callable[[Any], Row]
"""A function of a module that can be imported by its name: from the argument of a task to its row."""

Kind = Literal["text", "number", "integer", "texts", "numbers"]
"""Type of a column; the plural ones contain lists."""

Columns: TypeAlias = Mapping[str, Kind]
"""Types of the columns of a row, by name."""

FailureReason = Literal["input", "defect", "worker"]
"""Why a campaign has no result: it cannot be used, the program has a defect, or its worker process was lost."""


@shown
@dataclass(frozen=True, slots=True)
class Task:
    """One campaign to do.

    Attributes
    ----------
    campaign
        Which one: the path of its file, or its number in a study. Each has one row.
    key
        Checksum of everything that its row follows from: another key, and the row is computed anew.
    argument
        What the work is called with.
    """

    campaign: str
    key: str
    argument: Any


@shown
@dataclass(frozen=True, slots=True)
class Failure:
    """Why a task has no result.

    Attributes
    ----------
    reason
        ``input``: the campaign cannot be used; ``defect``: the work raised an error of the program; ``worker``: its worker
        process was lost repeatedly.
    message
        For people to read.
    """

    reason: FailureReason
    message: str


def content_key(parts: Iterable[str | bytes]) -> str:
    """Return the checksum of a sequence of texts or bytes.

    Parameters
    ----------
    parts
        In order; the boundaries between them count.

    Returns
    -------
    str
        32 hexadecimal digits, the first half of a SHA-256 checksum.

    Examples
    --------
    >>> content_key(["ab", "c"]) == content_key(["a", "bc"])
    False
    """
    digest = hashlib.sha256()
    for part in parts:
        content = part.encode("utf-8", "surrogateescape") if isinstance(part, str) else part
        digest.update(len(content).to_bytes(8, "little"))
        digest.update(content)
    return digest.hexdigest()[:32]


def attempt(work: Work, argument: Any) -> Row | Failure:
    """Do the work of one task; an error becomes a failure, so that it ends no other task.

    Parameters
    ----------
    work, argument
        The function, and what it is called with.

    Returns
    -------
    Row or Failure
        The row with the computing time, ``seconds``.
    """
    began = time.perf_counter()
    try:
        return {**work(argument), "seconds": time.perf_counter() - began}
    except SprungError as error:
        return Failure("input", str(error))
    except Exception as error:  # noqa: BLE001 (a failure is a row; the other campaigns are done)
        place = traceback.extract_tb(error.__traceback__)[-1]
        text = " ".join(str(error).split())
        return Failure("defect", f"{type(error).__name__}: {text} ({place.name}, line {place.lineno})")


def canonical_text(value: Any) -> str:
    """Return a text that is the same for equal values, in every process and on every machine, for a key.

    Parameters
    ----------
    value
        Text, numbers, None, sequences, mappings and dataclasses of them.

    Returns
    -------
    str
        JSON.

    Examples
    --------
    >>> canonical_text({"b": (1, 2.5), "a": None})
    '{"a": null, "b": [1, 2.5]}'
    """
    return json.dumps(_plain(value), sort_keys=True, allow_nan=True)


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        own = {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
        return {"type": type(value).__name__, **own}
    if isinstance(value, Mapping):
        return {str(name): _plain(item) for name, item in value.items()}
    if isinstance(value, Set):
        return sorted(map(canonical_text, value))
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_plain(item) for item in value]
    return value if isinstance(value, str | int | float | None) else str(value)

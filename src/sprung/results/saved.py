"""Reading back a saved result, and refusing one that is not as sprung wrote it."""

from __future__ import annotations

import json
import re
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from pydantic import ValidationError

from sprung.errors import Problem, Problems, ResultFileError
from sprung.results.checksums import SEALS, arrays_seal, document_seal
from sprung.results.plain import record_from
from sprung.results.result import SCHEMA, Result
from sprung.results.series import Everything, everything_in
from sprung.results.withholding import withhold_estimates
from sprung.uncertainty import Estimate
from sprung.vehicle import UNKNOWN_KEY

_AGAIN = "Run the identification again, or take the file from where it was copied."
_ROUNDING = 1e-6
"""By which a correlation may exceed 1 or differ from its mirror image."""

_UNREADABLE = (
    *(OSError, ValueError, LookupError, EOFError, TypeError, ArithmeticError, MemoryError, RuntimeError, SyntaxError),
    *(zipfile.BadZipFile, zlib.error, struct.error, tokenize.TokenError),
)
"""What NumPy and zipfile raise of archives in which bytes have been changed."""


def load(folder: str | Path, *, series: bool = True) -> Result:
    """Give back a saved result.

    Parameters
    ----------
    folder
        As given to `Result.save`, or its results.json.
    series
        Whether to read series.npz too, which only figures need; without it the result's ``series`` is empty.

    Returns
    -------
    Result

    Raises
    ------
    ResultFileError
        If a file is missing, cut off, changed since it was written, or written by a newer sprung; with every reason.
    """
    folder = Path(folder)
    path = folder if folder.suffix == ".json" else folder / "results.json"
    document = _document(path)
    problems = Problems()
    seals = document.pop(SEALS, {})
    try:
        result = record_from(Result, document)
    except ValidationError as error:
        result = None
        for what in error.errors():
            place = ".".join(str(part) for part in what["loc"])
            found = "a key that no result has" if what["type"] == UNKNOWN_KEY else what["msg"]
            problems.add(f"{path}: {place}", found, *_as_written(document))
    if result is not None:
        for where, found in _contradictions(result):
            problems.add(f"{path}: {where}", found, *_as_written(document))
    if not isinstance(seals, dict) or seals.get("document", document_seal(document)) != document_seal(document):
        found = "numbers or words that were changed after it was written (its checksum is another)"
        problems.add(str(path), found, "a result as sprung wrote it", _AGAIN)
    everything = Everything({}, {})
    if series:
        with problems.collecting():
            everything = _everything(
                path.with_name("series.npz"), seals.get("series") if isinstance(seals, dict) else None
            )
    if problems or result is None:
        raise ResultFileError(problems)
    return withhold_estimates(replace(result, **everything._asdict()))


def _document(path: Path) -> dict[str, Any]:
    try:
        document = json.loads(path.read_text(encoding="utf-8"), parse_constant=_no_number)
    except OSError as error:
        inside = path.parent / "results"
        do = f"Did you mean {inside}?" if (inside / "results.json").is_file() else "Name the folder given to save."
        _refuse(path, (error.strerror or str(error)).lower(), "a saved result", do, error)
    except (ValueError, RecursionError) as error:
        found = f"no valid JSON ({error}): cut off or changed by hand"
        _refuse(path, found, "a whole results.json", _AGAIN, error)
    if not isinstance(document, dict):
        _refuse(path, f"JSON that holds a {type(document).__name__}", "a result", "Name the folder given to save.")
    schema = document.get("schema")
    if schema is None:
        found = "JSON without a schema number, which every result has"
        _refuse(path, found, "a result as sprung wrote it", "Name the folder given to save.")
    if isinstance(schema, int) and schema > SCHEMA:
        writer = document.get("sprung", "a newer sprung")
        _refuse(path, f"schema {schema}, of sprung {writer}", f"schema {SCHEMA} or older", "Update sprung to read it.")
    return document


def _no_number(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number of JSON")


def _as_written(document: Mapping[str, Any]) -> tuple[str, str]:
    """Say what is expected of a document, and what to do where it is not so."""
    here, writer = version("sprung"), str(document.get("sprung"))
    if _release(writer) > _release(here):
        return f"what sprung {here} knows", f"It was written by sprung {writer}: update sprung to read it."
    return "a result as sprung wrote it", _AGAIN


def _release(text: str) -> tuple[int, ...]:
    return tuple(map(int, re.findall(r"\d+", text)[:3]))


def _contradictions(result: Result) -> Iterator[tuple[str, str]]:
    """Name what cannot be in one result, though each number alone could be."""
    for name, found in result.parameters.items():
        if not _is_whole(found):
            yield f"parameters.{name}", f"{found.status} with value {found.value} and std {found.std}"
    names, matrix = result.correlation.names, result.correlation.matrix
    strangers = [name for name in names if name not in result.parameters]
    if strangers:
        yield "correlation.names", f"{', '.join(strangers)}, of which there is no parameter"
    if len(matrix) != len(names) or any(len(row) != len(names) for row in matrix):
        yield "correlation.matrix", f"rows that do not fit {len(names)} names"
    elif names:
        rows = np.array(matrix)
        if (
            np.abs(rows - rows.T).max() > _ROUNDING
            or np.abs(np.diag(rows) - 1).max() > _ROUNDING
            or np.abs(rows).max() > 1 + _ROUNDING
        ):
            yield "correlation.matrix", "numbers that are no correlations"


def _is_whole(found: Estimate) -> bool:
    match found.status:
        case "unidentifiable":
            return found.value is None and found.std is None
        case "known":
            return found.value is not None and found.std == 0
        case "estimated":
            return found.value is not None and found.std is not None and found.std > 0


def _everything(path: Path, seal: object) -> Everything:
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            arrays = {key: archive[key] for key in archive.files}
    except FileNotFoundError as error:
        _refuse(path, "no such file", "the series of the result beside it", "Copy the whole results folder.", error)
    except _UNREADABLE as error:
        _refuse(path, f"no series ({error}): cut off or spoilt", "the series of a saved result", _AGAIN, error)
    if seal is not None and seal != arrays_seal(arrays):
        found = "series that do not belong to this result (their checksum is another)"
        _refuse(path, found, "the series that were written with results.json", _AGAIN)
    try:
        return everything_in(arrays)
    except ValueError as error:
        expected = "channels, time, measured and fitted of every drop, and what else sprung writes"
        _refuse(path, str(error), expected, _AGAIN, error)


def _refuse(path: Path, found: str, expected: str, do: str, because: Exception | None = None) -> NoReturn:
    raise ResultFileError([Problem(str(path), found, expected, do)]) from because

"""Reading of a saved result; a result that was changed since it was written is refused."""

from __future__ import annotations

import json
import re
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from sprung.errors import Problem, Problems, ResultFileError
from sprung.results.checksums import CHECKSUMS, arrays_checksum, document_checksum
from sprung.results.plain import record_from
from sprung.results.result import SCHEMA, Result
from sprung.results.series import series_from
from sprung.vehicle import UNKNOWN_KEY

_REMEDY = "Run the identification again, or take the file from where it was copied."

_UNREADABLE = (
    *(OSError, ValueError, LookupError, EOFError, TypeError, ArithmeticError, MemoryError, RuntimeError, SyntaxError),
    *(zipfile.BadZipFile, zlib.error, struct.error, tokenize.TokenError),
)
"""What NumPy and zipfile raise of archives in which bytes have been changed."""

_IN_WORDS = {UNKNOWN_KEY: "a key that no result has", "missing": "no such entry"}
"""What does not fit in a file, by the type of the error."""


def load(folder: str | Path, *, series: bool = True) -> Result:
    """Return a saved result.

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
    document = _read_document(path)
    checksums = document.pop(CHECKSUMS, None)
    checksums = checksums if isinstance(checksums, dict) else {}
    problems = Problems()
    result = None
    try:
        result = record_from(Result, document)
    except ValidationError as error:
        for reason in error.errors():
            key = ".".join(map(str, reason["loc"]))
            found = _IN_WORDS.get(reason["type"], reason["msg"])
            problems.add(f"{path}: {key}", found, *_expected_of(document))
    if checksums.get("document") != document_checksum(document):
        found = "a file that was changed after it was written (its checksum differs)"
        problems.add(str(path), found, "a result as sprung wrote it", _REMEDY)
    if series:
        with problems.collect():
            arrays = _read_arrays(path.with_name("series.npz"), checksums.get("series"))
            if result is not None:
                result = _with_series(result, arrays, path.with_name("series.npz"))
    if problems or result is None:
        raise ResultFileError(problems)
    return result


def _read_document(path: Path) -> dict[str, Any]:
    try:
        document = json.loads(path.read_text(encoding="utf-8"), parse_constant=_refuse_constant)
    except OSError as error:
        inside = path.parent / "results"
        do = f"Did you mean {inside}?" if (inside / "results.json").is_file() else "Name a folder of results."
        _refuse(path, (error.strerror or str(error)).lower(), "a saved result", do, error)
    except (ValueError, RecursionError) as error:
        found = f"no valid JSON ({error}): cut off or changed by hand"
        _refuse(path, found, "a whole results.json", _REMEDY, error)
    if not isinstance(document, dict):
        _refuse(path, f"JSON that holds a {type(document).__name__}", "a result", "Name a folder of results.")
    schema = document.get("schema")
    if schema is None:
        found = "JSON without a schema number, which every result has"
        _refuse(path, found, "a result as sprung wrote it", "Name a folder of results.")
    if isinstance(schema, int) and schema > SCHEMA:
        writer = document.get("sprung", "a newer sprung")
        _refuse(path, f"schema {schema}, of sprung {writer}", f"schema {SCHEMA} or older", "Update sprung to read it.")
    return document


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number of JSON")


def _expected_of(document: Mapping[str, Any]) -> tuple[str, str]:
    """Return what is expected of a document that does not fit, and the remedy."""
    own, writer = version("sprung"), str(document.get("sprung"))
    if _release(writer) > _release(own):
        return f"a result that sprung {own} can read", f"It was written by sprung {writer}: update sprung to read it."
    return "a result as sprung wrote it", _REMEDY


def _release(text: str) -> tuple[int, ...]:
    return tuple(map(int, re.findall(r"\d+", text)[:3]))


def _read_arrays(path: Path, checksum: object) -> dict[str, NDArray[Any]]:
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            arrays = {key: archive[key] for key in archive.files}
    except FileNotFoundError as error:
        _refuse(path, "no such file", "the series of the result beside it", "Copy the whole results folder.", error)
    except _UNREADABLE as error:
        found = "a file that is no archive of NumPy arrays: cut off, damaged or another file"
        _refuse(path, found, "the series of a saved result", _REMEDY, error)
    if checksum != arrays_checksum(arrays):
        found = "series that do not belong to this result (their checksum differs)"
        _refuse(path, found, "the series that were written with results.json", _REMEDY)
    return arrays


def _with_series(result: Result, arrays: Mapping[str, NDArray[Any]], path: Path) -> Result:
    try:
        series, recordings = series_from(arrays)
    except ValueError as error:
        expected = "the arrays of every drop, as sprung writes them"
        _refuse(path, str(error), expected, _REMEDY, error)
    return replace(result, series=series, recordings=recordings)


def _refuse(path: Path, found: str, expected: str, do: str, because: Exception | None = None) -> NoReturn:
    raise ResultFileError([Problem(str(path), found, expected, do)]) from because

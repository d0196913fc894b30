"""Excel workbooks: one sheet with a table, understood like a text table of the same cells."""

from __future__ import annotations

import datetime as dt
import zipfile
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from sprung.errors import InputError
from sprung.formats.csv import table_from_lines
from sprung.formats.libraries import load_library
from sprung.formats.reading_errors import SPARE, MemoryBudget, input_error, reading

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from sprung.formats.table import SampleTable

_KIND = "an Excel workbook"
_ZIP, _COMPOUND = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
_SAVE = "Open it in a spreadsheet program and save it as .xlsx, or better as CSV."
_RATIO = 15
"""How many times larger than the file its sheets may be: with sensor noise 4 to 9 times, of zeros only 13 times (measured)."""

_CELL = 32
"""Bytes of text that a cell may take."""


class ExcelFormat:
    """Workbooks as .xlsx or .xlsm, with the time and the channels as columns of one sheet; needs openpyxl."""

    def claims(self, path: Path, head: bytes) -> bool:  # noqa: ARG002 (what the ending says is refused by name if it is not so)
        """Claim by the ending, older and other workbooks too, so that the refusal can say what to do."""
        return path.suffix.lower() in {".xlsx", ".xlsm", ".xls", ".xlsb", ".ods"}

    def read(self, path: Path) -> SampleTable:
        """Read the only sheet that holds a recording; dates, decimal commas and rows of units as in a text table.

        Raises
        ------
        InputError
            If it is another kind of workbook, is damaged, holds no recording or several, or openpyxl is missing.
        """
        _refuse_others(path)
        openpyxl = load_library("openpyxl", "excel", path)
        budget = MemoryBudget(path)
        with reading(path.name, "an Excel workbook"):
            _refuse_larger_content(
                path
            )  # openpyxl reads a whole sheet to find its size where the sheet does not state it
            workbook = openpyxl.load_workbook(path, read_only=True, data_only=True)
        try:
            with reading(path.name, "an Excel workbook"):
                sheets = {sheet.title: list(_lines(sheet, budget)) for sheet in workbook.worksheets}
        finally:
            workbook.close()
        return _the_table({name: lines for name, lines in sheets.items() if any(line.strip() for line in lines)}, path)


def _refuse_others(path: Path) -> None:
    with path.open("rb") as file:
        head = file.read(512)
    ending = path.suffix.lower()
    if not head:
        raise input_error(path.name, "an empty file", _KIND, "Copy or export it again.")
    if ending in {".xlsx", ".xlsm"} and head.startswith(_ZIP):
        return
    if head.startswith(_COMPOUND):
        found = "a workbook of old Excel (.xls), or one with a password"
        raise input_error(path.name, found, "a workbook as .xlsx without a password, or CSV", _SAVE)
    if head.startswith(_ZIP):
        raise input_error(path.name, f"a workbook of another kind ({ending})", "a workbook as .xlsx, or CSV", _SAVE)
    if b"\0" not in head:
        found = f"text under the name of a workbook ({ending})"
        raise input_error(path.name, found, _KIND, "Rename it to .csv, as its content suggests.")
    raise input_error(path.name, f"a file that is no workbook ({ending})", _KIND, "Copy or export it again.")


def _refuse_larger_content(path: Path) -> None:
    """Refuse an archive that unpacks to many times its size; no more than it declares is unpacked."""
    with zipfile.ZipFile(path) as archive:
        declared = sum(member.file_size for member in archive.infolist())
    size = path.stat().st_size
    if declared > _RATIO * size + SPARE:
        found = f"{size} bytes that unpack to {declared}"
        raise input_error(path.name, found, "a workbook about as large as its recording", _SAVE)


def _lines(sheet: Any, budget: MemoryBudget) -> Iterator[str]:
    """Write each row as a line of text, its cells separated by tabs."""
    for row in sheet.iter_rows(values_only=True):
        budget.take(_CELL * len(row))
        yield "\t".join(map(_cell, row)).rstrip("\t")


def _cell(value: object) -> str:
    match value:
        case None:
            return ""
        case bool():
            return str(int(value))
        case dt.datetime():
            return value.isoformat(" ")
        case dt.time():
            return value.isoformat()
        case dt.timedelta():
            return repr(value.total_seconds())
        case _:
            return " ".join(str(value).split())


def _the_table(sheets: dict[str, list[str]], path: Path) -> SampleTable:
    """Understand every sheet; the one that is a recording is meant, and others, such as a cover, are not."""
    if not sheets:
        raise input_error(
            path.name, "a workbook without content", "a sheet with the time and the channels", "Export it again."
        )
    tables: dict[str, SampleTable] = {}
    problems: dict[str, InputError] = {}
    for name, lines in sheets.items():
        try:
            tables[name] = table_from_lines(f"{path.name}: sheet '{name}'", lines)
        except InputError as error:
            problems[name] = error
    match list(tables.items()):
        case [(name, table)]:
            place = table.place
            return replace(table, place=lambda sample: f"sheet '{name}', {place(sample).replace('line', 'row')}")
        case []:
            longest = max(problems, key=lambda name: len(sheets[name]))
            raise problems[longest]
        case _:
            found = f"{len(tables)} sheets with recordings: {', '.join(repr(name) for name in tables)}"
            raise input_error(path.name, found, "one", "Save each sheet as a workbook or CSV file of its own.")

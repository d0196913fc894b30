"""A workbook of some hundred kilobytes that unpacks to many megabytes of rows."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

_ROWS = b"<row><c><v>0</v></c><c><v>0</v></c></row>" * 25_000
"""About a megabyte."""


def write_zip_bomb(path: Path, megabytes: int) -> Path:
    """Write a workbook whose only sheet does not state its size: openpyxl then reads all of it first."""
    openpyxl = pytest.importorskip("openpyxl")
    workbook = openpyxl.Workbook()
    workbook.save(path)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            with archive.open(name, "w") as file:
                if not name.endswith("sheet1.xml"):
                    file.write(content)
                    continue
                file.write(b'<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>')
                for _ in range(megabytes):
                    file.write(_ROWS)
                file.write(b"</sheetData></worksheet>")
    return path

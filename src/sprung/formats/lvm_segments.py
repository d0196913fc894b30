"""The headers of a LabVIEW measurement file, and the lines between them that hold samples."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from sprung.formats.reading_errors import input_error, truncation_error
from sprung.formats.text_blocks import Encoding, read_blocks
from sprung.formats.text_layout import COLUMNS, DELIMITERS, EMPTY

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

_FIRST, _VERSION = "LabVIEW Measurement", "Writer_Version"
_END_OF_HEADER = "***End_of_Header***"
_START_SPECIAL, _END_SPECIAL = "***Start_Special***", "***End_Special***"
_AGAIN = "Copy the file again, or save the recording again from LabVIEW."


def is_lvm(head: bytes) -> bool:
    """Return whether a file begins as LabVIEW measurement files do.

    Parameters
    ----------
    head
        Its first bytes.
    """
    lines = head.replace(b"\0", b"").decode("latin-1").splitlines()  # UTF-16 too
    return bool(lines) and _FIRST in lines[0] and any(line.startswith(_VERSION) for line in lines)


@dataclass(frozen=True, eq=False)
class Segment:
    """The samples below one segment header.

    Attributes
    ----------
    line
        Number of the first line of the header.
    delimiter, decimal
        What separates cells, and the decimal mark of numbers, by the header of the file.
    fields
        The cells of every line of the header by its first cell, that one included.
    titles
        The cells of the line with the names of the columns.
    titles_line
        Number of that line.
    ranges
        Lines with samples: the number of the first, and of the line after the last.
    first_row
        The first of them.
    """

    line: int
    delimiter: str
    decimal: str
    fields: Mapping[str, list[str]]
    titles: list[str]
    titles_line: int
    ranges: list[tuple[int, int]] = field(default_factory=list)
    first_row: list[str] = field(default_factory=list)


@dataclass(eq=False)
class _Scanner:
    """Goes through the lines of a file; `follow` is what the next line is given to."""

    file: str
    segments: list[Segment] = field(default_factory=list)
    fields: dict[str, list[str]] = field(default_factory=dict)
    delimiter: str = "\t"
    decimal: str = "."
    header: int = 1
    follow: Callable[[int, str], None] = field(init=False)
    _after: Callable[[int, str], None] = field(init=False)

    def __post_init__(self) -> None:
        """Begin with the header of the file."""
        self.follow = self._after = self._file_header

    def end(self) -> None:
        """Check that the file is complete.

        Raises
        ------
        InputError
            If it ends within a header or a special block, or holds no segment.
        """
        if self.follow == self._special:
            raise truncation_error(self.file, f"a special block without {_END_SPECIAL}")
        if self.follow != self._samples and (self.fields or not self.segments):
            found = f"a header that begins in line {self.header}, without {_END_OF_HEADER} or without samples below it"
            raise input_error(self.file, found, "a header of the file, then segments, each with a header", _AGAIN)

    def _cells(self, line: str) -> list[str]:
        return [cell.strip() for cell in line.split(self.delimiter, COLUMNS)]

    def _enter_header(self, number: int, header: Callable[[int, str], None]) -> None:
        self.fields, self.header, self.follow = {}, number, header

    def _file_header(self, number: int, line: str) -> None:
        if line.startswith(_END_OF_HEADER):
            self._check_marks()
            self._enter_header(number + 1, self._segment_header)
            return
        for tag in (_FIRST, "Separator"):  # of both, the separator stands behind the tag
            if line.startswith(tag) and len(line) > len(tag):
                self.delimiter = line[len(tag)]
        cells = self._cells(line)
        if cells[0] == "Decimal_Separator":
            self.decimal = "".join(cells[1:2]) or self.decimal
        self.fields[cells[0]] = cells

    def _check_marks(self) -> None:
        where, allowed = f"{self.file}: header", [mark for mark in DELIMITERS if mark != " "]
        if self.delimiter not in allowed:
            expected = f"a separator that is one of: {', '.join(DELIMITERS[mark] for mark in allowed)}"
            raise input_error(where, f"the separator {self.delimiter!r}", expected, "Save the file with tabs.")
        if self.decimal not in (".", ","):
            found, expected = f"the decimal separator {self.decimal[:20]!r}", "a point or a comma"
            raise input_error(where, found, expected, "Save the file with a decimal point.")

    def _segment_header(self, number: int, line: str) -> None:
        if line.startswith(_FIRST):  # somebody appended to the file in another session
            self._enter_header(number, self._file_header)
        elif line.startswith(_START_SPECIAL):
            self.follow, self._after = self._special, self._segment_header
        elif line.startswith(_END_OF_HEADER):
            self.follow = self._titles
        else:
            cells = self._cells(line)
            if any(cells):
                self.header = self.header if self.fields else number
                self.fields[cells[0]] = cells

    def _special(self, number: int, line: str) -> None:  # noqa: ARG002 (of whatever kind it is)
        if line.startswith(_END_SPECIAL):
            self.follow = self._after

    def _titles(self, number: int, line: str) -> None:
        cells = self._cells(line)
        if not any(cells):
            return
        if cells[0] != "X_Value":
            found, expected = f"{cells[0][:80]!r}", "the names of the columns, beginning with X_Value"
            raise input_error(f"{self.file}: line {number}", found, expected, _AGAIN)
        while not cells[-1]:
            cells.pop()
        segment = Segment(self.header, self.delimiter, self.decimal, self.fields, cells, number)
        self.segments.append(segment)
        self.fields, self.follow = {}, self._samples

    def _samples(self, number: int, line: str) -> None:
        ranges = self.segments[-1].ranges
        if line[:1].isalpha() and self._cells(line)[0].lower() not in EMPTY:
            self._enter_header(number, self._segment_header)
            self._segment_header(number, line)
        elif line.startswith(_START_SPECIAL):
            self.follow, self._after = self._special, self._samples
        elif ranges and ranges[-1][1] == number:
            ranges[-1] = (ranges[-1][0], number + 1)
        elif line.strip():
            if not ranges:
                self.segments[-1].first_row.extend(self._cells(line))
            ranges.append((number, number + 1))


def find_segments(path: Path, encoding: Encoding) -> tuple[list[Segment], dict[int, int]]:
    """Return the segments of a file.

    Parameters
    ----------
    path
        The file, which is gone through once.
    encoding
        Its.

    Returns
    -------
    segments
        In the order of the file.
    line_numbers
        By the byte with which a block of lines begins, the number of its first line.

    Raises
    ------
    InputError
        If it ends too early, or if a header cannot be understood.
    """
    scanner, numbers, number = _Scanner(path.name), {}, 1
    for block in read_blocks(path, encoding):
        numbers[block.start] = number
        for line in block.lines:
            scanner.follow(number, line)
            number += 1
    scanner.end()
    return scanner.segments, numbers

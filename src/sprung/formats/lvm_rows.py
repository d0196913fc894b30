"""The lines of a LabVIEW measurement file that hold samples, without their comments."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from sprung.formats.text_blocks import LineBlock
from sprung.formats.text_layout import NUMBER
from sprung.formats.text_samples import TextSamples

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence


@dataclass(frozen=True, eq=False)
class SegmentSamples(TextSamples):
    """The lines with samples of segments with the same columns; all other lines are empty.

    Attributes
    ----------
    line_numbers
        By the byte with which a block of lines begins, the number of its first line.
    ranges
        Lines with samples: the number of the first, and of the line after the last.
    comments
        Whether a comment may stand behind the samples.
    """

    line_numbers: Mapping[int, int] = field(default_factory=dict)
    ranges: Sequence[tuple[int, int]] = ()
    comments: bool = True

    def read_blocks(self, start: int) -> Iterator[LineBlock]:
        """Yield the lines from a byte on."""
        number = self.line_numbers[start]
        for block in super().read_blocks(start):
            end = number + len(block.lines)
            kept = [""] * len(block.lines)
            for first, stop in self.ranges[max(bisect_right(self.ranges, (number, end)) - 1, 0) :]:
                if first >= end:
                    break
                for line in range(max(first, number), min(stop, end)):
                    kept[line - number] = self._without_comment(block.lines[line - number])
            yield LineBlock(block.start, kept)
            number = end

    def _without_comment(self, line: str) -> str:
        """Return a line without its comment, which may hold anything; more than one number is no comment."""
        delimiter, width = self.layout.delimiter, len(self.layout.names)
        if line.count(delimiter) < width:
            return line
        *cells, rest = line.split(delimiter, width)
        others = [cell for cell in map(str.strip, rest.split(delimiter)) if cell]
        if len(others) > self.comments and all(NUMBER.fullmatch(cell) for cell in others):
            return line
        return delimiter.join(cells)

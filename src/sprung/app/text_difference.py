"""Two versions of a text file: the lines that differ, and the line ends of the one in the other."""

from __future__ import annotations

import difflib
import itertools
from collections import Counter
from collections.abc import Iterable
from typing import TypeAlias

Opcode: TypeAlias = tuple[str, int, int, int, int]
"""As `difflib.SequenceMatcher.get_opcodes` returns them."""

_LARGEST = 4_000_000
"""Largest product of the numbers of lines that are compared each with each; a larger part counts as replaced as a whole.

`difflib` needs a time that grows with the third power of the number of lines where many are the same."""

_MOST = 1000
"""Most lines of a difference that are shown."""


def difference(old: str, new: str) -> list[str]:
    r"""Return the lines of a file that are changed, as ``diff -U1`` shows them, without the names of the files.

    Parameters
    ----------
    old, new
        Its versions.

    Examples
    --------
    >>> difference("a = 1\nb = 2\nc = 3\n", "a = 1\nb = 4\nc = 3\n")
    ['@@ -1,3 +1,3 @@', ' a = 1', '-b = 2', '+b = 4', ' c = 3']
    """
    before, after = old.splitlines(), new.splitlines()
    lines: list[str] = []
    for group in _Aligned(_opcodes(before, after)).get_grouped_opcodes(1):
        (_, i, _, j, _), (_, _, i_end, _, j_end) = group[0], group[-1]
        lines.append(f"@@ -{i + 1},{i_end - i} +{j + 1},{j_end - j} @@")
        for tag, i1, i2, j1, j2 in group:
            if tag == "equal":
                lines += (f" {line}" for line in before[i1:i2])
            else:
                lines += (f"-{line}" for line in before[i1:i2])
                lines += (f"+{line}" for line in after[j1:j2])
    return lines if len(lines) <= _MOST else [*lines[:_MOST], f"@@ {len(lines) - _MOST} more lines @@"]


def with_line_ends(text: str, original: str) -> str:
    r"""Return a text, whose lines end with ``\n``, with the line ends that the same lines have in another version.

    Parameters
    ----------
    text
        As a browser sends it.
    original
        The file. A new line ends as most lines of it do.

    Examples
    --------
    >>> with_line_ends("a\nb\nnew\nc\n", "a\r\nb\nc\r\n")
    'a\r\nb\nnew\r\nc\r\n'
    """
    before = original.split("\n")
    if not any(line.endswith("\r") for line in before):
        return text
    usual = Counter(line.endswith("\r") for line in before[:-1]).most_common(1)[0][0]
    after = text.split("\n")
    ends = [usual] * len(after)
    for tag, i1, i2, j1, j2 in _opcodes([line.removesuffix("\r") for line in before], after):
        if tag == "equal":
            ends[j1:j2] = [line.endswith("\r") for line in before[i1:i2]]
    *whole, last = (f"{line}\r" if has_return else line for line, has_return in zip(after, ends, strict=True))
    return "\n".join((*whole, last if original.endswith("\r") else after[-1]))


class _Aligned(difflib.SequenceMatcher[str]):
    """Lines that are aligned already."""

    def __init__(self, opcodes: list[Opcode]) -> None:
        super().__init__()
        self._aligned = opcodes

    def get_opcodes(self) -> list[Opcode]:  # type: ignore[override]
        return self._aligned


def _opcodes(old: list[str], new: list[str]) -> list[Opcode]:
    """Return how the lines of one text become those of the other."""
    head = _common(zip(old, new, strict=False))
    tail = _common(zip(reversed(old[head:]), reversed(new[head:]), strict=False))
    before, after = old[head : len(old) - tail], new[head : len(new) - tail]
    if not before or not after or len(before) * len(after) > _LARGEST:
        tag = "replace" if before and after else "delete" if before else "insert"
        inner: list[Opcode] = [(tag, 0, len(before), 0, len(after))] if before or after else []
    else:
        inner = list(difflib.SequenceMatcher(None, before, after, autojunk=False).get_opcodes())
    found: list[Opcode] = [(tag, i1 + head, i2 + head, j1 + head, j2 + head) for tag, i1, i2, j1, j2 in inner]
    if head:
        found.insert(0, ("equal", 0, head, 0, head))
    if tail:
        found.append(("equal", len(old) - tail, len(old), len(new) - tail, len(new)))
    return found


def _common(pairs: Iterable[tuple[str, str]]) -> int:
    """Return the number of pairs before the first whose texts differ."""
    return sum(1 for _ in itertools.takewhile(lambda pair: pair[0] == pair[1], pairs))

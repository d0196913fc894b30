"""The code blocks of a page, and what it takes to run them as a reader would: in order, in an empty folder."""

from __future__ import annotations

import contextlib
import io
import itertools
import json
import os
import re
import shlex
import subprocess
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from command_line import run

ELIDED = "..."
"""A line that stands for any lines in what is printed."""

_BLOCK = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"# file: (\S+)\n")
_NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
_INSTALLS = re.compile(r"python -m (pip|pytest)\b")


@dataclass(frozen=True)
class Block:
    """One fenced block: its language, what stands in it, and in which line it begins."""

    language: str
    text: str
    line: int


def blocks_of(page: str) -> list[Block]:
    """Return all fenced blocks of a page."""
    return [
        Block(found[1].strip(), found[2], page.count("\n", 0, found.start()) + 1) for found in _BLOCK.finditer(page)
    ]


def indented_code(page: str) -> list[str]:
    """Return lines that Markdown interprets as code without a fence: the tests would not run them."""
    lines = _BLOCK.sub("", page).split("\n")
    return [line for before, line in itertools.pairwise(lines) if not before.strip() and re.match(r" {4,}\S", line)]


def run_page(page: str) -> None:
    """Run every block in the working folder; what is shown below a block is what it printed."""
    names: dict[str, Any] = {"__name__": "page"}
    printed: str | None = None
    for block in blocks_of(page):
        match block.language:
            case "sh":
                printed = "".join(_commands(block))
            case "python":
                with contextlib.redirect_stdout(io.StringIO()) as out:
                    exec(compile("\n" * block.line + block.text, "page", "exec"), names)  # noqa: S102 (our own text)
                printed = out.getvalue()
            case "toml":
                tomllib.loads(block.text)
                if found := _FILE.match(block.text):
                    Path(found[1]).write_text(block.text, encoding="utf-8")
            case "json":
                json.loads(block.text)
            case "text":
                assert printed is not None, f"line {block.line}: nothing ran of which this could be what is printed"
                _compare(block, printed)
            case directive if directive.startswith("{"):
                pass
            case other:
                raise AssertionError(f"line {block.line}: nobody knows how to run '{other}'")


def _commands(block: Block) -> Iterator[str]:
    for line in re.sub(r"\\\n", " ", block.text).splitlines():
        for command in line.split("#", 1)[0].split("&&"):
            words = shlex.split(command)
            if words[:1] == ["sprung"]:
                done = run(*words[1:])
                assert done.status == 0, f"line {block.line}: {command}: {done.err}"
                yield done.out
            elif words[:1] == ["cd"]:
                os.chdir(words[1])
            elif words and not _INSTALLS.match(command.strip()):
                subprocess.run(command, shell=True, check=True)  # noqa: S602 (our own text)


def _compare(block: Block, printed: str) -> None:
    """Words must be the same, numbers to 2 % or two in the last place shown."""
    lines, place = [line.rstrip() for line in printed.splitlines()], 0
    parts = [part.strip("\n").split("\n") for part in f"\n{block.text}".split(f"\n{ELIDED}\n") if part.strip("\n")]
    for part in parts:
        found = next(
            (i for i in range(place, len(lines) - len(part) + 1) if all(map(_alike, part, lines[i : i + len(part)]))),
            None,
        )
        assert found is not None, f"line {block.line}: the page says\n{block.text}\nbut what was printed is\n{printed}"
        place = found + len(part)


def _alike(said: str, printed: str) -> bool:
    if _NUMBER.sub("0", re.sub(r"\s+", " ", said.strip())) != _NUMBER.sub("0", re.sub(r"\s+", " ", printed.strip())):
        return False
    return all(
        abs(float(one) - float(other)) <= max(0.02 * abs(float(one)), 2.01 * _last_place(one))
        for one, other in zip(_NUMBER.findall(said), _NUMBER.findall(printed), strict=True)
    )


def _last_place(number: str) -> float:
    mantissa, _, power = number.partition("e")
    _, _, decimals = mantissa.partition(".")
    return float(10.0 ** (int(power or 0) - len(decimals)))

"""Mutation of formulas: whether the tests of a room notice that one of its formulas is wrong.

`nox -s mutation -- --seed 1` draws ten formulas of `vehicle` and `estimation`, makes one of them wrong at a time in a copy of
the package, and runs the tests of both rooms on it. It ends with 1 if a wrong formula passes them.
"""

from __future__ import annotations

import argparse
import ast
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "sprung"
ROOMS = ("vehicle", "estimation")

_OPERATORS = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*"}
_LONGEST = 900.0
"""s after which the tests of a mutant count as failed: a wrong formula may never converge."""


@dataclass(frozen=True)
class Mutant:
    """A formula that is made wrong.

    Attributes
    ----------
    path
        Its file.
    line
        Its line, from 1.
    begin, end
        What is replaced, in bytes of the file.
    replacement
        By what.
    """

    path: Path
    line: int
    begin: int
    end: int
    replacement: str

    @property
    def text(self) -> str:
        """The mutated file."""
        source = self.path.read_bytes()
        return (source[: self.begin] + self.replacement.encode() + source[self.end :]).decode()

    def __str__(self) -> str:
        """Place, and the formula before and after."""
        before, after = (text.splitlines()[self.line - 1].strip() for text in (self.path.read_text("utf-8"), self.text))
        return f"{self.path.relative_to(PACKAGE)}:{self.line}: {before}  ->  {after}"


def mutants_of(path: Path) -> Iterator[Mutant]:
    """Yield every mutant of the arithmetic in the functions of a file: another operator, sign or constant."""
    source = path.read_bytes()
    starts = [0]
    for row in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(row))

    def place(line: int, column: int) -> int:
        return starts[line - 1] + column

    functions = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.FunctionDef)]
    inner = {id(node) for function in functions for node in ast.walk(function) if node is not function}
    for function in (one for one in functions if id(one) not in inner):
        for node in (each for statement in function.body for each in ast.walk(statement)):
            if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
                begin = place(node.lineno, node.col_offset)
                yield Mutant(path, node.lineno, begin, begin + 1, " ")
            if not isinstance(node, ast.BinOp) or type(node.op) not in _OPERATORS:
                continue
            left, right = node.left, node.right
            if any(isinstance(side, ast.JoinedStr | ast.Tuple | ast.List) for side in (left, right)):
                continue  # text or a sequence, and no number
            assert left.end_lineno is not None
            assert left.end_col_offset is not None
            begin = place(left.end_lineno, left.end_col_offset)
            between = source[begin : place(right.lineno, right.col_offset)].decode()
            operator = next((sign for sign in "+-*/" if sign in between), "")
            at = begin + len(between[: between.index(operator)].encode()) if operator else begin
            line = source[:at].count(b"\n") + 1
            yield Mutant(path, line, at, at + 1, _OPERATORS[type(node.op)])
            for side in (left, right):
                if isinstance(side, ast.Constant) and isinstance(side.value, int | float):
                    assert side.end_col_offset is not None
                    first, last = (place(side.lineno, column) for column in (side.col_offset, side.end_col_offset))
                    yield Mutant(path, side.lineno, first, last, repr(side.value + 1))


def draw_mutants(count: int, seed: int, rooms: Sequence[str] = ROOMS) -> list[Mutant]:
    """Draw mutants, each formula of the rooms as likely as any other."""
    every = [one for room in rooms for path in sorted((PACKAGE / room).glob("*.py")) for one in mutants_of(path)]
    return [every[number] for number in np.random.default_rng(seed).choice(len(every), count, replace=False)]


def is_caught(mutant: Mutant) -> bool:
    """Run the tests of the rooms on a copy of the package with a wrong formula; whether one of them fails."""
    own = mutant.path.relative_to(PACKAGE).parts[0]
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "sprung"
        shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
        (copy / mutant.path.relative_to(PACKAGE)).write_text(mutant.text, encoding="utf-8")
        tests = [f"tests/{room}" for room in sorted(ROOMS, key=lambda room: room != own)]
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-x",
            "-q",
            "-n",
            "0",
            "-m",
            "not long",
            "-p",
            "no:cacheprovider",
            *tests,
        ]
        environment = os.environ | {"PYTHONPATH": folder, "PYTHONDONTWRITEBYTECODE": "1"}
        try:
            done = subprocess.run(  # noqa: S603 (pytest, with files of this project)
                command, cwd=ROOT, env=environment, timeout=_LONGEST, capture_output=True, check=False
            )
        except subprocess.TimeoutExpired:
            return True
    if done.returncode not in (0, 1, 2):  # 1 a failed test, 2 an error while they are collected
        raise RuntimeError(done.stdout.decode() + done.stderr.decode())
    return done.returncode != 0


def main() -> int:
    """Draw mutants, and report which are caught."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=0, help="which mutants are drawn (default: 0)")
    parser.add_argument("--count", type=int, default=10, help="how many (default: 10)")
    options = parser.parse_args()
    survivors = 0
    for mutant in draw_mutants(options.count, options.seed):
        caught = is_caught(mutant)
        survivors += not caught
        sys.stdout.write(f"{'caught  ' if caught else 'SURVIVED'} {mutant}\n")
        sys.stdout.flush()
    sys.stdout.write(f"{options.count - survivors} of {options.count} caught\n")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())

"""What a docstring describes is there: the parameters of every function and the attributes of every class, private ones too."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from docstrings import Docstring

SOURCE = Path(__file__).resolve().parents[2] / "src" / "sprung"
FILES = sorted(path.relative_to(SOURCE).as_posix() for path in SOURCE.rglob("*.py"))

Function = ast.FunctionDef | ast.AsyncFunctionDef


def described(docstring: str, heading: str) -> list[str] | None:
    """Return the names that are described below a heading; None without one."""
    told = Docstring.of(docstring)
    return [*told.entries(heading)] if heading in told.sections else None


def of_function(node: Function) -> list[str]:
    """Return the names of its arguments."""
    every = node.args
    found = [*every.posonlyargs, *every.args, *every.kwonlyargs, every.vararg, every.kwarg]
    return [argument.arg for argument in found if argument is not None]


def of_class(node: ast.ClassDef) -> tuple[list[str], set[str]]:
    """Return its public fields without a docstring of their own, and every other name that an object of it has."""
    fields, others = list[str](), set[str]()
    for item, following in zip(node.body, [*node.body[1:], None], strict=True):
        if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name):
            has_own = isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant)
            (others.add if has_own or item.target.id.startswith("_") else fields.append)(item.target.id)
        elif isinstance(item, Function):
            others.add(item.name)
    assigned = (one for one in ast.walk(node) if isinstance(one, ast.Attribute) and isinstance(one.ctx, ast.Store))
    return fields, others | {one.attr for one in assigned}


def complaints(file: str, tree: ast.AST) -> Iterator[str]:
    """Return what is described and not there, or there and not described."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.ClassDef | Function) or (docstring := ast.get_docstring(node)) is None:
            continue
        if isinstance(node, ast.ClassDef):
            names = described(docstring, "Attributes")
            required, others = of_class(node)
            if "__getattr__" in others:
                continue
        else:
            names = described(docstring, "Parameters")
            required, others = (
                [name for name in of_function(node) if name[0] != "_" and name not in ("self", "cls")],
                {"cls"},
            )
        if names is not None:
            yield from (
                f"{file}, {node.name}: {name} is not there" for name in names if name not in {*required, *others}
            )
            yield from (f"{file}, {node.name}: {name} is not described" for name in required if name not in names)


@pytest.mark.parametrize("file", FILES)
def test_what_is_described_is_there(file: str) -> None:
    assert list(complaints(file, ast.parse((SOURCE / file).read_text(encoding="utf-8")))) == []


def test_a_name_that_has_changed_is_found() -> None:
    source = '''
class Axis:
    """An axis.

    Attributes
    ----------
    falling
        Whether it runs from high to low.
    """

    descending: bool
'''
    assert list(complaints("axis.py", ast.parse(source))) == [
        "axis.py, Axis: falling is not there",
        "axis.py, Axis: descending is not described",
    ]

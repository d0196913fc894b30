"""Requirements of the docstrings of public names, and their check."""

from __future__ import annotations

import ast
import dataclasses
import importlib
import inspect
import itertools
import pkgutil
import re
import textwrap
import typing
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
from pydantic import BaseModel

import sprung

ROOMS = (
    "analysis",
    "app",
    "assessment",
    "campaign",
    "checking",
    "cli",
    "drafting",
    "errors",
    "uncertainty",
    "estimation",
    "faults",
    "export",
    "files",
    "formats",
    "modal",
    "modal_survey",
    "paper",
    "optimisation",
    "planning",
    "plot",
    "preprocess",
    "report",
    "results",
    "selection",
    "simulation",
    "study",
    "tables",
    "units",
    "vehicle",
    "vibration",
)

UNIT = re.compile(
    r"\b(?i:SI|dimensionless|ratio|percent|factor|parts?|times|samples?|count|number of|seconds?|steps?|logarithms?|unit|units|"
    r"standard (uncertaint(y|ies)|deviations?|errors?)|log-likelihood|correlations?|probabilit(y|ies)|chances?|degrees?)\b"
    r"|%|\bHz\b|m/s|\bm²|\brad\b|\bkg\b|\bN\b|(?<![\w'])[ms]\b|1/s|σ|\b[Aa]s for `"
)
"""A unit, or a word that says what else a number is counted in, or where that is said."""

SHAPE = re.compile(r"\b[Ss]hape|\([^()]*\b\w+(, \w+)*,?\)|\b[Aa]s for `")

_HEADING = re.compile(r"^([A-Z]\w+)\n-{3,}$", re.MULTILINE)
_EQUATION = re.compile(r"\beqs?\. \((\d+)\)")
_LAST_EQUATION = 23
"""Of the paper: whose equations are cited without a name."""

_RAISING = frozenset(
    {"InputError", "ValueError", "RejectedResultError", "ResultFileError", "SprungError", "KeyError", "TypeError"}
)


@dataclass(frozen=True)
class Docstring:
    """The parts of a numpydoc docstring.

    Attributes
    ----------
    text
        All of it.
    sections
        Text by heading.
    """

    text: str
    sections: Mapping[str, str]

    @classmethod
    def of(cls, text: str) -> Docstring:
        """Take a docstring apart."""
        parts = _HEADING.split(text)
        return cls(text, dict(zip(parts[1::2], parts[2::2], strict=True)))

    def entries(self, heading: str) -> dict[str, str]:
        """Return the description of each name in a section; names may share one."""
        found: dict[str, str] = {}
        names: list[str] = []
        for line in self.sections.get(heading, "").strip("\n").split("\n"):
            if line and not line.startswith(" "):
                names = [name.strip(" *") for name in line.split(" : ")[0].split(",")]
                found.update(dict.fromkeys(names, line.partition(" : ")[2]))
            else:
                found.update({name: f"{found[name]} {line.strip()}" for name in names})
        return found


def public() -> Iterator[tuple[str, object]]:
    """Yield every public name of the package and its rooms, each object once."""
    seen: set[int] = set()
    for module in (sprung, *(importlib.import_module(f"sprung.{name}") for name in ROOMS)):
        for name in exported(module):
            value = getattr(module, name)
            if not inspect.ismodule(value) and id(value) not in seen:
                seen.add(id(value))
                yield f"{module.__name__}.{name}", value


def exported(module: ModuleType) -> list[str]:
    own = [name for name, value in vars(module).items() if getattr(value, "__module__", None) == module.__name__]
    return list(getattr(module, "__all__", [name for name in own if not name.startswith("_")]))


def complaints(name: str, value: object) -> list[str]:
    """Return what is missing in the docstring of a public name and of its public methods."""
    if inspect.isclass(value):
        said = _of_class(value)
    elif inspect.isroutine(value):
        said = _of_function(value)
    else:
        said = _of_constant(*name.rpartition(".")[::2])
    return [f"{name}{one}" for one in said]


def _of_constant(module: str, name: str) -> Iterator[str]:
    """Look for the text below a constant, where it is defined."""
    if name not in _constants_with_text(module):
        yield ": no text below it"


@cache
def _constants_with_text(module: str) -> frozenset[str]:
    room = importlib.import_module(module)
    inside = (found.name for found in pkgutil.walk_packages(getattr(room, "__path__", ()), f"{module}."))
    trees = (ast.parse(inspect.getsource(importlib.import_module(place))) for place in (module, *inside))
    return frozenset(name for tree in trees for name in _texts_below(tree.body))


def _of_class(value: type) -> Iterator[str]:
    text = inspect.getdoc(value) if "__doc__" in vars(value) else None
    if not text:
        yield ": no docstring"
        return
    told = Docstring.of(text)
    described = {
        name: said
        for one in reversed([one for one in value.__mro__ if one.__module__.startswith("sprung")])
        for name, said in (
            Docstring.of(inspect.cleandoc(one.__doc__ or "")).entries("Attributes") | _below_fields(one)
        ).items()
    }
    for name, kind in _fields(value).items():
        if name not in described:
            yield f".{name}: not described"
        else:
            yield from (f".{name}: {said}" for said in _of_number(kind, described[name] + told.text.split("\n")[0]))
    for name, method in vars(value).items():
        function = method.__func__ if isinstance(method, classmethod | staticmethod) else method
        if not name.startswith("_") and inspect.isfunction(function):
            yield from (f".{name}{said}" for said in _of_function(function, text))


def _fields(value: type) -> dict[str, Any]:
    """Return the public fields of a record and their types."""
    if dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value)]
    elif issubclass(value, BaseModel):
        names = [name for name in vars(value).get("__annotations__", {}) if name != "model_config"]
    else:
        names = list(getattr(value, "_fields", ()))
    kinds = _hints(value)
    return {name: kinds.get(name) for name in names if not name.startswith("_")}


def _below_fields(value: type) -> dict[str, str]:
    """Return the texts below the fields of a class."""
    body = ast.parse(textwrap.dedent(inspect.getsource(value))).body[0]
    assert isinstance(body, ast.ClassDef)
    return _texts_below(body.body)


def _texts_below(body: Sequence[ast.stmt]) -> dict[str, str]:
    """Return the texts below assignments, by name."""
    found = {}
    for assigned, text in itertools.pairwise(body):
        targets = assigned.targets if isinstance(assigned, ast.Assign) else [getattr(assigned, "target", None)]
        if isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant) and isinstance(text.value.value, str):
            # Of several names at once, one text.
            names = [one for target in targets for one in getattr(target, "elts", [target])]
            found.update({one.id: text.value.value for one in names if isinstance(one, ast.Name)})
    return found


def _of_function(function: Any, of_class: str = "") -> Iterator[str]:
    """Look at a function; a method may say in a sentence, or its class for all of them, what a function says in sections."""
    text = inspect.getdoc(function)
    if not text:
        yield ": no docstring"
        return
    told = Docstring.of(text)
    if strange := [number for number in _EQUATION.findall(text) if not 1 <= int(number) <= _LAST_EQUATION]:
        yield f": eq. {', '.join(strange)} is none of the paper's"
    kinds = _hints(function)
    names = [name for name in inspect.signature(function).parameters if name not in ("self", "cls")]
    described = told.entries("Parameters")
    if of_class and not described:
        around = f"{text}\n{of_class}"
        described = {name: around for name in names if re.search(rf"\b{name.rstrip('s')}", around, re.IGNORECASE)}
    if missing := [name for name in names if name not in described]:
        yield f": no word of {', '.join(missing)}"
    if strange := [name for name in described if name not in names]:
        yield f": {', '.join(strange)} are no parameters"
    for name in names:
        if name in described:
            yield from (f"({name}): {said}" for said in _of_number(kinds.get(name), described[name]))
    yield from _of_result(told, kinds.get("return"), names, of_class)
    told_errors = set(told.entries("Raises"))
    missing_errors = _raised(function) - told_errors
    if missing_errors and not (missing_errors == {"InputError"} and "ResultFileError" in told_errors):
        yield f": no Raises of {', '.join(sorted(missing_errors))}"


def _of_result(told: Docstring, kind: Any, names: Sequence[str], of_class: str) -> Iterator[str]:
    if kind not in (None, type(None), typing.NoReturn):
        if not of_class and names and not {"Returns", "Yields"} & told.sections.keys():
            yield ": no Returns"
        yield from (f": Returns: {said}" for said in _of_number(kind, f"{told.text}\n{of_class}"))


def _hints(value: Any) -> dict[str, Any]:
    try:
        return typing.get_type_hints(value)
    except (NameError, TypeError):
        return {}


def _of_number(kind: Any, said: str) -> Iterator[str]:
    """Ask for the unit of a number, and the shape of an array."""
    if _is_array(kind):
        if not SHAPE.search(said):
            yield "no shape"
        if _is_counted(kind) and not UNIT.search(said):
            yield "no unit"
    elif _is_number(kind) and not UNIT.search(said):
        yield "no unit"


def _is_array(kind: Any) -> bool:
    return typing.get_origin(kind) is np.ndarray or kind is np.ndarray or any(map(_is_array, _either(kind)))


def _is_counted(kind: Any) -> bool:
    """Whether an array contains quantities: indices and truth values have no unit."""
    return not re.search(r"numpy\.(bool|int|uint|str|object)", str(kind))


def _is_number(kind: Any) -> bool:
    return kind is float or any(map(_is_number, _either(kind)))


def _either(kind: Any) -> tuple[Any, ...]:
    """Return the members of a union, or the type in an annotated type."""
    return typing.get_args(kind) if "Union" in str(typing.get_origin(kind)) or "|" in str(kind)[:200] else ()


def _raised(function: Any) -> set[str]:
    """Return the names of the input errors that a function raises in its body."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and isinstance(node.exc.func, ast.Name):
            found.add(node.exc.func.id)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "raise_if_any":
            found.add("InputError")
    return found & _RAISING

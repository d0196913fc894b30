"""The glossary contains every fault code of the program, and the terms that other pages refer to."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
GLOSSARY = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")

CONTRACT_CODES = {
    "clipped",
    "flat",
    "missing",
    "spike",
    "unit",
    "sign",
    "exchanged",
    "position",
    "late",
    "wrong-wheel",
    "load-exchanged",
    "load-position",
    "brake",
    "unlike-repeats",
    "twist",
    "no-release",
    "no-decay",
    "rate",
    "clock",
    "offset",
    "drift",
}
"""The codes that results.json guarantees; new ones may be added."""


def codes_in_source() -> set[str]:
    """Return the literal codes of all faults that the source constructs."""
    codes = set()
    for path in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Fault" and node.args:
                code = node.args[0]
                if isinstance(code, ast.Constant) and isinstance(code.value, str):
                    codes.add(code.value)
    return codes


def glossary_terms() -> set[str]:
    """Return all terms, in lower case: the lines of a glossary block that are not indented."""
    blocks = re.findall(r"^:::\{glossary\}\n(.*?)^:::$", GLOSSARY, re.MULTILINE | re.DOTALL)
    return {line.lower() for block in blocks for line in block.splitlines() if line and not line.startswith(" ")}


def test_every_fault_code_is_described() -> None:
    described = set(re.findall(r"^\| `([a-z-]+)` \|", GLOSSARY, re.MULTILINE))
    in_source = codes_in_source()
    assert len(in_source) > 10
    assert sorted((in_source | CONTRACT_CODES) - described) == []


@pytest.mark.parametrize("page", sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").rglob("*.md")))
def test_every_term_referred_to_is_defined(page: str) -> None:
    used = re.findall(r"\{term\}`(?:[^`<]*<)?([^`<>]+)>?`", (ROOT / page).read_text(encoding="utf-8"))
    assert sorted({term.lower() for term in used} - glossary_terms()) == []


def test_every_term_has_a_definition() -> None:
    terms = glossary_terms()
    assert len(terms) > 100
    assert {"score test", "wald test", "overdispersion", "birge ratio", "warp", "tramp", "hop"} <= terms


def test_fault_codes_are_in_order() -> None:
    codes = re.findall(r"^\| `([a-z-]+)` \|", GLOSSARY.split("| code | fault |")[1].split("\n\n")[0], re.MULTILINE)
    assert codes == sorted(codes)

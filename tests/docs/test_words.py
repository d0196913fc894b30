"""Names and docstrings of the source use the terms of the field; no private name of the first version is left."""

from __future__ import annotations

import ast
import re
import tokenize
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2] / "src" / "sprung"
FILES = sorted(SOURCE.rglob("*.py"))

PRIVATE_NAMES = frozenset(
    re.findall(
        r"\w+",
        """
        Way Attempt Stand Fitted Choice Climb Summit Sums Amplitudes Run Flown Knowledge Outline Suspect Bench Trial Tally Heard
        Meaning Corners Righted Seen Rest Readings Felt Answer Changes Piece Before
        begun mended accused told fell errs worth wanting trying carried tilted mounted lively steady airborne senseless
        suspicious slid judge mend evened stamps examined seals blocked beyond
        to_the_top ascend ascend_stepped look_around prospects expected_gain force_scores lost_without told_directions feigned
        longhand catalogue rate_vehicles direct_start timed_by_release told_alone settle compete slowly fly conclude
        forces_beside as_test paper_copy
        """,
    )
)
"""Names whose meaning only the authors knew; docs/glossary.md has the terms that replace them.

Not listed are ordinary words that are legitimate names elsewhere: `late`, `twist` and `position` are codes of faults, `ahead`,
`against` and `inflation` are keys of results.json; `fall`, `extras` and `validate` are public; `Path` is that of `pathlib`.
"""

RETURN = re.compile(r"(Give|Gives|Say|Says|Tell|Tells)\b|Names? (the|what|which|where|every|all|everything|how)\b")
"""First words of a docstring for "return"."""


def names_of(path: Path) -> dict[str, int]:
    """Return all names in a file, with the first line of each."""
    with path.open(encoding="utf-8") as lines:
        tokens = [token for token in tokenize.generate_tokens(lines.readline) if token.type == tokenize.NAME]
    return {token.string: token.start[0] for token in reversed(tokens)} | {path.stem: 0, path.parent.name: 0}


def docstrings_of(path: Path) -> list[tuple[int, str]]:
    """Return the docstrings of a file's functions and classes, with their lines."""
    documented = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    nodes = [node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, documented)]
    return [(node.lineno, text) for node in nodes if (text := ast.get_docstring(node)) is not None]


def identify(path: Path) -> str:
    return path.relative_to(SOURCE).as_posix()


@pytest.mark.parametrize("path", FILES, ids=identify)
def test_no_private_name_is_left(path: Path) -> None:
    found = names_of(path)
    assert {name: found[name] for name in PRIVATE_NAMES & found.keys()} == {}


@pytest.mark.parametrize("path", FILES, ids=identify)
def test_docstrings_say_return(path: Path) -> None:
    assert [(line, text.splitlines()[0]) for line, text in docstrings_of(path) if RETURN.match(text)] == []


@pytest.mark.parametrize(
    ("text", "matches"),
    [
        ("Give the covariance.", True),
        ("Say whether it converged.", True),
        ("Tell channels from drops.", True),
        ("Name the channels of a logger.", True),
        ("Return the covariance.", False),
        ("Names by axle.", False),
        ("Name of the channel.", False),
        ("Given data.", False),
    ],
)
def test_first_words(text: str, matches: bool) -> None:
    assert bool(RETURN.match(text)) == matches

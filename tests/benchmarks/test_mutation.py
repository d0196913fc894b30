"""Mutants of formulas: what is made wrong, and that it is still Python."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from mutation import draw_mutants, mutants_of


def test_operators_signs_and_constants_are_made_wrong(tmp_path: Path) -> None:
    path = tmp_path / "formula.py"
    path.write_text("LIMIT = 2 * 3\n\n\ndef force(k, x):\n    # µ - ½\n    return -k * x + 1.5 / x\n", encoding="utf-8")
    texts = [mutant.text.splitlines() for mutant in mutants_of(path)]
    assert sorted(lines[5].strip() for lines in texts) == sorted(
        [
            "return  k * x + 1.5 / x",
            "return -k / x + 1.5 / x",
            "return -k * x - 1.5 / x",
            "return -k * x + 1.5 * x",
            "return -k * x + 2.5 / x",
        ]
    )
    assert all(lines[:5] == texts[0][:5] for lines in texts)


def test_text_and_sequences_are_no_formulas(tmp_path: Path) -> None:
    path = tmp_path / "words.py"
    path.write_text("def words(a):\n    return [1] + a, (1, 2) + a, f'{a}' + a\n", encoding="utf-8")
    assert list(mutants_of(path)) == []


@pytest.mark.slow
def test_drawn_mutants_differ_and_can_be_read() -> None:
    drawn = draw_mutants(50, seed=0)
    assert len({(mutant.path, mutant.begin, mutant.replacement) for mutant in drawn}) == 50
    assert {mutant.path.parent.name for mutant in drawn} == {"vehicle", "estimation"}
    for mutant in drawn:
        before, after = ast.parse(mutant.path.read_text(encoding="utf-8")), ast.parse(mutant.text)
        assert ast.dump(before) != ast.dump(after)

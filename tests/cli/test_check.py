"""`sprung check` and `sprung schema` as they are called."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

import sprung
from command_line import DROPS, Folder, copy_sedan, run


@pytest.fixture
def one(tmp_path: Path) -> Folder:
    """One drop, which is enough to look at."""
    return copy_sedan(tmp_path / "one", DROPS[2:3])


def test_the_table_fits_a_terminal_and_says_everything(one: Folder) -> None:
    said = run("check", one.path, "--no-drawings")
    assert (said.status, said.err) == (0, "")
    assert max(map(len, said.out.splitlines())) <= 80
    [drop] = run("check", one.path, "--no-drawings", "--json").json["drops"]
    row = next(line for line in said.out.splitlines() if line.startswith("empty_roll_left.csv"))
    assert "roll left" in row
    for moment in ("release", "landing", "last_lift_off", "start", "end"):
        assert ("-" if drop[moment] is None else f"{drop[moment]:.3f}") in row.split()
    for words in (drop["why_start"], drop["why_end"], "500 samples per second"):
        assert words in said.out
    for channel in drop["channels"]:
        line = next(line for line in said.out.splitlines() if line.startswith(channel["name"]))
        assert f"{channel['noise']:#.2g}" in line.split()


def test_drawings_are_beside_the_campaign_unless_told(one: Folder, tmp_path: Path) -> None:
    before = one.listing()
    assert run("check", one.path, "--no-drawings", "--json").json["drawings"] == []
    assert one.listing() == before
    said = run("check", one.path, "--json")
    beside = one.path / "check" / "empty_roll_left.svg"
    assert said.json["drawings"] == [str(beside)]
    assert beside.read_text(encoding="utf-8").startswith("<?xml")
    text = run("check", one.path, "-o", tmp_path / "else" / "where")
    assert f"Drawn: 1 drop in {tmp_path / 'else' / 'where'}" in " ".join(text.out.split())
    assert (tmp_path / "else" / "where" / "empty_roll_left.svg").read_bytes() == beside.read_bytes()


def test_a_folder_that_cannot_be_written_costs_the_drawings_only(one: Folder) -> None:
    (one.path / "check").write_text("in the way")
    said = run("check", one.path, "--json")
    assert said.status == 0
    assert said.json["drawings"] == []
    assert said.json["drops"][0]["start"] is not None
    [line] = said.err.splitlines()
    assert line.startswith("No drawings: ")
    assert "a file where the folder should be" in line
    assert (one.path / "check").read_text() == "in the way"


def test_wheels_that_fell_otherwise_than_stated(one: Folder) -> None:
    one.edit('wheels = ["fl", "rl"]', 'wheels = ["fr", "rr"]')
    said = run("check", one.path, "--no-drawings")
    assert "fr, rr stated to be dropped; the release shows fl, rl to have fallen" in " ".join(said.out.split())
    [drop] = run("check", one.path, "--no-drawings", "--json").json["drops"]
    assert (drop["kind"], drop["wheels"], drop["wheels_seen"]) == ("roll right", ["fr", "rr"], ["fl", "rl"])


def test_what_cannot_be_used_is_not_drawn(one: Folder) -> None:
    one.lines(lambda lines: lines[:60], "empty_roll_left.csv")
    before = one.listing()
    said = run("check", one.path)
    assert (said.status, said.out) == (2, "")
    assert one.listing() == before


@pytest.mark.parametrize("arguments", [(), ("--json",)])
def test_schema(arguments: tuple[str, ...]) -> None:
    said = run("schema", *arguments)
    assert (said.status, said.err) == (0, "")
    assert said.out == sprung.schema_text()
    Draft202012Validator.check_schema(json.loads(said.out))

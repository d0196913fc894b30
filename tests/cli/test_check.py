"""`sprung check` and `sprung schema` as they are called."""

from __future__ import annotations

import json
import re
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
    said = run("check", one.path, "--no-page")
    assert (said.status, said.err) == (0, "")
    assert max(map(len, said.out.splitlines())) <= 80
    [drop] = run("check", one.path, "--no-page", "--json").json["drops"]
    row = next(line for line in said.out.splitlines() if line.startswith("empty_roll_left.csv"))
    assert "roll left" in row
    for moment in ("release", "landing", "last_lift_off", "start", "end"):
        assert ("-" if drop[moment] is None else f"{drop[moment]:.3f}") in row.split()
    for words in (drop["why_start"], drop["why_end"], "sampling rate 500 Hz"):
        assert words in said.out
    for channel in drop["channels"]:
        line = next(line for line in said.out.splitlines() if line.startswith(channel["name"]))
        assert f"{channel['noise']:#.2g}" in line.split()


def test_one_page_is_beside_the_campaign_unless_told(one: Folder, tmp_path: Path) -> None:
    before = one.listing()
    said = run("check", one.path, "--no-page", "--json").json
    assert (said["page"], said["drawings"]) == (None, [])
    assert one.listing() == before
    said = run("check", one.path, "--json").json
    beside = one.path / "check" / "check.html"
    assert (said["page"], said["drawings"]) == (str(beside), [])
    assert beside.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    text = run("check", one.path, "-o", tmp_path / "else" / "where")
    assert f"Report: {tmp_path / 'else' / 'where' / 'check.html'}" in text.out.splitlines()
    assert (tmp_path / "else" / "where" / "check.html").read_bytes() == beside.read_bytes()


def test_the_page_is_named_as_it_was_given(one: Folder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert f"Report: {Path('there') / 'check.html'}" in run("check", one.path, "-o", "there").out.splitlines()
    said = run("check", one.path, "-o", "there", "--force", "--json").json
    assert said["page"] == str(tmp_path.resolve() / "there" / "check.html")


def test_drawings_are_files_on_wish(one: Folder) -> None:
    said = run("check", one.path, "--drawings", "--json").json
    assert said["drawings"] == [str(one.path / "check" / "empty_roll_left.svg")]
    assert Path(said["drawings"][0]).read_text(encoding="utf-8").startswith("<?xml")
    assert Path(said["page"]).exists()


def test_a_folder_that_cannot_be_written_costs_the_page_only(one: Folder) -> None:
    (one.path / "check").write_text("in the way")
    said = run("check", one.path, "--json")
    assert said.status == 0
    assert (said.json["page"], said.json["drawings"]) == (None, [])
    assert said.json["drops"][0]["start"] is not None
    assert "a file where the folder should be" in said.err
    assert (one.path / "check").read_text() == "in the way"


def last_line(out: str) -> str:
    """The last paragraph, unwrapped."""
    return " ".join(out.rstrip().rsplit("\n\n", 1)[-1].split())


def test_the_last_line_counts(one: Folder) -> None:
    assert last_line(run("check", one.path, "--no-page").out) == "1 of 1 drop usable"


def test_without_geometry_every_recording_is_judged(one: Folder) -> None:
    """Neither wheelbase, nor sensor positions, nor places of loads: as it is beside the car."""
    whole = run("check", one.path, "--no-page", "--json").json
    file = one.path / "campaign.toml"
    text = re.sub(r"(?m)^(wheelbase|position) .*$\n", "", file.read_text())
    text = re.sub(r"(?ms)^items .*?\]$\n", "", text)
    assert "position" not in text.split("[[load]]")[0]
    file.write_text(text)
    said = run("check", one.path, "--no-page")
    assert said.status == 0
    assert last_line(said.out) == "1 of 1 drop usable; missing: sensor positions, load items, wheelbase"
    said = run("check", one.path, "--no-page", "--json").json
    assert [entry["item"] for entry in said["missing"]] == [*["sensor positions"] * 4, "load items", "wheelbase"]
    assert [entry["needed"] for entry in said["missing"]] == [True] * 5 + [False]
    [drop], [before] = said["drops"], whole["drops"]
    assert (drop["release"], drop["wheels_seen"]) == (before["release"], before["wheels_seen"])
    assert drop["start"] >= before["start"]  # a landing that nothing shows is waited for
    assert [channel["noise"] for channel in drop["channels"]] == [channel["noise"] for channel in before["channels"]]
    refused = run("identify", one.path)
    assert refused.status == 2
    assert refused.err.count("needs its position") == 4
    assert "A load needs items" in refused.err


def test_a_draft_with_its_gaps_open_is_judged(one: Folder) -> None:
    (one.path / "campaign.toml").unlink()
    bare = run("check", one.path, "--no-page", "--json").json
    assert one.listing() == ["empty_roll_left.csv"]  # nothing is drafted into the user's folder
    assert run("new", one.path).status == 0
    said = run("check", one.path, "--no-page", "--json").json
    assert said["drops"] == bare["drops"]
    assert said["missing"] == bare["missing"]
    assert [drop["wheels"] for drop in said["drops"]] == [["fl", "rl"]]
    items = list(dict.fromkeys(entry["item"] for entry in said["missing"]))
    assert {"wheelbase", "total mass", "sensor positions"} <= set(items)
    usable = last_line(run("check", one.path, "--no-page").out)
    assert usable == f"1 of 1 drop usable; missing: {', '.join(items)}"


def test_what_is_not_known_of_a_drop_is_not_invented(one: Folder) -> None:
    one.edit('wheels = ["fl", "rl"]', 'wheels = "TODO: those that were dropped"')
    one.edit('load = "empty"', 'load = "TODO: which"')
    one.edit('on = "fl"', 'on = "TODO: fl, fr, rl or rr"')
    [drop] = run("check", one.path, "--no-page", "--json").json["drops"]
    assert (drop["load"], drop["wheels"], drop["kind"]) == (
        "",
        [],
        "rl",
    )  # the wheel at the front is not known by its station
    assert [channel["on"] for channel in drop["channels"]].count(None) == 1
    assert drop["faults"] == []
    assert drop["start"] is not None
    said = last_line(run("check", one.path, "--no-page").out)
    assert said == "1 of 1 drop usable; missing: wheel stations of sensors, loads of drops, dropped wheels"


def test_a_recording_that_cannot_be_read_costs_its_drop_only(tmp_path: Path) -> None:
    folder = copy_sedan(tmp_path / "two", DROPS[:2])
    (folder.path / "empty_bounce.csv").write_text("no\nrecording\n")
    said = run("check", folder.path, "--no-page")
    assert said.status == 0
    assert last_line(said.out) == "1 of 2 drops usable"
    [good, lost] = run("check", folder.path, "--no-page", "--json").json["drops"]
    assert (good["file"], lost["file"], lost["faults"]) == ("empty_pitch_front.csv", "empty_bounce.csv", ["unreadable"])
    assert "found a single column, 'no', expected the time and at least one channel" in " ".join(said.out.split())
    assert run("identify", folder.path).status == 2


def test_wheels_that_fell_otherwise_than_stated(one: Folder) -> None:
    one.edit('wheels = ["fl", "rl"]', 'wheels = ["fr", "rr"]')
    said = run("check", one.path, "--no-page")
    assert "stated fr, rr, detected fl, rl" in " ".join(said.out.split())
    [drop] = run("check", one.path, "--no-page", "--json").json["drops"]
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

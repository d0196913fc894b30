"""`sprung ride`: tables and documents of stored results, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from command_line import run

RESULTS = Path(__file__).resolve().parents[1] / "report"


def test_tables_of_a_result() -> None:
    said = run("ride", RESULTS / "accept.json", "--road", "A", "--road", "c", "--speed", "60", columns=200)
    assert (said.status, said.err) == (0, "")
    for words in ("damping ratio", "EUSAMA, %", "EGEA, °", "ISO 2631-1", "A, 60 km/h", "C, 60 km/h", "Half cars", "±"):
        assert words in said.out
    assert "D, 60 km/h" not in said.out


@pytest.mark.parametrize("columns", [40, 80, 200])
@pytest.mark.slow
def test_no_width_cuts_a_number(columns: int) -> None:
    wide, narrow = (run("ride", RESULTS / "accept.json", "--road", "C", columns=one) for one in (400, columns))
    assert {word for word in wide.out.split() if "." in word and word[0].isdigit()} <= set(narrow.out.split())
    assert max(map(len, narrow.out.splitlines())) <= max(columns, 40)


def test_document_of_a_result() -> None:
    said = run("ride", RESULTS / "accept.json", "--seat", "-1.4,0.4", "--seat", "-2.2,0", "--hours", "8", "--json")
    assert said.status == 0
    assert [one["road"] for one in said.json["roads"]] == list("ABCDE")
    assert said.json["options"]["speeds"] == pytest.approx([80 / 3.6])
    assert said.json["options"]["duration"] == 8 * 3600
    assert list(said.json["roads"][0]["places"]) == ["seat 1", "seat 2"]
    for axle in said.json["axles"].values():
        low, high = axle["body_damping"]["interval95"]
        assert low < axle["body_damping"]["value"] < high


def test_of_a_rejected_result_there_is_nothing() -> None:
    said = run("ride", RESULTS / "reject.json")
    assert (said.status, said.out) == (3, "")
    assert "rejected" in said.err
    assert "\n  - the model does not explain the records" in said.err
    document = run("ride", RESULTS / "reject.json", "--json")
    assert document.status == 3
    assert document.json["verdict"]["state"] == "reject"
    assert document.json.keys() == {"vehicle", "verdict"}


def test_without_scale_and_roll_there_is_what_needs_neither() -> None:
    said = run("ride", RESULTS / "unidentifiable.json", "--road", "C", "--json")
    assert said.status == 0
    front = said.json["axles"]["front"]
    assert front["m_s"]["value"] is None
    assert 0.9 < front["body_frequency"]["value"] < 1.2
    assert said.json["options"]["tracks"] == "same"
    assert said.json["roads"][0]["places"]["front"]["weighted"]["value"] > 0
    assert said.json["plates"]["fl"]["least_load"]["value"] is None
    text = run("ride", RESULTS / "unidentifiable.json", "--road", "C", columns=200).out
    assert "nan" not in text.split()
    assert "EUSAMA, %" not in text
    assert "What depends on roll has no value" in text


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--road", "Z"), "a class of ISO 8608"),
        (("--speed", "2000"), "found 2000 km/h (555.556 m/s); expected 1.8 to 540 km/h (0.5 to 150 m/s)"),
        (("--seat", "here"), "such as -1.4,0.4"),
        (("--seat", "-1,0,0.5"), "cg_height in the campaign"),
        (("--load", "trailer"), "ride numbers: load"),
        (("--tracks", "left"), "isotropic, same, independent"),
    ],
)
def test_impossible_options_are_bad_input(options: tuple[str, ...], message: str) -> None:
    said = run("ride", RESULTS / "accept.json", *options)
    assert (said.status, said.out) == (2, "")
    assert message in said.err
    assert "Traceback" not in said.err


def test_missing_results_are_bad_input(tmp_path: Path) -> None:
    said = run("ride", tmp_path)
    assert said.status == 2
    assert "results.json" in said.err

"""Every format from a result: options, loads, sensors, verdicts, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import sprung
from sprung import export
from sprung.errors import InputError
from sprung.export import ExportOptions, commonroad_parameters, mujoco_model
from sprung.export.requests import TERM_NAMES
from sprung.results import Result
from sprung.vehicle import EXTRAS

SAVED = Path(__file__).resolve().parents[1] / "report"


@pytest.fixture(scope="module")
def result() -> Result:
    return sprung.load(SAVED / "accept.json", series=False)


@pytest.mark.parametrize("to", export.FORMATS)
def test_every_format_is_written(to: str, result: Result, tmp_path: Path) -> None:
    options = ExportOptions(approximate=True) if to == "commonroad" else ExportOptions()
    file = export.export(result, to, options)
    assert file.content
    path = file.save(tmp_path)
    assert path == tmp_path / file.name
    assert path.read_bytes() == file.content
    assert not [note for note in file.notes if "doubtful" in note]


def test_a_load_and_the_sensors_of_the_test_are_in_it(result: Result) -> None:
    load = result.setup.loads[-1]
    text = export.export(result, "modelica", ExportOptions(load=load.name)).text
    assert text == export.modelica(result.vehicle, load, sensors=result.setup.sensors).text
    assert text != export.export(result, "modelica").text
    assert all(f"sensor_{sensor.channel}" in text for sensor in result.setup.sensors)
    assert export.export(result, "modelica", ExportOptions(load="empty")).text == export.export(result, "modelica").text


def test_all_that_is_wrong_is_said_at_once(result: Result) -> None:
    options = ExportOptions(load="balast", amplitude=0.01, number=5)
    with pytest.raises(InputError) as caught:
        export.export(result, "modelica", options)
    assert [problem.found for problem in caught.value.problems] == [
        "the option amplitude",
        "the option number",
        "the load 'balast'",
    ]
    assert "state-space" in caught.value.problems[0].do
    assert "ballast" in caught.value.problems[2].do


def test_an_unknown_format_has_a_neighbour(result: Result) -> None:
    with pytest.raises(InputError, match="Did you mean 'modelica'"):
        export.export(result, "modelika")


def test_a_doubtful_result_is_exported_with_its_reasons() -> None:
    doubtful = sprung.load(SAVED / "doubtful.json", series=False)
    for to in ("state-space", "mjcf", "draws", "latex"):
        note = export.export(doubtful, to).notes[-1]
        assert note.startswith("The result is doubtful: ")
        assert all(reason in note for reason in doubtful.verdict.reasons)


@pytest.mark.parametrize("state", ["reject", "unidentifiable"])
@pytest.mark.parametrize("to", [to for to in export.FORMATS if to not in ("markdown", "latex")])
def test_without_a_vehicle_nothing_is_exported(state: str, to: str) -> None:
    with pytest.raises(InputError) as caught:
        export.export(sprung.load(SAVED / f"{state}.json", series=False), to, ExportOptions(load="nothing such"))
    words = {"reject": "the verdict reject", "unidentifiable": "no value of m_s"}
    assert any(words[state] in problem.found for problem in caught.value.problems)
    assert len(caught.value.problems) > 1


def test_a_rejected_result_has_tables_without_estimates() -> None:
    rejected = sprung.load(SAVED / "reject.json", series=False)
    file = export.export(rejected, "markdown")
    assert "rejected" in file.notes[0]
    assert "| m\\_s | - | - | - |" in file.text


def test_files_of_others_are_kept(result: Result, tmp_path: Path) -> None:
    file = export.markdown(result)
    target = tmp_path / "mine.md"
    target.write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match=r"mine\.md"):
        file.save(target)
    assert target.read_text(encoding="utf-8") == "mine"
    file.save(target, overwrite=True)
    file.save(target)  # our own now
    assert target.read_text(encoding="utf-8") == file.text


def test_notes_are_added(result: Result) -> None:
    file = export.markdown(result).with_notes("One.", "Two.")
    assert file.notes == ("One.", "Two.")
    assert replace(file, notes=()) == export.markdown(result)


def test_every_term_has_words() -> None:
    assert TERM_NAMES.keys() == {*EXTRAS}


def test_every_term_is_held_by_a_format_or_said_to_be_lacking() -> None:
    """A new term joins what the format holds, here, or what stands for it, there."""
    in_mjcf = {
        *("anti-roll", "tyre-damping", "gravity", "asymmetry", "rigid-axle", "engine", "occupants", "seat-load"),
        *("rebound", "damper-curve", "rebound-knee", "second-knee", "third-knee", "progressive", "bump-stop"),
    }
    assert {*EXTRAS} - commonroad_parameters._LACKING.keys() == {"anti-roll"}
    assert {*EXTRAS} - mujoco_model._LACKING.keys() == in_mjcf

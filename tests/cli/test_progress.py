"""Long work says what it is doing, step by step."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import pytest
from car import CAR

import sprung
from command_line import Folder, run
from sprung.cli.output import StatusLine
from sprung.progress import Step, counted


def test_a_step_is_a_sentence_with_numbers() -> None:
    step = Step("reading the recordings", 3, 10, "empty_bounce.csv")
    assert step == "reading the recordings, 3 of 10: empty_bounce.csv"
    assert (step.stage, step.step, step.of, step.done) == ("reading the recordings", 3, 10, 0.2)
    again = pickle.loads(pickle.dumps(step))  # noqa: S301 (our own)
    assert (again, again.stage, again.step, again.of, again.done) == (step, step.stage, 3, 10, 0.2)
    with pytest.raises(AttributeError, match="cannot be set"):
        step.step = 4
    assert Step("judging the fit").done is None


def test_counted_tells_before_each_item() -> None:
    told: list[str] = []
    for name in counted(told.append, "reading", ("a", "b")):
        told.append(f"done {name}")
    assert told == ["reading, 1 of 2: a", "done a", "reading, 2 of 2: b", "done b"]


def test_reading_and_checking_name_every_recording_and_stage(folder: Folder) -> None:
    steps: list[Step] = []
    campaign = sprung.read(folder.path, progress=steps.append)
    sprung.check(campaign, progress=steps.append)
    stages: dict[str, list[Step]] = {}
    for step in steps:
        stages.setdefault(step.stage, []).append(step)
    assert list(stages) == [
        "reading the recordings",
        "checking the clocks and units of the recordings",
        "looking for spikes in the recordings",
        "looking for wrong signs, units and saturation in the recordings",
        "removing drift from the recordings",
        "finding the decays",
    ]
    assert [(one.step, one.of) for one in stages["reading the recordings"]] == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert [(one.step, one.of) for one in stages["finding the decays"]] == [(1, 4), (2, 4), (3, 4), (4, 4)]


def test_simulating_and_modes_name_their_steps(tmp_path: Path) -> None:
    (tmp_path / "car.toml").write_text(CAR)
    steps: list[Step] = []
    campaign = sprung.simulate(tmp_path / "car.toml", seed=1, progress=steps.append)
    assert [step.step for step in steps] == [1, 2, 3, 4, 5]
    steps.clear()
    sprung.modes(campaign, method="era", progress=steps.append)
    assert steps[-1] == "identifying the modes of load empty"


def test_the_status_line_shows_elapsed_time_and_an_estimate_where_there_is_one() -> None:
    now = [0.0]
    line = StatusLine(Step("reading the recordings"), lambda: now[0])
    assert line.text() == "0:00 reading the recordings"
    line.show_step(Step("reading the recordings", 1, 4, "a.csv"))
    now[0] = 30.0
    assert line.text() == "0:30 reading the recordings, 1 of 4: a.csv"
    line.show_step(Step("reading the recordings", 2, 4, "b.csv"))
    # A quarter took 30 s: three more such are 90 s.
    assert line.text() == "0:30 (about 1:30 more) reading the recordings, 2 of 4: b.csv"
    now[0] = 65.0
    line.show_step(Step("judging the fit"))
    assert line.text() == "1:05 judging the fit"


def test_steps_for_programs_are_lines_of_json_on_standard_error(folder: Folder) -> None:
    said = run("check", folder.path, "--no-page", "--json", SPRUNG_PROGRESS="json")
    assert said.status == 0
    steps = [json.loads(line)["progress"] for line in said.err.splitlines()]
    assert steps[0]["text"] == "reading the recordings"
    first = steps[1]
    assert (first["stage"], first["step"], first["of"], first["done"]) == ("reading the recordings", 1, 4, 0.0)
    assert first["text"].startswith("reading the recordings, 1 of 4: ")
    assert said.json["drops"]
    assert run("check", folder.path, "--no-page", "--json").err == ""

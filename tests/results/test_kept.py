"""What a result keeps for its pictures: recordings, the body's motions, shapes, what it began with; and its way to disk."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sprung
from sprung.assessment import Verdict
from sprung.campaign import Campaign
from sprung.errors import ResultFileError
from sprung.report import report_html
from sprung.results import Result, TraceStep
from sprung.vehicle import TABLE_1_CAR
from sprung.vibration import compute_modes, modal_assurance_criterion


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    """Three drops of the Table 1 car: the second with a spike, the third so short that it is left out."""
    drops = [{"wheels": wheels, "load": "empty"} for wheels in (["fl", "fr", "rl", "rr"], ["rl", "rr"], ["fl", "rl"])]
    known = {"total_mass": TABLE_1_CAR.total_mass}
    made = sprung.simulate(TABLE_1_CAR, drops=drops, noise=0.02, seed=1, known=known)
    first, second, third = made.recordings
    spiked = second.values.copy()
    spiked[5, 900] = 300.0
    short = replace(third, values=third.values[:, :300])
    return made.with_recordings((first, replace(second, values=spiked), short))


@pytest.fixture(scope="module")
def result(campaign: Campaign) -> Result:
    return sprung.identify(campaign, extras=(), amplitude=True)


@pytest.fixture
def folder(result: Result, tmp_path: Path) -> Path:
    return result.save(tmp_path / "results")


def test_shapes_are_those_of_the_vehicle(result: Result) -> None:
    truth = {mode.name: mode.shape for mode in compute_modes(TABLE_1_CAR.matrices())}
    for mode in result.modes["empty"][:2]:  # bounce and pitch, which these drops tell
        shape = np.array([complex(*part) for part in mode.motion])
        assert shape.size == 7
        assert np.abs(shape).max() == pytest.approx(1)
        assert shape[np.argmax(np.abs(shape))] == pytest.approx(1)  # in phase with what moves most
        # Two drops tell where the centre of gravity is to 4 % only: the parts of bounce and pitch are that sure.
        assert float(modal_assurance_criterion(shape[:, None], truth[mode.name][:, None])[0, 0]) > 1 - 0.1**2


def test_whole_recordings_are_kept_also_of_what_was_left_out(campaign: Campaign, result: Result) -> None:
    names = [drop.name for drop in result.drops]
    assert list(result.recordings) == names
    assert names[2] not in result.series
    for name, recording in zip(names, campaign.recordings, strict=True):
        kept = result.recordings[name]
        assert kept.values.shape == recording.values.shape
        np.testing.assert_allclose(kept.time, recording.time)
    [mark] = result.recordings[names[1]].marks
    assert (mark.code, mark.channel, mark.samples.tolist()) == ("spike", 5, [900])
    np.testing.assert_array_equal(result.recordings[names[0]].values, campaign.recordings[0].values.astype(np.float32))


def test_what_was_known_is_held_against_what_was_found(result: Result) -> None:
    mass = result.setup.known["total_mass"]
    assert (mass.value, mass.std, mass.unit, mass.found.status) == (TABLE_1_CAR.total_mass, 0.0, "kg", "known")
    assert result.setup.options == {"tracks": "left open", "extras": "none", "fall": "left open", "profile": "none"}
    assert set(result.setup.software) == {"sprung", "Python", "numpy", "scipy"}
    assert [sensor.channel for sensor in result.setup.sensors] == [one.name for one in result.drops[0].channels]


def test_everything_comes_back_from_the_folder(result: Result, folder: Path) -> None:
    loaded = sprung.load(folder)
    assert loaded.to_json() == result.to_json()
    for name, series in result.series.items():
        for part in ("time", "measured", "fitted", "body_measured", "body_simulated"):
            np.testing.assert_array_equal(getattr(loaded.series[name], part), getattr(series, part))
    for name, kept in result.recordings.items():
        found = loaded.recordings[name]
        np.testing.assert_array_equal(found.values, kept.values)
        assert (found.start, found.rate) == (kept.start, kept.rate)
        assert [(mark.code, mark.channel, mark.samples.tolist()) for mark in found.marks] == [
            (mark.code, mark.channel, mark.samples.tolist()) for mark in kept.marks
        ]
    assert report_html(loaded) == report_html(result)


@pytest.mark.slow
def test_amplitudes_are_what_a_validation_shows(campaign: Campaign, result: Result) -> None:
    document = json.loads(result.to_json())["amplitude"]
    assert document == sprung.validate(campaign, extras=()).document()["amplitude"]
    assert all(one["load"] == "empty" for one in document.values())


STEPS = (
    TraceStep("select_terms", "friction accepted", "Δ2lnL = 812, required 21"),
    TraceStep("isolate_faults", "gain of wheel_fl <not> corrected", "z = 1.2, required 4.1"),
)


def test_the_trace_is_saved_loaded_and_shown(result: Result, tmp_path: Path) -> None:
    traced = replace(result, trace=STEPS)
    document = json.loads(traced.to_json())
    assert document["trace"][0] == {"stage": "select_terms", "what": STEPS[0].what, "why": STEPS[0].why}
    assert sprung.load(traced.save(tmp_path / "traced")).trace == STEPS
    for shown in (report_html(traced), traced._repr_html_()):
        assert shown.count("How the result was reached") >= 1
        assert "&lt;not&gt; corrected" in shown
        assert "Δ2lnL = 812, required 21" in shown
    untraced = replace(result, trace=())
    assert "How the result was reached" not in report_html(untraced) + untraced._repr_html_()


def test_the_trace_of_a_rejected_result_is_shown(result: Result) -> None:
    rejected = replace(result, trace=STEPS, verdict=Verdict("reject", ("the model does not hold",)))
    assert "friction accepted" in rejected._repr_html_()
    assert "friction accepted" in report_html(rejected)


@pytest.mark.parametrize("spoilt", [{"body bounce": {}}, {"body bounce": 1}, [1], "curves"])
def test_curves_that_are_none_are_refused(folder: Path, spoilt: object) -> None:
    path = folder / "results.json"
    document = json.loads(path.read_text(encoding="utf-8"))
    del document["checksums"]
    path.write_text(json.dumps(document | {"amplitude": spoilt}), encoding="utf-8")
    with pytest.raises(ResultFileError, match="amplitude"):
        sprung.load(folder)

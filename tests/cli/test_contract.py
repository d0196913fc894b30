"""What the contract promises to programs: commands, documents, exit statuses, files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sprung
from command_line import SEDAN, Folder, Identified, Run, run
from sprung.files.ownership import MANIFEST

COMMANDS = (
    "demo",
    "paper",
    "check",
    "modal",
    "identify",
    "report",
    "validate",
    "compare",
    "ride",
    "app",
    "plan",
    "simulate",
    "schema",
)
# The contract's results.json.
KEYS = {
    "schema",
    "sprung",
    "vehicle",
    "verdict",
    "parameters",
    "scale",
    "unidentifiable",
    "correlation",
    "modes",
    "fit",
    "drops",
    "faults",
    "trace",
}
UNITS = {"kg", "kg m^2", "N/m", "N s/m", "N", "m", "1"}
SEVEN_DEGREES_OF_FREEDOM = {
    "m_s",
    "I_yy",
    "I_xx",
    "m_uf",
    "m_ur",
    "k_sf",
    "k_sr",
    "k_tf",
    "k_tr",
    "c_sf",
    "c_sr",
    "a",
    "b",
}


@pytest.fixture(params=["sedan", pytest.param("leafbus", marks=pytest.mark.slow), "one_drop"])
def any_campaign(request: pytest.FixtureRequest) -> Identified:
    made = request.getfixturevalue(request.param)
    assert isinstance(made, Identified)
    return made


@pytest.mark.parametrize("command", COMMANDS)
def test_help_with_an_example(command: str) -> None:
    for flag in ("--help", "-h"):
        said = run(command, flag)
        assert said.status == 0
        assert f"Example: sprung {command}" in said.out
        assert "--json" in said.out
        assert ", ," not in said.out  # brackets taken for colours once made "[vehicle], [parameters]" disappear


def test_help_names_every_command() -> None:
    said = run("--help")
    assert said.status == 0
    assert all(command in said.out for command in COMMANDS)


def test_version() -> None:
    assert run("--version") == Run(0, f"sprung {sprung.__version__}\n", "")


@pytest.mark.slow
def test_statuses(sedan: Identified, leafbus: Identified, one_drop: Identified) -> None:
    assert (sedan.text.status, sedan.json.status, sedan.json.json["verdict"]["state"]) == (0, 0, "accept")
    assert (leafbus.text.status, leafbus.json.status, leafbus.json.json["verdict"]["state"]) == (3, 3, "reject")
    assert (one_drop.text.status, one_drop.json.status, one_drop.json.json["verdict"]["state"]) == (0, 0, "doubtful")


def test_what_is_printed_is_what_is_written(any_campaign: Identified) -> None:
    written = (any_campaign.results / "again" / "results.json").read_text(encoding="utf-8")
    assert any_campaign.json.out == written
    assert json.loads(written) == any_campaign.json.json
    assert any_campaign.json.err == any_campaign.text.err == ""  # nobody watches, so there is no progress to show


def test_results_json(any_campaign: Identified) -> None:
    document = any_campaign.json.json
    assert document.keys() >= KEYS
    assert (document["schema"], document["sprung"]) == (1, sprung.__version__)
    assert set(document["vehicle"]) >= {"name"}
    assert document["verdict"]["state"] in {"accept", "doubtful", "reject"}
    assert document["verdict"]["reasons"]
    assert all(isinstance(reason, str) for reason in document["verdict"]["reasons"])
    assert document["parameters"].keys() >= SEVEN_DEGREES_OF_FREEDOM
    for estimate in document["parameters"].values():
        check_parameter(estimate)
    for ratio in document["scale"]["per_total_mass"].values():
        assert ratio.keys() == {"value", "std", "unit"}
    estimated = [name for name, found in document["parameters"].items() if found["status"] == "estimated"]
    assert set(document["correlation"]["names"]) <= set(estimated)
    matrix = np.array(document["correlation"]["matrix"])
    assert matrix.size == len(document["correlation"]["names"]) ** 2
    if matrix.size:
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-12)
        np.testing.assert_allclose(np.diag(matrix), 1, atol=1e-9)
    for modes in document["modes"].values():
        for mode in modes:
            check_mode(mode)
    assert document["fit"].keys() >= {"samples", "drops", "noise", "model", "method"}
    for drop in document["drops"]:
        assert drop.keys() >= {"file", "load", "start", "end", "faults"}
        assert 0 <= drop["start"] < drop["end"]
    for fault in document["faults"]:
        assert fault.keys() == {"code", "where", "what", "do"}
    for step in document["trace"]:
        assert step.keys() == {"stage", "what", "why"}


def check_parameter(estimate: dict[str, Any]) -> None:
    assert estimate.keys() == {"value", "std", "interval95", "unit", "status", "interval_from"}
    assert estimate["unit"] in UNITS
    match estimate["status"]:
        case "estimated":
            low, high = estimate["interval95"]
            assert low < estimate["value"] < high
            assert estimate["std"] > 0
        case "known":
            assert estimate["std"] == 0
            assert estimate["interval95"] == [estimate["value"], estimate["value"]]
        case "unidentifiable":
            assert estimate["value"] is estimate["std"] is estimate["interval95"] is None
        case other:
            pytest.fail(f"status {other}")


def check_mode(mode: dict[str, Any]) -> None:
    assert mode.keys() >= {
        "name",
        "pole",
        "frequency",
        "frequency_std",
        "damped_frequency",
        "damping_ratio",
        "damping_ratio_std",
    }
    pole = complex(*mode["pole"])
    assert pole.imag >= 0
    assert mode["frequency"] == pytest.approx(abs(pole) / (2 * np.pi))
    assert mode["damped_frequency"] == pytest.approx(pole.imag / (2 * np.pi))
    assert mode["damping_ratio"] == pytest.approx(-pole.real / abs(pole))


def test_a_determined_campaign_says_so(sedan: Identified) -> None:
    document = sedan.json.json
    assert document["scale"]["known"]
    assert document["unidentifiable"] == []
    assert list(document["modes"]) == ["empty", "ballast"]
    # Made from the Table 1 car: the front springs are 17000 N/m each.
    spring = document["parameters"]["k_sf"]
    assert abs(spring["value"] - 17000) < 5 * spring["std"] < 500


@pytest.mark.slow
def test_what_was_known_stays_as_given(leafbus: Identified) -> None:
    parameters = leafbus.json.json["parameters"]
    assert {name: parameters[name]["value"] for name in ("a", "b")} == {"a": 2.22, "b": 1.73}
    assert parameters["a"]["status"] == "known"


def test_one_drop_says_what_it_cannot_tell(one_drop: Identified) -> None:
    document = one_drop.json.json
    silent = {name for name, found in document["parameters"].items() if found["status"] == "unidentifiable"}
    assert {"m_s", "k_sf", "I_xx"} <= silent  # nothing tells the scale, and a bounce does not roll
    assert not document["scale"]["known"]
    named = {name for entry in document["unidentifiable"] for name in entry["parameters"]}
    assert silent <= named
    assert all(entry["text"] for entry in document["unidentifiable"])
    for name in silent:
        line = next(line for line in one_drop.text.out.splitlines() if line.split()[:1] == [name])
        assert line.split()[-1] == "unidentifiable"


def test_series(sedan: Identified) -> None:
    document = sedan.json.json
    with np.load(sedan.results / "series.npz", allow_pickle=False) as archive:
        names = {key.rpartition("/")[0] for key in archive.files}
        assert names == {Path(drop["file"]).stem for drop in document["drops"]}
        for drop in document["drops"]:
            name = Path(drop["file"]).stem
            channels, time = archive[f"{name}/channels"], archive[f"{name}/time"]
            assert channels.tolist() == list(document["fit"]["noise"])
            assert time[0] == pytest.approx(drop["start"] if drop["fit_start"] is None else drop["fit_start"])
            assert time[-1] == pytest.approx(drop["end"])
            measured, fitted = archive[f"{name}/measured"], archive[f"{name}/fitted"]
            assert measured.shape == fitted.shape == (len(channels), len(time))
            # Noise of 0.02 m/s² was simulated: what was fitted is that near.
            assert 0.015 < np.sqrt(np.mean((measured - fitted) ** 2)) < 0.03


def test_load_gives_the_result_back(any_campaign: Identified) -> None:
    loaded = sprung.load(any_campaign.results / "again")
    assert json.loads(loaded.to_json()) == any_campaign.json.json
    again = sprung.load(any_campaign.results / "again" / "results.json")
    for name, series in loaded.series.items():
        assert again.series[name].channels == series.channels
        np.testing.assert_array_equal(again.series[name].measured, series.measured)


@pytest.mark.slow
def test_results_are_written_beside_the_campaign_unless_told(folder: Folder) -> None:
    before = folder.listing()
    assert run("identify", folder.path / "campaign.toml").status == 0
    results = [f"results/{name}" for name in ("report.html", "results.json", "series.npz")]
    assert folder.listing() == sorted([*before, "results", *results])


@pytest.mark.long
def test_without_a_report_none_is_left(folder: Folder) -> None:
    """One of an earlier result would be read as this one's."""
    results = folder.path / "results"
    assert run("identify", folder.path).status == 0
    (results / "report.pdf").write_bytes(b"the user's own")
    said = run("identify", folder.path, "--no-report")
    assert "report.html" not in said.out
    assert sorted(path.name for path in results.iterdir() if path.name != MANIFEST) == [
        "report.pdf",
        "results.json",
        "series.npz",
    ]
    assert (results / "report.pdf").read_bytes() == b"the user's own"
    document = json.loads((results / "results.json").read_text(encoding="utf-8"))
    assert document["amplitude"] == {}  # nothing is spent on figures
    assert run("report", results).status == 0
    assert (results / "report.html").exists()


def test_a_report_of_nothing(tmp_path: Path) -> None:
    said = run("report", tmp_path)
    assert (said.status, said.out) == (2, "")
    assert "Name a folder of results." in said.err
    assert not list(tmp_path.iterdir())


def test_check(folder: Folder) -> None:
    before = folder.listing()
    said = run("check", folder.path, "--json")
    assert said.status == 0
    assert said.json.keys() >= {"drops", "faults"}
    assert [drop["file"] for drop in said.json["drops"]][-1] == "loaded_bounce.csv"
    text = run("check", folder.path)
    assert all(drop["file"] in text.out for drop in said.json["drops"])
    assert said.json["page"] == str(folder.path / "check" / "check.html")
    assert folder.listing() == sorted([*before, "check", "check/check.html"])


@pytest.mark.parametrize("method", ["ml", "era", "svm"])
def test_modal(folder: Folder, method: str) -> None:
    before = folder.listing()
    said = run("modal", folder.path, "--method", method, "--json")
    assert said.status == 0
    assert list(said.json) == ["modes", "modal"]  # the first keyed as in results.json
    modes = said.json["modes"]
    assert list(modes) == ["empty", "ballast"]
    for mode in modes["empty"]:
        check_mode(mode)
    bounce = next(mode for mode in modes["empty"] if mode["name"] == "body bounce")
    assert bounce["frequency"] == pytest.approx(1.052, abs=0.1)  # of the Table 1 car, from its matrices
    assert "Modes, ballast" in run("modal", folder.path, "--method", method).out
    assert folder.listing() == before


def test_simulate_and_back(vehicle_file: Path, tmp_path: Path) -> None:
    said = run("simulate", vehicle_file, "-o", tmp_path / "new" / "campaign", "--json")
    assert said.status == 0
    assert len(said.json["drops"]) == 5
    assert sorted(path.name for path in (tmp_path / "new" / "campaign").iterdir()) == sorted(
        [*said.json["drops"], "campaign.toml", "campaign.schema.json", MANIFEST]
    )
    found = run("identify", said.json["campaign"], "--json", "--no-report")
    assert found.status == 0
    # Without load or weighing only ratios are left: the front springs, 17000 N/m on 1551.8 kg.
    assert found.json["scale"]["per_total_mass"]["k_sf"]["value"] == pytest.approx(17000 / 1551.8, rel=0.02)


@pytest.mark.slow
def test_demo(tmp_path: Path) -> None:
    said = run("demo", tmp_path / "bus", "--json")
    assert (said.status, said.err) == (0, "")
    assert said.json["verdict"]["state"] == "accept"
    assert json.loads((tmp_path / "bus" / "results" / "results.json").read_text()) == said.json
    assert len(list((tmp_path / "bus").glob("*.csv"))) == 10


def test_paper(monkeypatch: pytest.MonkeyPatch) -> None:
    made = sprung.paper.reproduce(noise_levels=(0.0, 0.02), seeds=1)
    monkeypatch.setattr(sprung.paper, "reproduce", lambda **_: made)  # once is enough, it takes seconds
    said = run("paper", "--json")
    assert (said.status, said.err) == (0, "")
    assert said.json.keys() == {"table2", "table3", "bus", "misprints", "noise"}
    text = run("paper")
    assert text.status == 0
    assert "189174" in text.out  # the paper's k_tf, Table 2
    assert all(misprint["where"] in " ".join(text.out.split()) for misprint in said.json["misprints"])


@pytest.mark.slow
def test_the_same_campaign_gives_the_same_document(folder: Folder) -> None:
    quick = ("identify", folder.path, "--json", "--no-report")
    assert run(*quick).out == run(*quick).out


def test_recordings_are_left_as_they_are(sedan: Identified) -> None:
    assert sedan.text.status == 0
    assert not (SEDAN / "results").exists()

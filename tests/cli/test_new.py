"""`sprung new`: drafted, shown, refused; as a user meets it on the command line."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest

from command_line import Run, run
from held import half_car, write_rig
from sessions import write_session
from sprung.simulation import simulate
from sprung.vehicle import TABLE_1_CAR


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Five drops of the paper's car, from a logger that calls its channels ch1 to ch8, and a file that is none."""
    folder = tmp_path_factory.mktemp("session")
    write_session(folder, simulate(TABLE_1_CAR, noise=0.02, seed=1))
    (folder / "broken.csv").write_text("")
    return folder


@pytest.fixture(scope="module")
def new(folder: Path) -> Run:
    return run("new", folder, columns=100)


def test_it_shows_what_was_found_and_what_is_missing(folder: Path, new: Run) -> None:
    assert new.status == 0
    assert "5 drops detected" in new.out
    assert "empty_pitch_front.csv" in new.out
    assert "vehicle.wheelbase: m, front axle to rear axle" in new.out
    assert "broken.csv cannot be read: found an empty file" in new.out
    assert f"sprung check {folder / 'campaign.toml'}" in " ".join(new.out.split())
    assert max(map(len, new.out.splitlines())) <= 100 + len(str(folder)) + len(
        "Next:    fill in what is missing there, then "
    )
    assert new.err == ""


def test_it_writes_a_campaign_file_and_its_schema(folder: Path, new: Run) -> None:
    assert new.status == 0
    text = (folder / "campaign.toml").read_text(encoding="utf-8")
    assert text.startswith("#:schema ./campaign.schema.json\n")
    assert json.loads((folder / "campaign.schema.json").read_text(encoding="utf-8"))["title"] == "campaign.toml"
    assert max(map(len, text.splitlines())) <= 130


def test_every_gap_is_listed_with_its_place_and_what_to_do(folder: Path, new: Run) -> None:
    """`check` judges the recordings all the same, `identify` refuses."""
    assert new.status == 0
    places = ["vehicle.wheelbase", "known.total_mass", *(f"sensor[{i}].position (ch{i})" for i in range(1, 5))]
    missing = run("check", folder, "--no-page", "--json").json["missing"]
    assert [one["where"] for one in missing] == [f"campaign.toml: {place}" for place in places]
    assert all(one["what"] and one["do"] for one in missing)
    refused = run("identify", folder)
    assert refused.status == 2
    assert "6 faults" in refused.err  # wheelbase, mass on the scales, four positions
    for place in places:
        assert f"campaign.toml: {place}: found a placeholder; expected" in refused.err


def test_it_never_overwrites_a_campaign_file(folder: Path, new: Run) -> None:
    assert new.status == 0
    before = (folder / "campaign.toml").read_bytes()
    again = run("new", folder)
    assert again.status == 2
    assert f"Continue with it (`sprung check {shlex.quote(str(folder / 'campaign.toml'))}`)" in again.err
    assert "remove it" in again.err
    assert (folder / "campaign.toml").read_bytes() == before


def test_json_is_one_document_of_the_same(tmp_path: Path) -> None:
    write_session(tmp_path, simulate(TABLE_1_CAR, drops=[{"wheels": ["fl", "fr"], "file": "vorne leer.csv"}], seed=2))
    made = run("new", tmp_path, "--json")
    assert made.status == 0
    document = made.json
    assert document["campaign"] == str(tmp_path / "campaign.toml")
    (drop,) = document["drops"]
    assert (drop["files"], drop["load"], drop["wheels"], drop["kind"]) == (
        ["vorne leer.csv"], "empty", ["fl", "fr"], "pitch front",
    )  # fmt: skip
    assert drop["release"] == pytest.approx(0.4, abs=0.004)
    assert len(document["sensors"]) == 8
    assert document["next"] == ["sprung", "check", str(tmp_path / "campaign.toml")]
    assert {missing["where"] for missing in document["missing"]} >= {"vehicle.wheelbase"}


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda path: path.parent, "no such folder"),
        (lambda path: path.write_text("time,a\n"), "a file; expected a folder"),
        (lambda path: path.mkdir(), "no recordings"),
    ],
)
def test_bad_folders_leave_with_one_message(tmp_path: Path, make: object, words: str) -> None:
    assert callable(make)
    place = tmp_path / "place"
    make(place)
    refused = run("new", place)
    assert refused.status == 2
    assert words in refused.err
    assert "Traceback" not in refused.err
    assert not (place / "campaign.toml").exists()


def test_each_setting_of_a_vehicle_has_a_folder(tmp_path: Path) -> None:
    recordings = {f"Centre/run {i}, damped_{size}.csv": (half_car(damping=i), 0.0) for i, size in ((1, 300), (2, 700))}
    write_rig(tmp_path / "rig", recordings)
    made = run("new", tmp_path / "rig", "-o", tmp_path / "out")
    assert made.status == 0
    assert "2 settings of the vehicle by the names of the recordings: a campaign for each" in made.out
    assert "--no-settings" in made.out
    for setting in ("damped_300", "damped_700"):
        assert (tmp_path / "out" / setting / "campaign.toml").exists()
        assert str(tmp_path / "out" / setting / "campaign.toml") in made.out
    assert list((tmp_path / "rig").iterdir()) == [tmp_path / "rig" / "Centre"]
    again = run("new", tmp_path / "rig", "-o", tmp_path / "out")
    assert again.status == 2
    assert "damped_300/campaign.toml" in again.err.replace("\n", "")
    together = run("new", tmp_path / "rig", "--no-settings", "--json").json
    assert [drop["excitation"] for drop in together["drops"]] == ["push", "push"]
    assert together["campaign"] == str(tmp_path / "rig" / "campaign.toml")
    several = run("new", tmp_path / "rig", "--json", "-o", tmp_path / "json").json
    assert [campaign["setting"] for campaign in several["campaigns"]] == ["damped_300", "damped_700"]

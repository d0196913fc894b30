"""What is wrong with some recordings, and is told, not refused: the rest is identified."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from command_line import DROPS, Folder, Run, copy_sedan, run


def identify(folder: Folder) -> tuple[Run, Run]:
    """Identify, as JSON; and check, as text."""
    return run("identify", folder.path, "--json", "--no-report"), run("check", folder.path)


@pytest.mark.parametrize("cell", ["NaN", "", "-Infinity", "1e300"])
def test_whatever_is_no_reading_is_missing(tmp_path: Path, cell: str) -> None:
    folder = copy_sedan(tmp_path / "gap", DROPS[:1])
    folder.column("wheel_fl", lambda sample, number: cell if 500 <= sample < 520 else number)
    folder.column("wheel_fr", lambda sample, number: cell if sample == 500 else number)
    said = run("check", folder.path, "--json", "--no-drawings")
    left_out, filled = said.json["faults"]
    assert (left_out["code"], left_out["where"]) == ("missing", "empty_bounce.csv: wheel_fl")
    assert "20 of 1800 samples are missing, the first in line 502" in left_out["what"]
    assert (filled["code"], filled["where"]) == ("missing", "empty_bounce.csv: wheel_fr")
    assert "1 of 1800 samples is missing, the first in line 502; filled in" in filled["what"]


def test_one_short_line_is_one_fault(tmp_path: Path) -> None:
    folder = copy_sedan(tmp_path / "short", DROPS[:1])
    folder.lines(lambda lines: [*lines[:500], ",".join(lines[500].split(",")[:4]), *lines[501:]])
    said = run("check", folder.path, "--json", "--no-drawings")
    assert [drop["faults"] for drop in said.json["drops"]] == [["missing"]]
    text = " ".join(run("check", folder.path).out.split())
    assert text.count("1 of 1800 samples is missing") == 1
    assert "empty_bounce.csv: body_rr, wheel_fl, wheel_fr, wheel_rl, wheel_rr: missing" in text
    assert "missing, missing" not in text


@pytest.mark.slow
def test_a_missing_sample_is_filled_in_and_told(folder: Folder) -> None:
    plain = run("identify", folder.path, "--json", "--no-report")
    folder.column("wheel_fl", lambda sample, number: "NaN" if sample == 500 else number)
    said, text = identify(folder)
    assert (said.status, text.status, said.err) == (0, 0, "")
    [fault] = said.json["faults"]
    assert (fault["code"], fault["where"]) == ("missing", "empty_bounce.csv: wheel_fl")
    assert "1 of 1800 samples is missing, the first in line 502; filled in" in fault["what"]
    assert [drop["faults"] for drop in said.json["drops"]] == [["missing"], [], [], []]
    for name, one in plain.json["parameters"].items():
        assert abs(said.json["parameters"][name]["value"] - one["value"]) < 0.5 * one["std"]


@pytest.mark.slow
def test_a_channel_with_gaps_is_left_out_of_its_drop(folder: Folder) -> None:
    folder.column("wheel_fl", lambda sample, number: "NaN" if 500 <= sample < 520 else number)
    said, text = identify(folder)
    assert (said.status, text.status, said.err) == (0, 0, "")
    [fault] = said.json["faults"]
    assert (fault["code"], fault["where"]) == ("missing", "empty_bounce.csv: wheel_fl")
    assert "line 502" in fault["what"]
    assert [drop["faults"] for drop in said.json["drops"]] == [["missing"], [], [], []]
    assert "empty_bounce.csv: wheel_fl: missing: 20 of 1800 samples" in " ".join(text.out.split())
    with np.load(folder.path / "results" / "series.npz") as series:
        place = series["empty_bounce/channels"].tolist().index("wheel_fl")
        assert np.isnan(series["empty_bounce/measured"][place]).all()
        assert np.isfinite(series["loaded_bounce/measured"]).all()
    assert abs(said.json["parameters"]["k_sf"]["value"] / 17000 - 1) < 0.02  # the other drops still tell


@pytest.mark.slow
def test_a_channel_that_one_recording_lacks(folder: Folder) -> None:
    folder.lines(lambda lines: [line.rpartition(",")[0] for line in lines])
    said, text = identify(folder)
    assert (said.status, text.status) == (0, 0)
    [fault] = said.json["faults"]
    assert (fault["code"], fault["where"]) == ("missing", "empty_bounce.csv: wheel_rr")
    assert "Did you mean" not in fault["do"]  # every other column is some other sensor's
    assert "wheel_rr: missing" in text.out
    for command in ("check", "modal"):
        assert "wheel_rr: missing" in run(command, folder.path).out


def test_a_misnamed_channel_in_one_recording(folder: Folder) -> None:
    folder.edit("wheel_rr", "wheel_r", "empty_bounce.csv")
    said = run("check", folder.path, "--json")
    assert "Did you mean 'wheel_r'?" in said.json["faults"][0]["do"]


@pytest.mark.slow
def test_a_channel_that_nobody_declares_is_nobodys_business(folder: Folder) -> None:
    plain = run("identify", folder.path, "--json", "--no-report").json
    folder.lines(lambda lines: [f"{lines[0]},note", *(f"{line},hello" for line in lines[1:])])
    noted = run("identify", folder.path, "--json", "--no-report").json
    before, after = (document["setup"].pop("files") for document in (plain, noted))
    assert plain["checksums"].pop("document") != noted["checksums"].pop("document")
    assert noted == plain
    # It is another file all the same.
    assert [one["name"] for one in before if one not in after] == ["empty_bounce.csv"]


@pytest.mark.slow
def test_a_drop_that_ends_too_soon_is_left_out(folder: Folder) -> None:
    folder.lines(lambda lines: lines[:11])
    said, text = identify(folder)
    assert (said.status, text.status) == (0, 0)
    drop = said.json["drops"][0]
    assert (drop["start"], drop["end"], drop["faults"]) == (None, None, ["no-decay"])
    assert "no-decay" in text.out
    assert "left out" in text.out


def test_a_fault_that_leaves_nothing_is_named_as_one(tmp_path: Path) -> None:
    folder = copy_sedan(tmp_path / "short", DROPS[:1])
    folder.lines(lambda lines: lines[:11])
    said = run("check", folder.path)
    assert said.status == 2
    assert "empty_bounce.csv: found the fault no-decay (" in said.err
    assert "expected a usable decay in at least one drop" in said.err


def test_a_recording_of_nothing_but_rest_is_refused(tmp_path: Path) -> None:
    folder = copy_sedan(tmp_path / "rest", DROPS[:1])
    random = np.random.default_rng(1)

    def rest(lines: list[str]) -> list[str]:
        rows = np.column_stack([np.arange(1500) / 500, 9.81 + random.normal(0, 0.02, (1500, 8))])
        return [lines[0], *(",".join(f"{number:.5f}" for number in row) for row in rows)]

    folder.lines(rest)
    said, text = identify(folder)
    assert (said.status, text.status) == (2, 2)
    assert "no channel moves more than its noise at rest in 3 s" in text.err
    assert "usable decay in at least one drop" in text.err


def test_a_script_finds_the_drops_that_check_leaves_out(folder: Folder) -> None:
    """The exit status says only that something is usable, as docs/commands.md states."""
    folder.lines(lambda lines: lines[:11])
    said = run("check", folder.path, "--json", "--no-page")
    assert said.status == 0
    left_out = [drop for drop in said.json["drops"] if drop["start"] is None]
    assert [(drop["file"], drop["end"], drop["faults"]) for drop in left_out] == [
        ("empty_bounce.csv", None, ["no-decay"])
    ]
    assert len(said.json["drops"]) > 1
    assert [fault["code"] for fault in said.json["faults"]] == ["no-decay"]


@pytest.mark.slow
def test_front_drops_alone(tmp_path: Path) -> None:
    folder = copy_sedan(tmp_path / "front", ("empty_pitch_front", "loaded_pitch_front"))
    said = run("identify", folder.path, "--json", "--no-report")
    assert said.status == 0
    assert said.json["verdict"]["state"] == "doubtful"
    silent = {name for name, found in said.json["parameters"].items() if found["status"] == "unidentifiable"}
    assert {"I_xx", "t_f", "t_r"} <= silent  # they do not roll


def test_start_and_end_of_a_drop_are_used_as_given(folder: Folder) -> None:
    folder.edit('file = "empty_bounce.csv"\n', 'file = "empty_bounce.csv"\nstart = 0.6\nend = 2.0\n')
    drop = run("check", folder.path, "--json").json["drops"][0]
    assert (drop["start"], drop["end"]) == pytest.approx((0.6, 2.0))


@pytest.mark.slow
def test_without_wheel_sensors_nothing_breaks(folder: Folder) -> None:
    for station in ("fl", "fr", "rl", "rr"):
        folder.edit(f'[[sensor]]\nchannel = "wheel_{station}"\non = "{station}"\n', "")
    said = run("identify", folder.path, "--json", "--no-report")
    assert said.status in {0, 3}
    assert "Traceback" not in said.err
    assert said.json["fit"]["noise"].keys() == {"body_fl", "body_fr", "body_rl", "body_rr"}

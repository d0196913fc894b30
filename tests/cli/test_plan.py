"""`sprung plan`: what it prints, which document it gives, and how it leaves."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from rich.console import Console

import sprung
from command_line import DROPS, Folder, Identified, copy_sedan, linear_leafbus, run
from layouts import check_view_is_whole
from sprung.report import plan_view, text_of


def test_a_vehicle_file(vehicle_file: Path) -> None:
    before = sorted(vehicle_file.parent.iterdir())
    said = run("plan", vehicle_file)
    assert (said.status, said.err) == (0, "")
    assert said.out.startswith("car: expected standard uncertainty, %\n")
    assert "Next: knowing the total mass would determine 11 more parameters" in said.out
    first = next(line.split() for line in said.out.splitlines() if line.startswith("as planned"))
    assert first[2:5] == ["m_s", "-", "11"]
    assert sorted(vehicle_file.parent.iterdir()) == before


def test_what_cannot_be_told_is_named_below_the_table(vehicle_file: Path) -> None:
    said = " ".join(run("plan", vehicle_file).out.split())
    _, _, reasons = said.partition("Not determined")
    assert "as planned" in reasons
    assert "m_s, I_yy, I_xx" in reasons
    assert "changes no acceleration" in reasons
    assert "t_f" in reasons  # a bounce alone does not roll


def test_every_width_shows_every_parameter_of_every_alternative(vehicle_file: Path) -> None:
    drawn_up = sprung.plan(vehicle_file)
    check_view_is_whole(plan_view(drawn_up), tables=1)
    shown = text_of(plan_view(drawn_up), Console(width=80, highlight=False, color_system=None))
    assert not any(line != line.rstrip() for line in shown.splitlines())
    headers = [line.split() for line in shown.splitlines() if line.startswith("test ")]
    bound = drawn_up.rows[0].bound
    assert bound is not None
    assert set(bound.percents) <= {name for line in headers for name in line}


def test_the_document(vehicle_file: Path) -> None:
    said = run("plan", vehicle_file, "--json", "--wanted", "0.15", "--noise", "0.01", "--rate", "250")
    assert (said.status, said.err) == (0, "")
    assert (said.json["wanted"], said.json["rate"], set(said.json["noise"].values())) == (0.15, 250, {0.01})
    step = said.json["next_step"]
    assert step["enough"]
    assert max(step["percent"].values()) <= 0.15


@pytest.mark.slow
def test_a_campaign(folder: Folder) -> None:
    before = folder.listing()
    said = run("plan", folder.path)
    assert (said.status, said.err) == (0, "")
    assert "as it is" in said.out
    assert folder.listing() == before
    identified = run("identify", folder.path, "--no-report")
    next_line = said.out.partition("Next: ")[2]
    assert next_line
    assert next_line in identified.out
    document = json.loads((folder.path / "results" / "results.json").read_text(encoding="utf-8"))
    assert f"{document['next_step']}." == " ".join(next_line.split())


def test_identify_says_what_would_help(one_drop: Identified, sedan: Identified) -> None:
    assert "would determine 13 more parameters" in one_drop.json.json["next_step"]
    assert sedan.json.json["next_step"].startswith("nothing more is needed; every parameter is known to 1 % or better")


@pytest.mark.long
@pytest.mark.slow
def test_a_rejected_campaign_is_no_ground_for_a_plan(leafbus: Identified, tmp_path: Path) -> None:
    campaign = linear_leafbus(tmp_path / "campaign")
    said = run("plan", campaign, "--json")
    assert said.status == 3
    assert "does not explain the records" in said.json["rejected"][0]
    assert (said.json["alternatives"], said.json["next_step"]["percent"]) == ([], {})
    assert leafbus.json.json["next_step"] is None
    assert "Next:" not in leafbus.text.out


@pytest.mark.long
def test_in_words_too(tmp_path: Path) -> None:
    text = run("plan", linear_leafbus(tmp_path / "campaign")).out
    assert "no plan can be made from it" in " ".join(text.split())
    assert "Next:" not in text


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--wanted", "0"), ("plan: wanted",)),
        (("--noise", "0"), ("plan: noise",)),
        (("--rate", "1", "--noise", "-1"), ("plan: rate", "plan: noise", "2 faults")),
        (("--wanted", "much"), ("--wanted",)),
    ],
)
def test_bad_options(vehicle_file: Path, options: tuple[str, ...], words: tuple[str, ...]) -> None:
    said = run("plan", vehicle_file, "--json", *options)
    assert (said.status, said.out) == (2, "")
    assert all(word in said.err for word in words)
    assert "Traceback" not in said.err


def test_bad_files(vehicle_file: Path, folder: Folder) -> None:
    for path in (vehicle_file.with_name("none.toml"), vehicle_file.parent):
        assert run("plan", path).status == 2
    vehicle_file.write_text(vehicle_file.read_text().replace("m_s = 1380\n", ""))
    said = run("plan", vehicle_file)
    assert (said.status, said.out) == (2, "")
    assert "no 'm_s'" in said.err
    said = run("plan", folder.path, "--noise", "0.1", "--rate", "100")
    assert (said.status, said.out) == (2, "")
    assert said.err.count("a campaign has its own") == 2
    folder.edit("wheelbase", "wheelbse")
    assert run("plan", folder.path).status == 2


def test_a_campaign_with_one_drop(tmp_path: Path) -> None:
    folder = copy_sedan(tmp_path / "one", DROPS[:1])
    said = run("plan", folder.path, "--json")
    assert said.status == 0
    # A known mass and a drop of the left wheels would do, were the places of the sensors not known to 1 cm only: twice do.
    assert said.json["next_step"]["alternatives"] == ["drops twice", "+ 20 % left"]

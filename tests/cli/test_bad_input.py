"""Bad input: exit status 2, one message that names every fault, no traceback, and nothing written."""

from __future__ import annotations

import errno
import os
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from car import CAR

from command_line import DROPS, Folder, copy_sedan, run

Spoil = Callable[[Folder], object]


def remove(folder: Folder, file: str) -> None:
    (folder.path / file).unlink()


def write(folder: Folder, content: bytes, file: str = "empty_bounce.csv") -> None:
    (folder.path / file).write_bytes(content)


def make_folder(folder: Folder, file: str) -> None:
    remove(folder, file)
    (folder.path / file).mkdir()


def backward(lines: list[str]) -> list[str]:
    return [lines[0], *lines[100:200], *lines[1:100], *lines[200:]]


def two_body_sensors(folder: Folder) -> None:
    for _ in range(2):
        text = (folder.path / "campaign.toml").read_text()
        found = re.search(r'on = "body"\nposition = \[-2[^\n]*\n', text)
        assert found is not None
        folder.edit(found[0], 'on = "rl"\n')


# Spoils the folder; words of the message; number of faults.
BAD: dict[str, tuple[Spoil, tuple[str, ...], int]] = {
    "missing file": (
        lambda folder: remove(folder, "empty_bounce.csv"),
        ("empty_bounce.csv: found no such file", "Put the recordings there"),
        1,
    ),
    "channel that no recording has": (
        lambda folder: folder.edit('channel = "body_fl"', 'channel = "body_lf"'),
        ("sensor[1].channel (body_lf)", "which no recording has", "Did you mean 'body_fl'?"),
        1,
    ),
    "unknown key": (
        lambda folder: folder.edit("wheelbase", "wheelbse"),
        ("vehicle.wheelbse", "Did you mean 'wheelbase'?"),
        1,
    ),
    "unknown load": (
        lambda folder: folder.edit('load = "ballast"', 'load = "balast"'),
        ("drop[4].load (loaded_bounce.csv)", "Did you mean 'ballast'?"),
        1,
    ),
    "unplaced body sensor": (
        lambda folder: folder.edit("position = [0.12, 0.68, 0.55]\n", ""),
        ("sensor[1] (body_fl)", "position = [x, y, z]"),
        1,
    ),
    "two body sensors": (two_body_sensors, ("2 sensors on the body", "at least 3"), 1),
    "text for numbers": (
        lambda folder: folder.column("body_fr", lambda sample, cell: "oops" if sample == 49 else cell),
        ("empty_bounce.csv: line 51, column 'body_fr': found 'oops'; expected a number",),
        1,
    ),
    "empty recording": (lambda folder: write(folder, b""), ("empty_bounce.csv: found an empty file",), 1),
    "header alone": (lambda folder: folder.lines(lambda lines: lines[:1]), ("a header and no samples",), 1),
    "one sample": (lambda folder: folder.lines(lambda lines: lines[:2]), ("a single sample",), 1),
    "decreasing clock": (
        lambda folder: folder.lines(backward),
        ("empty_bounce.csv: line 102", "the time 0 s after 0.396 s"),
        1,
    ),
    "too slow": (
        lambda folder: folder.lines(lambda lines: [lines[0], *lines[1::10]]),
        ("50 samples per second", "at least 64"),
        1,
    ),
    "mass below the axles": (
        lambda folder: folder.edit(
            "[known]", "[known]\ntotal_mass = 1000\nfront_axle_mass = 800\nrear_axle_mass = 700"
        ),
        ("known.total_mass", "1000 kg", "1500 kg"),
        1,
    ),
    "binary recording": (lambda folder: write(folder, bytes(range(256)) * 20), ("no known format",), 1),
    "binary recording without zeros": (
        lambda folder: write(folder, bytes(range(1, 256)) * 20),
        ("unreadable characters",),
        1,
    ),
    "folder for a recording": (
        lambda folder: make_folder(folder, "empty_bounce.csv"),
        ("empty_bounce.csv: found a folder",),
        1,
    ),
    "folder for the campaign": (
        lambda folder: make_folder(folder, "campaign.toml"),
        ("campaign.toml: found a folder", "Rename the folder"),
        1,
    ),
    "no campaign": (lambda folder: remove(folder, "campaign.toml"), ("no such file", "sprung new"), 1),
    "empty campaign": (
        lambda folder: write(folder, b"", "campaign.toml"),
        ("0 sensors on the body", "no drops"),
        2,
    ),
    "binary campaign": (lambda folder: write(folder, b"\xff\x00\xfe", "campaign.toml"), ("not UTF-8",), 1),
    "same recording twice": (
        lambda folder: folder.edit('"loaded_bounce.csv"', '"empty_bounce.csv"'),
        ("'empty_bounce.csv', which drop[1] has too",),
        1,
    ),
    "negative mass": (
        lambda folder: folder.edit("[known]", "[known]\nm_s = -5"),
        ("known.m_s: found -5", "positive"),
        1,
    ),
    "no wheelbase at all": (
        lambda folder: folder.edit("wheelbase = 2.76", "wheelbase = 0"),
        ("vehicle.wheelbase: found 0", "positive"),
        1,
    ),
    "wheelbase in mm": (
        lambda folder: folder.edit("wheelbase = 2.76", "wheelbase = 2760"),
        ("vehicle.wheelbase: found 2760; expected 0.6 to 12 m", "2.76 if it was stated in mm"),
        1,
    ),
    "positions in mm": (
        lambda folder: folder.edit("[0.12, 0.68, 0.55]", "[120, 680, 550]"),
        ("sensor[1].position (body_fl): found [120, 680, 550]", "0.12, 0.68, 0.55 if it was stated in mm"),
        1,
    ),
    "huge load": (
        lambda folder: folder.edit("mass = 140.0", "mass = 1e300"),
        ("load[1].items[1].mass (ballast): found 1e+300", "it is read in kg."),
        1,
    ),
    "huge mass": (
        lambda folder: folder.edit("[known]", "[known]\ntotal_mass = 1e300"),
        ("known.total_mass: found 1e+300",),
        1,
    ),
    "tiny rate": (
        lambda folder: folder.edit("[known]", "[known]\nk_sf = 1e-300"),
        ("known.k_sf: found 1e-300; expected a positive number",),
        1,
    ),
    "infinite mass": (
        lambda folder: folder.edit("[known]", "[known]\ntotal_mass = inf"),
        ("known.total_mass: found Infinity",),
        1,
    ),
    "three faults in three places": (
        lambda folder: folder.edit("wheelbase", "wheelbse").edit('load = "ballast"', 'load = "balast"').lines(backward),
        ("3 faults", "vehicle.wheelbse", "drop[4].load", "line 102"),
        3,
    ),
}


@pytest.mark.parametrize(("spoil", "words", "faults"), BAD.values(), ids=BAD)
def test_a_fault_is_named_and_nothing_written(
    folder: Folder, spoil: Spoil, words: tuple[str, ...], faults: int
) -> None:
    spoil(folder)
    before = folder.listing()
    said = run("identify", folder.path, "-o", folder.path / "a" / "results")
    assert (said.status, said.out) == (2, "")
    headline, *problems = said.err.splitlines()
    assert headline.startswith("sprung cannot use this input")
    assert len(problems) == faults
    assert all(re.fullmatch(r".+: found .+; expected .+\. .+", problem) for problem in problems)
    for word in words:
        assert word in said.err
    assert "Traceback" not in said.err
    assert folder.listing() == before


@pytest.mark.parametrize("command", ["identify", "check", "modal"])
@pytest.mark.parametrize("options", [(), ("--json",)])
def test_every_command_says_the_same(folder: Folder, command: str, options: tuple[str, ...]) -> None:
    folder.edit("wheelbase", "wheelbse")
    said = run(command, folder.path, *options)
    assert (said.status, said.out) == (2, "")  # with --json too, standard output stays empty
    assert said.err.startswith("sprung cannot use this input:\ncampaign.toml: vehicle.wheelbse: found the unknown key")
    assert not (folder.path / "results").exists()


@pytest.mark.parametrize("command", ["identify", "check", "modal"])
@pytest.mark.parametrize("options", [(), ("--json",)])
def test_no_usable_drop(tmp_path: Path, command: str, options: tuple[str, ...]) -> None:
    folder = copy_sedan(tmp_path / "short", DROPS[:1]).lines(lambda lines: lines[:100])
    said = run(command, folder.path, *options)
    assert (said.status, said.out) == (2, "")
    assert "found" in said.err
    assert "drop" in said.err
    assert not (folder.path / "results").exists()


@pytest.mark.parametrize("command", ["identify", "check", "modal", "simulate"])
def test_a_path_that_is_not_there(tmp_path: Path, command: str) -> None:
    said = run(command, tmp_path / "nowhere", *(("-o", tmp_path / "x") if command == "simulate" else ()))
    assert (said.status, said.out) == (2, "")
    assert "nowhere: found no such file" in said.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), ""),
        (("identfy", "x"), "identfy"),
        (("identify",), "CAMPAIGN"),
        (("identify", "x", "--bad"), "--bad"),
        (("identify", "x", "y"), "y"),
        (("simulate", "x"), "--output"),
        (("simulate", "x", "-o", "y", "--rate", "fast"), "--rate"),
        (("simulate", "x", "-o", "y", "--rate", "1e12"), "--rate"),
        (("simulate", "x", "-o", "y", "--seed", "-1"), "--seed"),
    ],
)
def test_bad_usage(arguments: tuple[str, ...], words: str) -> None:
    said = run(*arguments)
    assert said.status == 2
    assert words in said.err
    assert "Traceback" not in said.err


def test_unknown_method(folder: Folder) -> None:
    said = run("modal", folder.path, "--method", "foo")
    assert (said.status, said.out) == (2, "")
    assert all(word in said.err for word in ("method", "'foo'", "era", "svm"))


def test_the_output_is_a_file(folder: Folder, tmp_path: Path) -> None:
    (tmp_path / "results").write_text("mine")
    said = run("identify", folder.path, "-o", tmp_path / "results")
    assert (said.status, said.out) == (2, "")
    assert "a file where the folder should be" in said.err
    assert (tmp_path / "results").read_text() == "mine"


def test_an_output_that_cannot_be_written_is_refused_before_the_fit(
    folder: Folder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(**_: object) -> object:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr("sprung.files.ownership.tempfile.TemporaryFile", refuse)
    for options in ((), ("--force",)):
        said = run("identify", folder.path, "-o", tmp_path / "results", "--json", *options)
        assert (said.status, said.out) == (2, "")
        assert "cannot be written to" in said.err


def test_the_output_cannot_be_written(folder: Folder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = Path.open

    def refuse(path: Path, mode: str = "r", *rest: object, **options: object) -> object:
        if "r" not in mode:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        return real(path, mode, *rest, **options)  # type: ignore[call-overload]

    monkeypatch.setattr(Path, "open", refuse)  # permissions do not bind the superuser, who may run the tests
    said = run("identify", folder.path, "-o", tmp_path / "new" / "results", "--json")
    assert said.status == 2
    assert "cannot be written to" in said.err
    assert said.json["verdict"]["state"] == "accept"  # what was found is shown, as it cannot be saved
    assert not (tmp_path / "new").exists()


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="permissions do not bind the superuser")
def test_a_read_only_folder(folder: Folder, tmp_path: Path) -> None:
    (tmp_path / "locked").mkdir(mode=0o500)
    said = run("identify", folder.path, "-o", tmp_path / "locked" / "results")
    assert (said.status, said.out) == (2, "")
    assert list((tmp_path / "locked").iterdir()) == []


# Of VEHICLE.toml: what to replace, and words of the message.
BAD_VEHICLES: dict[str, tuple[tuple[str, str], tuple[str, ...]]] = {
    "nothing": ((CAR, ""), ("found no 'm_s'", "found no 'b'")),
    "missing parameter": (("k_sf = 17000\n", ""), ("found no 'k_sf'", "spring rate, each front wheel")),
    "unknown parameter": (("k_sf = 17000", "k_fs = 17000"), ("k_fs",)),
    "negative mass": (("m_s = 1380", "m_s = -1380"), ("parameters.m_s: found -1380",)),
    "infinite mass": (("m_s = 1380", "m_s = inf"), ("parameters.m_s: found Infinity",)),
    "huge mass": (("m_s = 1380", "m_s = 1e300"), ("parameters.m_s: found 1e+300; expected 40 to 60000 kg",)),
    "no mass to speak of": (("m_s = 1380", "m_s = 1e-300"), ("parameters.m_s: found 1e-300; expected 40 to 60000 kg",)),
    "negative damper": (("c_sf = 1500", "c_sf = -1"), ("parameters.c_sf: found -1",)),
    "unknown load": (("[vehicle]", '[[drop]]\nload = "x"\n[vehicle]'), ("drop[1].load: found 'x'",)),
    "drop from a mountain": (("[vehicle]", "[[drop]]\nheight = 1e9\n[vehicle]"), ("drop[1].height: found 1e+09",)),
    "same file twice": (
        ("[vehicle]", '[[drop]]\nfile = "x.csv"\n[[drop]]\nfile = "x.csv"\n[vehicle]'),
        ("drop[2].file (x.csv)",),
    ),
    "two sensors": (
        ("[vehicle]", '[[sensor]]\nchannel = "a"\non = "fl"\n[[sensor]]\nchannel = "b"\non = "fr"\n[vehicle]'),
        ("0 sensors on the body",),
    ),
}


@pytest.mark.parametrize(("change", "words"), BAD_VEHICLES.values(), ids=BAD_VEHICLES)
def test_bad_vehicle_files(vehicle_file: Path, change: tuple[str, str], words: tuple[str, ...]) -> None:
    text = vehicle_file.read_text()
    assert change[0] in text
    vehicle_file.write_text(text.replace(*change, 1))
    said = run("simulate", vehicle_file, "-o", vehicle_file.parent / "out")
    assert (said.status, said.out) == (2, "")
    for word in words:
        assert word in said.err
    assert "car.toml: " in said.err
    assert not (vehicle_file.parent / "out").exists()


@pytest.mark.parametrize("option", [("--rate", "10"), ("--rate", "nan"), ("--noise", "-1"), ("--noise", "nan")])
def test_bad_simulation(vehicle_file: Path, option: tuple[str, str]) -> None:
    said = run("simulate", vehicle_file, "-o", vehicle_file.parent / "out", *option)
    assert (said.status, said.out) == (2, "")
    assert option[0][2:] in said.err
    assert "Traceback" not in said.err
    assert not (vehicle_file.parent / "out").exists()

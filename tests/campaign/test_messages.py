"""Every bad input is named: where it stands, what was found, and what to do about it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from sprung.campaign import read, read_vehicle
from sprung.errors import InputError

Folder = Callable[..., Path]
JARGON = ("pydantic", "http", "Input should", "Field required", "validation", "tuple", "Traceback", "None", "JSON")

FILE_FAULTS: dict[str, tuple[tuple[str, str], tuple[str, ...]]] = {
    "unknown key": (("wheelbase", "wheelbse"), ("vehicle.wheelbse", "unknown key", "Did you mean 'wheelbase'?")),
    "unknown section": (("[[load]]", "[[loads]]"), ("campaign.toml: loads", "Did you mean 'load'?")),
    "misspelt, not missing": (('channel = "body_fr"', 'chanel = "body_fr"'), ("sensor[2].chanel", "'channel'")),
    "missing key": (('channel = "body_fr"\n', ""), ("sensor[2].channel: found nothing", "Add channel = ... to it")),
    "text for a number": (("= 2.76", '= "2.76"'), ("vehicle.wheelbase", '"2.76"', "a number, or { value = ...")),
    "not a number": (("= 2.76", "= nan"), ("vehicle.wheelbase: found NaN", "a number")),
    "truth for a number": (("mass = 140", "mass = true"), ("load[1].items[1].mass (ballast)", "positive number")),
    "number for text": (('"body_fr"', "3"), ("sensor[2].channel: found 3", "text in double quotes")),
    "negative mass": (("mass = 140", "mass = -140"), ("load[1].items[1].mass", "-140", "a positive number")),
    "negative length": (("= 2.76", "= -2.76"), ("vehicle.wheelbase", "-2.76", "positive", "rear axle in m")),
    "short vector": (
        ("[0.1, 0.7, 0.5]", "[0.1, 0.7]"),
        ("sensor[1].position (body_fl)", "[0.1, 0.7]", "[x, y, z] in m"),
    ),
    "long vector": (("[0.1, 0.7, 0.5]", "[1, 2, 3, 4]"), ("sensor[1].position", "[1, 2, 3, 4]", "[x, y, z] in m")),
    "unknown choice": (('"body_fl"\non = "body"', '"body_fl"\non = "bodi"'), ("sensor[1].on", '"bodi"', "'body'")),
    "unplaced sensor": (
        ("position = [0.1, 0.7, 0.5]\n", ""),
        ("sensor[1] (body_fl)", "needs its position = [x, y, z]"),
    ),
    "two descriptions": (
        ('"ballast"\n', '"ballast"\nadded = { mass = 3 }\n'),
        ("load[1]", "Give either items or added"),
    ),
    "wheel twice": (('"one.csv"', '"one.csv"\nwheels = ["fl", "fl"]'), ("drop[1] (one.csv)", "Name each wheel once")),
    "no wheels": (('"one.csv"', '"one.csv"\nwheels = []'), ("drop[1].wheels (one.csv): found []", "not empty")),
    "end before start": (('"one.csv"', '"one.csv"\nstart = 0.1\nend = 0.05'), ("drop[1]", "must come after the start")),
    "single brackets": (("[[load]]", "[load]"), ("campaign.toml: load", "[[load]] in double brackets")),
    "several loggers": (('file = "one.csv"', 'files = ["one.csv", "b.csv"]'), ("b.csv: found no such file",)),
    "file and files": (('"one.csv"', '"one.csv"\nfiles = ["one.csv"]'), ("drop[1]", "ither the file or")),
    "no files": (('file = "one.csv"', "files = []"), ("drop[1].file: found nothing",)),
    "window": (('"one.csv"', '"one.csv"\nwindow = [2.0, 1.0]'), ("drop[1]", "he window must end after 2 s")),
    "no recording": (('file = "one.csv"\n', "height = 0.1\n"), ("drop[1].file: found nothing", "recording")),
    "missing recording": (('"one.csv"', '"on.csv"'), ("on.csv: found no such file", "Did you mean 'one.csv'?")),
    "recording twice": (('"two.csv"', '"./one.csv"'), ("drop[2].file", "'one.csv', which drop[1] has too")),
    "channel twice": (('"body_fr"', '"body_fl"'), ("sensor[2].channel", "'body_fl', which sensor[1] has too")),
    "load twice": (
        ('[[drop]]\nfile = "one.csv"', '[[load]]\nname = "ballast"\nadded = { mass = 3 }\n[[drop]]\nfile = "one.csv"'),
        ("load[2].name", "which load[1] has too"),
    ),
    "unknown load": (('load = "ballast"', 'load = "balast"'), ("drop[2].load (two.csv)", "Did you mean 'ballast'?")),
    "unknown channel": (('"body_fr"', '"body_fn"'), ("sensor[2].channel", "which no recording has", "'body_fr'")),
    "unknown unit": (
        ("position = [0.1, 0.7, 0.5]", 'position = [0.1, 0.7, 0.5]\nunit = "gg"'),
        ("sensor[1].unit", "'gg'"),
    ),
    "two body sensors": (
        ('on = "body"\nposition = [-2.9, 0.7, 0.5]', 'on = "rl"'),
        ("2 sensors on the body", "at least 3"),
    ),
    "sensors on a line": (("[-2.9, 0.7", "[0.1, 0.2"), ("on one line", "pitch cannot be distinguished from roll")),
    "unknown quantity": (("[known]", "[known]\nk_fs = 3"), ("known.k_fs", "Did you mean 'k_")),
    "wheelbase as known": (("[known]", "[known]\nwheelbase = 3"), ("known.wheelbase", "under [vehicle]")),
    "negative quantity": (("[known]", "[known]\nm_s = -4"), ("known.m_s: found -4", "positive", "sprung mass in kg")),
    "negative uncertainty": (("[known]", "[known]\na = { value = 1, std = -1 }"), ("known.a.std", "0 or more")),
    "only an uncertainty": (
        ("[known]", "[known]\na = { std = 1 }"),
        ("known.a.value: found nothing", "Add value = ..."),
    ),
    "axles beyond the total": (
        ("[known]", "[known]\ntotal_mass = { value = 1500, std = 5 }\nfront_axle_mass = 800\nrear_axle_mass = 750"),
        ("known.total_mass", "1500 ± 5 kg", "1550 kg", "state their uncertainty"),
    ),
    "one axle beyond the total": (
        ("[known]", "[known]\ntotal_mass = 1500\nrear_axle_mass = 1501"),
        ("1500 kg, but", "1501"),
    ),
    "wheelbase beyond a + b": (
        ("[known]", "[known]\na = 1.25\nb = 1.5"),
        ("vehicle.wheelbase", "2.76 m", "a + b = 2.75 m"),
    ),
    "unknown extra": (
        ("[known]", '[model]\nextras = ["anti-rol"]'),
        ("model.extras: found 'anti-rol'", "'anti-roll'?"),
    ),
    "unknown ban": (
        ("[known]", '[model]\nforbid = ["rebond"]'),
        ("model.forbid: found 'rebond'", "Did you mean 'rebound'?"),
    ),
    "asked and banned": (
        ("[known]", '[model]\nextras = ["anti-roll"]\nforbid = ["anti-roll"]'),
        ("model.forbid: found 'anti-roll'", "one of the two"),
    ),
    "extras as text": (("[known]", '[model]\nextras = "anti-roll"'), ("model.extras", "a list in [ ]")),
    "unknown tracks": (("[known]", '[model]\ntracks = "shard"'), ("model.tracks", "Did you mean 'shared'?")),
    "shared and apart": (
        ("[known]", '[model]\ntracks = "shared"\n[known]\nt_f2 = 0.5'),
        ("model.tracks", "Give t_f instead"),
    ),
    "start outside": (('"one.csv"', '"one.csv"\nstart = -1'), ("drop[1].start (one.csv): found -1 s", "0 to 0.198 s")),
    "end outside": (('"one.csv"', '"one.csv"\nend = 5'), ("drop[1].end (one.csv): found 5 s", "0 to 0.198 s")),
    "decimal comma": (("= 2.76", "= 2,76"), ("line 4, column", "`wheelbase = 2,76`", "decimal point")),
    "key twice": (
        ("= 2.76", "= 2.76\nwheelbase = 3"),
        ("line 5, column", "`wheelbase = 3`, a key that its section has already", "Delete one of the two"),
    ),
    "key twice in a table": (
        ("mass = 140", "mass = 140, mass = 140"),
        ("a key that its table has already", "Delete one of the two"),
    ),
    "section twice": (
        ("[known]", "[known]\n[vehicle]"),
        ("a section that the file has already", "keys of the two into one"),
    ),
    "on a seat without position": (
        ("mass = 140, position = [-1, 0, 0.5]", 'mass = 75, on = "seat"'),
        ("load[1].items[1]", 'An item with on = "seat" needs its position = [x, y, z] too'),
    ),
    "place in words": (
        ('"body_fl"\non = "body"', '"body_fl"\non = "rear right"'),
        (
            "sensor[1].on",
            '"rear right"',
            'expected one of "body", "fl", "fr", "rl", "rr", "pad fl"',
            "Did you mean 'rr'?",
        ),
    ),
    "pad without wheel": (
        ('"body_fl"\non = "body"', '"body_fl"\non = "pad"'),
        ("sensor[1].on", "Did you mean 'pad fl', 'pad fr', 'pad rl' or 'pad rr'?"),
    ),
    "axis of no rate": (
        ('"body_fl"\non = "body"', '"body_fl"\non = "body"\nquantity = "angular-rate"\nunit = "deg/s"\naxis = "yaw"'),
        ('sensor[1].axis (body_fl): found "yaw"; expected one of "pitch", "roll". Write one of these.',),
    ),
    "unknown excitation": (
        ('"one.csv"', '"one.csv"\nexcitation = "bump"'),
        ('expected one of "drop", "push", "pass", "pads". Write one of these.',),
    ),
    "speed of a drop": (
        ('"one.csv"', '"one.csv"\nspeed = 5'),
        ('not of a drop; write excitation = "pass", or remove speed.',),
    ),
    "speed of another vehicle": (
        ('"one.csv"', '"one.csv"\nexcitation = "pass"\nspeed = 30'),
        (
            "drop[1].speed (one.csv): found 30",
            "0.2 to 15 m/s, the range of passes over a bump",
            "8.3333 if it was stated in km/h",
        ),
    ),
    "section of a simulation": (
        ("[known]", "[bump]\nheight = 0.05\n[known]"),
        ("campaign.toml: bump: found [bump], a section of a vehicle file", "Remove it"),
    ),
    "vehicle file": (
        ("[known]", "[parameters]\nm_s = 1380\n[known]"),
        ("found [parameters], which makes it a vehicle file", "`sprung plan`", "`sprung simulate`"),
    ),
    "newer schema": (("schema = 1", "schema = 2\nfuture = 3"), ("schema 2", "Update sprung")),
    "no schema of ours": (("schema = 1", 'schema = "one"'), ("schema: found schema 'one'", "Write schema = 1")),
}


@pytest.mark.parametrize(("change", "words"), FILE_FAULTS.values(), ids=FILE_FAULTS)
def test_a_fault_of_the_campaign_file_is_said_once_and_exactly(
    folder: Folder, change: tuple[str, str], words: tuple[str, ...]
) -> None:
    with pytest.raises(InputError) as error:
        read(folder(change))
    message = str(error.value)
    for word in words:
        assert word in message
    assert not any(word in message for word in JARGON)
    assert len(error.value.problems) == 1  # no consequences beside the cause


@pytest.mark.parametrize(
    ("model", "zeros"), [("pitch-plane", "y = 0"), ("roll-plane", "x = 0"), ("quarter", "x = y = 0")]
)
def test_a_position_that_is_missing_is_asked_for_as_the_model_has_it(folder: Folder, model: str, zeros: str) -> None:
    path = folder(("wheelbase = 2.76", f'wheelbase = 2.76\nmodel = "{model}"'), ("position = [0.1, 0.7, 0.5]\n", ""))
    with pytest.raises(InputError, match=rf"position = \[x, y, z\], with {zeros} where model is {model}\."):
        read(path)


def test_every_fault_of_every_file_is_in_one_error(folder: Folder, text: Callable[..., str]) -> None:
    path = folder(
        ("= 2.76", '= "2.76"'),
        ('"body_fr"', "3"),
        ('load = "ballast"', 'load = "x"\nwheels = ["xx"]'),
        ("[known]", "[known]\nk_fs = 1\nm_s = 0"),
        one="",
        two=text().replace("0.0100,", "oops,"),
    )
    with pytest.raises(InputError) as error:
        read(path)
    places = [problem.where for problem in error.value.problems]
    expected = (
        "vehicle.wheelbase",
        "sensor[2].channel",
        "drop[2].wheels[1] (two.csv)",
        "known.k_fs",
        "known.m_s",
    )
    assert places == [
        *(f"campaign.toml: {place}" for place in expected),
        "one.csv",
        "two.csv: line 7, column 'time'",
    ]


def test_no_drops_at_all(folder: Folder) -> None:
    path = folder()
    content = (path / "campaign.toml").read_text()
    (path / "campaign.toml").write_text(content.split("[[drop]]", maxsplit=1)[0])
    with pytest.raises(InputError, match=r"drop: found no drops; expected at least one \[\[drop\]\]"):
        read(path)


def test_text_that_is_not_utf8_is_named_by_its_line(folder: Folder) -> None:
    path = folder() / "campaign.toml"
    path.write_bytes(path.read_text().replace('"car"', '"Käfer"').encode("latin-1"))
    with pytest.raises(InputError, match=r"campaign\.toml: line 3: .* Save the file as UTF-8"):
        read(path)


def test_lists_in_each_other_are_no_defect_of_the_program(folder: Folder) -> None:
    path = folder(("wheelbase = 2.76", "wheelbase = " + "[" * 5000 + "]" * 5000))
    with pytest.raises(InputError, match=r"campaign\.toml: found lists or tables in each other, thousands deep"):
        read(path)


def test_a_missing_campaign_file_names_its_neighbour(folder: Folder) -> None:
    path = folder()
    with pytest.raises(InputError, match=r"no such file.*Did you mean 'campaign\.toml'\?"):
        read(path / "campagne.toml")
    with pytest.raises(InputError, match="no such file"):
        read(path / "elsewhere" / "campaign.toml")


def test_a_folder_of_recordings_without_a_campaign_file_is_to_be_drafted(folder: Folder) -> None:
    path = folder()
    (path / "campaign.toml").unlink()
    with pytest.raises(InputError, match=r"no such file.*Draft it from the recordings: `sprung new .*`"):
        read(path)


def test_a_recording_in_place_of_the_campaign_file(folder: Folder) -> None:
    with pytest.raises(InputError, match=r"one\.csv: line 1, column .*Give the campaign file"):
        read(folder() / "one.csv")


VEHICLE_FAULTS: dict[str, tuple[tuple[str, str], tuple[str, ...]]] = {
    "unknown parameter": (("k_sf = 17000", "k_sf = 17000\nk_fs = 1"), ("parameters: found 'k_fs'", "Did you mean 'k_")),
    "missing parameter": (("k_sf = 17000\n", ""), ("parameters: found no 'k_sf'", "spring rate", "Add k_sf = ...")),
    "impossible parameter": (("m_s = 1380", "m_s = -1380"), ("parameters.m_s: found -1380", "positive number, kg")),
    "text for a number": (("I_xx = 380", 'I_xx = "380"'), ("parameters.I_xx", "Write a number, without quotes")),
    "no half-distance": (("t_f = 0.74\n", ""), ("parameters.t_f", "either t_f, or t_f1 (dampers) and t_f2 (springs)")),
    "wheelbase beyond a + b": (("b = 1.51", "b = 1.6"), ("vehicle.wheelbase", "a + b = 2.85 m")),
    "unknown load": (('load = "ballast"', 'load = "x"'), ("drop[2].load", "'x'", "[[load]]")),
    "misspelt section": (("[parameters]", "[parameter]"), ("unknown key 'parameter'", "Did you mean 'parameters'?")),
    "bump in millimetres": (
        ("[known]", "[bump]\nheight = 40\n[known]"),
        ("bump.height: found 40; expected 0.002 to 0.6 m, the range of bumps", "0.04 if it was stated in mm"),
    ),
    "long bump": (
        ("[known]", "[bump]\nlength = 300\n[known]"),
        ("bump.length: found 300", "0.3 if it was stated in mm"),
    ),
    "force in kilonewtons": (("[known]", "[push]\nforce = 0.9\n[known]"), ("push.force", "900 if it was stated in kN")),
}


@pytest.mark.parametrize(("change", "words"), VEHICLE_FAULTS.values(), ids=VEHICLE_FAULTS)
def test_a_fault_of_a_vehicle_file_is_said_once_and_exactly(
    vehicle_file: Folder, change: tuple[str, str], words: tuple[str, ...]
) -> None:
    with pytest.raises(InputError) as error:
        read_vehicle(vehicle_file(change))
    message = str(error.value)
    for word in words:
        assert word in message
    assert "VEHICLE.toml: " in message
    assert len(error.value.problems) == 1

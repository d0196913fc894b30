"""The form of a campaign: what the file says, what is wrong beside its field, and what was entered as changes of the file."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from sprung.app.campaign_form import CampaignForm, Field, campaign_form
from sprung.app.campaign_text import apply_changes
from sprung.app.decimals import number_literal
from sprung.app.form_actions import apply_action
from sprung.app.form_changes import understand, with_problems
from sprung.campaign import schema_text
from sprung.errors import InputError

DATA = sorted((Path(__file__).parents[1] / "data").glob("*/campaign.toml"))

FILE = """schema = 1
[vehicle]
name = "Van"
wheelbase = "TODO: m, front axle to rear axle"    # by tape
[known]
total_mass = 1194      # scales
[[sensor]]
channel = "body_fl"
on = "body"
position = [0.10, 0.58, 0.50]
[[sensor]]
channel = "body_fr"
on = "body"
position = "TODO: [x, y, z], m"
[[sensor]]
channel = "body_rl"
on = "body"
position = [-2.65, 0.560, 0.50]
unit = "parsec"
[[load]]
name = "sandbags"
items = [{ mass = 235, position = [-1.2, 0.4, 1.1] }]
[[drop]]
file = "a.csv"
wheels = ["fl", "fr"]
[[drop]]
file = "b.csv"
load = "sandbag"
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "a.csv").write_text("t,a\n")
    return tmp_path / "campaign.toml"


def form_of(text: str, path: Path) -> CampaignForm:
    return campaign_form(text, path)[0]


def field(form: CampaignForm, name: str) -> Field:
    return next(each for each in form.fields() if each.name == name)


def entered(form: CampaignForm, **values: str | list[str]) -> dict[str, list[str]]:
    """What a browser sends: every input, some of them changed."""
    sent: dict[str, list[str]] = {}
    for each in form.fields():
        for part in each.parts:
            sent[part.name] = ["", *each.chosen] if each.kind == "several" else [part.value]
    for name, value in values.items():
        key = name.replace("__", ".")
        assert key in sent, key
        sent[key] = [value] if isinstance(value, str) else ["", *value]
    return sent


def save(text: str, path: Path, **values: str | list[str]) -> str:
    form = form_of(text, path)
    understood = understand(form, entered(form, **values))
    assert not understood.problems
    return apply_changes(text, understood.changes)


def test_every_key_of_the_schema_is_a_field() -> None:
    """By the schema that editors use; sections and items are groups of the form."""
    import json  # noqa: PLC0415

    from sprung.app.form_fields import section_specs  # noqa: PLC0415

    definitions: dict[str, Any] = json.loads(schema_text())["$defs"]
    models = {"vehicle": "VehicleSection", "test": "TestRecord", "model": "ModelChoice"}
    models |= {"sensor": "Sensor", "load": "Load", "item": "Item", "drop": "Drop"}
    for section, model in models.items():
        keys = {spec.key.partition(".")[0] for spec in section_specs(section)}
        assert keys == set(definitions[model]["properties"]) - {"items"}


def test_it_shows_numbers_as_they_are_written(path: Path) -> None:
    form = form_of(FILE, path)
    assert [part.value for part in field(form, "sensor.0.position").parts] == ["0.10", "0.58", "0.50"]
    assert [part.value for part in field(form, "sensor.2.position").parts] == ["-2.65", "0.560", "0.50"]
    assert [part.value for part in field(form, "known.total_mass").parts] == ["1194", ""]
    assert field(form, "known.total_mass").spec.unit == "kg"
    assert field(form, "drop.0.wheels").chosen == ("fl", "fr")
    assert field(form, "drop.1.wheels").chosen == ("fl", "fr", "rl", "rr")  # the default


def test_problems_and_gaps_stand_beside_their_fields(path: Path) -> None:
    form = form_of(FILE, path)
    assert field(form, "vehicle.wheelbase").missing == "m, front axle to rear axle"
    assert field(form, "sensor.1.position").missing == "[x, y, z], m"
    (unit,) = field(form, "sensor.2.unit").problems
    assert unit.found == "'parsec'"
    (load,) = field(form, "drop.1.load").problems
    assert load.do == "Did you mean 'sandbags'?"
    (file,) = field(form, "drop.1.file").problems
    assert (file.found, file.do) == ("'b.csv', which is not there", "Correct the name, or put the recording there.")
    assert not field(form, "drop.0.file").problems
    assert (form.faulty, form.missing) == (3, 2)


def test_nothing_entered_changes_nothing(path: Path) -> None:
    assert save(FILE, path) == FILE


WRONG = """schema = 1
vehicle = { name = 3, model = "halved", wheelbase = "2.55", motion_ratio = { spring_front = [1] } }
test = { date = "yesterday" }
known = { k_sf = { value = 1, std = 2, more = 3 }, nothing = 4 }
model.extras = ["anti-rol"]
model.fall = 3
[[sensor]]
on = "wing"
position = [1, "b"]
[[load]]
items = [{ mass = "heavy", position = 5, on = 7 }, 3]
added = 4
[[drop]]
wheels = ["xx", "fl", 3]
load = ["a"]
window = [1, 2, 3]
files = 3
"""


@pytest.mark.parametrize("text", [WRONG, "sensor = 3\ndrop = [1, 2]\nload = { a = 1 }\nvehicle = []\n", ""])
def test_what_is_wrong_stays_until_somebody_changes_it(path: Path, text: str) -> None:
    assert save(text, path) == text


@pytest.mark.parametrize("file", DATA, ids=lambda file: file.parent.name)
def test_the_forms_of_whole_campaigns_change_nothing(file: Path) -> None:
    form = form_of(file.read_text(), file)
    assert understand(form, entered(form)).changes == ()
    assert (form.faulty, form.missing) == (0, 0)


@pytest.mark.parametrize("comma", [".", ","])
def test_gaps_are_filled_with_a_decimal_point_or_comma(path: Path, comma: str) -> None:
    text = save(
        FILE,
        path,
        vehicle__wheelbase__value=f"2{comma}55",
        vehicle__wheelbase__std=f"0{comma}005",
        sensor__1__position__0=f"0{comma}10",
        sensor__1__position__1=f"\N{MINUS SIGN}0{comma}58",
        sensor__1__position__2=f"0{comma}5",
    )
    lines = dict(zip(FILE.splitlines(), text.splitlines(), strict=True))
    assert {old: new for old, new in lines.items() if old != new} == {
        'wheelbase = "TODO: m, front axle to rear axle"    # by tape': "wheelbase = { value = 2.55, std = 0.005 }    # by tape",
        'position = "TODO: [x, y, z], m"': "position = [0.10, -0.58, 0.5]",
    }


def test_each_kind_of_field(path: Path) -> None:
    text = save(
        FILE,
        path,
        known__total_mass__std="2",
        sensor__0__position__1="0,6",
        sensor__2__unit="",
        sensor__2__direction="down",
        drop__0__wheels=["rl", "fl"],
        drop__1__load="sandbags",
        drop__1__start="1.5",
        load__0__items__0__mass__value="240",
        test__date="22.11.2026",
        model__extras=["friction"],
        model__fall="true",
    )
    assert "total_mass = { value = 1194, std = 2 }      # scales" in text
    document = tomllib.loads(text)
    assert document["sensor"][0]["position"] == [0.1, 0.6, 0.5]
    assert document["sensor"][2] == {
        "channel": "body_rl",
        "on": "body",
        "position": [-2.65, 0.56, 0.5],
        "direction": "down",
    }
    assert document["drop"] == [
        {"file": "a.csv", "wheels": ["fl", "rl"]},
        {"file": "b.csv", "load": "sandbags", "start": 1.5},
    ]
    assert document["load"][0]["items"][0]["mass"] == 240
    assert str(document["test"]["date"]) == "2026-11-22"
    assert document["model"] == {"extras": ["friction"], "fall": True}
    again = save(text, path, known__total_mass__std="", model__extras=[], model__fall="")
    assert tomllib.loads(again)["known"] == {"total_mass": {"value": 1194}}
    assert tomllib.loads(again)["model"] == {}


@pytest.mark.parametrize(
    ("name", "value", "found"),
    [
        ("vehicle__wheelbase__value", "two", "'two'"),
        ("vehicle__wheelbase__std", "0.1", "a standard uncertainty without a value"),
        ("vehicle__cg_height", "1.194,5", "'1.194,5'"),
        ("sensor__1__position__0", "1", "no y"),
        ("test__date", "yesterday", "'yesterday'"),
        ("test__date", "31.02.2026", "'31.02.2026'"),
        ("test__date", "٢٠٢٦-11-22", "'٢٠٢٦-11-22'"),
    ],
)
def test_what_cannot_be_understood_is_said_and_kept_on_the_page(path: Path, name: str, value: str, found: str) -> None:
    form = form_of(FILE, path)
    given = entered(form, **{name: value})
    understood = understand(form, given)
    assert apply_changes(FILE, understood.changes) == FILE
    assert [problem.found for problem in understood.problems.values()] == [found]
    shown = with_problems(form, given, understood.problems)
    assert shown.faulty == form.faulty + 1
    input_name = name.replace("__", ".")
    assert next(part.value for each in shown.fields() for part in each.parts if part.name == input_name) == value


@pytest.mark.parametrize(
    ("text", "literal"),
    [
        ("2,55", "2.55"),
        ("+0.10", "0.10"),
        ("-.5", "-0.5"),
        ("5.", "5.0"),
        ("007", "7"),
        ("1 194,5", "1194.5"),
        ("2e-3", "2e-3"),
        ("1,5E3", "1.5E3"),
        ("0x10", None),
        ("1.194,5", None),
        ("inf", None),
        ("٢", None),
        ("2e٢", None),
        ("", None),
        ("1-2", None),
    ],
)
def test_numbers(text: str, literal: str | None) -> None:
    assert number_literal(text) == literal
    if literal is not None:
        tomllib.loads(f"x = {literal}")


def test_sections_are_added_and_removed(path: Path) -> None:
    text = FILE
    for action in (
        "add sensor",
        "add load",
        "add item load.1",
        "add drop b c.csv",
        "add known k_sf",
        "remove sensor.2",
    ):
        text = apply_action(text, action)
    form = form_of(text, path)
    names = [group.name for group in form.groups]
    assert names[4:] == ["sensor.0", "sensor.1", "sensor.2", "load.0", "load.1", "drop.0", "drop.1", "drop.2"]
    assert field(form, "sensor.2.channel").missing == "name of the column in the recordings"
    assert field(form, "load.1.items.1.mass").missing == "kg"
    assert field(form, "known.k_sf").missing
    assert field(form, "drop.2.file").parts[0].value == "b c.csv"
    for action in ("remove load.1.items.0", "remove load.1", "remove known.k_sf", "remove drop.2", "remove sensor.2"):
        text = apply_action(text, action)
    assert tomllib.loads(text)["load"] == tomllib.loads(FILE)["load"]


@pytest.mark.parametrize(
    "action", ["", "add", "add wheel", "remove", "remove sensor.9", "add item load.7", "add item x", "eat"]
)
def test_no_other_action(action: str) -> None:
    with pytest.raises(InputError):
        apply_action(FILE, action)


def test_three_hundred_drops_are_few_enough_inputs(path: Path) -> None:
    text = FILE + "".join(f'[[drop]]\nfile = "{number}.csv"\nwheels = ["fl"]\n' for number in range(300))
    inputs = sum(
        len(each.choices) if each.kind == "several" else len(each.parts) for each in form_of(text, path).fields()
    )
    assert inputs < 5000  # what a form may have


def test_what_cannot_be_written_hinders_nothing_else(path: Path) -> None:
    """Items in sections of their own, [[load.items]], can be changed but not continued by a form."""
    from sprung.app.form_view import form_view  # noqa: PLC0415 (imports the drawings)

    text = FILE.replace("items = [{ mass = 235, position = [-1.2, 0.4, 1.1] }]", "[[load.items]]\nmass = 235")
    given = {
        "vehicle.name": ["Lorry"],
        "load.0.name": ["bricks"],
        "load.0.items.0.mass.value": ["240"],
        "load.0.items.0.mass.std": [""],
    }
    view = form_view(str(path), text, given)
    assert (view["refused"], view["unclear"]) == ([], 0)
    assert tomllib.loads(view["text"])["load"][0] == {"name": "bricks", "items": [{"mass": 240}]}
    with pytest.raises(InputError, match="Change it in the text of the file"):
        form_view(str(path), text, given, "add item load.0")


LOADS = """[[load]]
name = "loaded"
items = "TODO: [ { mass = ..., position = [x, y, z] }, ... ], kg and m, one for each piece of this load"
[[load]]
name = "guests"
added = "TODO: totals"
[[load]]
name = "none"
"""


def viewed(text: str, path: Path, action: str = "", **values: str) -> dict[str, Any]:
    """What the page shows after something was entered or a button was pressed."""
    from sprung.app.form_view import form_view  # noqa: PLC0415 (imports the drawings)

    return form_view(str(path), text, entered(form_of(text, path), **values), action)


def test_a_load_that_is_not_described_is_marked_at_the_load(path: Path) -> None:
    view = viewed(LOADS, path)
    gaps = {group["name"]: len(group["gaps"]) for group in view["form"]["groups"] if group["section"] == "load"}
    assert gaps == {"load.0": 1, "load.1": 1, "load.2": 1}
    assert [each["text"] for each in view["form"]["where"]] == ["Load 1: loaded", "Load 2: guests", "Load 3: none"]
    assert view["form"]["missing"] == 3


def test_every_missing_place_is_in_the_list_of_places(path: Path) -> None:
    text = FILE.replace("std = 2", "").replace('load = "sandbag"', 'load = "sandbags"\nstart = 2\nend = 1') + LOADS
    text = text.replace("wheelbase = ", "cg_height = { value = 'TODO: m' }\nwheelbase = ").replace(
        "position = [-2.65, 0.560, 0.50]", "position = [-2.65, 'TODO: y', 0.50]"
    )
    form = viewed(text, path)["form"]
    assert form["missing"] == 7
    assert [each["text"] for each in form["where"]] == [
        *("Vehicle, Wheelbase", "Vehicle, Height of the centre of gravity"),
        *("Sensor 2: body_fr, Position", "Sensor 3: body_rl, Position"),
        *("Load 2: loaded", "Load 3: guests", "Load 4: none"),
        *("Drop 2: b.csv", "Drop 2: b.csv, Recording"),  # end before start: a problem of no single field
    ]


def test_totals_and_pieces_of_a_load_take_the_place_of_what_marks_that_the_others_are_missing(path: Path) -> None:
    values = {"load__0__added__mass__value": "100", "load__0__added__I_yy": "57,5", "load__1__added__mass__value": "3"}
    view = viewed(LOADS, path, **values)
    assert tomllib.loads(view["text"])["load"] == [
        {"name": "loaded", "added": {"mass": 100, "I_yy": 57.5}},
        {"name": "guests", "added": {"mass": 3}},
        {"name": "none"},
    ]
    assert [each["text"] for each in view["form"]["where"]] == ["Load 3: none"]
    back = viewed(view["text"], path, load__0__added__mass__value="", load__0__added__I_yy="")
    assert tomllib.loads(back["text"])["load"][0] == {"name": "loaded"}  # no load of 0 kg
    for load in ("load.0", "load.1"):
        (description,) = (
            viewed(LOADS, path, f"add item {load}")["text"].split("[[load]]")[int(load[-1]) + 1].splitlines()[2:]
        )
        assert description.startswith('items = [{ mass = "TODO: kg"')
    both = viewed(apply_action(LOADS, "add item load.0"), path, load__0__items__0__mass__value="5")["text"]
    both = viewed(both, path, load__0__added__mass__value="100")["text"]
    assert tomllib.loads(both)["load"][0].keys() == {"name", "items", "added"}  # a piece that was entered stays


def test_what_may_remain_unknown_can_be_left_out(path: Path) -> None:
    text = '[known]\ntotal_mass = "TODO: kg, on the scales: a number or { value = ... }; or remove this line"\n'
    text += "[[sensor]]\nchannel = 'a'\nhigh_pass = 'TODO: Hz; remove the line if it has none, or it is not known'\n"
    form = form_of(text, path)
    left_out = {each.name: each.missing for each in form.fields() if each.may_be_left_out}
    assert left_out == {"known.total_mass": "kg, on the scales", "sensor.0.high_pass": "Hz"}
    for name in left_out:
        text = apply_action(text, f"remove {name}")
    assert "TODO" not in text
    assert not field(form_of(text, path), "known.total_mass").stated  # it can still be entered


def test_drops_keep_a_load_that_is_renamed(path: Path) -> None:
    text = (
        FILE.replace('load = "sandbag"', 'load = "sandbags"') + '[[load]]\nname = "driver"\n[[drop]]\nload = "driver"\n'
    )
    document = tomllib.loads(save(text, path, load__0__name="bricks", drop__0__load="driver"))
    assert [drop.get("load") for drop in document["drop"]] == ["driver", "bricks", "driver"]
    swapped = tomllib.loads(save(text, path, load__0__name="driver", load__1__name="sandbags"))
    assert [drop.get("load") for drop in swapped["drop"]] == [None, "driver", "sandbags"]

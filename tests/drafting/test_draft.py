"""Drafts of campaigns: sessions whose sensors, drops and loads are known, written down without saying any of it."""

from __future__ import annotations

import tomllib
from dataclasses import fields
from datetime import date
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import sprung
from days import Day, day
from layouts import check_view_is_whole
from sessions import NEUTRAL, fill_in, write_session, write_table
from sprung.campaign import Campaign
from sprung.campaign import TestRecord as Record
from sprung.drafting import DraftCampaign
from sprung.drafting.names import axis_named, load_named, part_named, station_named, wheels_named
from sprung.drafting.text import campaign_text
from sprung.errors import InputError
from sprung.progress import Step
from sprung.report import draft_view
from sprung.simulation import simulate
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import TABLE_1_CAR, WHEELS, Load, Wheel

LOAD = {
    "name": "ballast",
    "items": [{"mass": 140.0, "position": [-1.0, 0.2, 0.6]}, {"mass": 60.0, "position": [-2.6, 0, 0.6]}],
}
DAY: tuple[tuple[Wheel, ...], ...] = (WHEELS, ("fl", "fr"), ("rl", "rr"), ("fl", "rl"), ("fr", "rr"))
PARAMETERS = ("m_s", "I_yy", "I_xx", "m_uf", "m_ur", "k_sf", "k_sr", "k_tf", "k_tr", "c_sf", "c_sr", "a")


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    """The paper's car, five drops empty and five with ballast."""
    return simulate(TABLE_1_CAR, loads=[LOAD], noise=0.02, seed=1)


@pytest.fixture(scope="module")
def one_day() -> Day:
    """The same five drops in one long recording, with people at work between them."""
    return day(TABLE_1_CAR, DAY, np.random.default_rng(1), rate=250.0, disturbances=1)


def known(draft: DraftCampaign) -> dict[str, str | None]:
    return {sensor.channel: sensor.on for sensor in draft.sensors}


def truth(names: tuple[str, ...] = NEUTRAL) -> dict[str, str]:
    return dict(zip(names, ("body",) * 4 + WHEELS, strict=True))


def positions(campaign: Campaign) -> dict[str, str]:
    return {
        f"position of {name}": str(list(sensor.position))
        for name, sensor in zip(NEUTRAL, campaign.sensors, strict=True)
        if sensor.position is not None
    }


def test_a_session_with_neutral_names_is_drafted_filled_in_and_identified(tmp_path: Path, campaign: Campaign) -> None:
    write_session(tmp_path, campaign)
    draft = sprung.draft(tmp_path)
    assert known(draft) == truth()
    assert [(drop.files[0], drop.load, drop.wheels, drop.window) for drop in draft.drops] == sorted(
        (drop.file, drop.load, drop.wheels, None) for drop in campaign.drops
    )
    corners = [sensor.corner for sensor in draft.sensors if sensor.on == "body"]
    assert corners == ["fl", "fr", "rl", "rr"]
    check_view_is_whole(draft_view(draft), tables=2)
    path = draft.write()
    with pytest.raises(InputError) as caught:
        sprung.read(path)
    assert [problem.where.partition(": ")[2] for problem in caught.value.problems] == [
        where for where, _ in draft.missing
    ]
    assert len(draft.missing) == 7  # wheelbase, mass on the scales, four positions, the load
    items = "[{ mass = 140, position = [-1.0, 0.2, 0.6] }, { mass = 60, position = [-2.6, 0, 0.6] }]"
    fill_in(path, {"wheelbase": "2.76", "total_mass": "", "items": items, **positions(campaign)})
    result = sprung.identify(sprung.read(path))
    assert result.verdict.state == "accept"
    for name in PARAMETERS:
        estimate = result.parameters[name]
        assert estimate.value is not None
        assert estimate.std is not None
        # Five of its own standard uncertainties: chance exceeds that in one of 100000 sets of twelve.
        assert abs(estimate.value - getattr(TABLE_1_CAR, name)) < 5 * estimate.std
        assert estimate.std < 0.05 * estimate.value


def test_a_whole_day_in_one_file_becomes_windows(tmp_path: Path, one_day: Day) -> None:
    names = tuple(sensor.channel for sensor in one_day.sensors)
    write_table(tmp_path / "day.csv", one_day.values, one_day.rate, names, start=100.0)
    draft = sprung.draft(tmp_path)
    assert known(draft) == truth(names)
    assert [drop.found.release for drop in draft.drops] == pytest.approx(
        [100 + time for time in one_day.releases], abs=0.01
    )
    assert [drop.wheels for drop in draft.drops] == list(DAY)
    assert [drop.load for drop in draft.drops] == [None] * 5
    for drop in draft.drops:
        assert drop.window is not None
        assert drop.window[0] < drop.found.release < drop.window[1]
    path = draft.write()
    placed = {
        f"position of {sensor.channel}": str(list(sensor.position)) for sensor in one_day.sensors if sensor.position
    }
    fill_in(path, {"wheelbase": "2.76", "total_mass": "1551.8", "load": '"empty"', **placed})
    read = sprung.read(path)
    assert [drop.window for drop in read.drops] == [pytest.approx(drop.window, abs=6e-4) for drop in draft.drops]
    result = sprung.identify(read)
    assert result.verdict.state == "accept"
    for name in PARAMETERS:
        estimate = result.parameters[name]
        assert estimate.value is not None
        assert estimate.std is not None
        assert abs(estimate.value - getattr(TABLE_1_CAR, name)) < 5 * estimate.std + 1e-9


def told(folder: Path, values: NDArray[np.float64], rate: float, names: tuple[str, ...] = NEUTRAL) -> DraftCampaign:
    write_table(folder / "day.csv", values, rate, names)
    return sprung.draft(folder)


@pytest.mark.parametrize(("unit", "size"), [("g", 1 / STANDARD_GRAVITY), ("m/s^2", 1.0), ("mm/s^2", 1e3)])
def test_gravity_tells_unit_and_direction(tmp_path: Path, one_day: Day, unit: str, size: float) -> None:
    signs = np.array([1, -1, 1, 1, -1, 1, 1, -1])
    draft = told(tmp_path, one_day.values * size * signs[:, None], one_day.rate)
    assert [sensor.unit for sensor in draft.sensors] == [unit] * 8
    assert [sensor.direction for sensor in draft.sensors] == ["up" if sign > 0 else "down" for sign in signs]
    assert {sensor.coupling for sensor in draft.sensors} == {"DC"}
    assert len(draft.drops) == 5
    written = tomllib.loads(draft.text)["sensor"]
    assert [sensor["unit"] for sensor in written] == [unit] * 8
    assert [sensor.get("direction", "up") for sensor in written] == [sensor.direction for sensor in draft.sensors]


@pytest.mark.parametrize(("unit", "gravity"), [("mg", 1000.0), ("cm/s^2", 980.665)])
def test_units_that_differ_little_are_told_by_all_channels_together(
    tmp_path: Path, campaign: Campaign, unit: str, gravity: float
) -> None:
    recording = campaign.recordings[0]
    draft = told(tmp_path, recording.values / STANDARD_GRAVITY * gravity, recording.rate)
    assert {sensor.unit for sensor in draft.sensors} == {unit}
    assert all("2 % less or more" in " ".join(sensor.notes) for sensor in draft.sensors)


def test_gravity_knows_better_than_the_file(tmp_path: Path, one_day: Day) -> None:
    names = tuple(f"{name} [m/s^2]" for name in NEUTRAL)
    draft = told(tmp_path, one_day.values / STANDARD_GRAVITY, one_day.rate, names)
    assert {sensor.unit for sensor in draft.sensors} == {"g"}
    assert "though the file states m/s^2" in draft.text


@pytest.mark.parametrize("size", [1.0, 1 / STANDARD_GRAVITY, 1e3])
def test_sensors_without_gravity_show_which_way_they_point_when_they_fall(tmp_path: Path, size: float) -> None:
    coupled = day(TABLE_1_CAR, DAY, np.random.default_rng(2), rate=250.0, disturbances=1, high_pass=0.5)
    signs = np.array([1, -1, 1, 1, -1, 1, 1, -1])
    draft = told(tmp_path, coupled.values * size * signs[:, None], coupled.rate)
    assert [drop.found.release for drop in draft.drops] == pytest.approx(coupled.releases, abs=0.01)
    assert [sensor.on for sensor in draft.sensors] == ["body"] * 4 + ["wheel"] * 4
    assert [sensor.direction for sensor in draft.sensors] == ["up" if sign > 0 else "down" for sign in signs]
    assert {(sensor.coupling, sensor.unit) for sensor in draft.sensors} == {("AC", None)}
    asked = [where.partition(" ")[0].rpartition(".")[2] for where, _ in draft.missing]
    assert asked.count("high_pass") == asked.count("unit") == 8
    assert asked.count("on") == 4


def test_the_corner_of_a_body_sensor_is_told_whichever_way_it_points(tmp_path: Path) -> None:
    coupled = day(TABLE_1_CAR, DAY, np.random.default_rng(2), rate=250.0, disturbances=1, high_pass=0.5)
    signs = np.array([1, -1, -1, 1, -1, 1, 1, -1])
    names = (*NEUTRAL[:4], *(f"wheel {wheel}" for wheel in WHEELS))
    draft = told(tmp_path, coupled.values * signs[:, None], coupled.rate, names)
    assert [(sensor.on, sensor.corner) for sensor in draft.sensors[:4]] == [("body", wheel) for wheel in WHEELS]


def test_what_is_no_sensor_on_the_vehicle_is_left_out_with_the_reason(tmp_path: Path, one_day: Day) -> None:
    samples = one_day.values.shape[1]
    noise = np.random.default_rng(3).standard_normal((4, samples))
    others: dict[str, NDArray[np.float64]] = {
        "temperature [°C]": 21 + 0.01 * noise[0],
        "packet": np.arange(samples, dtype=float),
        "spare": np.zeros(samples),
        "trigger": 9.8 + 0.01 * noise[1],
        "ch9_x": noise[2],
        "ch9_z": 9.8 + 0.01 * noise[3],
    }
    draft = told(tmp_path, np.vstack([one_day.values, *others.values()]), one_day.rate, (*NEUTRAL, *others))
    assert known(draft).keys() == set(NEUTRAL)
    reasons = draft.files[0].left_out
    assert "no unit of acceleration" in reasons["temperature"]
    assert reasons["packet"] == "it is a counter"
    assert reasons["spare"] == "it reads 0 throughout"
    assert reasons["trigger"] == reasons["ch9_z"] == "no drop moves it"
    assert "along x" in reasons["ch9_x"]


def test_full_scale_shows_where_a_sensor_stays_at_its_extreme(tmp_path: Path, one_day: Day) -> None:
    values = one_day.values.copy()
    values[4] = np.clip(values[4], -50, 50)
    draft = told(tmp_path, values, one_day.rate)
    assert {sensor.channel: sensor.full_scale for sensor in draft.sensors if sensor.full_scale} == {"ch5": 50.0}
    assert "# range = 50" in draft.text


def test_two_loggers_of_one_drop_are_put_together(tmp_path: Path, campaign: Campaign) -> None:
    for recording in campaign.recordings[:5]:
        for logger, channels in (("A", slice(0, 4)), ("B", slice(4, 8))):
            path = tmp_path / f"{Path(recording.name).stem}_{logger}.csv"
            write_table(
                path, recording.values[channels], recording.rate, NEUTRAL[channels], start=7.0 * (logger == "B")
            )
    draft = sprung.draft(tmp_path)
    assert known(draft) == truth()
    assert [drop.files for drop in draft.drops] == [
        (f"{stem}_A.csv", f"{stem}_B.csv")
        for stem in ("empty_bounce", "empty_pitch_front", "empty_pitch_rear", "empty_roll_left", "empty_roll_right")
    ]
    assert tomllib.loads(draft.text)["drop"][0]["files"] == ["empty_bounce_A.csv", "empty_bounce_B.csv"]
    assert [drop.wheels for drop in draft.drops] == [drop.wheels for drop in campaign.drops[:5]]


@pytest.mark.parametrize(
    "loggers",
    [
        pytest.param(tuple("ABCDEFGH"), id="letters"),
        pytest.param(
            (*(f"body_{i}" for i in range(1, 5)), "front_left", "front_right", "rear_left", "rear_right"),
            marks=pytest.mark.long,
            id="places",
        ),
    ],
)
@pytest.mark.slow
def test_wireless_loggers_that_all_call_their_channel_z(
    tmp_path: Path, campaign: Campaign, loggers: tuple[str, ...]
) -> None:
    random = np.random.default_rng(1)
    for drop, recording in zip(campaign.drops, campaign.recordings, strict=True):
        for logger, values in zip(loggers, recording.values, strict=True):
            first = int(random.integers(0, 60))  # no two are started together
            path = tmp_path / f"{drop.label}_{logger}.csv"
            write_table(path, values[None, first:], recording.rate, ("z",), start=float(random.uniform(0, 100)))
    draft = sprung.draft(tmp_path)
    assert {sensor.logger: sensor.on for sensor in draft.sensors} == dict(zip(loggers, truth().values(), strict=True))
    assert sorted((drop.load, drop.wheels) for drop in draft.drops) == sorted(
        (drop.load, drop.wheels) for drop in campaign.drops
    )
    path = draft.write()
    assert {sensor["channel"] for sensor in tomllib.loads(draft.text)["sensor"]} == {"z"}
    # Every gap of a position is of a channel z: they are filled in one after the other.
    blank, lines = "position = ", path.read_text().splitlines()
    places = iter(
        next(
            list(one.position or ())
            for name, one in zip(loggers, campaign.sensors, strict=True)
            if name == sensor.logger
        )
        for sensor in draft.sensors
        if sensor.on == "body"
    )
    path.write_text("\n".join(f"{blank}{next(places)}" if line.startswith("position") else line for line in lines))
    items = "[{ mass = 140, position = [-1.0, 0.2, 0.6] }, { mass = 60, position = [-2.6, 0, 0.6] }]"
    fill_in(path, {"wheelbase": "2.76", "total_mass": "", "items": items})
    read = sprung.read(path)
    assert len(read.recordings[0].parts) == 8
    check = sprung.check(read)
    assert all(drop.start is not None for drop in check.drops)
    assert {fault.code for fault in check.faults} <= {"clock"}


def test_recordings_that_cannot_be_read_are_named_with_the_reason(tmp_path: Path, campaign: Campaign) -> None:
    write_session(tmp_path, campaign)
    (tmp_path / "broken.csv").write_text("")
    (tmp_path / "notes.txt").write_text("It rained.\n")
    (tmp_path / "photo.jpg").write_bytes(b"\xff\xd8")
    draft = sprung.draft(tmp_path)
    assert set(draft.unreadable) == {"broken.csv", "notes.txt"}
    assert "# Not read: broken.csv: an empty file." in draft.text


def test_every_draft_explains_how_a_load_is_described() -> None:
    text = campaign_text(DraftCampaign(folder=Path(), name="car", sensors=(), drops=(), files=(), unreadable={}))
    assert "load" not in tomllib.loads(text)
    head, name, first, second, _, added = (
        line.removeprefix("# ") for line in text[text.index("# [[load]]") :].splitlines()[:6]
    )
    for lines, mass in (((head, name, first, second), 255), ((head, name, added), 470)):
        (load,) = tomllib.loads("\n".join(lines))["load"]
        assert Load(**load).total_mass() == mass


def test_every_draft_has_a_record_of_the_test_to_fill_in() -> None:
    text = campaign_text(DraftCampaign(folder=Path(), name="car", sensors=(), drops=(), files=(), unreadable={}))
    lines = text[text.index("# [test]") :].split("\n\n")[0].splitlines()
    [record] = tomllib.loads("\n".join(line.removeprefix("# ") for line in lines)).values()
    assert record.keys() == {field.name for field in fields(Record)}
    assert record["date"] == date(2026, 11, 22)


def test_subfolders_tell_the_load(tmp_path: Path, campaign: Campaign) -> None:
    for drop, recording in zip(campaign.drops, campaign.recordings, strict=True):
        folder = "leer" if drop.load == "empty" else "Sandsäcke 200 kg"
        write_table(tmp_path / folder / recording.name.partition("_")[2], recording.values, recording.rate)
    draft = sprung.draft(tmp_path)
    assert [drop.load for drop in draft.drops] == ["empty"] * 5 + ["200kg"] * 5
    assert draft.loads == ("200kg",)


def test_wheels_contradict_the_name_of_the_file(tmp_path: Path, campaign: Campaign) -> None:
    names = tuple(sensor.channel for sensor in campaign.sensors)
    for recording in campaign.recordings[:5]:
        write_table(tmp_path / recording.name, recording.values, recording.rate, names)
    (tmp_path / "empty_pitch_front.csv").rename(tmp_path / "swap.csv")
    (tmp_path / "empty_pitch_rear.csv").rename(tmp_path / "empty_pitch_front.csv")
    draft = sprung.draft(tmp_path)
    front = next(drop for drop in draft.drops if drop.files == ("empty_pitch_front.csv",))
    assert front.wheels == ("rl", "rr")
    assert "these wheels fell, though the name of the file states fl, fr" in front.notes


def test_without_a_drop_everything_is_refused_with_the_reasons(tmp_path: Path) -> None:
    quiet = 9.8 + 0.02 * np.random.default_rng(4).standard_normal((8, 4000))
    write_table(tmp_path / "quiet.csv", quiet, 500.0)
    (tmp_path / "empty.csv").write_text("")
    with pytest.raises(InputError) as caught:
        sprung.draft(tmp_path)
    assert [problem.where for problem in caught.value.problems] == ["quiet.csv", "empty.csv"]
    assert "no drop: it shows no motion" in str(caught.value)


def test_progress_runs_from_nothing_to_everything(tmp_path: Path, campaign: Campaign) -> None:
    write_session(tmp_path, campaign)
    steps: list[Step] = []
    sprung.draft(tmp_path, progress=steps.append)
    seen = [step.done for step in steps if step.done is not None]
    assert len(seen) == len(steps)
    assert seen == sorted(seen)
    assert seen[0] == 0.0
    assert seen[-1] == pytest.approx(1.0)
    assert {step.step for step in steps} == set(range(1, len(campaign.recordings) + 1))


@pytest.mark.parametrize(
    ("name", "station", "part"),
    [
        ("body_fl", "fl", "body"),
        ("Rad VL", "fl", "wheel"),
        ("AxleBodyFL", "fl", None),
        ("Aufbau hinten rechts", "rr", "body"),
        ("left_rear_wheel", "rl", "wheel"),
        ("HA_R", "rr", None),
        ("wheel_f_l", "fl", "wheel"),
        ("AccHRz", "rr", None),
        ("unsprungRL", "rl", "wheel"),
        # ISO/TS 13499: test object, position, main and fine location, dimension, direction, filter class
        ("10WHEL0100FLACZP", "fl", "wheel"),
        ("11AXLELE00FRACZA", "fl", "wheel"),
        ("ch1", None, None),
        ("Chassis rear", None, "body"),
    ],
)
def test_names_of_channels(name: str, station: Wheel | None, part: str | None) -> None:
    assert station_named(name) == station
    assert part_named(name) == part


@pytest.mark.parametrize(
    ("name", "load", "wheels"),
    [
        ("empty_bounce.csv", "empty", WHEELS),
        ("2024-05-03 beladen hinten.mf4", "loaded", ("rl", "rr")),
        ("unloaded/fl_rr.csv", "empty", ("fl", "rr")),
        ("mit Ballast/vl.csv", "ballast", ("fl",)),
        ("with_200kg_left.tdms", "200kg", ("fl", "rl")),
        ("drop 3.csv", None, ()),
    ],
)
def test_names_of_files(name: str, load: str | None, wheels: tuple[Wheel, ...]) -> None:
    assert load_named(name) == load
    assert wheels_named(name) == wheels


def test_an_axis_is_one_only_beside_its_sisters() -> None:
    assert axis_named("acc_x", ("acc_x", "acc_y", "acc_z")) == "x"
    assert axis_named("acc_x", ("acc_x",)) is None
    assert axis_named("max", ("max", "maz_2")) is None
    assert axis_named("10WHEL0100FLACXP", ()) == "x"


def test_drops_of_which_no_name_tells_the_load_are_grouped_by_how_they_swing(
    tmp_path: Path, campaign: Campaign
) -> None:
    for number, recording in enumerate(campaign.recordings):
        write_table(tmp_path / f"run{number}.csv", recording.values, recording.rate)
    draft = sprung.draft(tmp_path)
    # Five drops empty, then the same five with ballast, 200 kg on 1552 kg.
    assert [drop.load for drop in draft.drops] == ["empty"] * 5 + ["loaded"] * 5
    assert "swings more slowly than others of the same wheels" in draft.drops[7].notes[-1]
    assert any(what.startswith("which load?") for where, what in draft.missing if where == "load[1].items (loaded)")
    assert "# 5 drops swing more slowly" in draft.text

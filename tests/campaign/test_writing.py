from __future__ import annotations

import dataclasses
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sprung.campaign import Campaign, Drop, DropTest, ModelChoice, Recording, read, write
from sprung.campaign.comments import SECTIONS, describe_key
from sprung.errors import InputError
from sprung.files import atomic_write
from sprung.files.ownership import MANIFEST
from sprung.simulation import simulate
from sprung.uncertainty import KnownValue
from sprung.units import split_unit
from sprung.vehicle import EMPTY, TABLE_1_CAR, Added, Item, Load, Sensor

if TYPE_CHECKING:
    from collections.abc import Callable

deviations = st.floats(1e-3, 1e4)
numbers = st.floats(-1e4, 1e4)
names = st.text("abcXYZ_ ,;\"'()µ°0123456789.-", min_size=1, max_size=8).filter(lambda text: text == text.strip())


@st.composite
def sensors(draw: st.DrawFn) -> tuple[Sensor, ...]:
    channels = draw(
        st.lists(
            st.builds(str.__add__, names, st.sampled_from(["", " [g]", " (mg)", " (left)"])),
            min_size=4,
            max_size=4,
            unique_by=lambda channel: split_unit(channel)[0],
        )
    )
    places: list[tuple[Any, Any]] = [("body", (0, 1, 2)), ("body", (1, -1, 2)), ("body", (-3.25, 0.1, 2)), ("rl", None)]
    return tuple(
        Sensor(
            channel=channel,
            on=on,
            position=position,
            unit=draw(st.sampled_from([None, "g", "m/s^2", "mg"])),
            direction=draw(st.sampled_from(["up", "down"])),
            range=draw(st.none() | st.floats(1, 1e4)),
            high_pass=draw(st.none() | st.floats(1e-3, 30)),
            logger=draw(st.none() | names),
        )
        for channel, (on, position) in zip(channels, places, strict=True)
    )


@st.composite
def campaigns(draw: st.DrawFn) -> Campaign:
    load = draw(
        st.sampled_from(
            [
                Load(
                    name='a "b"', items=(Item(mass=1.5, position=(0, 1, -0.5)), Item(mass=0.1, on="fl", inertia=(1, 2)))
                ),
                Load(name="totals", added=Added(mass=470, I_yy=1057.5, I_xx=339.6)),
            ]
        )
    )
    where = draw(sensors())
    files = draw(
        st.lists(
            st.sampled_from(["a.csv", "sub/a.csv", "b c.CSV", "d.txt", "e.f.csv"]), min_size=1, max_size=3, unique=True
        )
    )
    drops = []
    for file in files:
        samples = draw(st.integers(2, 12))
        values = np.array(draw(st.lists(st.lists(numbers, min_size=samples, max_size=samples), min_size=4, max_size=4)))
        if draw(st.booleans()):
            values[draw(st.integers(0, 3))] = np.nan
        start, rate = draw(st.floats(-10, 1e4)), draw(st.floats(64, 5000))
        channels = tuple(sensor.channel for sensor in where)
        drop = Drop(file=file, load=draw(st.sampled_from(["empty", load.name])), wheels=("rr", "fl"), start=None)
        drops.append(drop.with_recording(Recording(file, channels, values, start, rate)))
    # What a vehicle may have that carries these loads and sensors: reading refuses what none has.
    weighed = [("m_s", 200, 6e4), ("k_tf", 8e3, 5e7), ("total_mass", 200, 6e4)]
    return Campaign(
        name=draw(st.text(st.characters(codec="utf-8"), min_size=1, max_size=9)),
        sensors=where,
        drops=tuple(drops),
        loads=(EMPTY, load),
        wheelbase=draw(st.none() | st.builds(KnownValue, st.floats(1.5, 12), deviations)),
        cg_height=draw(st.none() | st.floats(0.1, 4)),
        wheel_height=draw(st.none() | st.floats(0.05, 1.2)),
        roll_axis_height=draw(st.none() | st.floats(-2, 3)),
        known=draw(
            st.sampled_from(weighed).flatmap(
                lambda one: st.dictionaries(
                    st.just(one[0]), st.builds(KnownValue, st.floats(one[1], one[2]), deviations), max_size=1
                )
            )
        ),
        model=draw(
            st.sampled_from(
                [ModelChoice(), ModelChoice(extras=()), ModelChoice(extras=("anti-roll",), tracks="shared")]
            )
        ),
    )


@settings(max_examples=60, deadline=None)
@given(campaigns())
@pytest.mark.slow
def test_what_is_written_is_read_back(campaign: Campaign) -> None:
    with tempfile.TemporaryDirectory() as folder:
        back = read(write(campaign, folder))
    for field in (
        "name",
        "sensors",
        "loads",
        "wheelbase",
        "cg_height",
        "wheel_height",
        "roll_axis_height",
        "known",
        "model",
    ):
        assert getattr(back, field) == getattr(campaign, field)
    for old, new in zip(campaign.drops, back.drops, strict=True):
        assert new.file is not None
        assert replace(new, file=old.file) == old
        assert new.name == old.name
    for before, after in zip(campaign.recordings, back.recordings, strict=True):
        assert after.channels == before.channels
        np.testing.assert_allclose(after.values, before.values, rtol=1e-8, atol=1e-300)  # nine digits are written
        duration = (before.values.shape[1] - 1) / before.rate
        assert after.start == pytest.approx(before.start, abs=1e-10)
        assert after.rate == pytest.approx(before.rate, rel=3e-10 / duration)  # times are written to 0.1 ns


def one_drop(**changes: Any) -> Campaign:
    where = [(0.0, 1.0, 0.5), (0.0, -1.0, 0.5), (-3.0, 0.0, 0.5)]
    campaign = Campaign(
        name="car",
        sensors=tuple(Sensor(channel=f"body_{i}", on="body", position=position) for i, position in enumerate(where)),
        drops=(DropTest(recording=Recording("x", ("body_0", "body_1", "body_2"), np.ones((3, 5)), 0.0, 500.0)),),
    )
    return dataclasses.replace(campaign, **changes)


def test_only_what_differs_from_the_defaults_is_written(tmp_path: Path) -> None:
    assert write(one_drop(), tmp_path / "a" / "b") == tmp_path / "a" / "b" / "campaign.toml"
    lines = (tmp_path / "a" / "b" / "campaign.toml").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "#:schema ./campaign.schema.json"
    assert [" ".join(line.partition("#")[0].split()) for line in lines if line and not line.startswith("#")] == [
        "schema = 1",
        "[vehicle]",
        'name = "car"',
        "[[sensor]]",
        'channel = "body_0"',
        'on = "body"',
        "position = [0.0, 1.0, 0.5]",
        "[[sensor]]",
        'channel = "body_1"',
        'on = "body"',
        "position = [0.0, -1.0, 0.5]",
        "[[sensor]]",
        'channel = "body_2"',
        'on = "body"',
        "position = [-3.0, 0.0, 0.5]",
        "[[drop]]",
        'file = "empty_bounce.csv"',
        'load = "empty"',
        'wheels = ["fl", "fr", "rl", "rr"]',
    ]
    assert (tmp_path / "a" / "b" / "empty_bounce.csv").read_text().splitlines()[:3] == [
        "time,body_0,body_1,body_2",
        "0,1,1,1",
        "0.002,1,1,1",
    ]


def test_comments_say_what_every_section_and_key_is_for(tmp_path: Path) -> None:
    campaign = replace(
        one_drop(),
        loads=(
            EMPTY,
            Load(name="bags # of sand", items=(Item(mass=50.0, position=(-1.0, 0.0, 0.5)), Item(mass=5.0, on="fl"))),
            Load(name="totals", added=Added(mass=100.0, I_yy=20.0)),
        ),
        known={"total_mass": KnownValue(1500.0, 2.0), "a": KnownValue(1.2)},
    )
    path = write(campaign, tmp_path)
    text = path.read_text(encoding="utf-8")
    assert max(map(len, text.splitlines())) <= 128
    for said in (*SECTIONS["load"].splitlines(), SECTIONS["sensor"], SECTIONS["drop"], SECTIONS["known"]):
        assert text.count(f"# {said}\n") == 1
    for section, key in (
        ("vehicle", "name"),
        ("known", "a"),
        ("sensor", "position"),
        ("load", "items"),
        ("drop", "wheels"),
    ):
        assert describe_key(section, key)
        assert text.count(f"# {describe_key(section, key)}\n") == 1
    assert {load.name: load for load in read(path).loads} == {load.name: load for load in campaign.loads}
    assert read(path).known == campaign.known


def test_names_stay_in_the_folder_and_apart(tmp_path: Path) -> None:
    recording = one_drop().recordings[0]
    drops = (Drop(), Drop(), Drop(file="/elsewhere/x.mf4"), Drop(file="../x.csv"), Drop(file="X.csv"))
    campaign = one_drop(drops=tuple(drop.with_recording(recording) for drop in drops))
    back = read(write(campaign, tmp_path / "out"))
    files = [drop.file for drop in back.drops]
    assert files == ["empty_bounce.csv", "empty_bounce_2.csv", "x.csv", "x_2.csv", "X_3.csv"]
    assert list(tmp_path.iterdir()) == [tmp_path / "out"]


def contents(folder: Path) -> dict[str, bytes]:
    """Every file but sprung's list of its own."""
    found = {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    found.pop(MANIFEST, None)
    return found


def test_files_replace_their_elders_and_leave_nothing_else(tmp_path: Path) -> None:
    atomic_write(tmp_path, {"a": b"1", "sub/b": b"2"})
    atomic_write(tmp_path, {"a": b"3", "c": b"4"})
    assert contents(tmp_path) == {"a": b"3", "sub/b": b"2", "c": b"4"}


@pytest.mark.parametrize("step", ["writing", "naming"])
@pytest.mark.parametrize("trouble", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_whatever_goes_wrong_the_folder_is_as_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str, trouble: BaseException
) -> None:
    atomic_write(tmp_path, {"a": b"1", "b": b"2"})
    calls = iter(range(100))

    def failing(original: Callable[..., Any], at: int) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            if next(calls) == at:
                raise trouble
            return original(*arguments)

        return call

    if step == "writing":
        monkeypatch.setattr("os.fsync", failing(lambda _: None, 2))
    else:  # the journal, b aside, a aside, a in place, then b in place fails
        monkeypatch.setattr(Path, "replace", failing(Path.replace, 4))
    with pytest.raises(InputError if isinstance(trouble, OSError) else KeyboardInterrupt) as error:
        atomic_write(tmp_path, {"a": b"3", "b": b"4", "new/c": b"5"})
    monkeypatch.undo()
    assert contents(tmp_path) == {"a": b"1", "b": b"2"}
    assert not (tmp_path / "new").exists()
    if isinstance(trouble, OSError):
        assert "No space left on device" in str(error.value)


def test_a_file_where_the_folder_should_be(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    for folder in (tmp_path / "file", tmp_path / "file" / "deeper"):
        with pytest.raises(InputError, match="found a file where the folder should be; expected a folder to write to"):
            write(one_drop(), folder)
    assert contents(tmp_path) == {"file": b"x"}


def test_a_folder_where_a_file_should_be(tmp_path: Path) -> None:
    (tmp_path / "campaign.toml").mkdir()
    with pytest.raises(InputError, match=r"a folder has the name campaign\.toml"):
        write(one_drop(), tmp_path)
    assert contents(tmp_path) == {}


def test_a_read_only_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    open_as_ever = Path.open

    def refuse(path: Path, mode: str = "r", **how: Any) -> Any:
        if path.is_relative_to(tmp_path):
            raise PermissionError(13, "Permission denied")
        return open_as_ever(path, mode, **how)

    monkeypatch.setattr(Path, "open", refuse)  # permissions do not bind the superuser, who may run the tests
    with pytest.raises(InputError, match=r"cannot be written to \(Permission denied\).*check its permissions"):
        write(one_drop(), tmp_path / "new")
    monkeypatch.undo()
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("name", ["../x", "/x", "a/../../x"])
def test_names_that_lead_out_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match="leads out of the folder"):
        atomic_write(tmp_path, {name: b""})


@pytest.mark.parametrize("name", ["a\u2028b", "a\x85b", "a\u2029"])
def test_a_name_may_hold_what_unicode_takes_for_the_end_of_a_line(name: str, tmp_path: Path) -> None:
    made = simulate(TABLE_1_CAR, drops=[{"wheels": ["fl", "rl"]}], seed=1, duration=1.2)
    assert read(write(replace(made, name=name), tmp_path)).name == name

"""Which file holds which sensor, and how what several loggers recorded is put together."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sprung.campaign import Drop, Recording, merge_loggers, read, unique_drop_names, unique_recording_names
from sprung.errors import InputError

SENSORS = """
[[sensor]]
channel = "z"
logger = "front_left"
on = "fl"
[[sensor]]
channel = "z"
logger = "front_right"
on = "fr"
[[sensor]]
channel = "b1"
on = "body"
position = [0, 0.7, 0.5]
[[sensor]]
channel = "b2"
on = "body"
position = [0, -0.7, 0.5]
[[sensor]]
channel = "b3"
on = "body"
position = [-2.7, 0, 0.5]
[[drop]]
files = ["drop1_front_left.csv", "drop1_front_right.csv", "drop1_body.csv"]
"""


def table(columns: str, rate: float, start: float, samples: int, phase: float = 0.0) -> str:
    """Write a file of a logger in which every column is a slow sine of true time."""
    lines = [f"time,{columns}"]
    for k in range(samples):
        value = np.sin(2 * np.pi * 1.5 * (k / rate + phase))
        lines.append(",".join([f"{start + k / rate:.6f}", *[f"{value:.9g}"] * (columns.count(",") + 1)]))
    return "\n".join(lines) + "\n"


def campaign(folder: Path, sensors: str = SENSORS) -> Path:
    (folder / "drop1_front_left.csv").write_text(table("z", 200, 10.0, 400))
    (folder / "drop1_front_right.csv").write_text(table("z", 200, -3.0, 420))
    (folder / "drop1_body.csv").write_text(table("b1,b2,b3", 500, 0.0, 1000))
    (folder / "campaign.toml").write_text("schema = 1\n" + sensors)
    return folder / "campaign.toml"


def test_a_logger_is_found_by_its_name_or_its_channel(tmp_path: Path) -> None:
    recording = read(campaign(tmp_path)).recordings[0]
    assert recording.channels == ("front_left z", "front_right z", "b1", "b2", "b3")
    assert [part.channels for part in recording.parts] == [("front_left z",), ("front_right z",), ("b1", "b2", "b3")]
    clocks = [(part.rate, part.start) for part in recording.parts]
    np.testing.assert_allclose(clocks, [(200, 10), (200, -3), (500, 0)], rtol=1e-12)
    assert recording.rate == pytest.approx(500)
    # As if all had been started at once: the first logger's clock, its slower samples interpolated.
    assert recording.start == 10
    assert recording.values.shape[1] == pytest.approx(500 * 399 / 200, abs=1)
    expected = np.sin(2 * np.pi * 1.5 * (recording.time - 10))
    np.testing.assert_allclose(recording.values, np.tile(expected, (5, 1)), atol=2e-6)
    assert [clock.channels for clock in recording.clocks] == [(0,), (1,), (2, 3, 4)]
    stand = [(clock.offset, clock.rate_ratio) for clock in recording.clocks]
    np.testing.assert_allclose(stand, [(0.0, 0.4), (-13.0, 0.4), (-10.0, 1.0)], rtol=1e-9)


def test_a_channel_of_two_files_needs_its_logger(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"sensor 'z'.*drop1_front_left.csv, drop1_front_right.csv.*logger = "):
        read(campaign(tmp_path, SENSORS.replace('logger = "front_left"\n', "").replace('logger = "front_right"', "")))


def day(columns: str, rate: float, start: float, seed: int, samples: int) -> str:
    """Write a file of a logger that saw three falls, 5, 14 and 24 s after the first logger was started."""
    time = np.arange(samples) / rate
    since = (time + (0.0 if start == 10.0 else 1.7))[:, None] - [5.0, 14.0, 24.0]
    motion = np.where(since > 0, 5 * np.exp(-2 * since) * np.sin(9 * since), 0.0).sum(axis=1)
    motion += 0.02 * np.random.default_rng(seed).standard_normal(samples)
    rows = np.column_stack([start + time, *[motion] * (columns.count(",") + 1)])
    return "\n".join([f"time,{columns}", *(",".join(f"{one:.6f}" for one in row) for row in rows)]) + "\n"


@pytest.mark.parametrize("fall", [5.0, 14.0, 24.0])
def test_a_window_on_the_first_clock_is_found_on_the_others(tmp_path: Path, fall: float) -> None:
    """The other clocks stand 1000 s and -3 s apart and were started 1.7 s later."""
    path = campaign(tmp_path, SENSORS.replace("files = [", f"window = [{9 + fall}, {12 + fall}]\nfiles = ["))
    (tmp_path / "drop1_front_left.csv").write_text(day("z", 200, 10.0, 1, 6000))
    (tmp_path / "drop1_front_right.csv").write_text(day("z", 200, -3.0, 2, 5900))
    (tmp_path / "drop1_body.csv").write_text(day("b1,b2,b3", 500, 1000.0, 3, 14000))
    (recording,) = read(path).recordings
    assert recording.name.endswith(f"from {9 + fall:g} s")
    moved = [one.time[np.argmax(np.abs(one.values[0]) > 0.5)] for one in recording.parts]
    np.testing.assert_allclose(moved, [10 + fall, fall - 4.7, fall + 998.3], atol=0.05)
    lasts = [one.values.shape[1] / one.rate for one in recording.parts]
    np.testing.assert_allclose(lasts, [3.0, 3.2, 3.2], atol=0.01)


def test_a_window_is_on_the_clock_of_a_file_that_is_used(tmp_path: Path) -> None:
    written = SENSORS.replace('files = ["drop1_front', 'window = [1.0, 2.0]\nfiles = ["unused.csv", "drop1_front')
    path = campaign(tmp_path, written)
    (tmp_path / "unused.csv").write_text(day("temperature", 200, 10.0, 1, 600))
    with pytest.raises(InputError, match=r"window.*unused.csv.*Name another file first"):
        read(path)


def test_a_logger_without_a_file_is_missing_from_the_drop(tmp_path: Path) -> None:
    recording = read(campaign(tmp_path, SENSORS.replace('"drop1_front_right.csv", ', ""))).recordings[0]
    fault = next(fault for fault in recording.faults if fault.code == "missing")
    assert "'front_right'" in fault.what
    assert not recording.usable[1]
    assert recording.usable[[0, 2, 3, 4]].all()


@pytest.mark.parametrize(
    ("files", "name"),
    [
        (("a_1.csv", "a_2.csv"), "a_*.csv"),
        (("left/one.csv", "right/one.csv"), "*t/one.csv"),
        (("x.csv", "y.csv", "z.csv"), "x.csv and 2 more"),
        (("one.csv",), "one.csv"),
    ],
)
def test_files_are_called_by_what_they_have_in_common(files: tuple[str, ...], name: str) -> None:
    assert Drop(files=files).recording_name == name


@pytest.mark.parametrize(
    ("files", "recordings", "names"),
    [
        ([("a_1.csv", "a_2.csv"), ("b_1.csv", "b_2.csv")], ["a_*.csv", "b_*.csv"], ["a", "b"]),
        # What the files of both drops have in common tells neither.
        (
            [("log_1.csv", "log_7.csv"), ("log_2.csv", "log_8.csv")],
            ["log_1.csv and 1 more", "log_2.csv and 1 more"],
            ["log_1", "log_2"],
        ),
        ([("monday/one.csv",), ("tuesday/one.csv",)], ["monday/one.csv", "tuesday/one.csv"], ["monday_one", "tuesday_one"]),
        ([("one.csv",), ("one.csv",), ("two.csv",)], ["one.csv", "one.csv (2)", "two.csv"], ["one", "one (2)", "two"]),
        ([("x.csv", "y.csv"), ("z.csv", "w.csv")], ["x.csv and 1 more", "z.csv and 1 more"], ["x", "z"]),
    ],
)  # fmt: skip
def test_drops_and_their_recordings_are_called_by_names_of_their_own(
    files: list[tuple[str, ...]], recordings: list[str], names: list[str]
) -> None:
    drops = [Drop(file=own[0]) if len(own) == 1 else Drop(files=own) for own in files]
    assert list(unique_recording_names(drops)) == recordings
    assert list(unique_drop_names(drops)) == names


def part(name: str, rate: float, start: float, delay: float, samples: int) -> Recording:
    """Record a motion of true time, beginning at the delay, on a clock that shows the start then."""
    time = delay + np.arange(samples) / rate
    values: NDArray[np.float64] = np.array([np.exp(-time) * np.sin(2 * np.pi * 11 * time)])
    return Recording(name, (name,), values, start, rate)


@pytest.mark.parametrize("rate", [200.0, 500.0, 500.05])
def test_loggers_are_put_on_one_clock_by_a_moment_they_share(rate: float) -> None:
    parts = (part("a", 500, 100.0, 0.2, 900), part("b", rate, -7.0, 0.1003, int(2 * rate)))
    whole = Recording("drop", ("a", "b"), np.empty((2, 0)), 0.0, 1.0, parts=parts)
    # The moment 0.5 s of true time, on both clocks.
    together = merge_loggers(whole, [100.3, -7.0 + 0.3997])
    true = together.time - 99.8
    clock = together.clocks[1]
    assert clock.offset - together.clocks[0].offset == pytest.approx(-7 + 0.3997 - 100.3, abs=0.5 / rate + 1e-9)
    # By its clock's own word a sample was taken when it was: within half a step, or interpolated.
    own = together.time + clock.offset + 7 + 0.1003
    exact = np.exp(-own) * np.sin(2 * np.pi * 11 * own)
    # 500.05 Hz is taken for 500: 0.2 ms off at the end.
    np.testing.assert_allclose(together.values[1], exact, atol=1e-9 if rate == 500 else 3e-3)
    np.testing.assert_allclose(together.values[0], np.exp(-true) * np.sin(2 * np.pi * 11 * true), atol=1e-9)


def test_a_logger_of_which_no_moment_is_known_is_left_out() -> None:
    parts = (part("a", 500, 0.0, 0.0, 900), part("b", 500, 0.0, 0.0, 900))
    whole = Recording("drop", ("a", "b"), np.empty((2, 0)), 0.0, 1.0, parts=parts)
    together = merge_loggers(whole, [0.1, None])
    assert together.usable.tolist() == [True, False]


def test_no_channel_is_lost_to_rounding_where_its_logger_begins_last_or_ends_first() -> None:
    random = np.random.default_rng(3)
    for _ in range(200):
        parts = []
        for name, rate in (("fast", 1000.0), ("slow", 200.0)):
            values = random.standard_normal((1, int(rate)))
            parts.append(Recording(name, (name,), values, float(random.uniform(-1000, 1000)), rate))
        whole = Recording("drop", ("fast", "slow"), np.empty((2, 0)), 0.0, 1.0, parts=tuple(parts))
        moments = [part.start + float(random.uniform(0.3, 0.6)) for part in parts]
        together = merge_loggers(whole, moments)
        assert together.values.shape[1] > 500
        assert together.usable.all()

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sprung.campaign import read, read_vehicle
from sprung.errors import InputError
from sprung.uncertainty import KnownValue
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import EMPTY

Folder = Callable[..., Path]
Text = Callable[..., str]
FL = np.arange(100) % 5 + 9.0  # what the fixture writes into body_fl


def test_a_sound_campaign(folder: Folder) -> None:
    campaign = read(folder())
    assert campaign.name == "car"
    assert campaign.wheelbase == KnownValue(2.76)
    assert [load.name for load in campaign.loads] == ["empty", "ballast"]
    assert campaign.loads[0] == EMPTY
    assert [drop.label for drop in campaign.drops] == ["one", "two"]
    assert campaign.path is not None
    one = campaign.recordings[0]
    assert one.name == "one.csv"
    assert one.channels == ("body_fl", "body_fr", "body_rl")
    assert one.rate == pytest.approx(500, rel=1e-12)
    assert one.start == 0
    np.testing.assert_array_equal(one.values[0], FL)
    assert one.faults == ()
    assert "100 samples at 500 Hz" in one.history[0]


def test_folder_and_file_are_the_same_and_the_folder_names_the_vehicle(folder: Folder) -> None:
    path = folder(('name = "car"\n', ""))
    assert read(path).name == read(str(path / "campaign.toml")).name == path.name


def test_known_quantities_are_numbers_or_values_with_uncertainty(folder: Folder) -> None:
    campaign = read(folder(("[known]", "[known]\na = 1.25\nc_tf = 0\ntotal_mass = { value = 1550, std = 5 }")))
    assert campaign.known == {"a": KnownValue(1.25), "c_tf": KnownValue(0.0), "total_mass": KnownValue(1550, 5)}


@pytest.mark.parametrize(
    "known",
    [
        "total_mass = { value = 1540, std = 3 }\nfront_axle_mass = 800\nrear_axle_mass = 750",  # 10 < 4 * 3
        "total_mass = 1500\nfront_axle_mass = 800",
        "a = 1.25\nb = 1.510001",  # 1e-6 of 2.76 is 2.76e-6
        "a = { value = 1.25, std = 0.003 }\nb = 1.5",  # 0.01 < 4 * 0.003
    ],
)
def test_what_uncertainty_allows_is_no_contradiction(folder: Folder, known: str) -> None:
    assert read(folder(("[known]", f"[known]\n{known}"))).known


def test_units_and_direction_become_si_and_positive_up(folder: Folder, text: Text) -> None:
    path = folder(
        ('channel = "body_fl"', 'channel = "body_fl"\nunit = "g"\ndirection = "down"'),
        one=text("time,body_fl [mg],body_fr [g],body_rl (mm/s²)"),  # the sensor's unit overrides the file's
    )
    one, two = read(path).recordings
    np.testing.assert_allclose(one.values[0], -STANDARD_GRAVITY * FL, rtol=1e-15)
    np.testing.assert_allclose(one.values[1], STANDARD_GRAVITY * two.values[1], rtol=1e-15)
    np.testing.assert_allclose(one.values[2], 1e-3 * two.values[2], rtol=1e-15)
    said = "\n".join(one.history)
    assert "body_fl: read in g, times 9.80665 to m/s², turned from down to up" in said
    assert "body_fr: read in g, as the file says" in said


def test_a_range_is_in_the_unit_of_the_file_where_the_sensor_names_none(folder: Folder, text: Text) -> None:
    path = folder(
        ('channel = "body_fl"', 'channel = "body_fl"\nrange = 5'),
        ('channel = "body_fr"', 'channel = "body_fr"\nrange = 5\nunit = "mg"'),
        one=text("time,body_fl [g],body_fr [g],body_rl"),
    )
    one, two = read(path).recordings
    assert one.full_scale == pytest.approx((5 * STANDARD_GRAVITY, 5e-3 * STANDARD_GRAVITY, None))
    assert two.full_scale == pytest.approx((5.0, 5e-3 * STANDARD_GRAVITY, None))


def test_the_sensor_may_name_its_column_with_the_unit(folder: Folder, text: Text) -> None:
    path = folder(
        ('"body_fl"', '"body_fl [g]"'),
        one=text("t,body_fl [g],body_fr,body_rl"),
        two=text("t,body_fl [g],body_fr,body_rl"),
    )
    np.testing.assert_allclose(read(path).recordings[0].values[0], STANDARD_GRAVITY * FL, rtol=1e-15)


def test_a_unit_that_is_none_of_acceleration(folder: Folder, text: Text) -> None:
    with pytest.raises(InputError, match=r"one\.csv: body_fl: found the unit 'V'; .*unit = \"g\""):
        read(folder(one=text("time,body_fl [V],body_fr,body_rl")))


def test_a_channel_missing_in_one_recording_is_left_out_there(folder: Folder, text: Text) -> None:
    one, two = read(folder(two=text("time,body_fl,bodyfr,body_rl"))).recordings
    assert one.usable.all()
    assert two.usable.tolist() == [True, False, True]
    (fault,) = two.faults
    assert (fault.code, fault.where) == ("missing", "two.csv: body_fr")
    assert "Did you mean 'bodyfr'?" in fault.do
    assert "two.csv: body_fr: left out (missing)" in two.history


@pytest.mark.parametrize("gap", ["NaN", "", "n/a", "inf"])
def test_a_short_gap_is_filled_and_a_long_one_leaves_the_channel_out(folder: Folder, text: Text, gap: str) -> None:
    short = text().replace("0.0100,9,", f"0.0100,{gap},")
    long = "".join(
        f"{i * 0.002:.4f},{gap if 40 <= i < 60 else 9 + i % 5},{9 + i % 3},{-1 - i % 2}\n" for i in range(100)
    )
    one, two = read(folder(one=short, two="time,body_fl,body_fr,body_rl\n" + long)).recordings
    assert one.usable.all()
    (fault,) = one.faults
    assert fault.code == "missing"
    assert "1 of 100 samples is missing, the first in line 7; filled in" in fault.what
    assert f"one.csv: body_fl: {fault.what}" in one.history
    assert two.usable.tolist() == [False, True, True]
    (fault,) = two.faults
    assert "20 of 100 samples are missing, the first in line 42; the channel is left out" in fault.what
    assert "two.csv: body_fl: left out (missing)" in two.history


def test_a_drop_without_any_channel_is_kept_and_named(folder: Folder, text: Text) -> None:
    one, two = read(folder(one=text("time,x,y,z"))).recordings
    assert np.isnan(one.values).all()
    assert one.values.shape == two.values.shape
    assert [fault.where for fault in one.faults][-1] == "one.csv"
    assert "the drop is left out" in one.faults[-1].what


def test_nothing_usable_is_a_problem(folder: Folder, text: Text) -> None:
    empty = text().replace("9,", "NaN,").replace("9.5", "NaN").replace("-1.25", "NaN")
    with pytest.raises(InputError, match="something usable in at least one drop") as error:
        read(folder(one=empty, two=empty))
    assert len(error.value.problems) == 8  # three channels and the drop, twice


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            ("0.0100,", "0.0109,"),
            "up to line 7; the samples are not smoother at these times, and were taken as regular",
        ),
        (("0.0100,9,11.5,-2.25\n", ""), "1 of 100 lines is missing, the first before line 7; filled in"),
    ],
)
def test_an_uneven_clock_is_understood_and_told(folder: Folder, text: Text, change: tuple[str, str], said: str) -> None:
    assert change[0] in text()
    one = read(folder(one=text().replace(*change))).recordings[0]
    assert one.usable.all()
    assert one.values.shape == (3, 100)
    (fault,) = one.faults
    assert fault.code == "clock"
    assert said in fault.what


def test_a_clock_that_nothing_can_be_made_of_leaves_the_drop_out(folder: Folder) -> None:
    rows = "".join(f"{(i / 30) ** 3:.6f},{i % 5},{i % 3},{i % 2}\n" for i in range(150))
    one = read(folder(one="time,body_fl,body_fr,body_rl\n" + rows)).recordings[0]
    assert np.isnan(one.values).all()
    (fault,) = one.faults
    assert fault.code == "clock"
    assert "the drop is left out" in fault.what


def test_times_rounded_to_milliseconds_are_an_even_clock(folder: Folder) -> None:
    rows = "".join(f"{i / 400:.3f},1,2,3\n" for i in range(200))  # steps of 2 and 3 ms
    one = read(folder(one="time,body_fl,body_fr,body_rl\n" + rows)).recordings[0]
    assert one.faults == ()
    assert one.rate == pytest.approx(400, rel=2e-3)


@pytest.mark.parametrize("time", ["0.0080", "0.0060"])
def test_a_clock_that_stops_or_runs_backward_names_the_line(folder: Folder, text: Text, time: str) -> None:
    with pytest.raises(InputError, match=rf"one\.csv: line 7: found the time {float(time):g} s after 0\.008 s"):
        read(folder(one=text().replace("0.0100,", f"{time},")))


@pytest.mark.parametrize(("step", "words"), [(1 / 50, "50 samples per second"), (2.0, "time [ms]")])
def test_a_slow_recording_is_refused(folder: Folder, text: Text, step: float, words: str) -> None:
    with pytest.raises(InputError, match="at least 64") as error:
        read(folder(one=text(step=step)))
    assert words in str(error.value)


def test_the_slowest_recording_is_accepted_whatever_rounding_leaves_of_its_rate(folder: Folder, text: Text) -> None:
    one = read(folder(one=text(step=(1 + 1e-7) / 64))).recordings[0]
    assert one.rate == pytest.approx(64, rel=1e-4)


def test_wheel_sensors_are_optional_and_start_and_end_are_kept(folder: Folder) -> None:
    campaign = read(folder(('"one.csv"', '"one.csv"\nstart = 0.05\nend = 0.198')))
    assert (campaign.drops[0].start, campaign.drops[0].end) == (0.05, 0.198)


def test_a_vehicle_file(vehicle_file: Folder) -> None:
    file = read_vehicle(vehicle_file(("wheelbase", "cg_height = 0.55\nwheelbase"), ("[known]", "[known]\nm_s = 1380")))
    assert file.vehicle.name == "car"
    assert file.vehicle.k_sr == 22000
    assert file.vehicle.cg_height == 0.55
    assert file.wheelbase == KnownValue(2.76)
    assert file.known == {"m_s": KnownValue(1380)}
    assert [sensor.channel for sensor in file.sensors] == ["body_fl", "body_fr", "body_rl"]
    assert [load.name for load in file.loads] == ["empty", "ballast"]
    assert [drop.label for drop in file.drops] == ["empty_pitch_front", "ballast_bounce"]


@pytest.mark.shared
@pytest.mark.parametrize(
    ("name", "load_mass", "known"),
    # From data/README.md and the two campaign files.
    [
        ("sedan", 200.0, {}),
        ("leafbus", 470.0, {"total_mass": KnownValue(5240, 5), "a": KnownValue(2.22), "b": KnownValue(1.73)}),
    ],
)
def test_the_development_campaigns(shared: Path, name: str, load_mass: float, known: dict[str, KnownValue]) -> None:
    campaign = read(shared / "data" / name)
    assert campaign.name == name
    assert dict(campaign.known) == known
    assert campaign.load("ballast").total_mass() == load_mass
    assert len(campaign.recordings) == len(campaign.drops) == 10
    for recording in campaign.recordings:
        assert recording.faults == ()
        assert recording.rate == pytest.approx(500, rel=1e-9)
        # At the end the vehicle rests on its wheels: each accelerometer reads standard gravity, whatever its unit was.
        np.testing.assert_allclose(recording.values[:, -500:].mean(axis=1), STANDARD_GRAVITY, rtol=0.01)


@pytest.mark.parametrize(("last", "found"), [("1e300", "the time 1e\\+300 s"), ("-1e13", "the time -1e\\+13 s")])
def test_a_time_that_no_clock_shows(folder: Folder, text: Text, last: str, found: str) -> None:
    with pytest.raises(InputError, match=rf"one\.csv: line 101: found {found}; expected the time of a sample"):
        read(folder(one=text().replace("0.1980,", f"{last},")))


def test_samples_that_follow_each_other_sooner_than_any(folder: Folder, text: Text) -> None:
    with pytest.raises(InputError, match="found 2e-12 s from one sample to the next"):
        read(folder(one=text("time [ns],body_fl,body_fr,body_rl")))

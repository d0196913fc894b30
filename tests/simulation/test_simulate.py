"""Simulated drop tests: what is recorded, from what is known to be true."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from sprung.campaign import Drop, ModelChoice
from sprung.errors import InputError
from sprung.simulation import default_drops, default_sensors, drop_from_blocks, simulate, static_wheel_loads
from sprung.uncertainty import KnownValue
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import EMPTY, SCHOOL_BUS, TABLE_1_CAR, WHEELS, Added, Item, Load, Sensor, Vehicle

SANDBAGS = Load(name="sandbags", items=(Item(mass=140, position=(-1.0, 0.2, 0.6)),))


def test_defaults_are_eight_sensors_and_five_drops_for_each_load() -> None:
    campaign = simulate(SCHOOL_BUS, loads=[SANDBAGS], noise=0, duration=0.5)
    assert [sensor.on for sensor in campaign.sensors] == ["body"] * 4 + list(WHEELS)
    # 0.1 m beyond the axles of the 3.95 m wheelbase, at the dampers' 0.64 m: wider than the springs.
    assert [sensor.position for sensor in campaign.sensors[:4]] == [
        (0.1, 0.64, 0.5),
        (0.1, -0.64, 0.5),
        (pytest.approx(-4.05), 0.64, 0.5),
        (pytest.approx(-4.05), -0.64, 0.5),
    ]
    assert [drop.file for drop in campaign.drops] == [
        f"{load}_{kind}.csv"
        for load in ("empty", "sandbags")
        for kind in ("bounce", "pitch_front", "pitch_rear", "roll_left", "roll_right")
    ]
    assert {drop.height for drop in campaign.drops} == {0.05}
    assert campaign.loads == (EMPTY, SANDBAGS)
    assert campaign.name == "School bus"
    assert campaign.wheelbase == KnownValue(SCHOOL_BUS.wheelbase)
    assert campaign.known == {}
    assert campaign.model == ModelChoice()
    assert [recording.name for recording in campaign.recordings] == [drop.file for drop in campaign.drops]
    for recording in campaign.recordings:
        assert recording.channels == tuple(sensor.channel for sensor in campaign.sensors)
        assert recording.values.shape == (8, 450)
        assert (recording.start, recording.rate) == (0.0, 500.0)
        assert recording.history


def test_without_noise_a_recording_is_the_exact_motion_felt_by_each_sensor() -> None:
    campaign = simulate(TABLE_1_CAR, loads=[SANDBAGS], noise=0.0)
    for drop, recording in zip(campaign.drops, campaign.recordings, strict=True):
        load = campaign.load(drop.load)
        motion = drop_from_blocks(TABLE_1_CAR, load, drop.wheels, 0.05).motion(0.002, 1600)
        z, theta, phi, *wheels = motion.acceleration
        # Body corners: z_s - (x + a) θ + y φ with x = 0.1 m and -2.86 m, a = 1.25 m, y = ±0.74 m.
        corners = [z - ahead * theta + y * phi for ahead in (1.35, -1.61) for y in (0.74, -0.74)]
        assert_allclose(recording.values[:, 200:], STANDARD_GRAVITY + np.vstack([corners, wheels]), atol=1e-10)
        assert_array_equal(recording.values[:, :200], STANDARD_GRAVITY)


def test_the_first_sample_after_the_release_is_what_the_lost_blocks_leave() -> None:
    # All wheels fall: nothing pushes them up any more, the springs still push down with the weight of the body.
    campaign = simulate(TABLE_1_CAR, noise=0.0, gravity=10.0, duration=0.1)
    at_release = campaign.recordings[0].values[:, 200]
    wheels = 10 - static_wheel_loads(TABLE_1_CAR, gravity=10.0) / [40.5, 40.5, 45.4, 45.4]
    assert_allclose(at_release, [10.0] * 4 + list(wheels), rtol=1e-10)


@pytest.mark.parametrize("rest", [0.0, 0.4, 0.4013])
def test_the_release_may_be_between_two_samples(rest: float) -> None:
    campaign = simulate(TABLE_1_CAR, drops=[Drop()], noise=0.0, rest=rest, duration=1.0)
    recording = campaign.recordings[0]
    first = int(np.ceil(rest * 500 - 1e-9))
    fall = drop_from_blocks(TABLE_1_CAR)
    expected = fall.motion(0.002, recording.values.shape[1] - first, start=max(0.0, first / 500 - rest))
    assert_allclose(recording.values[4:, first:], STANDARD_GRAVITY + expected.acceleration[3:], atol=1e-10)
    assert_array_equal(recording.values[:, :first], STANDARD_GRAVITY)
    assert recording.time[-1] == pytest.approx(rest + 1.0, abs=0.003)


def test_mappings_as_in_a_campaign_file_are_as_good_as_records() -> None:
    sensor = Sensor(channel="chassis", on="body", position=(0.0, 0.3, 0.5), unit="g")
    drop = Drop(load="sandbags", wheels=("fl", "rl"), height=0.03)
    records = simulate(
        TABLE_1_CAR,
        sensors=[sensor],
        loads=[SANDBAGS],
        drops=[drop],
        seed=3,
        known={"total_mass": KnownValue(1551.8, 2.0), "a": KnownValue(1.25)},
        model=ModelChoice(tracks="shared"),
    )
    mappings = simulate(
        TABLE_1_CAR,
        sensors=[{"channel": "chassis", "on": "body", "position": [0.0, 0.3, 0.5], "unit": "g"}],
        loads=[{"name": "sandbags", "items": [{"mass": 140, "position": [-1.0, 0.2, 0.6]}]}],
        drops=[{"load": "sandbags", "wheels": ["fl", "rl"], "height": 0.03}],
        seed=3,
        known={"total_mass": {"value": 1551.8, "std": 2.0}, "a": 1.25},
        model={"tracks": "shared"},
    )
    assert_array_equal(records.recordings[0].values, mappings.recordings[0].values)
    for field in ("name", "sensors", "drops", "loads", "wheelbase", "known", "model"):
        assert getattr(records, field) == getattr(mappings, field)
    assert records.known["total_mass"] == KnownValue(1551.8, 2.0)


def test_the_default_drops_and_sensors_may_be_given_too() -> None:
    given = simulate(
        TABLE_1_CAR, sensors=default_sensors(TABLE_1_CAR), loads=[EMPTY], drops=default_drops([EMPTY]), seed=1, rate=100
    )
    default = simulate(TABLE_1_CAR, seed=1, rate=100)
    assert given.loads == default.loads == (EMPTY,)
    for one, other in zip(given.recordings, default.recordings, strict=True):
        assert_array_equal(one.values, other.values)


def test_repeated_drops_are_numbered_and_given_files_kept() -> None:
    left = Drop(wheels=("fl", "rl"))
    strange = Load(name="10 % / roof", added=Added(mass=100))
    drops = [left, left, Drop(file="mine.csv"), left, Drop(file="empty_bounce.csv"), Drop(), Drop(load=strange.name)]
    campaign = simulate(TABLE_1_CAR, loads=[strange], drops=drops, duration=0.1)
    assert [drop.file for drop in campaign.drops] == [
        "empty_roll_left.csv",
        "empty_roll_left_2.csv",
        "mine.csv",
        "empty_roll_left_3.csv",
        "empty_bounce.csv",
        "empty_bounce_2.csv",
        "10_roof_bounce.csv",
    ]


def test_what_the_vehicle_and_the_user_know_is_in_the_campaign() -> None:
    bus = Vehicle.from_parameters(SCHOOL_BUS.parameters, cg_height=0.9, name="Bus")
    campaign = simulate(
        bus, drops=[Drop(start=0.6, end=2.0)], known={"wheelbase": KnownValue(3.96, 0.01)}, duration=2.0
    )
    assert (campaign.name, campaign.cg_height) == ("Bus", 0.9)
    assert campaign.wheelbase == KnownValue(3.96, 0.01)
    assert campaign.known == {}
    assert (campaign.drops[0].start, campaign.drops[0].end) == (0.6, 2.0)


def test_seeds_repeat_and_a_further_drop_leaves_the_earlier_ones_alone() -> None:
    one, again, other = (simulate(TABLE_1_CAR, seed=seed, duration=0.5) for seed in (1, 1, 2))
    fewer = simulate(TABLE_1_CAR, drops=one.drops[:2], seed=1, duration=0.5)
    for i, recording in enumerate(one.recordings):
        assert_array_equal(recording.values, again.recordings[i].values)
        assert np.abs(recording.values - other.recordings[i].values).min(axis=1).max() > 0
    for recording, same in zip(one.recordings, fewer.recordings, strict=False):
        assert_array_equal(recording.values, same.values)


def test_a_long_recording_of_an_undamped_vehicle_is_followed_to_its_end() -> None:
    undamped = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"c_sf": 0.0, "c_sr": 0.0})
    campaign = simulate(undamped, drops=[Drop(height=0.1)], duration=4.0, rest=0.0017, rate=100)
    assert np.isfinite(campaign.recordings[0].values).all()


def test_every_fault_is_named_at_once() -> None:
    with pytest.raises(InputError) as caught:
        simulate(
            TABLE_1_CAR,
            sensors=[
                {"channel": "a", "on": "body"},
                {"channel": "b", "on": "fl", "unit": "furlong"},
                {"channel": "b", "on": "fr", "high_pass": 28.0},
            ],
            loads=[{"name": "lead"}, {"name": "sand", "added": {"mass": 1}}, {"name": "sand", "added": {"mass": 2}}],
            drops=[
                {"load": "lead"},
                {"weels": 3},
                {"load": "snad"},
                {"file": "x.csv"},
                {"file": "x.csv"},
                {"wheels": []},
            ],
            rate=50,
            noise={"c": 1.0, "b": -1.0},
            offset=-0.1,
            duration=-1.0,
            known={"total_mas": 1500.0, "a": {"val": 1.25}, "b": float("nan")},
            model={"tracks": "double"},
        )
    assert [problem.where.removeprefix("simulate: ") for problem in caught.value.problems] == [
        "sensors[0]",
        "loads[0]",
        "drops[1].weels",
        "drops[4].wheels",  # of those that are left
        "sensors",
        "loads",
        "drops",
        "drops",
        "rate",
        "offset",
        "sensor 'b'.unit",
        "sensor 'b'.high_pass",
        "noise",
        "noise['b']",
        "known['total_mas']",
        "known['a']",
        "known['b']",
        "model.tracks",
        "duration",
    ]
    text = str(caught.value)
    assert "Did you mean 'wheels'?" in text
    assert "found load 'snad'; expected the name of a load. Did you mean 'sand'?" in text
    assert "found 'x.csv' 2 times" in text
    assert "found 50 samples per second; expected 64 or more" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"noise": -0.1}, "simulate: noise: found -0.1"),
        ({"noise": float("nan")}, "simulate: noise: found nan"),
        ({"noise": {"wheel_fl": 0.1}}, r"noise\['body_fl'\]: found nothing; expected .* Give every channel"),
        ({"rate": float("inf")}, "found inf samples per second"),
        ({"gravity": -9.8}, "simulate: gravity: found -9.8"),
        ({"gravity": 0.0}, "all wheels pressed to the ground"),
        ({"rest": float("nan")}, "simulate: rest: found nan"),
        ({"sensors": []}, "simulate: sensors: found none"),
        ({"drops": []}, "simulate: drops: found none"),
    ],
)
def test_impossible_arguments(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        simulate(TABLE_1_CAR, **arguments)  # type: ignore[arg-type]


def test_every_drop_that_cannot_be_is_named() -> None:
    tail_heavy = Load(name="tail", items=(Item(mass=900, position=(-6.0, 0, 1)),))
    with pytest.raises(InputError) as caught:
        simulate(TABLE_1_CAR, loads=[tail_heavy])
    assert len(caught.value.problems) == 5
    assert all("load 'tail'" in problem.where for problem in caught.value.problems)

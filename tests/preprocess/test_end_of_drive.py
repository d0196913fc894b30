"""Where a push or a bump has ended, as the recordings alone show it, and what is no release in them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

import sprung
from sprung.campaign import Drop
from sprung.errors import InputError
from sprung.preprocess import find_flights, prepare
from sprung.preprocess.end_of_drive import DIES_AWAY
from sprung.preprocess.passage import measure_delay
from sprung.simulation import Acting, Bump, Push
from sprung.vehicle import EMPTY, TABLE_1_CAR, Vehicle, Wheel

CASES = [
    ("push", "hand", "half-sine"),
    ("push", "rope", "half-sine"),
    ("pass", "hand", "half-sine"),
    ("pass", "hand", "kerb"),
]


def excited(
    excitation: str, push: str, bump: str, vehicle: Vehicle = TABLE_1_CAR, noise: float = 0.02
) -> tuple[sprung.Campaign, list[float]]:
    """A campaign of pushes or passes, and when the free decay of each begins."""
    wheels = [("fl", "fr", "rl", "rr"), ("fl", "rl")]
    drops = [{"excitation": excitation, "wheels": list(own)} for own in wheels]
    shapes: dict[str, dict[str, str]] = {"push": {"shape": push}, "bump": {"shape": bump}}
    campaign = sprung.simulate(vehicle, drops=drops, noise=noise, seed=1, **shapes)  # type: ignore[arg-type]
    acting = Acting(Push(shape=push), Bump(shape=bump))  # type: ignore[arg-type]
    starts = [0.4 + acting.motion(vehicle, EMPTY, drop, 3.2).decay_start for drop in campaign.drops]
    return campaign, starts


@pytest.mark.parametrize(("excitation", "push", "bump"), CASES)
def test_a_decay_begins_when_the_motion_dies_away(excitation: str, push: str, bump: str) -> None:
    campaign, starts = excited(excitation, push, bump)
    prepared = prepare(campaign)
    assert not prepared.left_out
    for decay, start in zip(prepared.decays, starts, strict=True):
        assert decay.is_driven
        assert not decay.faults
        assert start - 0.4 < decay.start < start + 0.7
        assert decay.start - decay.earlier.shape[1] / decay.rate <= start
        assert decay.events.release == pytest.approx(0.4, abs=0.1)
        assert decay.rest.noise.std(axis=1) == pytest.approx(0.02, rel=0.3)


@pytest.mark.parametrize("seed", range(12))
def test_who_pushes_a_side_by_hand_has_not_let_go_of_it_at_once(seed: int) -> None:
    """Wheels hardly move then: what is noise, or rises slowly, does not show a held body (5 of 12 seeds once did)."""
    drops = [{"excitation": "push", "wheels": list(side)} for side in (("fl", "rl"), ("fr", "rr"))]
    prepared = prepare(sprung.simulate(TABLE_1_CAR, drops=drops, noise=0.02, seed=seed))
    assert all(decay.events.why_start == DIES_AWAY for decay in prepared.decays)


def test_nothing_fell() -> None:
    campaign, _ = excited("pass", "hand", "half-sine")
    prepared = prepare(campaign)
    assert all(not seen.dropped for seen in prepared.observations)
    assert find_flights(prepared.decays, prepared.observations) == [None, None]


def test_a_stated_start_is_used() -> None:
    campaign, _ = excited("pass", "hand", "half-sine")
    drops = tuple(replace(drop, start=1.3) for drop in campaign.drops)
    prepared = prepare(replace(campaign, drops=drops))
    assert [decay.start for decay in prepared.decays] == pytest.approx([1.3, 1.3])
    assert not any(decay.is_driven for decay in prepared.decays)


def test_a_recording_that_begins_on_the_bump_shows_no_rest_and_that_is_no_fault() -> None:
    campaign, starts = excited("pass", "hand", "half-sine")
    cut = [replace(one, values=one.values[:, 210:], start=0.42) for one in campaign.recordings]
    prepared = prepare(campaign.with_recordings(cut))
    assert all(seen.release is None for seen in prepared.observations)
    assert [fault.code for decay in prepared.decays for fault in decay.faults] == []
    assert all(abs(decay.start - start) < 0.3 for decay, start in zip(prepared.decays, starts, strict=True))


def codes_and_words(campaign: sprung.Campaign) -> tuple[set[str], str]:
    """Codes of all faults of the drops that are left out, and everything that is said of them."""
    faults = [fault for _, own in prepare(campaign).left_out for fault in own]
    return {fault.code for fault in faults}, " ".join(f"{fault.what} {fault.do}" for fault in faults)


@pytest.mark.parametrize(("excitation", "behind"), [("pass", "behind the bump"), ("push", "after the push")])
def test_a_recording_that_ends_too_soon_is_left_out(excitation: str, behind: str) -> None:
    campaign, starts = excited(excitation, "hand", "half-sine")
    cut = [
        replace(one, values=one.values[:, : int((start + 0.2) * one.rate)])
        for one, start in zip(campaign.recordings, starts, strict=True)
    ]
    codes, words = codes_and_words(campaign.with_recordings(cut))
    assert codes == {"no-decay"}
    assert behind in words
    assert "release" not in words


def test_a_road_that_is_not_flat_behind_the_bump_is_said_to_be_so() -> None:
    """Random excitation of the wheels around their hop, with 1 m/s² root-mean-square beside 10 m/s² on the bump."""
    campaign, starts = excited("pass", "hand", "half-sine")
    random, rough = np.random.default_rng(1), []
    for one, start in zip(campaign.recordings, starts, strict=True):
        values, first = one.values.copy(), int(start * one.rate)
        motion = lfilter([1, 0, -1], [1, -1.9 * np.cos(0.12), 0.9], random.standard_normal(values[:, first:].shape))
        values[:, first:] += motion / motion.std()
        rough.append(replace(one, values=values))
    codes, words = codes_and_words(campaign.with_recordings(rough))
    assert codes == {"no-decay"}
    assert "does not die away" in words
    assert "flat, smooth road" in words


@pytest.mark.parametrize(("stated", "said"), [(5.0, None), (5.5, None), (3.0, "it is read in m/s"), (None, None)])
@pytest.mark.parametrize("wheels", [("fl", "fr", "rl", "rr"), ("fl", "rl")])
def test_a_speed_is_held_against_the_delay_of_the_rear_wheels(
    stated: float | None, said: str | None, wheels: tuple[Wheel, ...]
) -> None:
    drop = Drop(excitation="pass", wheels=wheels, speed=5.0)
    campaign = sprung.simulate(TABLE_1_CAR, drops=[drop], seed=1)
    stating = replace(campaign, drops=tuple(replace(one, speed=stated) for one in campaign.drops))
    assert measure_delay(campaign.drops[0], campaign) == pytest.approx(TABLE_1_CAR.wheelbase / 5.0, rel=0.05)
    (decay,) = prepare(stating).decays
    assert [fault.code for fault in decay.faults] == ["speed"] * (said is not None)
    assert said is None or said in decay.faults[0].do


def test_kilometres_per_hour_are_recognised() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, drops=[{"excitation": "pass", "speed": 10 / 3.6}], seed=1)
    (decay,) = prepare(replace(campaign, drops=tuple(replace(one, speed=10.0) for one in campaign.drops))).decays
    (fault,) = decay.faults
    assert "10 km/h are 2.78 m/s" in fault.do
    assert "10 m/s is stated" in fault.what


def test_no_vehicle_drives_over_a_bump_at_twenty_metres_per_second() -> None:
    with pytest.raises(InputError, match=r"5\.5556 if it was stated in km/h"):
        sprung.simulate(TABLE_1_CAR, drops=[{"excitation": "pass", "speed": 20.0}])


def test_front_and_rear_sensors_that_are_exchanged_show() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, drops=[{"excitation": "pass", "speed": 5.0}], seed=1)
    other: dict[str, Wheel] = {"fl": "rl", "fr": "rr", "rl": "fl", "rr": "fr"}
    sensors = tuple(one if one.wheel is None else replace(one, on=other[one.wheel]) for one in campaign.sensors)
    (decay,) = prepare(replace(campaign, sensors=sensors)).decays
    assert [fault.code for fault in decay.faults] == ["speed"]
    assert "before the front wheels" in decay.faults[0].what

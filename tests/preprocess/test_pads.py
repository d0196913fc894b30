"""Statements about sensors of pads that the recordings contradict, and none about sound ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from numpy.typing import NDArray

import sprung
from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.preprocess import Prepared, prepare
from sprung.simulation import PadMotion
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Sensor, Vehicle
from strategies import vehicles

Real = NDArray[np.float64]

NOISE = {"acceleration": 0.02, "displacement": 5e-5, "force": 8.0}


def on_pads(
    vehicle: Vehicle = TABLE_1_CAR, kind: Literal["random", "sweep", "step"] = "random", seed: int = 1
) -> Campaign:
    """Two tests on pads: all of them move, and those of the left side."""
    drops: list[dict[str, Any]] = [{"excitation": "pads"}, {"excitation": "pads", "wheels": ["fl", "rl"]}]
    return sprung.simulate(vehicle, drops=drops, noise=NOISE, seed=seed, rate=250, pads=PadMotion(kind, duration=20.0))


@pytest.fixture(scope="module")
def sound() -> Campaign:
    return on_pads()


def restated(campaign: Campaign, changes: dict[str, Callable[[Sensor], Sensor]]) -> Campaign:
    """Change what is stated of channels."""
    sensors = tuple(changes[one.channel](one) if one.channel in changes else one for one in campaign.sensors)
    return replace(campaign, sensors=sensors)


def scaled(campaign: Campaign, channel: str, factor: float) -> Campaign:
    """Multiply the samples of a channel."""
    factors = np.array([[factor if one.channel == channel else 1.0] for one in campaign.sensors])
    return campaign.with_recordings(replace(own, values=own.values * factors) for own in campaign.recordings)


def faults_of(prepared: Prepared) -> list[Fault]:
    return [fault for decay in prepared.decays for fault in decay.faults]


def check_corrected(spoilt: Campaign, sound: Campaign) -> Fault:
    """Check that one fault is found, and that the decays are then those of the sound campaign; return the fault."""
    prepared = prepare(spoilt)
    (fault,) = faults_of(prepared)
    for own, right in zip(prepared.decays, prepare(sound).decays, strict=True):
        np.testing.assert_allclose(own.values, right.values, rtol=1e-9)
    return fault


@pytest.mark.parametrize("kind", ["random", "sweep", "step"])
@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS], ids=lambda one: one.name)
def test_sound_sensors_have_no_fault(vehicle: Vehicle, kind: Literal["random", "sweep", "step"]) -> None:
    assert not faults_of(prepare(on_pads(vehicle, kind)))


@settings(max_examples=10, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(vehicle=vehicles)
@pytest.mark.slow
def test_sound_sensors_of_no_vehicle_have_a_fault(vehicle: Vehicle) -> None:
    assert not faults_of(prepare(on_pads(vehicle, "sweep"))) + faults_of(prepare(on_pads(vehicle)))


@pytest.mark.parametrize(
    ("channel", "unit", "factor", "named"),
    [
        ("force_fl", "kN", 1e3, "N"),
        ("force_rr", "N", 1e-3, "kN"),
        ("pad_fl", "mm", 0.1, "cm"),
        ("pad_rl", "cm", 10, "mm"),
    ],
)
def test_a_wrong_unit_of_one_pad_is_named_and_corrected(
    sound: Campaign, channel: str, unit: str, factor: float, named: str
) -> None:
    """The samples are in the named unit, and were read in the stated one."""
    spoilt = scaled(restated(sound, {channel: lambda one: replace(one, unit=unit)}), channel, factor)
    fault = check_corrected(spoilt, sound)
    assert (fault.code, fault.where) == ("unit", channel)
    assert fault.do == f'Set unit = "{named}" for it.'
    expected = (
        "N/m at the opposite pad" if channel.startswith("force") else "times as far as it reads, expected about once"
    )
    assert expected in fault.what


def test_what_is_in_no_known_unit_is_left_out(sound: Campaign) -> None:
    prepared = prepare(scaled(sound, "force_fr", 200.0))
    (fault,) = faults_of(prepared)
    assert (fault.code, fault.where) == ("unit", "force_fr")
    assert "the channel is left out" in fault.what
    index = [one.channel for one in sound.sensors].index("force_fr")
    assert all(np.flatnonzero(~decay.usable).tolist().count(index) for decay in prepared.decays)


@pytest.mark.parametrize("channel", ["pad_fl", "force_rr"])
def test_a_wrong_direction_is_named_and_corrected(sound: Campaign, channel: str) -> None:
    fault = check_corrected(scaled(sound, channel, -1.0), sound)
    assert (fault.code, fault.where) == ("sign", channel)
    assert 'direction = "down"' in fault.do


def test_a_wheel_sensor_upside_down_does_not_blame_the_pad(sound: Campaign) -> None:
    assert not faults_of(prepare(scaled(sound, "wheel_fl", -1.0)))


def exchanged(campaign: Campaign, *kinds: str) -> Campaign:
    """State the channels of some kinds at the opposite place of the front axle."""

    def opposite(one: Sensor) -> Sensor:
        place = one.on.replace("fl", "fr") if one.on and "fl" in one.on else (one.on or "").replace("fr", "fl")
        return replace(one, on=place)  # type: ignore[arg-type]

    return restated(campaign, {f"{kind}_{wheel}": opposite for kind in kinds for wheel in ("fl", "fr")})


@pytest.mark.parametrize("kinds", [("pad", "force"), ("wheel",)])
def test_exchanged_pads_or_wheels_are_told_by_the_body_and_corrected(sound: Campaign, kinds: tuple[str, ...]) -> None:
    prepared, right = prepare(exchanged(sound, *kinds)), prepare(sound)
    (fault,) = faults_of(prepared)
    assert fault.code == "exchanged"
    assert {*fault.where.split(", ")} == {f"{kind}_{wheel}" for kind in kinds for wheel in ("fl", "fr")}
    channels = [one.channel for one in sound.sensors]
    swaps = {channels.index(f"{kind}_fl"): channels.index(f"{kind}_fr") for kind in kinds}
    swaps |= {second: first for first, second in swaps.items()}
    order = [swaps.get(channel, channel) for channel in range(len(channels))]
    for own, sound_decay in zip(prepared.decays, right.decays, strict=True):
        np.testing.assert_array_equal(own.values, sound_decay.values[order])
        assert own.pads == sound_decay.pads


def test_without_sensors_of_the_body_exchanged_pads_are_only_named(sound: Campaign) -> None:
    kept = [n for n, one in enumerate(sound.sensors) if one.on != "body"]
    bare = replace(
        sound.with_recordings(
            replace(own, values=own.values[kept], channels=tuple(own.channels[n] for n in kept))
            for own in sound.recordings
        ),
        sensors=tuple(sound.sensors[n] for n in kept),
    )
    spoilt = exchanged(bare, "pad", "force")
    (fault,) = faults_of(prepare(replace(spoilt, drops=spoilt.drops[:1])))
    assert (fault.code, fault.where) == ("exchanged", "wheel_fl, wheel_fr")
    assert "wheel_fl, stated on fl, follows pad_fl, stated on pad fr" in fault.what
    # A pad that stands still by its statement moves in the second test.
    assert {fault.code for fault in faults_of(prepare(spoilt))} == {"exchanged", "wheels"}


def test_pads_that_move_beside_the_stated_ones_are_named_and_used(sound: Campaign) -> None:
    spoilt = replace(sound, drops=(replace(sound.drops[0], wheels=("fl",)), *sound.drops[1:]))
    fault = check_corrected(spoilt, sound)
    assert (fault.code, fault.where) == ("wheels", sound.recordings[0].name)
    assert "the pads under fr, rl, rr move too" in fault.what
    assert 'wheels = ["fl", "fr", "rl", "rr"]' in fault.do
    assert prepare(spoilt).decays[0].pads == ("fl", "fr", "rl", "rr")


def test_a_displacement_of_a_pad_that_is_stated_on_the_wheel_is_left_out(sound: Campaign) -> None:
    spoilt = restated(sound, {"pad_fl": lambda one: replace(one, on="fl")})
    prepared = prepare(spoilt)
    (fault,) = faults_of(prepared)
    assert (fault.code, fault.where) == ("unlike-others", "pad_fl")
    assert 'on = "pad fl"' in fault.do
    index = [one.channel for one in sound.sensors].index("pad_fl")
    assert not any(decay.usable[index] for decay in prepared.decays)


def test_a_displacement_of_a_wheel_stays(sound: Campaign) -> None:
    displacement = Sensor(channel="height_fl", on="fl", quantity="displacement", unit="m")
    campaign = sprung.simulate(
        TABLE_1_CAR,
        sensors=[*sound.sensors, displacement],
        drops=[{"excitation": "pads"}],
        noise=NOISE,
        seed=1,
        pads=PadMotion(duration=20.0),
    )
    prepared = prepare(campaign)
    assert not faults_of(prepared)
    assert prepared.decays[0].usable.all()


def test_pads_that_all_move_alike_prove_nothing(sound: Campaign) -> None:
    """With one motion of all pads nothing shows which wheel follows which."""
    channels = [one.channel for one in sound.sensors]
    same = {channels.index(f"pad_{wheel}"): channels.index("pad_fl") for wheel in ("fr", "rl", "rr")}
    order = [same.get(index, index) for index in range(len(channels))]
    first = sound.recordings[0]
    noise = (
        1e-5 * np.random.default_rng(1).standard_normal(first.values.shape) * np.isin(order, [*same.values()])[:, None]
    )
    alike = replace(sound, drops=sound.drops[:1]).with_recordings([replace(first, values=first.values[order] + noise)])
    assert not faults_of(prepare(scaled(alike, "force_fl", 1e3)))

"""Vehicles on pads through the whole of `identify`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from injuries import Change, changed
from numpy.typing import NDArray
from parts_of_a_vehicle import PITCH_PLANE, QUARTER_CAR

import sprung
from sprung.campaign import Campaign
from sprung.errors import InputError
from sprung.results import Result
from sprung.simulation import PadMotion, default_sensors
from sprung.vehicle import TABLE_1_CAR, Sensor, Vehicle

Real = NDArray[np.float64]

PADS = {"excitation": "pads"}
NOISE = {"acceleration": 0.02, "displacement": 5e-5, "force": 8.0}
"""The force to 0.2 % of a wheel load, the displacement to 0.05 mm."""

SHORT = PadMotion(duration=10.0)


def errors_of(result: Result, vehicle: Vehicle) -> dict[str, float]:
    return {
        name: np.inf if one.value is None else abs(one.value / vehicle.parameters[name] - 1)
        for name, one in result.parameters.items()
        if vehicle.parameters.get(name)
    }


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, PITCH_PLANE, QUARTER_CAR], ids=lambda one: one.name)
@pytest.mark.slow
def test_identify_inverts_simulate_and_nothing_is_weighed(vehicle: Vehicle) -> None:
    campaign = sprung.simulate(vehicle, drops=[PADS], noise=0, pads=SHORT)
    result = sprung.identify(campaign, extras=(), tracks="shared")
    assert max(errors_of(result, vehicle).values()) < 1e-6
    assert result.verdict.state == "accept"
    assert result.scale.known


@pytest.mark.slow
def test_half_a_minute_on_pads_determines_every_parameter_to_half_a_percent() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, drops=[PADS], noise=NOISE, seed=1)
    result = sprung.identify(campaign)
    assert result.verdict.state == "accept"
    assert result.fit.model == ()
    assert not result.faults
    assert max(errors_of(result, TABLE_1_CAR).values()) < 5e-3
    assert all(one.std is not None and one.std < 5e-3 * abs(one.value or 0) for one in result.parameters.values())
    assert ("select_nonlinear_terms", "no nonlinear term is tried") in [
        (step.stage, step.what) for step in result.trace
    ]
    expected = [NOISE[sensor.quantity] for sensor in campaign.sensors]
    np.testing.assert_allclose(list(result.fit.noise.values()), expected, rtol=0.15)


def test_pads_and_drops_of_one_vehicle_are_identified_together() -> None:
    """A pad's sensors tell nothing of a drop, and an accelerometer has one noise level in both."""
    drops: list[Mapping[str, object]] = [PADS, {"wheels": ["fl", "fr"]}, {"excitation": "pads", "wheels": ["fl", "rl"]}]
    campaign = sprung.simulate(TABLE_1_CAR, drops=drops, noise=NOISE, seed=1, pads=SHORT)
    result = sprung.identify(campaign, extras=(), tracks="shared")
    assert result.verdict.state == "accept"
    assert max(errors_of(result, TABLE_1_CAR).values()) < 5e-3
    assert len(result.validation) == 3
    assert all(0.5 < drop.residual < 1.2 for drop in result.validation.values())


@pytest.mark.slow
def test_a_damper_mount_is_found_on_pads() -> None:
    vehicle = TABLE_1_CAR.with_values(k_df=2.1e5, k_dr=2.6e5)
    campaign = sprung.simulate(vehicle, drops=[PADS], noise=NOISE, seed=1, pads=PadMotion(duration=20.0))
    result = sprung.identify(campaign)
    assert result.fit.model == ("damper-mount",)
    assert max(errors_of(result, vehicle).values()) < 0.02


def test_forces_known_to_one_percent_give_the_scale_to_half_of_that() -> None:
    """Four sensors whose gains are uncertain by 1 % each."""
    campaign = sprung.simulate(TABLE_1_CAR, drops=[PADS], noise=NOISE, seed=1, pads=SHORT)
    sensors = tuple(replace(one, gain_std=0.01) if one.quantity == "force" else one for one in campaign.sensors)
    result = sprung.identify(replace(campaign, sensors=sensors), extras=(), tracks="shared")
    mass = result.parameters["m_s"]
    assert mass.std == pytest.approx(0.005 * 1380, rel=0.2)


@pytest.mark.long
def test_a_force_that_reads_ten_percent_too_little_is_corrected() -> None:
    """Gains are stated to 1 %, to which that of the corrected channel is known as well."""
    made = sprung.simulate(TABLE_1_CAR, drops=[PADS], noise=NOISE, seed=1, pads=SHORT, sensor_errors=True)
    result = sprung.identify(spoilt(made, "force_rl", lambda record: 0.9 * record), extras=(), tracks="shared")
    assert [(fault.code, fault.where) for fault in result.faults] == [("gain", "force_rl")]
    mass = result.parameters["m_s"]
    assert mass.std == pytest.approx(0.006 * 1380, rel=0.2)
    assert mass.value == pytest.approx(1380, abs=3 * (mass.std or 0))


def spoilt(campaign: Campaign, channel: str, change: Change) -> Campaign:
    """Return a campaign of which one channel recorded something else."""
    return changed(campaign, [[sensor.channel for sensor in campaign.sensors].index(channel)], change)


def late(record: Real) -> Real:
    return np.roll(record, 3)


@pytest.mark.parametrize(
    ("channel", "change", "code"),
    [
        ("body_fr", lambda record: 1.3 * record, "gain"),
        ("wheel_fr", lambda record: 1.05 * record, "gain"),
        ("pad_fr", lambda record: 1.05 * record, "gain"),
        ("wheel_rl", lambda record: -record, "sign"),
        ("body_rl", late, "late"),
        ("wheel_rr", late, "late"),
        ("pad_fr", late, "late"),
    ],
)
@pytest.mark.slow
def test_one_sensor_at_fault_is_named_and_corrected(channel: str, change: Change, code: str) -> None:
    """What is predicted of free decays does not hold on pads: such campaigns were rejected after a minute without a reason."""
    made = sprung.simulate(TABLE_1_CAR, drops=[PADS], noise=NOISE, seed=1, pads=SHORT)
    result = sprung.identify(spoilt(made, channel, change))
    assert [(fault.code, fault.where) for fault in result.faults] == [(code, channel)]
    assert (result.verdict.state, result.fit.model) == ("accept", ())
    assert max(errors_of(result, TABLE_1_CAR).values()) < 5e-3


@pytest.mark.slow
def test_a_sensor_stated_elsewhere_on_pads_is_named_and_corrected() -> None:
    made = sprung.simulate(TABLE_1_CAR, drops=[PADS], noise=NOISE, seed=1, pads=SHORT)
    sensors = [
        replace(one, position=(one.position[0] + 0.3, *one.position[1:]))
        if one.channel == "body_rl" and one.position is not None
        else one
        for one in made.sensors
    ]
    result = sprung.identify(replace(made, sensors=tuple(sensors)))
    assert [(fault.code, fault.where) for fault in result.faults] == [("position", "body_rl")]
    assert result.verdict.state == "accept"
    assert max(errors_of(result, TABLE_1_CAR).values()) < 5e-3


@pytest.mark.parametrize(
    ("term", "values"),
    [
        ("damper-mount", {"k_df": 3e5, "k_dr": 2.5e5}),
        ("tyre-damping", {"c_tf": 150.0, "c_tr": 150.0}),
        ("anti-roll", {"k_af": 8e3, "k_ar": 5e3}),
    ],
)
@pytest.mark.slow
def test_what_a_model_lacks_on_pads_blames_no_sensor(term: str, values: Mapping[str, float]) -> None:
    campaign = sprung.simulate(TABLE_1_CAR.with_values(**values), drops=[PADS], noise=NOISE, seed=2, pads=SHORT)
    result = sprung.identify(campaign)
    assert (result.verdict.state, result.fit.model, result.faults) == ("accept", (term,), ())


def without(campaign: Campaign, channels: set[str]) -> Campaign:
    """Return a campaign in which channels hold nothing."""
    gone = [sensor.channel in channels for sensor in campaign.sensors]
    drops = [
        replace(
            drop,
            recording=replace(drop.recording, values=np.where(np.array(gone)[:, None], 0.0, drop.recording.values)),
        )
        for drop in campaign.drops
    ]
    return replace(campaign, drops=tuple(drops))


def test_a_pad_whose_sensors_are_dead_leaves_its_record_out() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, drops=[PADS], noise=NOISE, seed=1, pads=SHORT)
    with pytest.raises(InputError, match="neither displacement nor force is known of the pads under fl"):
        sprung.identify(without(campaign, {"pad_fl", "force_fl"}))
    result = sprung.identify(without(campaign, {"pad_fl"}), extras=(), tracks="shared")
    assert max(errors_of(result, TABLE_1_CAR).values()) < 0.01


def pad(wheel: str) -> Sensor:
    return Sensor(channel=f"pad_{wheel}", on=f"pad {wheel}", quantity="displacement", unit="m")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("sensors", "drops", "message"),
    [
        ([], [PADS], "no displacement and no force of the pad under fl, fr, rl, rr"),
        ([pad("fl"), pad("fr")], [PADS], "no displacement and no force of the pad under rl, rr"),
        ([pad("fl")], [{}], "pad_fl on pads that do not move"),
    ],
)
def test_statements_of_pads_and_drops_have_to_agree(
    sensors: list[Sensor], drops: list[dict[str, object]], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        sprung.simulate(TABLE_1_CAR, sensors=[*default_sensors(TABLE_1_CAR), *sensors], drops=drops, pads=SHORT)


def test_what_needs_time_stepping_is_refused() -> None:
    campaign = sprung.simulate(QUARTER_CAR, drops=[PADS], noise=NOISE, seed=1, pads=SHORT)
    with pytest.raises(InputError, match="extras friction, and drops on pads"):
        sprung.identify(campaign, extras="friction")
    with pytest.raises(InputError, match="a linear vehicle on pads that move"):
        sprung.simulate(TABLE_1_CAR.with_values(F_f=50.0, F_r=50.0), drops=[PADS])
    with pytest.raises(InputError, match="not on pads"):
        sprung.modes(campaign)
    with pytest.raises(InputError, match="drops, pushes or passes"):
        sprung.plan(QUARTER_CAR, drops=[PADS])


def test_impossible_pads_are_named_all_at_once() -> None:
    with pytest.raises(InputError) as caught:
        sprung.simulate(
            QUARTER_CAR, drops=[PADS], pads=PadMotion(amplitude=-1.0, lowest=5.0, highest=2.0, duration=1.0)
        )
    assert len(caught.value.problems) == 3

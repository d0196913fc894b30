"""The landing by the heights of wheels, where no accelerometers on the body show it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sprung.campaign import Campaign, Drop
from sprung.preprocess import prepare
from sprung.simulation import default_sensors, drop_from_blocks, simulate
from sprung.units import Quantity
from sprung.vehicle import EMPTY, TABLE_1_CAR, Sensor, Vehicle

QUARTER_CAR = Vehicle(model="quarter", m_s=340.0, m_u=42.0, k_s=21e3, k_t=195e3, c_s=1450.0)

ALLOWED = 0.25
"""s that are allowed for wheel hop after the fall where no sensor shows it."""


def travels(vehicle: Vehicle) -> list[Sensor]:
    """Return sensors of suspension travel."""
    wheels = vehicle.layout.wheels
    return [Sensor(channel=f"travel_{one}", on="body", quantity="displacement", relative_to=one) for one in wheels]


def recorded(vehicle: Vehicle, sensors: list[Sensor]) -> Campaign:
    """Return drops with displacements of 0.05 mm and accelerations of 0.02 m/s² of noise."""
    noise = {one.channel: 5e-5 if one.quantity == "displacement" else 0.02 for one in sensors}
    wheels = vehicle.layout.wheels
    drops = [{"wheels": some, "height": 0.05} for some in (wheels, wheels[:1])]
    return simulate(vehicle, sensors=sensors, drops=drops, noise=noise, seed=3)


def landing(vehicle: Vehicle, drop: Drop) -> float:
    """Return when the last tyre of a drop last touches the ground, s."""
    return 0.4 + drop_from_blocks(vehicle, EMPTY, drop.wheels, drop.height or 0.05, duration=3.2).decay_start


@pytest.mark.parametrize("vehicle", [QUARTER_CAR, TABLE_1_CAR], ids=["quarter car", "car"])
@pytest.mark.parametrize("quantity", ["displacement", "acceleration"])
def test_a_decay_begins_soon_after_the_last_tyre_touches(vehicle: Vehicle, quantity: Quantity) -> None:
    """What is allowed for wheel hop is longer by far than it lasts, and these samples tell most."""
    hubs = [replace(one, quantity=quantity) for one in default_sensors(vehicle) if one.on != "body"]
    campaign = recorded(vehicle, [*travels(vehicle), *hubs])
    for decay, drop in zip(prepare(campaign).decays, campaign.drops, strict=True):
        touched = landing(vehicle, drop)
        assert touched <= decay.start < touched + ALLOWED / 2
        assert decay.start - decay.earlier.shape[1] / decay.rate <= touched + 0.01


def test_without_the_height_of_the_blocks_accelerometers_do_not_tell_how_low_a_wheel_is() -> None:
    hubs = [one for one in default_sensors(QUARTER_CAR) if one.on != "body"]
    campaign = recorded(QUARTER_CAR, [*travels(QUARTER_CAR), *hubs])
    unknown = replace(campaign, drops=tuple(replace(drop, height=None) for drop in campaign.drops))
    for known, decay in zip(prepare(campaign).decays, prepare(unknown).decays, strict=True):
        assert decay.start > known.start + ALLOWED / 2


def test_travel_alone_does_not_show_when_a_tyre_touches() -> None:
    campaign = recorded(QUARTER_CAR, travels(QUARTER_CAR))
    for decay, drop in zip(prepare(campaign).decays, campaign.drops, strict=True):
        assert decay.start > landing(QUARTER_CAR, drop) + ALLOWED / 2


def test_a_wheel_that_is_high_again_is_waited_for() -> None:
    """It rises by 2 cm after 0.1 s, as a tyre that leaves the ground lets it."""
    hubs = [replace(one, quantity="displacement") for one in default_sensors(QUARTER_CAR) if one.on != "body"]
    campaign = recorded(QUARTER_CAR, [*travels(QUARTER_CAR), *hubs])
    raised = [one.recording.values.copy() for one in campaign.drops]
    time = np.arange(raised[0].shape[1]) / campaign.drops[0].recording.rate
    for values in raised:
        values[1, (time > 0.55) & (time < 0.58)] += 0.02
    higher = campaign.with_recordings(
        replace(drop.recording, values=values) for drop, values in zip(campaign.drops, raised, strict=True)
    )
    for decay in prepare(higher).decays:
        assert 0.578 <= decay.start < 0.6

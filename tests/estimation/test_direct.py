"""The direct start against the truth, and the frame it works in against the usual one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

from sprung.estimation.modulating_functions import modulating_function_estimate
from sprung.estimation.records import batch_records
from sprung.estimation.starts import VehicleSize
from sprung.preprocess import prepare
from sprung.simulation import simulate
from sprung.uncertainty import KnownValue
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Load, Vehicle, parse_record
from strategies import vehicles

BAGS = parse_record(
    Load,
    {
        "name": "bags",
        "items": [{"mass": 140, "position": (-1.0, 0.2, 0.5)}, {"mass": 100, "position": (-2.9, 0.0, 0.5)}],
    },
)
CRATES = parse_record(
    Load,
    {
        "name": "crates",
        "items": [{"mass": 1000, "position": (-2.0, 0.0, 1.0)}, {"mass": 600, "position": (-5.0, 0.3, 1.0)}],
    },
)


def start(
    vehicle: Vehicle, load: Load | None, noise: float = 0.0, known: dict[str, KnownValue] | None = None
) -> dict[str, float] | None:
    campaign = simulate(vehicle, loads=[] if load is None else [load], noise=noise, seed=1, rate=500, duration=3.2)
    decays = prepare(campaign).decays
    models = [vehicle.linear_model(campaign.load(name)) for name in sorted({decay.load for decay in decays})]
    given = {"wheelbase": KnownValue(vehicle.wheelbase, 0.0)} | (known or {})
    size = VehicleSize.of(given, campaign.sensors)
    return modulating_function_estimate(batch_records(decays), models, campaign.sensors, size)


def errors(found: dict[str, float] | None, vehicle: Vehicle) -> dict[str, float]:
    assert found is not None
    return {name: abs(found[name] / value - 1) for name, value in vehicle.parameters.items()}


@pytest.mark.parametrize(("vehicle", "load"), [(TABLE_1_CAR, BAGS), (SCHOOL_BUS, CRATES)])
def test_without_noise_it_is_nearly_there(vehicle: Vehicle, load: Load) -> None:
    # What is left is the difference between sums over samples and integrals.
    assert max(errors(start(vehicle, load), vehicle).values()) < 0.005


def test_noise_does_not_bend_it() -> None:
    # Least squares as they are would be wrong by factors here: noise is in what is multiplied, too.
    assert max(errors(start(TABLE_1_CAR, BAGS, noise=0.1), TABLE_1_CAR).values()) < 0.15
    assert max(errors(start(TABLE_1_CAR, BAGS, noise=0.2), TABLE_1_CAR).values()) < 0.6


def test_a_weighed_vehicle_needs_no_load() -> None:
    weighed = {"total_mass": KnownValue(TABLE_1_CAR.total_mass, 0.0)}
    found = start(TABLE_1_CAR, None, noise=0.02, known=weighed)
    # The share of the wheels in the total is a usual one: a few percent off the scale.
    wrong = errors(found, TABLE_1_CAR)
    assert found is not None
    assert max(wrong.values()) < 0.1
    assert found["k_sf"] / found["m_s"] == pytest.approx(TABLE_1_CAR.k_sf / TABLE_1_CAR.m_s, rel=0.02)


def test_it_says_when_it_cannot() -> None:
    """Four sensors do not see seven coordinates."""
    campaign = simulate(TABLE_1_CAR, noise=0.02, seed=1)
    blind = np.array([0.0] * 4 + [np.nan] * 4)[:, None]
    batches = batch_records([replace(decay, values=decay.values + blind) for decay in prepare(campaign).decays])
    outline = VehicleSize.of({"wheelbase": KnownValue(TABLE_1_CAR.wheelbase, 0.0)}, campaign.sensors)
    assert modulating_function_estimate(batches, [TABLE_1_CAR.linear_model()], campaign.sensors, outline) is None


@settings(max_examples=20, deadline=None)
@given(vehicle=vehicles)
def test_the_poles_are_the_same_seen_from_the_front_axle(vehicle: Vehicle) -> None:
    model, values = vehicle.linear_model(BAGS), list(vehicle.parameters.values())
    moved = model.referred_to_front_axle(vehicle.wheelbase)
    here, there = (np.poly(one.matrices(values).state / 50) for one in (model, moved))
    np.testing.assert_allclose(here, there, rtol=1e-7, atol=1e-9 * np.abs(here).max())
    # Nothing but the mass depends on where the centre of gravity is.
    ahead = 1 + model.names.index("a")
    assert not moved.terms[(moved.products == ahead).any(axis=1), 1:].any()

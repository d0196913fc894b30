"""Air springs that a valve levels under every load: where they rest, how stiff they are there, and identified."""

from __future__ import annotations

import numpy as np
import pytest

import sprung
from sprung.vehicle import TABLE_1_CAR, Load, Vehicle, parse_record

CAR = Vehicle.from_parameters(
    TABLE_1_CAR.parameters | {"e_lf": 6.0, "e_lr": 8.0, "g_f": 50.0, "g_r": 90.0}, name="car on levelled air springs"
)
LOAD = {"name": "ballast", "items": [{"mass": 200.0, "position": (-2.07, 0.0, 0.5)}]}


def test_the_rate_grows_with_what_the_spring_carries() -> None:
    """The load lies at three quarters of the wheelbase of 2.76 m: a rear wheel carries 75 kg of it, a front wheel 25 kg."""
    load = parse_record(Load, LOAD)
    assert load.mass_at_wheels(CAR.wheelbase) == pytest.approx({"f": 25.0, "r": 75.0})
    stiffer = Vehicle.from_parameters(
        TABLE_1_CAR.parameters | {"k_sf": CAR.k_sf + 25.0 * 50.0, "k_sr": CAR.k_sr + 75.0 * 90.0}
    )
    np.testing.assert_allclose(CAR.matrices(load).K, stiffer.matrices(load).K, rtol=1e-12, atol=1e-6)
    np.testing.assert_allclose(CAR.matrices().K, TABLE_1_CAR.matrices().K, rtol=1e-12, atol=1e-6)


@pytest.mark.slow
def test_a_small_motion_is_that_of_the_linear_vehicle_under_any_load() -> None:
    """A sealed spring is stiffer where the load has pressed it together; one that is levelled is not."""
    drops = [{"wheels": ("fl", "fr", "rl", "rr"), "load": "ballast", "height": 0.002}]
    levelled, sealed, linear = (
        sprung.simulate(Vehicle.from_parameters(TABLE_1_CAR.parameters | more), loads=[LOAD], drops=drops, noise=0.0)
        for more in ({"e_lf": 6.0, "e_lr": 8.0}, {"e_f": 6.0, "e_r": 8.0}, {})
    )
    records = [one.drops[0].recording.values for one in (levelled, sealed, linear)]
    levelled_differs, sealed_differs = (np.abs(record - records[2]).max() for record in records[:2])
    assert sealed_differs > 5 * levelled_differs


@pytest.mark.long
def test_they_are_identified() -> None:
    drops = [
        {"wheels": wheels, "load": load, "height": 0.06}
        for load in ("empty", "ballast")
        for wheels in (("fl", "fr", "rl", "rr"), ("fl", "rl"))
    ]
    campaign = sprung.simulate(CAR, loads=[LOAD], drops=drops, noise=0.02, seed=3)
    result = sprung.identify(campaign, extras=("levelled-air",), tracks="shared")
    assert result.verdict.state == "accept"
    for name in ("k_sf", "k_sr", "e_lf", "e_lr", "g_f", "g_r", "m_s", "c_sf"):
        estimate = result.parameters[name]
        assert estimate.std is not None
        assert estimate.value == pytest.approx(getattr(CAR, name), abs=4 * estimate.std), name

"""Tyres whose rate grows with their deflection: at rest, through a whole drop, and identified."""

from __future__ import annotations

import numpy as np
import pytest

import sprung
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import TABLE_1_CAR, Vehicle, differentiate_tyre_rates_at_rest, with_tyre_rates_at_rest

GROWTH = 14.0
CAR = Vehicle.from_parameters(
    TABLE_1_CAR.parameters | {"h_tf": GROWTH, "h_tr": GROWTH, "c_tf": 90.0, "c_tr": 90.0}, name="car with tyre curves"
)


def rate_at_rest(car: Vehicle, axle: str) -> float:
    """k d (1 + h d/2) = W, solved for the deflection d by hand; the rate there is k (1 + h d)."""
    far = car.b if axle == "f" else car.a
    weight = STANDARD_GRAVITY * (car.m_s * far / (2 * (car.a + car.b)) + getattr(car, f"m_u{axle}"))
    rate, growth = getattr(car, f"k_t{axle}"), getattr(car, f"h_t{axle}")
    return float(rate * (1 + growth * max(np.roots([rate * growth / 2, rate, -weight]))))


def test_near_rest_it_moves_with_the_rates_that_its_tyres_have_there() -> None:
    linear = TABLE_1_CAR.with_values(
        k_tf=rate_at_rest(CAR, "f"), k_tr=rate_at_rest(CAR, "r"), c_tf=CAR.c_tf, c_tr=CAR.c_tr
    )
    assert linear.k_tf > 1.15 * CAR.k_tf
    np.testing.assert_allclose(CAR.matrices().K, linear.matrices().K, rtol=1e-9, atol=1e-6)


def test_the_rates_at_rest_are_differentiated() -> None:
    model, values = CAR.linear_model(), np.array(list(CAR.parameters.values()))
    rate, mass = (model.names.index(name) for name in ("k_tf", "m_s"))
    slopes = differentiate_tyre_rates_at_rest(model, values)
    for place in (rate, mass):
        ends = []
        for factor in (1 + 1e-4, 1 - 1e-4):
            moved = values.copy()
            moved[place] *= factor
            ends.append(rate_at_rest(Vehicle.from_parameters(dict(zip(model.names, moved.tolist(), strict=True))), "f"))
        assert slopes[rate, place] == pytest.approx((ends[0] - ends[1]) / (2e-4 * values[place]), rel=1e-5)
    unchanged = [i for i, name in enumerate(model.names) if not name.startswith("k_t")]
    np.testing.assert_allclose(slopes[unchanged], np.eye(len(values))[unchanged], atol=1e-9)
    np.testing.assert_array_equal(with_tyre_rates_at_rest(model, values)[unchanged], values[unchanged])


@pytest.mark.long
def test_they_are_identified_from_drops_in_which_they_leave_the_ground() -> None:
    """Truth and simulation are of the same model here; docs/studies/real_cars.py has tyres of another program."""
    drops = [
        {"wheels": wheels, "load": load} for load in ("empty", "ballast") for wheels in (("fl", "fr"), ("fl", "rl"))
    ]
    load = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.3, 0.5)}]}
    campaign = sprung.simulate(CAR, loads=[load], drops=drops, noise=0.02, seed=2)
    result = sprung.identify(campaign, extras=("tyre-damping", "tyre-curve"), tracks="shared")
    assert result.verdict.state == "accept"
    for name, truth in CAR.parameters.items():
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - truth) < 4 * found.std, name
        assert not name.startswith("k_t") or abs(found.value / truth - 1) < 0.02
    assert result.curves["tyre_front"].reached[1] <= 0
    deflection = -0.02
    point = result.curves["tyre_front"].at(deflection)
    error = float(point.force) - CAR.k_tf * deflection * (1 - GROWTH * deflection / 2)
    assert abs(error) < 4 * float(point.std)


@pytest.mark.slow
def test_their_curve_ends_where_a_falling_wheel_leaves_it() -> None:
    drops = [
        {"wheels": wheels, "load": load} for load in ("empty", "ballast") for wheels in (("fl", "fr"), ("rl", "rr"))
    ]
    load = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.3, 0.5)}]}
    car = CAR.with_values(c_tf=0.0, c_tr=0.0)
    campaign = sprung.simulate(car, loads=[load], drops=drops, duration=2.0, noise=0.02, seed=2)
    result = sprung.identify(campaign, extras=("tyre-curve",), tracks="shared", fall=True)
    assert {name: curve.reached[1] for name, curve in result.curves.items()} == {"tyre_front": 0.0, "tyre_rear": 0.0}

"""Loads on seats: a cushion between the item and the body, which the drops tell."""

from __future__ import annotations

import numpy as np
import pytest

import sprung
from sprung.errors import InputError
from sprung.vehicle import TABLE_1_CAR, Load, Vehicle, parse_record

OMEGA = 2 * np.pi * 4.0
CAR = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"w_l": OMEGA**2, "c_l": 2 * 0.3 * OMEGA})
ITEMS = [
    {"mass": 75.0, "position": (-1.0, 0.35, 0.6), "on": "seat"},
    {"mass": 75.0, "position": (-2.0, -0.35, 0.6), "on": "seat"},
    {"mass": 100.0, "position": (-2.5, 0.0, 0.5), "on": "floor"},
]
LOAD = {"name": "people", "items": ITEMS}


def test_on_a_rigid_seat_they_are_on_the_floor() -> None:
    """Where every item moves as the body below it, kinetic energy and weight are those of the same items on the floor."""
    soft = parse_record(Load, LOAD)
    hard = parse_record(Load, {"name": "people", "items": [{**item, "on": "floor"} for item in ITEMS]})
    heave, pitch, roll = 0.7, 0.3, -0.4
    body = np.array([heave, pitch, roll, 0.1, 0.2, 0.3, 0.4])
    places = [item.position for item in soft.items[:2] if item.position is not None]
    people = [heave - pitch * (CAR.a + x) + roll * y for x, y, _ in places]
    together = np.array([*body, *people, 0.0, 0.0])
    rigid, own = TABLE_1_CAR.matrices(hard), CAR.matrices(soft)
    assert together @ own.M @ together == pytest.approx(body @ rigid.M @ body, rel=1e-12)
    assert together @ own.K @ together == pytest.approx(body @ rigid.K @ body, rel=1e-12)
    assert together @ own.C @ together == pytest.approx(body @ rigid.C @ body, rel=1e-12)


def test_a_held_body_lets_them_move_at_their_own_frequency() -> None:
    own = CAR.matrices(parse_record(Load, LOAD))
    for place in (7, 8):
        assert own.K[place, place] / own.M[place, place] == pytest.approx(OMEGA**2)
        assert own.C[place, place] / own.M[place, place] == pytest.approx(2 * 0.3 * OMEGA)


@pytest.mark.slow
def test_they_are_identified() -> None:
    drops = [
        {"wheels": wheels, "load": load}
        for load in ("empty", "people")
        for wheels in (("fl", "fr", "rl", "rr"), ("fl", "fr"), ("fl", "rl"))
    ]
    campaign = sprung.simulate(CAR, loads=[LOAD], drops=drops, noise=0.02, seed=4)
    result = sprung.identify(campaign)
    assert result.verdict.state == "accept"
    assert result.faults == ()
    assert "seat-load" in result.fit.model
    for name in ("w_l", "c_l", "m_s", "I_yy", "k_sf", "k_sr", "c_sf", "c_sr"):
        estimate = result.parameters[name]
        assert estimate.std is not None
        assert estimate.value == pytest.approx(getattr(CAR, name), abs=4 * estimate.std), name


def test_without_such_an_item_nobody_can_ask_for_it() -> None:
    drops = [{"wheels": ("fl", "fr"), "load": "empty"}]
    campaign = sprung.simulate(TABLE_1_CAR, drops=drops, noise=0.02, seed=1)
    with pytest.raises(InputError, match="no item of a load on a seat"):
        sprung.identify(campaign, extras=("seat-load",))


def test_more_than_four_seats_are_too_many() -> None:
    items = [{"mass": 70.0, "position": (-0.5 * i, 0.0, 0.6), "on": "seat"} for i in range(5)]
    with pytest.raises(ValueError, match="at most 4 items"):
        parse_record(Load, {"name": "people", "items": items})

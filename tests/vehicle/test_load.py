"""What loads add to the mass matrix."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from sprung.errors import InputError
from sprung.vehicle import EMPTY, SCHOOL_BUS, TABLE_1_CAR, WHEELS, Added, Item, Load, Vehicle

CAR_MASS = TABLE_1_CAR.matrices().M


def added_mass(load: Load) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return TABLE_1_CAR.matrices(load).M - CAR_MASS


@given(
    st.lists(
        st.builds(
            Item,
            mass=st.floats(1, 300),
            position=st.tuples(st.floats(-4, 1), st.floats(-1, 1), st.just(0.5)),
            inertia=st.tuples(st.floats(0, 50), st.floats(0, 50)),
        ),
        min_size=1,
        max_size=4,
    )
)
@settings(max_examples=25, deadline=None)
def test_items_add_the_moments_of_a_set_of_point_masses(items: list[Item]) -> None:
    # About the empty body's centre of gravity, at x = -a: θ moves a point at x by -(x + a) θ, φ one at y by y φ.
    expected = np.zeros((7, 7))
    for item in items:
        assert item.position is not None
        m, ahead, y = item.mass, item.position[0] + TABLE_1_CAR.a, item.position[1]
        expected[:3, :3] += [
            [m, -m * ahead, m * y],
            [-m * ahead, m * ahead**2, -m * ahead * y],
            [m * y, -m * ahead * y, m * y**2],
        ]
        expected[1, 1] += item.inertia[1]
        expected[2, 2] += item.inertia[0]
    delta_M = added_mass(Load(name="load", items=tuple(items)))
    assert_allclose(delta_M, expected, rtol=1e-9, atol=1e-9)
    assert np.linalg.matrix_rank(delta_M, tol=1e-9) <= 3


@pytest.mark.parametrize(
    ("along", "across"),
    [((1.5, -1.5), (0.85, -0.85)), ((1.5, 1.5, -1.5, -1.5), (0.85, -0.85, 0.85, -0.85))],
    ids=["two items", "four items"],
)
def test_symmetric_items_reproduce_the_totals_of_the_paper_s_bus(
    along: tuple[float, ...], across: tuple[float, ...]
) -> None:
    # Section 4.1: 470 kg, 1057.5 kg m² = 470 · 1.5² in pitch and 339.6 kg m² = 470 · 0.85² in roll.
    share = 470 / len(along)
    items = tuple(Item(mass=share, position=(at - SCHOOL_BUS.a, y, 1.0)) for at, y in zip(along, across, strict=True))
    by_items = SCHOOL_BUS.matrices(Load(name="sandbags", items=items)).M - SCHOOL_BUS.matrices().M
    totals = Load(name="sandbags", added=Added(mass=470, I_yy=1057.5, I_xx=339.6))
    by_totals = SCHOOL_BUS.matrices(totals).M - SCHOOL_BUS.matrices().M
    assert_allclose(np.diag(by_items), np.diag(by_totals), rtol=1e-4, atol=1e-9)  # 470 · 0.85² = 339.575
    assert_allclose(by_totals, np.diag([470, 1057.5, 339.6, 0, 0, 0, 0]), atol=1e-9)
    if len(along) == 2:  # two items lie on a diagonal and couple pitch with roll; totals cannot tell
        assert by_items[1, 2] == pytest.approx(-470 * 1.5 * 0.85)
    else:
        assert_allclose(by_items, np.diag(np.diag(by_items)), atol=1e-9)


def test_height_counts_only_where_that_of_the_centre_of_gravity_is_known() -> None:
    load = Load(name="roof", items=(Item(mass=100, position=(-TABLE_1_CAR.a, 0, 1.7), inertia=(3, 8)),))
    expected = np.diag([100.0, 8, 3, 0, 0, 0, 0])
    assert_allclose(added_mass(load), expected, atol=1e-9)
    low = Vehicle.from_parameters(TABLE_1_CAR.parameters, cg_height=0.5)
    expected[1, 1] += 100 * 1.2**2
    expected[2, 2] += 100 * 1.2**2
    assert_allclose(low.matrices(load).M - CAR_MASS, expected, atol=1e-9)


def test_items_on_wheels_and_added_wheel_masses() -> None:
    on_wheels = tuple(Item(mass=4.0 if wheel[0] == "f" else 5.0, on=wheel) for wheel in WHEELS)
    by_items, by_totals = (
        added_mass(load)
        for load in (
            Load(name="items", items=on_wheels),
            Load(name="totals", added=Added(mass=0, m_uf=4, m_ur=5)),
        )
    )
    assert_allclose(by_items, np.diag([0, 0, 0, 4, 4, 5, 5]), atol=1e-12)
    assert_allclose(by_totals, by_items, atol=1e-12)
    assert Load(name="items", items=on_wheels).total_mass() == 18
    assert Load(name="t", added=Added(mass=0, m_uf=4, m_ur=5)).total_mass() == 18


def test_empty_adds_nothing() -> None:
    assert EMPTY.elements() == ()
    assert EMPTY.total_mass() == 0


@pytest.mark.parametrize(
    ("given_load", "message"),
    [
        ({"name": "empty", "added": {"mass": 1}}, "give this load another name"),
        ({"name": "x", "added": {"mass": 1}, "items": [{"mass": 1, "on": "fl"}]}, "not both"),
        ({"name": "x", "items": [{"mass": 1}]}, r"n item needs its position = \[x, y, z\] on the body, or the wheel"),
        (
            {"name": "x", "items": [{"mass": 1, "on": "fl", "position": [0, 0, 0]}]},
            'n item with on = "fl" sits on that wheel and has no position',
        ),
        (
            {"name": "x", "items": [{"mass": 75, "on": "seat"}]},
            r'n item with on = "seat" needs its position = \[x, y, z\] too',
        ),
        ({"name": "x", "items": [{"mass": -1, "on": "fl"}]}, "greater than 0"),
        ({"name": "x", "added": {"mass": 1, "I_zz": 2}}, "the unknown key 'I_zz'"),
    ],
)
def test_a_load_that_cannot_be_is_refused(given_load: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Load(**given_load)


def test_a_load_of_which_nothing_is_known_adds_nothing_in_silence() -> None:
    with pytest.raises(InputError, match=r"load 'x': found neither items nor added"):
        Load(name="x").elements()

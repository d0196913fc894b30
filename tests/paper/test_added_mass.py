"""Eqs. (15)-(18) on state matrices that are known, and the parameters from M, C and K."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from sprung.errors import InputError
from sprung.estimation.monomials import parameters_from_matrices
from sprung.paper.added_mass import added_mass
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Added, Load, Matrices, Vehicle
from strategies import make_vehicle, vehicles


@given(vehicles, st.floats(0.03, 0.5))
@settings(max_examples=30, deadline=None)
def test_equation_18_gives_back_the_matrices(vehicle: Vehicle, part: float) -> None:
    M, C, K = vehicle.matrices()
    loaded = Matrices((1 + part) * M, C, K).state
    found = added_mass(vehicle.matrices().state, loaded, part * M)
    for one, other in zip(found, (M, C, K), strict=True):
        assert_allclose(one, other, atol=1e-8 * np.abs(other).max())


def test_a_load_on_the_body_alone_is_refused_with_the_way_out() -> None:
    # The load of the paper's experiment, section 4.1.
    load = Load(name="loaded", added=Added(mass=470, I_yy=1057.5, I_xx=339.6))
    empty, loaded = SCHOOL_BUS.matrices(), SCHOOL_BUS.matrices(load)
    with pytest.raises(InputError) as caught:
        added_mass(empty.state, loaded.state, loaded.M - empty.M)
    message = str(caught.value)
    assert "rank 3 of 7, no added mass on z_uA, z_uB, z_uC, z_uD" in message
    assert "structured_least_squares" in message


def test_rank_is_judged_whatever_the_units_and_couplings_of_the_load() -> None:
    M = TABLE_1_CAR.matrices().M
    off_centre = np.zeros((7, 7))
    off_centre[:3, :3] = 100 * np.outer([1, 0.3, 0.2], [1, 0.3, 0.2])  # one bag: rank 1
    with pytest.raises(InputError, match="rank 5 of 7"):
        added_mass(np.eye(14), np.eye(14), off_centre + np.diag([0, 0, 0, 1, 1, 1, 1]))
    with pytest.raises(InputError, match="rank 0 of 7"):
        added_mass(np.eye(14), np.eye(14), np.zeros((7, 7)))
    tiny = 1e-6 * M
    loaded = Matrices(M + tiny, *TABLE_1_CAR.matrices()[1:]).state
    assert_allclose(added_mass(TABLE_1_CAR.matrices().state, loaded, tiny).M, M, atol=1e-4 * M.max())


@given(
    st.builds(
        make_vehicle,
        mass=st.floats(400, 16000),
        share=st.floats(0.35, 0.65),
        body=st.tuples(st.floats(0.8, 3.0), st.floats(0.8, 3.0)),
        hop=st.just((10.0, 12.0)),
        damping=st.just((0.2, 0.3)),
        wheel=st.just((0.03, 0.04)),
        spread=st.just((1.0, 1.0)),
        tracks=st.just((0.25, 0.27)),
        damper_tracks=st.just((0.22, 0.29)),
    )
)
@settings(max_examples=20, deadline=None)
def test_parameters_follow_from_matrices(vehicle: Vehicle) -> None:
    assert parameters_from_matrices(vehicle.matrices(), "separate") == pytest.approx(vehicle.parameters, rel=1e-10)


def test_parameters_are_the_least_squares_of_all_entries() -> None:
    # m_uf and m_ur stand twice in M: what differs left and right is averaged.
    M, C, K = SCHOOL_BUS.matrices()
    uneven = M + np.diag([0, 0, 0, 2.0, -2.0, 5.0, 1.0])
    found = parameters_from_matrices(Matrices(uneven, C, K), "separate")
    assert found["m_uf"] == pytest.approx(130.0)
    assert found["m_ur"] == pytest.approx(333.0)

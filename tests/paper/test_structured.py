"""Structured least squares: exact from exact state matrices, honest from noisy ones."""

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from sprung.errors import InputError
from sprung.paper.structured import structured_least_squares
from sprung.vehicle import DERIVED, EMPTY, SCHOOL_BUS, TABLE_1_CAR, Added, Item, Load, Vehicle
from strategies import make_vehicle, vehicles

BUS_LOAD = Load(name="paper", added=Added(mass=470, I_yy=1057.5, I_xx=339.6))  # section 4.1 of the paper

separate = st.builds(
    make_vehicle,
    mass=st.floats(400, 16000),
    share=st.floats(0.35, 0.65),
    body=st.tuples(st.floats(0.8, 3.0), st.floats(0.8, 3.0)),
    hop=st.tuples(st.floats(8, 22), st.floats(8, 22)),
    damping=st.tuples(st.floats(0.08, 0.7), st.floats(0.08, 0.7)),
    wheel=st.just((0.03, 0.05)),
    spread=st.just((1.1, 0.9)),
    tracks=st.just((0.25, 0.27)),
    damper_tracks=st.tuples(st.floats(0.2, 0.32), st.floats(0.2, 0.32)),
)


def body_load(vehicle: Vehicle, part: float = 0.1) -> Load:
    added = Added(mass=part * vehicle.m_s, I_yy=part * vehicle.I_yy, I_xx=part * vehicle.I_xx)
    return Load(name="body", added=added)


def full_load(vehicle: Vehicle) -> Load:
    added = Added(
        mass=0.1 * vehicle.m_s,
        I_yy=0.1 * vehicle.I_yy,
        I_xx=0.1 * vehicle.I_xx,
        m_uf=0.1 * vehicle.m_uf,
        m_ur=0.1 * vehicle.m_ur,
    )
    return Load(name="full", added=added)


def bag(vehicle: Vehicle) -> Load:
    """One bag off centre: ΔM is full and of rank one, and depends on where the centre of gravity is."""
    return Load(name="bag", items=(Item(mass=0.08 * vehicle.m_s, position=(-0.4 * vehicle.a, 0.3, 1.0)),))


def assert_exact(vehicle: Vehicle, loads: tuple[Load, ...], known: Mapping[str, float] | None = None) -> None:
    states = [(load, vehicle.matrices(load).state) for load in loads]
    fit = structured_least_squares(states, known=known or {}, tracks=vehicle.tracks)
    assert fit.converged
    assert fit.parameters == pytest.approx(vehicle.parameters, rel=1e-9)


@given(vehicles, st.sampled_from([body_load, full_load, bag]))
@settings(max_examples=30, deadline=None)
@pytest.mark.slow
def test_exact_from_any_load(vehicle: Vehicle, load: type) -> None:
    assert_exact(vehicle, (EMPTY, load(vehicle)))


@given(separate, st.sampled_from([body_load, bag]))
@settings(max_examples=20, deadline=None)
@pytest.mark.slow
def test_exact_with_springs_and_dampers_at_half_distances_of_their_own(vehicle: Vehicle, load: type) -> None:
    assert_exact(vehicle, (EMPTY, load(vehicle)))


def test_exact_from_loaded_states_alone_and_from_many() -> None:
    bus = SCHOOL_BUS
    assert_exact(bus, (body_load(bus, 0.2), bag(bus)))
    assert_exact(bus, (EMPTY, BUS_LOAD, bag(bus), full_load(bus)))


@given(vehicles, st.sampled_from(["total_mass", "front_axle_mass", "rear_axle_mass", "m_ur", "k_sf", "c_sr", "I_xx"]))
@settings(max_examples=20, deadline=None)
def test_one_known_mass_or_rate_stands_in_for_the_load(vehicle: Vehicle, name: str) -> None:
    p = vehicle.parameters
    assert_exact(vehicle, (EMPTY,), {name: DERIVED[name].value(p) if name in DERIVED else p[name]})


def test_the_papers_experiment() -> None:
    # Section 4: load on the body alone; Table 4 gives total mass, a, b, t_f2 and t_r2.
    known = {"total_mass": 5240.0, "a": 2.22, "b": 1.73, "t_f2": 0.4, "t_r2": 0.5}
    assert_exact(SCHOOL_BUS, (EMPTY, BUS_LOAD), known)
    states = [(load, SCHOOL_BUS.matrices(load).state) for load in (EMPTY, BUS_LOAD)]
    fit = structured_least_squares(states, known=known, tracks="separate")
    given = [i for i, name in enumerate(fit.names) if name in known]
    assert_allclose(fit.covariance[given], 0.0, atol=1e-25)


def test_anti_roll_bars_and_tyre_damping_even_where_they_are_zero() -> None:
    with_bars = TABLE_1_CAR.with_values(k_af=8000.0, k_ar=3000.0, c_tf=80.0, c_tr=120.0)
    for vehicle in (with_bars, TABLE_1_CAR):
        states = [(load, vehicle.matrices(load).state) for load in (EMPTY, body_load(vehicle))]
        fit = structured_least_squares(states, extras=("anti-roll", "tyre-damping"))
        truth = {name: getattr(vehicle, name) for name in fit.names}
        assert fit.parameters == pytest.approx(truth, rel=1e-9, abs=1e-4)


def noisy_states(
    seed: int, size: float
) -> tuple[list[tuple[Load, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]], list[np.ndarray]]:
    rng = np.random.default_rng(seed)
    states, spread = [], []
    for load in (EMPTY, body_load(TABLE_1_CAR)):
        A = TABLE_1_CAR.matrices(load).state
        norms = np.stack([np.linalg.norm(block, axis=1) for block in (A[7:, :7], A[7:, 7:])], axis=1)
        std = size * np.repeat(norms, 7, axis=1)
        A[7:] += std * rng.standard_normal((7, 14))
        states.append((load, A))
        spread.append(std)
    return states, spread


def test_errors_are_as_large_as_the_covariance_says() -> None:
    # 15 parameters, 12 draws: Σ (error / std)² over draws of one parameter is χ² with 12 degrees of freedom; all within
    # its 1e-6 and 1 - 1e-6 quantiles, 0.68 and 51.
    truth = np.array(list(TABLE_1_CAR.parameters.values()))
    squares = np.zeros(15)
    for seed in range(12):
        states, std = noisy_states(seed, 1e-3)
        fit = structured_least_squares(states, std=std)
        assert fit.misfit == pytest.approx(1.0, abs=0.25)
        squares += (fit.values - truth) ** 2 / np.diag(fit.covariance)
    assert np.all((squares > 0.68) & (squares < 51))


def test_a_weighing_is_worth_more_than_the_load() -> None:
    states, std = noisy_states(3, 1e-3)
    without = structured_least_squares(states, std=std)
    weighed = structured_least_squares(states, std=std, known={"total_mass": TABLE_1_CAR.total_mass})
    assert np.all(np.diag(weighed.covariance) <= np.diag(without.covariance) * (1 + 1e-9))
    assert weighed.covariance[0, 0] < 0.1 * without.covariance[0, 0]


def test_without_std_the_covariance_comes_from_the_misfit() -> None:
    states, std = noisy_states(4, 1e-3)
    by_misfit = structured_least_squares(states)
    by_std = structured_least_squares(states, std=std)
    ratio = np.diag(by_misfit.covariance) / np.diag(by_std.covariance)
    assert np.all((ratio > 0.7) & (ratio < 1.4))


def test_gross_noise_does_not_break_it() -> None:
    states, _ = noisy_states(5, 0.1)
    fit = structured_least_squares(states, known={"total_mass": TABLE_1_CAR.total_mass})
    assert np.all(fit.values > 0)
    assert fit.parameters["m_s"] == pytest.approx(TABLE_1_CAR.m_s, rel=0.1)


def test_the_scale_must_come_from_somewhere() -> None:
    state = TABLE_1_CAR.matrices().state
    with pytest.raises(InputError, match="does not determine the common factor"):
        structured_least_squares([(EMPTY, state)])
    with pytest.raises(InputError, match="does not determine the common factor"):
        structured_least_squares([(EMPTY, state)], known={"a": 1.25, "wheelbase": 2.76})


def test_what_is_not_determined_is_named() -> None:
    # Without a force in the front dampers nobody can say how far apart they stand.
    undamped = SCHOOL_BUS.with_values(c_sf=0.0)
    states = [(load, undamped.matrices(load).state) for load in (EMPTY, BUS_LOAD)]
    with pytest.raises(InputError, match="found t_f1 can change"):
        structured_least_squares(states, tracks="separate")


def test_wrong_input_is_said_all_at_once() -> None:
    with pytest.raises(InputError) as caught:
        structured_least_squares(
            [(EMPTY, np.ones((7, 14))), (BUS_LOAD, np.full((14, 14), np.nan))],
            known={"total_mas": 1.0},
            std=[np.ones(3)],
        )
    assert len(caught.value.problems) == 4
    assert "Did you mean 'total_mass'?" in str(caught.value)

"""The joint fit against laws that hold whatever the vehicle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sprung.campaign import Campaign
from sprung.estimation import (
    FitStatistics,
    fit_jointly,
    fit_linear,
    scale_of,
    to_estimates,
    unidentifiable_combinations,
)
from sprung.preprocess import prepare
from sprung.simulation import free_decays, simulate
from sprung.uncertainty import Estimate, KnownValue
from sprung.vehicle import (
    SCHOOL_BUS,
    TABLE_1_CAR,
    LinearModel,
    Load,
    Sensor,
    Vehicle,
    Wheel,
    linear_elements,
    parse_record,
)
from strategies import vehicles

# Off the centreline and off the centre of gravity, so that ΔM is full.
LOAD = parse_record(
    Load,
    {
        "name": "bags",
        "items": [{"mass": 0.07, "position": (-0.6, 0.3, 0.5)}, {"mass": 0.05, "position": (-1.9, -0.2, 0.5)}],
    },
)


def load_for(vehicle: Vehicle) -> Load:
    """Make a load of twelve percent of a vehicle's mass."""
    items = tuple(replace(item, mass=item.mass * vehicle.m_s) for item in LOAD.items)
    return Load(name="bags", items=items)


def models_of(campaign: Campaign, vehicle: Vehicle) -> dict[str, LinearModel]:
    """Return the equations of motion of a vehicle with each load of a campaign."""
    elements, names = linear_elements(vehicle.tracks), tuple(vehicle.parameters)
    return {load.name: LinearModel.of(elements + load.elements(), names) for load in campaign.loads}


def fit(
    campaign: Campaign, vehicle: Vehicle, start: Mapping[str, float] | None = None
) -> tuple[FitStatistics, dict[str, Estimate]]:
    known = dict(campaign.known)
    if campaign.wheelbase is not None:
        known["wheelbase"] = campaign.wheelbase
    found = fit_jointly(prepare(campaign).decays, models_of(campaign, vehicle), campaign.sensors, known, start=start)
    return found, to_estimates(found, known)


def errors(estimates: Mapping[str, Estimate], vehicle: Vehicle) -> dict[str, float]:
    truth = vehicle.parameters
    return {
        name: float("inf") if one.value is None else abs(one.value / truth[name] - 1) for name, one in estimates.items()
    }


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(vehicle=vehicles)
def test_identify_undoes_simulate_with_a_load(vehicle: Vehicle) -> None:
    campaign = free_decays(vehicle, loads=[load_for(vehicle)], states=4, seed=1, rate=250)
    found, estimates = fit(campaign, vehicle)
    assert found.converged
    assert max(errors(estimates, vehicle).values()) < 1e-6


@settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(vehicle=vehicles)
def test_identify_undoes_simulate_with_axle_weights(vehicle: Vehicle) -> None:
    """Axle loads and no added mass: enough, because they hold the total mass."""
    front = vehicle.m_s * vehicle.b / vehicle.wheelbase + 2 * vehicle.m_uf
    known = {"front_axle_mass": KnownValue(front), "rear_axle_mass": KnownValue(vehicle.total_mass - front)}
    campaign = free_decays(vehicle, states=4, seed=2, rate=250, known=known)
    found, estimates = fit(campaign, vehicle)
    assert found.converged
    assert max(errors(estimates, vehicle).values()) < 1e-6


def test_drops_from_blocks_are_identified_through_flight_and_landing() -> None:
    campaign = simulate(TABLE_1_CAR, loads=[load_for(TABLE_1_CAR)], noise=0.0)
    found, estimates = fit(campaign, TABLE_1_CAR)
    assert max(errors(estimates, TABLE_1_CAR).values()) < 1e-8
    # What is left is rounding, the processor's own: its colour enlarges nothing.
    assert (found.inflation, found.inflated_by) == (1.0, "nothing")


def test_springs_and_dampers_apart() -> None:
    campaign = free_decays(SCHOOL_BUS, loads=[load_for(SCHOOL_BUS)], states=5, seed=3)
    _, estimates = fit(campaign, SCHOOL_BUS)
    assert {"t_f1", "t_f2", "t_r1", "t_r2"} <= estimates.keys()
    assert max(errors(estimates, SCHOOL_BUS).values()) < 1e-6


@pytest.mark.parametrize("ratio", [1.0, 1.4])
def test_critical_and_overdamped_vehicles(ratio: float) -> None:
    """Damping at and beyond critical: pairs of real poles, at 1.0 (of the body as if alone) close together."""
    corner = TABLE_1_CAR.m_s / 4
    damping = {f"c_s{axle}": ratio * 2 * (corner * getattr(TABLE_1_CAR, f"k_s{axle}")) ** 0.5 for axle in "fr"}
    vehicle = replace(TABLE_1_CAR, **damping)
    if ratio > 1:
        assert np.sum(np.linalg.eigvals(vehicle.matrices().state).imag == 0) >= 4  # this is what the test is about
    campaign = free_decays(vehicle, loads=[load_for(vehicle)], states=4, seed=4)
    _, estimates = fit(campaign, vehicle)
    assert max(errors(estimates, vehicle).values()) < 1e-6


def test_scale_cannot_be_seen_and_everything_else_can() -> None:
    """Scaling M, C and K together changes no acceleration (design fact 7)."""
    factor = 2.5
    scaled = Vehicle.from_parameters(
        {name: value * (factor if name[0] in "mIkc" else 1.0) for name, value in TABLE_1_CAR.parameters.items()}
    )
    states = np.random.default_rng(5).standard_normal((4, 14)) * 0.05
    one = free_decays(TABLE_1_CAR, states=states, noise=0.02, seed=6)
    other = free_decays(scaled, states=states, noise=0.02, seed=6)
    for record, same in zip(one.recordings, other.recordings, strict=True):
        np.testing.assert_allclose(record.values, same.values, atol=1e-10)

    found, estimates = fit(one, TABLE_1_CAR)
    scale = scale_of(found)
    assert not scale.known
    for name, one_estimate in estimates.items():
        assert (one_estimate.status == "unidentifiable") == (name[0] in "mIkc")
    assert unidentifiable_combinations(found, estimates)[0].parameters == tuple(
        n for n in TABLE_1_CAR.parameters if n[0] in "mIkc"
    )
    for name, ratio in scale.per_total_mass.items():
        truth = TABLE_1_CAR.parameters[name] / TABLE_1_CAR.total_mass
        assert ratio.std > 0
        assert abs(ratio.value - truth) < 4.5 * ratio.std


def mirrored(campaign: Campaign) -> Campaign:
    """Look at the campaign in a mirror: left is right."""
    other: dict[Wheel, Wheel] = {"fl": "fr", "fr": "fl", "rl": "rr", "rr": "rl"}

    def sensor(one: Sensor) -> Sensor:
        position = None if one.position is None else (one.position[0], -one.position[1], one.position[2])
        return replace(one, on=one.on if one.wheel is None else other[one.wheel], position=position)

    drops = tuple(replace(d, wheels=tuple(other[w] for w in d.wheels)) for d in campaign.drops)
    loads = tuple(
        replace(
            load,
            items=tuple(
                replace(item, position=item.position and (item.position[0], -item.position[1], item.position[2]))
                for item in load.items
            ),
        )
        for load in campaign.loads
    )
    return replace(campaign, sensors=tuple(map(sensor, campaign.sensors)), drops=drops, loads=loads)


def test_left_and_right_are_alike() -> None:
    campaign = simulate(TABLE_1_CAR, loads=[load_for(TABLE_1_CAR)], noise=0.02, seed=7)
    here, _ = fit(campaign, TABLE_1_CAR)
    there, _ = fit(mirrored(campaign), TABLE_1_CAR)
    np.testing.assert_allclose(there.values, here.values, rtol=1e-6)  # converged to 1e-4 of 0.3 %
    np.testing.assert_allclose(there.covariance, here.covariance, rtol=1e-3)


@settings(max_examples=5, deadline=None)
@given(order=st.permutations(range(8)))
def test_the_order_of_channels_changes_nothing(order: list[int]) -> None:
    campaign = free_decays(TABLE_1_CAR, loads=[load_for(TABLE_1_CAR)], states=3, noise=0.02, seed=8, rate=250)
    shuffled = replace(
        campaign.with_recordings(
            replace(r, values=r.values[order], channels=tuple(r.channels[i] for i in order))
            for r in campaign.recordings
        ),
        sensors=tuple(campaign.sensors[i] for i in order),
    )
    here, _ = fit(campaign, TABLE_1_CAR, start=TABLE_1_CAR.parameters)
    there, _ = fit(shuffled, TABLE_1_CAR, start=TABLE_1_CAR.parameters)
    np.testing.assert_allclose(there.values, here.values, rtol=1e-8)


def test_a_later_clock_and_another_offset_change_nothing() -> None:
    campaign = simulate(TABLE_1_CAR, loads=[load_for(TABLE_1_CAR)], noise=0.02, seed=9)
    offsets = np.linspace(-3, 3, 8)[:, None]
    moved = campaign.with_recordings(
        replace(r, start=r.start + 1234.5, values=r.values + offsets) for r in campaign.recordings
    )
    here, _ = fit(campaign, TABLE_1_CAR)
    there, _ = fit(moved, TABLE_1_CAR)
    np.testing.assert_allclose(there.values, here.values, rtol=1e-8)


def test_a_channel_left_out_costs_certainty_only() -> None:
    campaign = simulate(TABLE_1_CAR, loads=[load_for(TABLE_1_CAR)], noise=0.02, seed=10)
    spoilt = np.array(campaign.recordings[0].values)
    spoilt[5] = np.nan
    less = campaign.with_recordings((replace(campaign.recordings[0], values=spoilt), *campaign.recordings[1:]))
    here, _ = fit(campaign, TABLE_1_CAR)
    there, _ = fit(less, TABLE_1_CAR)
    spread = np.sqrt(np.diag(there.relative_covariance))
    assert np.all(np.diag(there.relative_covariance) > 0.98 * np.diag(here.relative_covariance))
    assert np.all(np.abs(np.log(there.values / here.values)) < 3 * spread)


@pytest.mark.slow
def test_errors_match_their_bars_over_seeds() -> None:
    """Over 60 campaigns the squared errors in standard uncertainties average one; ± 4 of its own standard errors."""
    names = tuple(TABLE_1_CAR.parameters)
    scores = []
    for seed in range(60):
        random = np.random.default_rng(seed)
        weighed = {"total_mass": KnownValue(TABLE_1_CAR.total_mass + 5 * random.standard_normal(), 5.0)}
        campaign = free_decays(TABLE_1_CAR, states=4, noise=0.05, seed=seed, rate=200, duration=2.0, known=weighed)
        found, _ = fit(campaign, TABLE_1_CAR, start=TABLE_1_CAR.parameters)
        error = np.log(found.values / np.array([TABLE_1_CAR.parameters[name] for name in names]))
        free = [i for i, name in enumerate(names) if name != "b"]  # b follows from a under the exact wheelbase
        precision = np.linalg.inv(found.relative_covariance[np.ix_(free, free)])
        scores.append(error[free] @ precision @ error[free] / len(free))
    # χ² with 14 degrees of freedom over 14 has the variance 2/14.
    assert abs(np.mean(scores) - 1) < 4 * np.sqrt(2 / 14 / len(scores))


def test_body_sensors_alone_are_enough_for_the_body() -> None:
    """Without sensors at the wheels: what the body does not show is not claimed, the rest is within its error bars."""
    campaign = simulate(TABLE_1_CAR, loads=[load_for(TABLE_1_CAR)], noise=0.02, seed=11)
    body = [i for i, sensor in enumerate(campaign.sensors) if sensor.on == "body"]
    blind = replace(
        campaign.with_recordings(
            replace(r, values=r.values[body], channels=tuple(r.channels[i] for i in body)) for r in campaign.recordings
        ),
        sensors=tuple(campaign.sensors[i] for i in body),
    )
    found, estimates = fit(blind, TABLE_1_CAR)
    assert found.converged
    for name, one in estimates.items():
        if one.value is not None and one.std is not None:
            assert abs(one.value - TABLE_1_CAR.parameters[name]) < 4 * one.std
    assert estimates["m_s"].status == "estimated"


@pytest.mark.slow
def test_noise_feigns_no_knowledge_of_motions_nobody_excited() -> None:
    """Bounce drops only: the roll modes have amplitudes fitted to noise, and no information must come of them."""
    drops = [{"wheels": ["fl", "fr", "rl", "rr"], "file": f"bounce_{i}.csv"} for i in range(5)]
    wrong = 0
    for seed in range(6):
        campaign = simulate(
            TABLE_1_CAR, drops=drops, noise=0.02, seed=seed, known={"total_mass": TABLE_1_CAR.total_mass}
        )
        _, estimates = fit(campaign, TABLE_1_CAR)
        for name in ("I_xx", "t_f", "t_r"):
            one = estimates[name]
            if one.value is not None and one.std is not None:
                wrong += abs(one.value - TABLE_1_CAR.parameters[name]) > 3 * one.std
    assert wrong <= 1  # of 18


def test_everything_known_leaves_nothing_to_fit() -> None:
    campaign = simulate(TABLE_1_CAR, noise=0.02, seed=12, known=dict(TABLE_1_CAR.parameters))
    found, estimates = fit(campaign, TABLE_1_CAR)
    assert found.converged
    assert {one.status for one in estimates.values()} == {"known"}


@pytest.mark.parametrize("std", [1e-300, 1e-6, 1e-3])
def test_a_very_small_uncertainty_is_no_trouble(std: float) -> None:
    known = {"total_mass": KnownValue(TABLE_1_CAR.total_mass, std)}
    campaign = simulate(TABLE_1_CAR, noise=0.02, seed=13, known=known)
    found, estimates = fit(campaign, TABLE_1_CAR)
    assert found.converged
    assert all(one.status == "estimated" for one in estimates.values())


def test_an_exact_quantity_that_cannot_be_is_named() -> None:
    known = {"total_mass": KnownValue(0.8 * TABLE_1_CAR.total_mass)}
    campaign = simulate(TABLE_1_CAR, loads=[load_for(TABLE_1_CAR)], noise=0.02, seed=14, known=known)
    found, _ = fit(campaign, TABLE_1_CAR)
    assert found.contradictions["total_mass"] > 10


@pytest.mark.parametrize("std", [0.2, 2.0, 20.0])
def test_a_contradiction_is_a_distance_in_standard_uncertainties_of_the_difference(std: float) -> None:
    truth = TABLE_1_CAR.total_mass
    plain = simulate(TABLE_1_CAR, loads=[load_for(TABLE_1_CAR)], noise=0.02, seed=15)
    told, _ = fit(plain, TABLE_1_CAR)
    gradient = np.array([{"m_s": 1.0, "m_uf": 2.0, "m_ur": 2.0}.get(name, 0.0) for name in told.names])
    own = float(gradient @ told.covariance @ gradient) ** 0.5
    stated = float(gradient @ told.values) + 4 * np.hypot(own, std)
    campaign = replace(plain, known={**plain.known, "total_mass": KnownValue(stated, std)})
    found, _ = fit(campaign, TABLE_1_CAR)
    assert abs(stated - truth) > 3 * std
    assert found.contradictions["total_mass"] == pytest.approx(4.0, rel=0.05)


def test_what_a_fit_has_still_to_gain_contradicts_no_statement() -> None:
    """A fit that was stopped on its way: before, each of its statements was contradicted by all that was left to gain."""
    known = {"total_mass": KnownValue(TABLE_1_CAR.total_mass, 2.0), "k_sf": KnownValue(TABLE_1_CAR.k_sf, 50.0)}
    campaign = simulate(TABLE_1_CAR, loads=[load_for(TABLE_1_CAR)], noise=0.02, seed=16, known=known)
    start = TABLE_1_CAR.parameters | {"k_tf": 1.01 * TABLE_1_CAR.k_tf, "I_yy": 1.01 * TABLE_1_CAR.I_yy}
    models = models_of(campaign, TABLE_1_CAR)
    stopped = fit_linear(prepare(campaign).decays, models, campaign.sensors, campaign.known, start=start, most=0)
    assert stopped.remaining_gain > 100
    conflicts = stopped.problem.conflicts(stopped.iterate, 1.0)
    assert {"total_mass", "k_sf"} <= {*conflicts}
    assert max(conflicts.values()) < 4

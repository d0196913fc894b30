"""What a fit holds and what follows from it, in closed form, by matrix exponentials and by time stepping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import sprung
from sprung.campaign import Campaign, LoggerClock
from sprung.estimation import FitResult, fit_from_contact, fit_linear, fit_nonlinear, score_nonlinear_terms
from sprung.estimation.contact import clear_of_splines
from sprung.estimation.starts import VehicleSize
from sprung.estimation.stepped_likelihood import TimeSteppingAt
from sprung.estimation.stuck_drops import _stuck_drops, go_on_with_likelier_states
from sprung.estimation.time_stepping import TimeSteppingObjective
from sprung.faults.fault_scores import score_faults
from sprung.optimisation import Maximum
from sprung.preprocess import FreeDecay, prepare
from sprung.selection.structure import ModelStructure, choose_structure
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Vehicle

Real = NDArray[np.float64]

LOAD = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.3, 0.5)}]}
FRICTION = {"F_f": 30.0, "F_r": 40.0, "s_f": 2e5, "s_r": 2e5}


def made(vehicle: Vehicle, duration: float = 2.5) -> Campaign:
    drops: list[dict[str, object]] = [{"wheels": wheels} for wheels in (("fl", "fr"), ("fl", "rl"))]
    drops += [drop | {"load": "ballast"} for drop in drops]
    return sprung.simulate(vehicle, loads=[LOAD], drops=drops, rate=250, noise=0.02, seed=4, duration=duration)


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return made(TABLE_1_CAR)


@pytest.fixture(scope="module")
def linear(campaign: Campaign) -> FitResult:
    """A fit in which one drop has no reading of its last channel."""
    structure = choose_structure(campaign, "shared", ())
    decays = list(prepare(campaign).decays)
    values = decays[1].values.copy()
    values[7] = np.nan
    decays[1] = replace(decays[1], values=values)
    return fit_linear(decays, structure.linear_models, campaign.sensors, structure.known, start=TABLE_1_CAR.parameters)


@pytest.fixture(scope="module")
def rubbing() -> tuple[Campaign, ModelStructure, tuple[FreeDecay, ...], Real]:
    """A campaign with dry friction, its model, its decays, and states from the fit without friction."""
    vehicle = Vehicle.from_parameters(TABLE_1_CAR.parameters | FRICTION)
    campaign = made(vehicle, duration=1.5)
    structure = choose_structure(campaign, "shared", ("friction",))
    plain = choose_structure(campaign, "shared", ())
    decays = prepare(campaign).decays
    start = TABLE_1_CAR.parameters
    states = fit_linear(decays, plain.linear_models, campaign.sensors, plain.known, start=start).states
    return campaign, structure, decays, states


@pytest.fixture(scope="module")
def stepped(rubbing: tuple[Campaign, ModelStructure, tuple[FreeDecay, ...], Real]) -> FitResult:
    campaign, structure, decays, states = rubbing
    return fit_nonlinear(
        decays, structure.nonlinear_models, campaign.sensors, structure.known,
        start=TABLE_1_CAR.parameters | FRICTION, states=states, enough=0.1, near=True, most=3,
    )  # fmt: skip


def test_residuals_are_what_the_model_leaves(linear: FitResult) -> None:
    for decay, fitted, residual, sums in zip(
        linear.decays, linear.fitted, linear.residuals, linear.residual_sums, strict=True
    ):
        centred = decay.values - decay.values.mean(axis=1, keepdims=True) - fitted
        np.testing.assert_allclose(residual, centred, atol=1e-12)
        np.testing.assert_allclose(np.nansum(residual**2, axis=1), sums, rtol=1e-6)
    assert np.isnan(linear.residuals[1][7]).all()
    # What white noise of 0.02 m/s² leaves; a standard deviation of 600 samples is known to 3 %.
    np.testing.assert_allclose(linear.noise, 0.02, rtol=0.12)


def test_the_same_vehicle_on_the_same_decays_leaves_the_same(linear: FitResult) -> None:
    np.testing.assert_allclose(linear.residual_sums_of(linear.decays), linear.residual_sums, rtol=1e-9)
    np.testing.assert_allclose(linear.states_of(linear.decays), linear.states, rtol=1e-9, atol=1e-12)


def test_another_label_leaves_more(linear: FitResult) -> None:
    """Each drop under the other load: 10 % more mass shifts frequencies by 5 %, five times the noise."""
    loads = {"empty": "ballast", "ballast": "empty"}
    relabelled = [replace(decay, load=loads[decay.load]) for decay in linear.decays]
    assert np.all(linear.residual_sums_of(relabelled).sum(axis=1) > 4 * linear.residual_sums.sum(axis=1))


def test_motion_begins_with_the_state_and_goes_backward(linear: FitResult) -> None:
    motion = linear.motion(2, 30, 50)
    np.testing.assert_allclose(motion[:, 30], linear.states[2], rtol=1e-9, atol=1e-12)
    # The velocity is the derivative of the displacement, before the first sample as after it.
    slope = np.gradient(motion[0], 1 / linear.decays[2].rate)
    np.testing.assert_allclose(slope[5:-5], motion[7, 5:-5], atol=0.02 * np.abs(motion[7]).max())


@pytest.mark.slow
def test_a_stepped_fit_leaves_the_same_on_the_same_decays(stepped: FitResult) -> None:
    again, before = (
        sums @ stepped.weights for sums in (stepped.residual_sums_of(stepped.decays), stepped.residual_sums)
    )
    # Nothing is lost, and where the fit had found the initial states after its three steps nothing is left to gain.
    assert np.all(again <= before * (1 + 1e-6))
    np.testing.assert_allclose(again[:2], before[:2], rtol=1e-3)
    assert stepped.states_of(stepped.decays).shape == stepped.states.shape
    assert stepped.clock_delays(np.eye(len(stepped.names))) == {}
    assert stepped.most_likely_delays(stepped.decays, np.array([0.0])) == {}


@pytest.mark.slow
def test_decays_that_were_not_fitted_are_followed_from_rest(stepped: FitResult) -> None:
    """A copy under another name: its state is unknown, and is found from rest."""
    copy = replace(stepped.decays[0], file="copy.csv")
    squares = stepped.residual_sums_of([copy])[0] @ stepped.weights
    # The gain of the last step of the states is far below one.
    assert squares == pytest.approx(float(stepped.residual_sums[0] @ stepped.weights), abs=10)


def test_friction_cannot_be_followed_backward(stepped: FitResult) -> None:
    assert not stepped.is_reversible
    motion = stepped.motion(0, 3, 10)
    assert np.isnan(motion[:, :3]).all()
    np.testing.assert_allclose(motion[:, 3], stepped.states[0], atol=1e-12)


def test_one_drop_of_a_stepped_fit_is_that_drop(stepped: FitResult) -> None:
    at = stepped.iterate.at
    assert isinstance(at, TimeSteppingAt)
    alone, whole = at.of_drop(2), at.objective.at_states(at.values, at.weights, at.stepped.begin)
    np.testing.assert_allclose(alone.residual_sums[0], at.residual_sums[2], rtol=1e-12)
    # Derivatives are of single precision: some 1e-5 of each, and of 8000 residuals the root of these sums up.
    # 1e-3 of a standard error is below all that a fit resolves.
    errors = (alone.gradient - at.by_drop[0][2]) / np.sqrt(np.diagonal(alone.information))
    assert np.abs(errors).max() < 1e-3
    np.testing.assert_allclose(whole.residual_sums, stepped.residual_sums, rtol=1e-12)


@pytest.mark.slow
def test_drops_go_on_with_memories_that_friction_can_have(stepped: FitResult) -> None:
    """One drop holds with six times its frictions, which no step was taken from yet: it alone begins anew, and is likelier."""
    problem = stepped.problem
    assert isinstance(problem.objective, TimeSteppingObjective)
    states = stepped.states.copy()
    states[1, 14:] = [6.0, -6.0, 5.0, -5.0]
    objective = problem.objective.with_states(states)
    held = replace(problem, objective=objective)
    stuck = Maximum(held.start(stepped.iterate.u), 0, True)
    found = go_on_with_likelier_states(held, objective, stuck, 0.1, 2)
    assert found.steps > 0
    assert held.cost(found.point) < held.cost(stuck.point) - 100
    assert np.abs(found.point.at.states[1, 14:]).max() < 1.5
    assert held.cost(found.point) < stepped.problem.cost(stepped.iterate) + 1


@pytest.mark.slow
def test_a_drop_that_is_worse_than_all_others_is_looked_for_from_elsewhere(stepped: FitResult) -> None:
    """Its initial state is one that no step was taken from. Where more than a third are worse, it is the model."""
    problem = stepped.problem
    assert isinstance(problem.objective, TimeSteppingObjective)
    states = stepped.states.copy()
    states[2] *= 1.05
    objective = problem.objective.with_states(states)
    held = replace(problem, objective=objective)
    stuck = Maximum(held.start(stepped.iterate.u), 0, True)
    found = go_on_with_likelier_states(held, objective, stuck, 0.1, 2)
    assert held.cost(found.point) < stepped.problem.cost(stepped.iterate) + 1
    many = problem.objective.with_states(1.05 * stepped.states)
    at = replace(problem, objective=many).start(stepped.iterate.u).at
    assert _stuck_drops(objective, stuck.point.at) == [2]
    assert _stuck_drops(many, at) == []


def test_possible_memories_are_left_as_they_are(stepped: FitResult) -> None:
    objective = stepped.problem.objective
    assert isinstance(objective, TimeSteppingObjective)
    ended = Maximum(stepped.iterate, 3, stepped.converged)
    assert go_on_with_likelier_states(stepped.problem, objective, ended, 0.1, 2) is ended


def test_a_landing_that_is_not_over_is_left_out(stepped: FitResult) -> None:
    """A shock in the first 5 samples of the first drop, 8 ms at 250 Hz apart from the rest."""
    struck = list(stepped.decays)
    values = struck[0].values.copy()
    values[4, :5] += 2.0
    struck[0] = replace(struck[0], values=values)
    problem = replace(stepped.problem, objective=stepped.problem.objective.with_decays(struck))
    first = replace(stepped, problem=problem, iterate=problem.start(stepped.iterate.u))
    asked: list[list[int]] = []

    def again(decays: Sequence[FreeDecay], fit: FitResult, states: Real) -> FitResult:
        assert states.shape == fit.states.shape
        asked.append([decay.samples for decay in decays])
        return fit

    linear = {load: model.linear for load, model in stepped.problem.objective.models.items()}  # type: ignore[attr-defined]
    decays, _ = fit_from_contact(struck, linear, first, again)
    assert asked[0][0] == struck[0].samples - 5
    assert decays[0].samples == struck[0].samples - 5
    unmoved, fit = fit_from_contact(stepped.decays, linear, stepped, again)
    assert (len(asked), fit) == (1, stepped)
    assert [decay.samples for decay in unmoved] == [decay.samples for decay in stepped.decays]


def critically_damped() -> Vehicle:
    """Two modes meet in one shape at a double real pole: damper rates found by bisection."""

    def vehicle(rate: float) -> Vehicle:
        return TABLE_1_CAR.with_values(
            t_f=None, t_r=None, t_f1=0.5, t_r1=0.5, t_f2=0.74, t_r2=0.74, c_sf=rate, c_sr=rate
        )

    low, high = 1500.0, 40000.0
    for _ in range(60):
        middle = (low + high) / 2
        real = np.any(np.linalg.eigvals(vehicle(middle).matrices().state).imag == 0)
        low, high = (low, middle) if real else (middle, high)
    return vehicle(high)


def test_without_modes_there_are_no_scores_and_no_clocks() -> None:
    vehicle = critically_damped()
    campaign = made(vehicle)
    structure = choose_structure(campaign, "separate", ())
    known = {name: KnownValue(value) for name, value in vehicle.parameters.items()}
    fit = fit_linear(
        prepare(campaign).decays, structure.linear_models, campaign.sensors, known, start=vehicle.parameters
    )
    assert fit.converged
    larger = structure.with_terms(("friction",))
    values = fit.parameters | {"F_f": 0.0, "F_r": 0.0, "s_f": 2e5, "s_r": 2e5}
    assert score_nonlinear_terms(fit, larger.nonlinear_models, values, {"friction": ("F_f", "F_r")}) == {
        "friction": (0.0, {"F_f": 0.0, "F_r": 0.0})
    }
    assert score_faults(fit, campaign.sensors, {load.name: load for load in campaign.loads}, campaign.heights) == ()
    assert fit.clock_delays(np.zeros((17, 17))) == {}
    assert fit.most_likely_delays(fit.decays, np.array([0.0])) == {}
    np.testing.assert_allclose(fit.motion(0, 10, 20)[:, 10], fit.states[0], atol=1e-12)
    np.testing.assert_allclose(fit.states_of(fit.decays), fit.states, rtol=1e-6, atol=1e-9)


def test_samples_that_were_interpolated_across_the_start_are_skipped(campaign: Campaign) -> None:
    """A logger at half the rate: its first 8 samples hold something of those before the start."""
    decay = prepare(campaign).decays[0]
    earlier, rest = decay.values[:, :20], decay.values[:, 20:]
    clocks = tuple(
        LoggerClock(name, channels, 0.0, rate_ratio=ratio)
        for name, channels, ratio in (("fast", (0, 1, 2, 3), 1.0), ("slow", (4, 5, 6, 7), 0.5))
    )
    cleared = clear_of_splines(replace(decay, earlier=earlier, values=rest, clocks=clocks))
    assert cleared.samples == rest.shape[1] - 8
    np.testing.assert_array_equal(cleared.values[:4], rest[:4, :-8])
    np.testing.assert_array_equal(cleared.values[4:], rest[4:, 8:])
    assert [clock.delay for clock in cleared.clocks] == [0.0, pytest.approx(8 / decay.rate)]
    assert [clock.offset for clock in cleared.clocks] == [0.0, pytest.approx(8 / decay.rate)]


@pytest.mark.parametrize(
    ("known", "front_share", "mass"),
    [
        ({"wheelbase": 2.7, "b": 1.35, "total_mass": 1500.0}, 0.5, 1500.0),
        ({"wheelbase": 2.7, "a": 1.08, "front_axle_mass": 600.0}, 0.6, 1200.0),
        ({"wheelbase": 2.7, "front_axle_mass": 900.0, "rear_axle_mass": 600.0}, 0.6, 1500.0),
        ({"a": 1.2, "b": 1.5, "m_s": 860.0}, 1.5 / 2.7, 1000.0),
    ],
)
def test_the_size_of_a_vehicle_follows_from_what_is_known(
    known: dict[str, float], front_share: float, mass: float
) -> None:
    """Wheels are 3.5 % of the mass each: a body of 860 kg belongs to a vehicle of 1000 kg."""
    size = VehicleSize.of({name: KnownValue(value) for name, value in known.items()}, [])
    assert size.wheelbase == pytest.approx(2.7)
    assert size.front_share == pytest.approx(front_share)
    assert size.mass == pytest.approx(mass)
    assert size.weighed
    assert size.half_track == pytest.approx(0.27 * 2.7)  # no sensor says more


def test_without_any_knowledge_the_size_is_a_usual_one() -> None:
    size = VehicleSize.of({}, [])
    assert (size.wheelbase, size.front_share, size.weighed) == (2.7, 0.5, False)
    assert size.mass == pytest.approx(1500.0)

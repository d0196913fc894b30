"""The stepped likelihood against the linear one, and the scores and tests that rest on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import sprung
from sprung.campaign import Campaign
from sprung.estimation import (
    FitResult,
    LowPass,
    UsualValue,
    estimate_of,
    fit_linear,
    fit_nonlinear,
    scale_of,
    score_linear_term,
    score_nonlinear_terms,
    score_stepped_terms,
    uncertainty_of,
    wald_test,
)
from sprung.estimation.stepped_likelihood import TimeSteppingAt
from sprung.estimation.time_stepping import TimeSteppingObjective
from sprung.preprocess import FreeDecay, prepare
from sprung.selection.structure import ModelStructure, choose_structure
from sprung.uncertainty import KnownValue
from sprung.vehicle import (
    LOW_PASS_CORNER,
    TABLE_1_CAR,
    Readout,
    Stepper,
    Vehicle,
    is_of_sensor,
    parameter_of,
    parameters_of_term,
)

LOAD = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.3, 0.5)}]}


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    drops: list[dict[str, object]] = [{"wheels": wheels} for wheels in (("fl", "fr"), ("fl", "rl"))]
    drops += [drop | {"load": "ballast"} for drop in drops]
    barred = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"k_af": 60.0, "k_ar": 60.0})
    return sprung.simulate(barred, loads=[LOAD], drops=drops, rate=500, noise=0.02, seed=4)


@pytest.fixture(scope="module")
def decays(campaign: Campaign) -> tuple[FreeDecay, ...]:
    return prepare(campaign).decays


@pytest.fixture(scope="module")
def plain(campaign: Campaign) -> ModelStructure:
    return choose_structure(campaign, "shared", ())


@pytest.fixture(scope="module")
def optimum(campaign: Campaign, decays: tuple[FreeDecay, ...], plain: ModelStructure) -> FitResult:
    return fit_linear(decays, plain.linear_models, campaign.sensors, plain.known)


def test_with_nothing_to_step_it_is_the_linear_likelihood(
    campaign: Campaign, decays: tuple[FreeDecay, ...], plain: ModelStructure, optimum: FitResult
) -> None:
    """The summit, its noise and its information are those of the linear fit; friction of no force changes none of them."""
    larger = plain.with_terms(("friction",))
    start = optimum.parameters | {"F_f": 0.0, "F_r": 0.0, "s_f": 2e5, "s_r": 2e5}
    known = dict(plain.known) | {
        name: sprung.uncertainty.KnownValue(value) for name, value in start.items() if name[:2] in ("F_", "s_")
    }
    found = fit_nonlinear(
        decays, larger.nonlinear_models, campaign.sensors, known, start=start, states=optimum.states, near=True
    )
    for name, value in optimum.parameters.items():
        assert found.parameters[name] == pytest.approx(value, rel=2e-5)
    np.testing.assert_allclose(found.noise, optimum.noise, rtol=1e-4)
    count = len(optimum.names)
    own, other = (one.iterate.at.information for one in (optimum, found))
    scale = np.sqrt(np.outer(np.diag(own), np.diag(own)))
    np.testing.assert_allclose(other[:count, :count] / scale, own / scale, atol=2e-3)


@pytest.mark.parametrize("loaded", [False, True])
def test_only_a_known_mass_gives_the_scale(
    campaign: Campaign, decays: tuple[FreeDecay, ...], plain: ModelStructure, optimum: FitResult, loaded: bool
) -> None:
    """That every mass and rate grows alike changes no motion: without a load there is no information of it."""
    larger = plain.with_terms(("friction",))
    start = optimum.parameters | {"F_f": 40.0, "F_r": 40.0, "s_f": 2e5, "s_r": 2e5}
    chosen = [i for i, decay in enumerate(decays) if loaded or decay.load == "empty"]
    found = fit_nonlinear(
        [decays[i] for i in chosen],
        larger.nonlinear_models,
        campaign.sensors,
        dict(larger.known) | {"m_s": KnownValue(1380.0)},
        start=start,
        states=np.hstack([optimum.states[chosen], np.full((len(chosen), 4), 0.3)]),  # memories of friction
        near=True,
        most=0,
    )
    at = found.iterate.at
    along = np.array([value * parameter_of(name).scales for name, value in zip(found.names, found.values, strict=True)])
    windows = at.by_window
    assert windows is not None
    of_records = [along @ own @ along for own in (at.information, windows[1].sum(axis=0))]
    slopes = [own.sum(axis=0) @ along for own in (at.by_drop[0], windows[0])]
    objective = found.problem.objective
    assert isinstance(objective, TimeSteppingObjective)
    visible = objective.visible_changes(found.values) @ along
    if loaded:
        assert min(of_records) > 1e3  # 140 kg of ballast are known
        np.testing.assert_array_equal(visible, along)
    else:
        np.testing.assert_allclose(of_records, 0.0, atol=1e-6)
        np.testing.assert_allclose(slopes, 0.0, atol=1e-3)
        np.testing.assert_allclose(visible, 0.0, atol=1e-6)


def test_scores_are_those_of_the_linear_fit(
    campaign: Campaign, decays: tuple[FreeDecay, ...], plain: ModelStructure, optimum: FitResult
) -> None:
    """What an anti-roll bar would gain is told by modes as by steps."""
    larger = plain.with_terms(("anti-roll",))
    start = optimum.parameters | {"k_af": 0.0, "k_ar": 0.0}
    ((by_modes, _),) = score_linear_term(optimum, larger.linear_models, campaign.sensors, larger.known, [start])
    all_in = plain.with_terms(("anti-roll", "friction"))
    by_steps = score_stepped_terms(
        decays,
        all_in.nonlinear_models,
        campaign.sensors,
        all_in.known,
        values=start | {"F_f": 0.0, "F_r": 0.0, "s_f": 2e5, "s_r": 2e5},
        states=optimum.states,
        together=[(name,) for name in optimum.names],
        candidates={"anti-roll": [("k_af",), ("k_ar",)]},
        longest_step=0.0025,
    )["anti-roll"]
    assert by_modes > 10
    # The weights of the channels are not quite the same: those of the modes are taken before initial states are known.
    assert by_steps == pytest.approx(by_modes, rel=0.15)


def test_a_start_whose_motion_has_no_bounds_has_no_score(
    campaign: Campaign, plain: ModelStructure, optimum: FitResult
) -> None:
    larger = plain.with_terms(("anti-roll",))
    sound, unstable = (optimum.parameters | {"k_af": rate, "k_ar": rate} for rate in (0.0, -1e9))
    (own, _), (gain, _) = score_linear_term(
        optimum, larger.linear_models, campaign.sensors, larger.known, [sound, unstable]
    )
    assert gain == -np.inf < own


@pytest.mark.slow
def test_scores_of_forces_need_no_steps(
    campaign: Campaign, plain: ModelStructure, optimum: FitResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By modes and filters they are what the steps say: of forces that are there, and of others."""
    friction = {"F_f": 2.0, "F_r": 1.0, "s_f": 2e5, "s_r": 2e5}
    rubbing = Vehicle.from_parameters(TABLE_1_CAR.parameters | friction | {"r_f": 1.01})
    drops = [replace(drop, file=None) for drop in campaign.drops]
    other = sprung.simulate(rubbing, loads=[LOAD], drops=drops, rate=500, noise=0.02, seed=4)
    theirs = prepare(other).decays
    found = fit_linear(theirs, plain.linear_models, other.sensors, plain.known, start=optimum.parameters)
    extras = ("friction", "rebound", "progressive")
    larger = plain.with_terms(extras)
    neutral = {"F_f": 0.0, "F_r": 0.0, "s_f": 2e5, "s_r": 2e5, "r_f": 1.0, "r_r": 1.0, "p_f": 0.0, "p_r": 0.0}
    values = found.parameters | neutral
    brought = {extra: parameters_of_term(extra, "shared") for extra in extras}
    by_modes = score_nonlinear_terms(found, larger.nonlinear_models, values, brought)
    by_steps = score_stepped_terms(
        theirs,
        larger.nonlinear_models,
        other.sensors,
        larger.known,
        values=values,
        states=found.states,
        together=[(name,) for name in found.names],
        candidates={extra: [(name,) for name in names] for extra, names in brought.items()},
        longest_step=0.0025,
    )
    assert min(by_modes["friction"][0], by_modes["rebound"][0]) > 50
    # A motion that decays fast is followed in parts, and long drops one by one: with the same scores, to rounding.
    assert len({decay.samples for decay in theirs}) > 1
    for limit, value in (("_LARGEST_POWER", 2.0), ("_LARGEST", 1)):
        monkeypatch.setattr(f"sprung.estimation.nonlinear_scores.{limit}", value)
        in_parts = score_nonlinear_terms(found, larger.nonlinear_models, values, brought)
        for extra in extras:
            assert in_parts[extra][0] == pytest.approx(by_modes[extra][0], rel=1e-7)
    for extra in extras:
        assert by_modes[extra][0] == pytest.approx(by_steps[extra], rel=0.15, abs=3)


def test_what_is_lost_without_a_value_is_what_the_likelihood_loses(
    campaign: Campaign, decays: tuple[FreeDecay, ...], plain: ModelStructure, optimum: FitResult
) -> None:
    """Wald's test is exact to second order: half a percent off, a mass costs what its information says."""
    value = optimum.parameters["m_uf"] * 1.002
    expected = wald_test(optimum, [("m_uf", value)])
    known = dict(plain.known) | {"m_uf": sprung.uncertainty.KnownValue(value)}
    held = fit_linear(decays, plain.linear_models, campaign.sensors, known, start=optimum.parameters | {"m_uf": value})
    assert 2 * (optimum.loglikelihood - held.loglikelihood) == pytest.approx(expected, rel=0.05)


def test_what_is_lost_without_a_term_does_not_depend_on_how_well_the_scale_is_known() -> None:
    """Weighed to 10 %, rates of anti-roll bars are known to 10 %; that there are any, hundreds of standard errors."""
    barred = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"k_af": 2000.0, "k_ar": 2000.0})
    lost = {}
    for weighed in (0.001, 0.1):
        total = sprung.uncertainty.KnownValue(barred.total_mass, weighed * barred.total_mass)
        drops = [{"wheels": wheels} for wheels in (("fl", "fr"), ("fl", "rl"))]
        other = sprung.simulate(barred, drops=drops, noise=0.02, seed=4, known={"total_mass": total})
        structure = choose_structure(other, "shared", ("anti-roll",))
        found = fit_linear(prepare(other).decays, structure.linear_models, other.sensors, structure.known)
        lost[weighed] = wald_test(found, [("k_af", 0.0), ("k_ar", 0.0)])
        # A certain rate is not the same at every scale.
        certain = wald_test(found, [("k_af", 1000.0)])
        assert certain == pytest.approx((0.5 / weighed) ** 2, rel=0.2) if weighed == 0.1 else certain > 1000
    assert lost[0.001] > 1e4
    assert lost[0.1] == pytest.approx(lost[0.001], rel=1e-3)


def test_what_nothing_determines_may_have_any_value() -> None:
    """Where nothing is weighed, half as much again is as likely a mass; its place is known to 0.3 %.

    Rounding is taken for information: a part of 1e-12 of the largest, which is some 1e8.
    """
    drops = [{"wheels": wheels} for wheels in (("fl", "fr"), ("fl", "rl"))]
    unweighed = sprung.simulate(TABLE_1_CAR, drops=drops, noise=0.02, seed=4)
    structure = choose_structure(unweighed, "shared", ())
    start = dict(TABLE_1_CAR.parameters)
    found = fit_linear(prepare(unweighed).decays, structure.linear_models, unweighed.sensors, {}, start=start)
    assert wald_test(found, [("m_s", 1.5 * found.parameters["m_s"])]) < 0.1
    assert wald_test(found, [("a", 1.1 * found.parameters["a"])]) > 100


def test_a_usual_value_is_no_weighing() -> None:
    """A prior on the rates of bars says nothing of the masses; a statement about one of them does."""
    barred = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"k_af": 2000.0, "k_ar": 2000.0})
    drops = [{"wheels": wheels} for wheels in (("fl", "fr"), ("fl", "rl"))]
    other = sprung.simulate(barred, drops=drops, noise=0.02, seed=4)
    structure = choose_structure(other, "shared", ("anti-roll",))
    decays, models, sensors = prepare(other).decays, structure.linear_models, other.sensors
    start, usual = dict(barred.parameters), {"k_af": UsualValue(3000.0, 1.05)}
    fit = fit_linear(decays, models, sensors, structure.known, start=start, usual=usual)
    assert fit.problem.priors.usual == usual
    found = uncertainty_of(fit)
    assert not scale_of(found).known
    assert estimate_of(found, structure.known, "m_s").status == "unidentifiable"
    assert scale_of(found).per_total_mass["k_sf"].std > 0
    known = {**structure.known, "k_af": KnownValue(2000.0, 100.0)}
    found = uncertainty_of(fit_linear(decays, models, sensors, known, start=start))
    mass = estimate_of(found, known, "m_s")
    assert mass.value is not None
    assert mass.std == pytest.approx(0.05 * mass.value, rel=0.1)


def test_frictions_that_hold_with_more_than_they_can_begin_anew_sliding(
    decays: tuple[FreeDecay, ...], campaign: Campaign, plain: ModelStructure, optimum: FitResult
) -> None:
    """Noise and another law explain a memory of 1.4; one of -2.2 and all others of its drop are those of sliding."""
    larger = plain.with_terms(("friction",))
    memories = np.tile([1.4, 0.3, -1.1, 0.9], (len(decays), 1))
    memories[1] = [1.4, 0.3, -2.2, 0.9]
    states = np.hstack([optimum.states, memories])
    rows = Readout.of(campaign.sensors, larger.names)
    objective = TimeSteppingObjective(decays, larger.nonlinear_models, rows, states, False, 0.002)
    anew = objective.with_possible_memories(states)
    np.testing.assert_array_equal(anew[1, 14:], [1.0, 0.3, -1.0, 0.9])
    np.testing.assert_array_equal(np.delete(anew, 1, axis=0), np.delete(states, 1, axis=0))
    np.testing.assert_array_equal(anew[:, :14], states[:, :14])


def test_windows_of_time_add_up(decays: tuple[FreeDecay, ...], plain: ModelStructure, optimum: FitResult) -> None:
    """Gradient and information of all windows are those of the whole; where the model is right, no window disagrees."""
    larger = plain.with_terms(("rebound",))
    found = fit_nonlinear(
        decays,
        larger.nonlinear_models,
        plain.sensors,
        plain.known,
        start=optimum.parameters | {"r_f": 1.0, "r_r": 1.0},
        states=optimum.states,
    )
    at = found.iterate.at
    assert at.by_window is not None
    gradients, informations = at.by_window
    scale = np.sqrt(np.diag(at.information))
    np.testing.assert_allclose(gradients.sum(axis=0) / scale, at.gradient / scale, atol=0.05)
    np.testing.assert_allclose(
        informations.sum(axis=0) / np.outer(scale, scale), at.information / np.outer(scale, scale), atol=1e-6
    )
    assert found.disagreement_in_time < 2


def test_readings_follow_all_unknowns_behind_a_low_pass(
    decays: tuple[FreeDecay, ...], plain: ModelStructure, optimum: FitResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is left of the records, against differences: with what the low-pass remembers, and whatever is fitted so far.

    Initial velocities of wheels excite motions that it hardly passes, and of which it sees more than the samples do. Where in
    a step a kink is passed moves with the unknowns, which derivatives leave out: a thousandth of them.
    """
    larger = plain.with_terms(("rebound",))
    begun = fit_nonlinear(
        decays,
        larger.nonlinear_models,
        plain.sensors,
        plain.known,
        start=optimum.parameters | {"r_f": 1.3, "r_r": 1.2, LOW_PASS_CORNER: 96.0},
        states=optimum.states,
        near=True,
        most=0,
        low_pass=LowPass(90.0, 4),
    )
    assert isinstance(begun.iterate.at, TimeSteppingAt)
    assert begun.names[-1] == LOW_PASS_CORNER
    assert begun.parameters[LOW_PASS_CORNER] == pytest.approx(96.0)
    assert is_of_sensor(LOW_PASS_CORNER)
    assert parameter_of(LOW_PASS_CORNER).unit == "Hz"
    finer = replace(begun.iterate.at.objective, longest_step=0.5 * begun.iterate.at.objective.longest_step)
    assert finer.every > 1
    at = finer.at_states(begun.iterate.at.values, begun.iterate.at.weights, begun.iterate.at.stepped.begin)
    parameters = len(at.values)
    corner, damping, wheel = begun.names.index(LOW_PASS_CORNER), begun.names.index("c_sf"), parameters + 10
    passed = at.stepped.stepper.unresolved(at.stepped.trajectory)
    for is_held, within in ((False, 1e-3), (True, 2e-5)):
        if is_held:
            monkeypatch.setattr(Stepper, "unresolved", lambda *_: passed)
        for unknown, size in ((corner, 0.01), (damping, 0.1), (wheel, 1e-5)):
            found = at.stepped.products[:, :, unknown, -1]
            change = np.zeros(parameters + at.stepped.begin.shape[1])
            change[unknown] = size
            of_values, of_states = np.split(change, [parameters])
            sums = [
                at.objective.at_states(at.values + side * of_values, at.weights, at.stepped.begin + side * of_states)
                for side in (-1.0, 1.0)
            ]
            difference = (sums[0].residual_sums - sums[1].residual_sums) / (4 * size)
            np.testing.assert_allclose(found, difference, rtol=1e-4, atol=within * np.abs(found).max())


def test_initial_states_follow_the_delay_of_a_low_pass(
    decays: tuple[FreeDecay, ...], plain: ModelStructure, optimum: FitResult
) -> None:
    """A corner 10 % higher delays by 9 % less, and the motion comes as much later: little is left to gain by the states alone.

    Along a straight line of the corner it would come later by another 1 % of 4.6 ms, and leave 125.
    """
    begun = fit_nonlinear(
        decays,
        plain.with_terms(("rebound",)).nonlinear_models,
        plain.sensors,
        plain.known,
        start=optimum.parameters | {"r_f": 1.0, "r_r": 1.0, LOW_PASS_CORNER: 90.0},
        states=optimum.states,
        near=True,
        most=0,
        low_pass=LowPass(90.0, 4),
    )
    at = begun.iterate.at
    assert isinstance(at, TimeSteppingAt)
    at = at.with_optimal_states()
    higher = at.values * np.where(np.array(begun.names) == LOW_PASS_CORNER, 1.1, 1.0)
    followed = at.moved(higher)
    best = followed.with_optimal_states()
    lost = float(at.weights @ (followed.residual_sums - best.residual_sums).sum(axis=0))
    assert 0 <= lost < 10


def test_a_low_pass_sees_where_in_a_step_a_kink_is_passed(
    decays: tuple[FreeDecay, ...], plain: ModelStructure, optimum: FitResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Readings with steps of 1 ms, against those with steps of 0.1 ms: a third of what the ends alone make them err by."""
    begun = fit_nonlinear(
        decays,
        plain.with_terms(("rebound",)).nonlinear_models,
        plain.sensors,
        plain.known,
        start=optimum.parameters | {"r_f": 2.5, "r_r": 2.5},
        states=optimum.states,
        near=True,
        most=0,
        low_pass=LowPass(90.0, 4),
    )
    assert isinstance(begun.iterate.at, TimeSteppingAt)
    begin, objective = begun.iterate.at.stepped.begin, begun.iterate.at.objective

    def read(longest_step: float) -> NDArray[np.float64]:
        own = replace(objective, longest_step=longest_step)
        return own.at_states(begun.iterate.at.values, begun.iterate.at.weights, begin).stepped.residuals

    precise = read(0.1e-3)
    error = np.abs(read(1e-3) - precise).max()
    monkeypatch.setattr(Stepper, "unresolved", lambda _, trajectory: np.zeros_like(trajectory.forces))
    assert error < 0.35 * np.abs(read(1e-3) - precise).max()


def test_a_step_gains_what_is_expected_of_it_where_initial_states_are_not_at_their_maximum(
    campaign: Campaign, decays: tuple[FreeDecay, ...], plain: ModelStructure, optimum: FitResult
) -> None:
    """Without the states' own part a fit would end as soon as the parameters alone have nothing more to gain."""
    larger = plain.with_terms(("friction",))
    start = optimum.parameters | {"F_f": 0.0, "F_r": 0.0, "s_f": 2e5, "s_r": 2e5}
    known = dict(plain.known) | {
        name: sprung.uncertainty.KnownValue(value) for name, value in start.items() if name[:2] in ("F_", "s_")
    }
    states = optimum.states + 2e-5 * np.random.default_rng(1).standard_normal(optimum.states.shape)
    begun = fit_nonlinear(
        decays, larger.nonlinear_models, campaign.sensors, known, start=start, states=states, near=True, most=0
    )
    step, expected = begun.problem.normal_equations(begun.iterate).step()
    _, gain = begun.problem.trial(begun.iterate, step)
    of_parameters = begun.problem.normal_equations(begun.iterate)._replace(eliminated=0.0).step()[1]
    assert of_parameters < 0.5 * expected
    assert gain == pytest.approx(expected, rel=0.3)


def test_a_drop_whose_initial_state_loses_is_damped_more(
    campaign: Campaign, decays: tuple[FreeDecay, ...], plain: ModelStructure, optimum: FitResult
) -> None:
    """Whole steps of it would lose again and again; the damped one leaves out only what its record hardly shows."""
    larger = plain.with_terms(("friction",))
    values = np.array(
        [(optimum.parameters | {"F_f": 0.0, "F_r": 0.0, "s_f": 2e5, "s_r": 2e5})[n] for n in larger.names]
    )
    rows = Readout.of(campaign.sensors, larger.names)
    states = optimum.states + 2e-5 * np.random.default_rng(1).standard_normal(optimum.states.shape)
    objective = TimeSteppingObjective(decays, larger.nonlinear_models, rows, states, False, 0.002)
    tried: list[np.ndarray] = []

    class Bent(TimeSteppingAt):
        """Where the whole step of the second drop ends far from its prior."""

        def _moved_by(self, values: np.ndarray, states: np.ndarray) -> TimeSteppingAt:
            tried.append(states.copy())
            moved = super()._moved_by(values, states)
            begin = moved.stepped.begin.copy()
            begin[1, 0] += 1e3 * objective.prior_std[0] * (len(tried) == 1)
            return replace(moved, stepped=replace(moved.stepped, begin=begin))

    at = objective.at(values, np.full(8, 0.02**-2))
    moved = Bent(at.stepped, at.weights).moved(values)
    whole, damped = tried
    np.testing.assert_array_equal(np.delete(damped, 1, axis=0), np.delete(whole, 1, axis=0))
    assert (damped[1] != whole[1]).any()
    # A damping of one thousandth takes so much at the most from what the whole step gains, but along what is hardly shown.
    promised = objective.at(values, at.weights)._normal_equations[1][1, len(values) :] @ whole[1]
    assert (at._costs - moved._costs)[1] > 0.9 * promised

"""Parts that a fitted vehicle does not have: what they would do to its poles, and what they would gain, from its own modes."""

from __future__ import annotations

import numpy as np
import pytest

import sprung
from sprung.campaign import Campaign
from sprung.estimation import (
    FitResult,
    fit_linear,
    readout_of,
    score_linear_term,
    score_linear_terms,
)
from sprung.estimation.eliminated_coordinates import eliminate_coordinates
from sprung.estimation.modal_solution import differentiate_response, solve_modes
from sprung.preprocess import FreeDecay, prepare
from sprung.selection.starts import neutral_values
from sprung.selection.structure import ModelStructure, choose_structure
from sprung.simulation import PadMotion
from sprung.vehicle import TABLE_1_CAR, LinearModel, Readout, Vehicle, parameters_of_term

LOAD = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.0, 0.55)}]}

PARTS = ("engine", "damper-mount", "zener", "twist", "bending", "occupants")


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    """Drops of a car whose springs are stiffer in fast motion, by so little that the fit without it is a good one."""
    own = TABLE_1_CAR.parameters
    branch = {"k_zf": 0.01 * own["k_sf"], "k_zr": 0.01 * own["k_sr"]}
    branch |= {"c_zf": 0.05 * branch["k_zf"], "c_zr": 0.05 * branch["k_zr"]}
    return sprung.simulate(Vehicle.from_parameters(own | branch), loads=[LOAD], noise=0.02, seed=5)


@pytest.fixture(scope="module")
def decays(campaign: Campaign) -> tuple[FreeDecay, ...]:
    return prepare(campaign).decays


@pytest.fixture(scope="module")
def plain(campaign: Campaign) -> ModelStructure:
    return choose_structure(campaign, "shared", ())


@pytest.fixture(scope="module")
def optimum(campaign: Campaign, decays: tuple[FreeDecay, ...], plain: ModelStructure) -> FitResult:
    return fit_linear(decays, plain.linear_models, campaign.sensors, plain.known, start=TABLE_1_CAR.parameters)


@pytest.mark.parametrize("part", PARTS)
def test_poles_move_with_a_part_as_its_own_model_says(part: str, plain: ModelStructure) -> None:
    """Differences of the poles of the larger model; the part hardly acts, so that 2 % and rounding are left."""
    larger, own = plain.with_terms((part,)), TABLE_1_CAR.parameters
    names = parameters_of_term(part, "shared")
    values = neutral_values(larger, own)
    small, model = (LinearModel.stack([one.linear_models["empty"]]) for one in (plain, larger))
    sensors = Readout.of(plain.sensors, plain.names, plain.wheelbase)
    at = np.array([own[name] for name in plain.names])
    modes = solve_modes(small, sensors, at)
    numbers = np.array([values[name] for name in larger.names])
    scales = np.array([values[name] or 0.1 for name in names])
    changed = np.array([[float(name == other) for other in larger.names] for name in names]) * scales[:, None]
    forces, _ = eliminate_coordinates(modes, plain.names, model, numbers, changed)
    moved, _ = differentiate_response(small, sensors, at, modes, forces, 3.0)

    def poles(
        step: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
    ) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
        every = np.linalg.eigvals(model.matrices(numbers + step).state[0])
        return np.array([every[np.abs(every - pole).argmin()] for pole in modes.poles[0]])

    step = 1e-3
    for change, found in zip(changed, moved[0], strict=True):
        expected = (poles(step * change) - poles(-step * change)) / (2 * step)
        np.testing.assert_allclose(found, expected, atol=0.02 * np.abs(expected).max() + 1e-8)


def test_a_part_that_is_there_gains_as_its_own_model_says(
    campaign: Campaign, plain: ModelStructure, optimum: FitResult
) -> None:
    """Mounts show by the modes alone; what branches begin with, which their own model has free, takes up some of their gain."""
    terms = ("damper-mount", "zener")
    all_in = plain.with_terms(terms)
    values = neutral_values(all_in, optimum.parameters)
    sensors = readout_of(all_in.sensors, all_in.names, all_in.known)
    brought = {term: parameters_of_term(term, "shared") for term in terms}
    tests = score_linear_terms(optimum, all_in.linear_models, sensors, [(values, brought)])
    assert tests is not None
    gains = {term: gain for term, (gain, _) in tests[0].items()}
    for term, tolerance in (("damper-mount", 0.02), ("zener", 0.5)):
        larger = plain.with_terms((term,))
        start = neutral_values(larger, optimum.parameters)
        ((own, _),) = score_linear_term(optimum, larger.linear_models, campaign.sensors, larger.known, [start])
        assert own > 100
        assert gains[term] == pytest.approx(own, rel=tolerance)


@pytest.mark.parametrize("with_drops", [False, True])
@pytest.mark.slow
def test_terms_gain_on_pads_what_their_own_models_say(with_drops: bool) -> None:
    """Lines in place of modes, and both together."""
    own = TABLE_1_CAR.parameters
    branch = {"k_zf": 0.02 * own["k_sf"], "k_zr": 0.02 * own["k_sr"]}
    branch |= {"c_zf": 0.05 * branch["k_zf"], "c_zr": 0.05 * branch["k_zr"]}
    drops: list[dict[str, object]] = [{"excitation": "pads"}]
    drops += [{"wheels": ("fl", "fr")}, {"wheels": ("fl", "rl")}] if with_drops else []
    noise = {"acceleration": 0.02, "displacement": 5e-5, "force": 8.0}
    pads = PadMotion("random", duration=20.0)
    campaign = sprung.simulate(
        Vehicle.from_parameters(own | branch), drops=drops, pads=pads, noise=noise, seed=5, rate=500.0
    )
    structure = choose_structure(campaign, "shared", ())
    decays = prepare(campaign).decays
    fit = fit_linear(decays, structure.linear_models, campaign.sensors, structure.known, start=own)
    exact = ("anti-roll", "tyre-damping", "asymmetry", "rigid-axle")
    terms = (*exact, "damper-mount")
    all_in = structure.with_terms(terms)
    sensors = readout_of(all_in.sensors, all_in.names, all_in.known)
    brought = {term: parameters_of_term(term, "shared") for term in terms}
    ways = [(neutral_values(all_in, fit.parameters), brought)]
    found = score_linear_terms(fit, all_in.linear_models, sensors, ways)
    assert found is not None
    for term in terms:
        larger = structure.with_terms((term,))
        start = neutral_values(larger, fit.parameters)
        ((gain, values),) = score_linear_term(fit, larger.linear_models, campaign.sensors, larger.known, [start])
        scored, estimates = found[0][term]
        assert gain > 1
        # The ends of what moves in series, which its own model has free, take up a part of the gain.
        assert scored == pytest.approx(gain, rel=0.02 if term in exact else 0.05)
        if term == "tyre-damping":
            assert estimates == pytest.approx({name: values[name] for name in brought[term]}, rel=0.02)

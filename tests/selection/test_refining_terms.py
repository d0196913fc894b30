"""Terms that refine another one: they are tried beside it alone, and only where the recordings have what they describe."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sprung
from sprung.campaign import ModelChoice
from sprung.estimation import fit_linear
from sprung.preprocess import prepare
from sprung.progress import silent
from sprung.selection import further_terms, scoring
from sprung.selection.search import ModelSearch
from sprung.selection.starts import fit_structure
from sprung.selection.structure import choose_structure
from sprung.vehicle import EXTRAS, TABLE_1_CAR, Vehicle

BALLAST = {"name": "ballast", "items": [{"mass": 300.0, "position": [-2.0, 0.2, 0.6]}]}
RUBBING = {"F_f": 60.0, "F_r": 150.0, "s_f": 2e5, "s_r": 4e5}
ONE_KNEE = {"v_kf": 0.08, "v_kr": 0.1, "q_f": 0.4, "q_r": 0.5}
TWO_KNEES = {"v_kf": 0.06, "v_kr": 0.07, "q_f": 0.5, "q_r": 0.6, "v_2f": 0.2, "v_2r": 0.25, "q_2f": 0.4, "q_2r": 0.5}

_OPEN = (
    "friction",
    "load-friction",
    "rebound",
    "damper-curve",
    "rebound-knee",
    "rounded-knee",
    "second-knee",
    "third-knee",
    "progressive",
)


def simulated(car: Vehicle, *loads: str) -> sprung.Campaign:
    """Simulate a car whose recordings are to decide about friction, dampers and springs."""
    wheels = (["fl", "fr"], ["rl", "rr"], ["fl", "rl"])
    drops = [{"wheels": one, "load": load} for one in wheels for load in loads]
    campaign = sprung.simulate(
        car, loads=[BALLAST], drops=drops, rate=250, duration=1.8, seed=2, known={"total_mass": car.total_mass}
    )
    forbidden = tuple(extra for extra in EXTRAS if extra not in (*_OPEN, "seat-load"))
    return replace(campaign, model=ModelChoice(tracks="shared", forbid=forbidden))


def identified(
    more: dict[str, float], *loads: str, extras: tuple[str, ...] | None = None
) -> tuple[Vehicle, sprung.Result]:
    """Simulate and identify a car."""
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | more)
    return car, sprung.identify(simulated(car, *loads), fall=False, extras=extras)


def deviations(car: Vehicle, result: sprung.Result) -> dict[str, float]:
    """Return by how many standard errors each estimate is off."""
    estimates = ((name, result.parameters[name]) for name in car.parameters)
    return {
        name: (one.value - car.parameters[name]) / one.std
        for name, one in estimates
        if one.value is not None and one.std
    }


@pytest.mark.long
@pytest.mark.parametrize("extras", [("friction", "load-friction"), None])
def test_friction_that_grows_with_the_load_is_selected(extras: tuple[str, ...] | None) -> None:
    """Leaf springs: 2 and 8 % of the load on each front, and rear, wheel; requested, or stated nowhere."""
    car, result = identified(RUBBING | {"u_f": 0.02, "u_r": 0.08}, "empty", "ballast", extras=extras)
    assert result.fit.model == ("friction", "load-friction")
    assert result.verdict.state == "accept"
    off = deviations(car, result)
    assert set(off) >= {"u_f", "u_r"}
    assert max(map(abs, off.values())) < 5
    assert "of the load on each front wheel" in result.additional_terms


@pytest.mark.long
@pytest.mark.parametrize("loads", [("empty", "ballast"), ("empty",)])
def test_friction_that_is_the_same_under_every_load_is_not_refined(loads: tuple[str, ...]) -> None:
    """Nor is one of which drops with one load say nothing."""
    growth = {} if len(loads) > 1 else {"u_f": 0.02, "u_r": 0.08}
    _, result = identified(RUBBING | growth, *loads)
    assert result.fit.model == ("friction",)
    assert result.verdict.state == "accept"


@pytest.mark.slow
def test_a_second_knee_is_selected_and_shown() -> None:
    """The curve is monotone, with its band, and the true one within that; a rounded knee explains less."""
    car, result = identified(TWO_KNEES, "empty")
    assert result.fit.model == ("damper-curve", "second-knee")
    assert max(map(abs, deviations(car, result).values())) < 5
    curve = result.curves["damper_front"]
    assert np.all(np.diff(curve.force) > 0)
    speed = np.array([0.05, 0.15, 0.3])
    truth = 1500.0 * np.interp(speed, [0.0, 0.06, 0.2, 1.2], np.cumsum([0.0, 0.06, 0.5 * 0.14, 0.5 * 0.4]))
    found = curve.at(speed)
    assert np.all(np.abs(found.force - truth) < 5 * np.asarray(found.std))
    assert np.all(np.asarray(found.std) < 0.01 * truth)
    assert "second knee" in result.additional_terms


@pytest.mark.slow
def test_a_knee_of_rebound_is_selected_and_shown() -> None:
    """Valves of rebound that open earlier, onto a steeper line; a second knee for both directions explains less."""
    own = {"r_f": 1.6, "r_r": 1.8, "b_kf": 0.7, "b_kr": 0.75, "b_qf": 1.3, "b_qr": 1.2}
    car, result = identified(ONE_KNEE | own, "empty")
    assert result.fit.model == ("rebound", "damper-curve", "rebound-knee")
    assert result.verdict.state == "accept"
    assert max(map(abs, deviations(car, result).values())) < 5
    assert "in rebound" in result.additional_terms
    # The curve has the knee of either side.
    curve = result.curves["damper_front"]
    speed = np.array([-0.15, -0.05, 0.05, 0.15])
    truth = 1500.0 * np.array([-(0.08 + 0.4 * 0.07), -0.05, 1.6 * 0.05, 1.6 * (0.056 + 0.52 * 0.094)])
    found = curve.at(speed)
    assert np.all(np.abs(found.force - truth) < 5 * np.asarray(found.std))


@pytest.mark.slow
def test_friction_that_shows_in_no_score_is_tried_once_nothing_else_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where a fit of everything at once lost it."""
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | RUBBING | ONE_KNEE)
    campaign = simulated(car, "empty")
    plain = choose_structure(campaign, "shared")
    curved = plain.with_terms(("damper-curve",))
    decays = prepare(campaign).decays
    first = fit_linear(decays, plain.linear_models, campaign.sensors, plain.known, start=TABLE_1_CAR.parameters)
    search = ModelSearch(curved, fit_structure(curved, decays, first, 1.0, silent), decays)
    monkeypatch.setattr(scoring, "score_terms", lambda search, terms: (search, dict.fromkeys(terms, (0.0, 0.0))))
    found = further_terms.select_terms_beside(search)
    assert "friction" in found.structure.terms
    assert abs(found.fit.parameters["F_r"] / car.parameters["F_r"] - 1) < 0.05


@pytest.mark.long
def test_one_knee_has_no_second_one() -> None:
    _, result = identified(ONE_KNEE, "empty")
    assert result.fit.model == ("damper-curve",)
    assert result.verdict.state == "accept"


@pytest.mark.long
@pytest.mark.parametrize(("force", "shape"), [(15.0, "hand"), (40.0, "rope")])
def test_friction_of_small_motions_is_found(force: float, shape: str) -> None:
    """After a push a linear fit goes astray for the sake of friction, and no score there shows it."""
    car = TABLE_1_CAR.with_values(F_f=force, F_r=force, s_f=2e5, s_r=2e5)
    sides = (["fl", "fr", "rl", "rr"], ["fl", "fr"], ["rl", "rr"], ["fl", "rl"], ["fr", "rr"])
    pushes = [{"excitation": "push", "wheels": own} for own in sides]
    known = {"total_mass": car.total_mass}
    campaign = sprung.simulate(car, drops=pushes, noise=0.02, seed=1, push={"shape": shape}, known=known)
    result = sprung.identify(campaign, fall=False)
    assert result.verdict.state == "accept"
    assert result.fit.model == ("friction",)
    assert max(map(abs, deviations(car, result).values())) < 4

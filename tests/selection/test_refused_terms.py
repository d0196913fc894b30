"""A term that is refused after others have been tried beside it."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from sprung.estimation import fit_linear
from sprung.preprocess import prepare
from sprung.selection import ModelSearch, choose_structure, stepwise
from sprung.selection.nonlinear import select_nonlinear_terms
from sprung.simulation import simulate
from sprung.vehicle import TABLE_1_CAR


@pytest.mark.parametrize(
    ("part", "beside", "against"),
    [
        (1.0, [["engine"]], "it does not explain the whole misfit"),
        (0.5, [], "it explains less than half of the misfit"),
    ],
)
def test_a_term_that_is_gone_beside_others_is_refused_without_being_asked_again(
    monkeypatch: pytest.MonkeyPatch, part: float, beside: list[list[str]], against: str
) -> None:
    """An engine seems to explain some of dry friction, less than half of it: nothing is tried beside it.

    Where more may be left to others, the terms tried beside it leave it out (once a KeyError).
    """
    monkeypatch.setattr(stepwise, "MISFIT_LEFT_TO_OTHERS", part)
    car = TABLE_1_CAR.with_values(F_f=30.0, F_r=30.0, s_f=2e5, s_r=2e5)
    campaign = simulate(car, rate=250.0, noise=0.02, seed=1, known={"total_mass": car.total_mass})
    plain, decays = choose_structure(campaign), prepare(campaign).decays
    fit = fit_linear(decays, plain.linear_models, plain.sensors, plain.known)
    search = ModelSearch(plain, fit, decays)
    seen: list[list[str]] = []

    def leave_out(tried: ModelSearch, _: Sequence[str]) -> ModelSearch:
        seen.append(tried.selected)
        return tried.refit(tried.without("engine"))

    monkeypatch.setattr(stepwise, "select_linear_terms", leave_out)
    found = stepwise.try_term(search, "engine")
    assert seen == beside
    assert found.selected == []
    assert against in found.steps[-1].text


@pytest.mark.slow
def test_a_term_that_took_the_place_of_another_is_left_out_beside_nonlinear_ones() -> None:
    """A Zener branch in the place of a damper mount has no step of its own among those of the search (once a KeyError)."""
    car = TABLE_1_CAR.with_values(r_f=1.5, r_r=1.5)
    campaign = simulate(car, rate=250.0, noise=0.02, seed=1, known={"total_mass": car.total_mass})
    plain, decays = choose_structure(campaign), prepare(campaign).decays
    fit = fit_linear(decays, plain.linear_models, plain.sensors, plain.known)
    linear = ModelSearch(plain, fit, decays).refit(plain.with_terms(("zener",)))
    assert linear.steps == ()
    found = select_nonlinear_terms(linear, plain)
    assert found.selected == ["rebound"]
    assert (found.steps[-1].extra, found.steps[-1].against) == ("zener", "it is not needed beside rebound")

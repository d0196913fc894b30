"""The scale of a vehicle that nothing shows: that of an ordinary one, where a linear fit has made a body of many tons."""

from __future__ import annotations

import pytest

import sprung
from sprung.estimation import fit_linear
from sprung.preprocess import prepare
from sprung.progress import silent
from sprung.selection import ModelSearch, choose_structure, fit_structure, is_ordinary, or_from_ordinary_vehicle
from sprung.selection.ordinary_vehicle import ordinary_vehicle, with_usual_scale
from sprung.vehicle import TABLE_1_CAR, parameter_of

DROPS = [{"wheels": ("fl", "fr")}, {"wheels": ("fl", "rl")}]


def at(factor: float, weighed: float | None = None) -> ModelSearch:
    """Return a fit that has been left where all masses and rates are too large by a factor, as far as the scales, kg, allow."""
    known = {} if weighed is None else {"total_mass": weighed}
    campaign = sprung.simulate(TABLE_1_CAR, drops=DROPS, noise=0.02, seed=1, rate=250.0, known=known)
    structure, decays = choose_structure(campaign, "shared", ()), prepare(campaign).decays
    own = {name: value * (factor if parameter_of(name).scales else 1) for name, value in TABLE_1_CAR.parameters.items()}
    fit = fit_linear(decays, structure.linear_models, campaign.sensors, structure.known, start=own, most=0)
    return ModelSearch(structure, fit, decays)


def test_masses_and_rates_become_those_of_a_usual_body_all_alike() -> None:
    search = at(50.0)
    before, after = search.fit.parameters, with_usual_scale(search)
    usual, _ = ordinary_vehicle(search.structure)
    assert after["m_s"] == pytest.approx(usual["m_s"], rel=1e-12)
    factor = after["m_s"] / before["m_s"]
    assert factor < 0.05
    for name, value in before.items():
        assert after[name] == pytest.approx(value * (factor if parameter_of(name).scales else 1), rel=1e-12), name


def test_a_vehicle_as_there_are_many_keeps_its_scale() -> None:
    search = at(1.2)
    assert search.fit.parameters["m_s"] == pytest.approx(1.2 * TABLE_1_CAR.parameters["m_s"])
    assert with_usual_scale(search) == search.fit.parameters


def test_a_vehicle_that_was_weighed_keeps_what_the_scales_say() -> None:
    """Whatever is usual: it may be a truck."""
    search = at(1.0, weighed=9000.0)
    assert search.fit.parameters["m_s"] > 5000
    assert with_usual_scale(search) == search.fit.parameters


def test_a_nonlinear_fit_whose_wheels_are_nowhere_begins_with_usual_half_distances_again() -> None:
    """From there it ends where the simulated vehicle is, within four standard errors of a drop to one side and one forward."""
    car = TABLE_1_CAR.with_values(p_f=6.0, p_r=6.0)
    campaign = sprung.simulate(car, drops=DROPS, noise=0.02, seed=1, rate=250.0)
    structure, decays = choose_structure(campaign, "shared", ("progressive",)), prepare(campaign).decays
    linear = structure.with_terms(())
    fit = fit_linear(decays, linear.linear_models, campaign.sensors, linear.known)
    start = {**fit.parameters, "p_f": 5.0, "p_r": 5.0, "t_f": 0.04}
    lost = fit_structure(structure, decays, fit, 0.01, silent, most=0, start=start)
    search = ModelSearch(structure, lost, decays)
    assert search.structure.is_time_stepped
    assert not is_ordinary(search)
    found = or_from_ordinary_vehicle(search)
    assert is_ordinary(found)
    assert found.fit.parameters["t_f"] == pytest.approx(car.t_f, rel=0.03)

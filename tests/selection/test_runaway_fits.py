"""Fits that have run away, and vehicles of which nothing is left to be found."""

from __future__ import annotations

import numpy as np
import pytest

import sprung
from sprung.analysis import identify_campaign
from sprung.estimation import fit_linear
from sprung.preprocess import prepare
from sprung.progress import silent
from sprung.selection import ModelSearch, choose_structure, fit_structure, from_ordinary_vehicle
from sprung.selection.nonlinear_terms import DAMPER_LAW
from sprung.selection.structure import ModelStructure
from sprung.vehicle import TABLE_1_CAR, Vehicle

LIGHTLY_DAMPED = Vehicle(
    name="Lightly damped vehicle",
    m_s=408.0,
    I_yy=704.0,
    I_xx=94.0,
    m_uf=22.0,
    m_ur=16.0,
    k_sf=19180.0,
    k_sr=4261.0,
    k_tf=383_800.0,
    k_tr=129_300.0,
    c_sf=164.0,
    c_sr=63.0,
    a=0.912,
    b=1.543,
    t_f=0.524,
    t_r=0.703,
)
"""Of a damping ratio of 5 %, the front stiffer than the rear by more than four: a rig may be like that."""


def linear_search(campaign: sprung.Campaign) -> ModelSearch:
    structure, decays = choose_structure(campaign, "shared"), prepare(campaign).decays
    fit = fit_linear(decays, structure.linear_models, campaign.sensors, structure.known)
    return ModelSearch(structure, fit, decays)


def test_an_unusual_vehicle_that_explains_its_recordings_is_not_searched_any_further() -> None:
    """Fits from an ordinary vehicle with every usual term took half a minute, and ended where they began."""
    campaign = sprung.simulate(LIGHTLY_DAMPED, noise=0.02, seed=1, rate=500.0, known={"total_mass": 484.0})
    run = identify_campaign(campaign)
    assert run.model.structure.terms == ()
    fitted = {step.extra for step in run.model.steps if step.fitted}
    assert fitted.isdisjoint(DAMPER_LAW)


def test_a_vehicle_that_runs_away_without_what_it_does_not_need_is_no_result(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its information is no number: nothing can be said of its terms, and the model stays what it was."""
    search = linear_search(sprung.simulate(TABLE_1_CAR, noise=0.02, seed=1, rate=250.0))
    rich = search.with_terms(DAMPER_LAW)
    fitted = fit_structure(rich, search.decays, search.fit, 0.01, silent)

    def run_away(search: ModelSearch, structure: ModelStructure, *_: object, **__: object) -> ModelSearch:
        start = {**search.fit.parameters, "c_sf": -1e6}
        with np.errstate(all="ignore"):
            lost = fit_structure(rich, search.decays, search.fit, 0.01, silent, most=0, start=start)
        assert lost.loglikelihood == -np.inf
        return ModelSearch(structure, lost, search.decays, steps=search.steps)

    monkeypatch.setattr(
        from_ordinary_vehicle, "fit_usual_terms", lambda *_, **__: ModelSearch(rich, fitted, search.decays)
    )
    monkeypatch.setattr(ModelSearch, "leaves_misfit", lambda *_: False)
    monkeypatch.setattr(ModelSearch, "refit", run_away)
    found = from_ordinary_vehicle.select_beside_usual_terms(search, rich)
    assert (found.structure, found.fit) == (search.structure, search.fit)
    assert {step.extra for step in found.steps if not step.taken} >= {*DAMPER_LAW}

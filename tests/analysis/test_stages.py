"""The stages of an analysis: their order, the one way back, and what the trace tells of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sprung
import sprung.analysis.terms
from sprung.analysis import STAGES, Analysis, AnalysisOptions, analyse, identify_campaign, result_of
from sprung.analysis.faults import isolate_evident_faults
from sprung.campaign import DEFAULT_HEIGHT, Drop
from sprung.progress import silent
from sprung.selection import ModelSearch, ModelStructure
from sprung.vehicle import TABLE_1_CAR, WHEELS, Item, Load

BALLAST = Load(name="ballast", items=(Item(mass=140, position=(-1.0, 0.3, 0.5)),))
KINDS = (WHEELS, WHEELS[:2], WHEELS[::2])
MOST_FITS, MOST_PREPARATIONS = 8, 3
"""For a campaign with one fault."""


@pytest.fixture(scope="module")
def campaign() -> sprung.Campaign:
    drops = [
        Drop(file=f"{load}_{number}.csv", load=load, wheels=wheels, height=DEFAULT_HEIGHT)
        for load in ("empty", "ballast")
        for number, wheels in enumerate(KINDS)
    ]
    return sprung.simulate(
        TABLE_1_CAR, loads=[BALLAST], drops=drops, rate=300.0, noise=0.02, seed=2, duration=2.4,
        known={"total_mass": TABLE_1_CAR.total_mass},
    )  # fmt: skip


@pytest.fixture(scope="module")
def sound(campaign: sprung.Campaign) -> Analysis:
    return identify_campaign(campaign)


def scaled(campaign: sprung.Campaign, channel: int, factor: float) -> sprung.Campaign:
    """Multiply what one channel reads, gravity at rest included."""
    rows = np.arange(len(campaign.sensors))[:, None] == channel
    return campaign.with_recordings(
        [replace(one, values=np.where(rows, factor * one.values, one.values)) for one in campaign.recordings]
    )


@pytest.mark.slow
def test_a_nonlinear_term_that_explains_more_than_a_fault_comes_first() -> None:
    """Tyres that stiffen seemed to be a brake in the drop from all four wheels."""
    stiffening = TABLE_1_CAR.with_values(h_tf=5.0, h_tr=5.0)
    drops = [{"wheels": list(wheels)} for wheels in (WHEELS, WHEELS[:2], WHEELS[2:], WHEELS[::2])]
    known = {"total_mass": TABLE_1_CAR.total_mass}
    campaign = sprung.simulate(stiffening, drops=drops, rate=300.0, noise=0.05, seed=1, duration=2.0, known=known)
    result = sprung.identify(campaign, fall=False)
    assert "tyre-curve" in result.fit.model
    assert (result.verdict.state, result.faults) == ("accept", ())


def with_friction(last: str) -> Analysis:
    """Analyse a short campaign of a car with dry friction up to a stage."""
    rubbing = TABLE_1_CAR.with_values(F_f=90.0, F_r=70.0, s_f=2.5e5, s_r=2.5e5)
    drops = [{"wheels": list(wheels)} for wheels in KINDS]
    known = {"total_mass": TABLE_1_CAR.total_mass}
    campaign = sprung.simulate(rubbing, drops=drops, rate=200.0, noise=0.02, seed=1, duration=1.2, known=known)
    names = [stage.__name__ for stage in STAGES]
    return Analysis.start(campaign, AnalysisOptions(), STAGES[: names.index(last) + 1]).run()


def test_a_sound_campaign_goes_through_every_stage_once(sound: Analysis) -> None:
    stages = [step.stage for step in sound.trace]
    assert stages[0] == "preprocess"
    assert stages[-1] == "assess"
    assert set(stages) <= {stage.__name__ for stage in STAGES}
    assert not any("restart" in step.what for step in sound.trace)
    assert not sound.remaining
    assert sound.preparations == 1
    assert result_of(sound).trace == sound.trace
    assert result_of(sound).verdict.state == "accept"


def test_an_analysis_that_is_not_complete_has_no_result(campaign: sprung.Campaign) -> None:
    begun = Analysis.start(campaign, AnalysisOptions(), STAGES)
    for missing in (
        lambda: result_of(begun),
        lambda: begun.prepared,
        lambda: begun.model,
        lambda: begun.uncertainty,
    ):
        with pytest.raises(RuntimeError):
            missing()


@pytest.mark.parametrize(
    ("channel", "factor", "code"), [(4, 1.05, "gain"), (1, 0.95, "gain"), (6, 1 / 9.80665, "unit")]
)
def test_one_fault_takes_few_fits(campaign: sprung.Campaign, channel: int, factor: float, code: str) -> None:
    run = identify_campaign(scaled(campaign, channel, factor))
    name = campaign.sensors[channel].channel
    assert [(fault.code, name in fault.where) for fault in result_of(run).faults] == [(code, True)]
    assert result_of(run).verdict.state == "accept"
    assert run.fits <= MOST_FITS
    assert run.preparations <= MOST_PREPARATIONS
    if len(run.corrected) > 0:  # gravity at rest corrects a unit before the fit
        restarts = [step for step in run.trace if "restart" in step.what]
        assert len(restarts) == 1
        assert name in restarts[0].why


def test_a_restart_begins_again_and_keeps_what_was_found(sound: Analysis) -> None:
    again = sound.restart(sound.campaign, [], "isolate_faults", "because the test says so")
    assert again.remaining == again.stages == STAGES
    assert again.search is None
    assert again.trace[-1].why == "because the test says so"
    assert again.trace[:-1] == sound.trace
    assert again.preparation is sound.preparation  # nothing was corrected that would change the recordings


def test_requested_terms_are_fitted_and_no_others_tried(campaign: sprung.Campaign) -> None:
    run = analyse(campaign, AnalysisOptions(tracks="shared", terms=("anti-roll",), fall=False))
    assert run.model.structure.terms == ("anti-roll",)
    assert not [step for step in run.trace if step.stage.startswith("select") and "scored" in step.what]


@pytest.mark.slow
def test_faults_are_looked_for_once_in_a_misfit_of_which_none_explains_any() -> None:
    """Friction is no fault: while most of what it does is left, no other fit of springs and dampers shows one either."""
    first = with_friction("isolate_evident_faults")
    assert first.isolated == (first.fit, ())

    moved = replace(first, search=replace(first.model, fit=replace(first.fit, steps=first.fit.steps + 1)))
    again = isolate_evident_faults(moved, silent)
    assert again.fits == moved.fits
    assert again.trace[-1].what == "faults are not looked for again"

    explained = moved.model.refit(moved.model.with_terms(["friction"]))
    other = isolate_evident_faults(replace(moved, search=explained), silent)
    assert other.trace[-1].what != "faults are not looked for again"


@pytest.mark.slow
def test_a_nonlinear_term_that_is_nothing_at_the_optimum_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """The search ends a standard error away from the optimum, and does not know where the wheels last touched."""
    run = with_friction("fit_baseline")

    def with_too_much(search: ModelSearch, _: ModelStructure) -> ModelSearch:
        return search.refit(search.with_terms(["friction", "tyre-curve"]))

    monkeypatch.setattr(sprung.analysis.terms, "select_nonlinear", with_too_much)
    found = sprung.analysis.terms.select_nonlinear_terms(run, silent)
    assert found.model.structure.terms == ("friction",)
    assert found.fit.converged
    assert any(step.what == "tyre-curve: fitted and not included" for step in found.trace)

"""Corrections beside a model that lacked a term: taken back where the model with that term does not need them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import sprung
from sprung.analysis import Analysis, AnalysisOptions
from sprung.analysis.baseline import fit_baseline
from sprung.analysis.preparation import preprocess
from sprung.analysis.taking_back import take_back_corrections
from sprung.errors import Fault
from sprung.faults import CandidateFit, Hypothesis
from sprung.faults.correction import Correction, scale_channel
from sprung.preprocess import exclude_drops
from sprung.progress import silent
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, WHEELS

RUBBER = TABLE_1_CAR.with_values(k_zf=4e3, k_zr=4e3, c_zf=250.0, c_zr=250.0)
WAYS = (WHEELS, WHEELS[:2], WHEELS[2:], WHEELS[::2])
HEAVIER, SHIFTED = 1.05, 1.03
"""Factors on what a vehicle weighs in one drop, and on what a channel reads."""


@cache
def recorded(*, is_sound: bool) -> sprung.Campaign:
    """Four drops of a car with rubber beside its springs; in the last one somebody else may sit in it."""
    known = {"total_mass": RUBBER.total_mass}
    drops = [{"wheels": list(wheels)} for wheels in WAYS]
    cars = [RUBBER, RUBBER if is_sound else RUBBER.with_values(m_s=HEAVIER * RUBBER.m_s)]
    campaign, other = (
        sprung.simulate(car, drops=drops, rate=250.0, noise=0.02, seed=1, duration=2.0, known=known) for car in cars
    )
    return campaign.with_recordings([*campaign.recordings[:-1], other.recordings[-1]])


def analysed(campaign: sprung.Campaign, excluded: Sequence[str] = (), terms: tuple[str, ...] = ("zener",)) -> Analysis:
    """Analyse a campaign up to its linear model, with drops left out."""
    why = {name: Fault("unlike-repeats", name, "contradicts the others", "Record it again.") for name in excluded}
    first = preprocess(Analysis.start(campaign, AnalysisOptions("shared", terms), ()), silent)
    left = exclude_drops(first.campaign, first.prepared, why)
    return fit_baseline(replace(first, excluded=why, preparation=left), silent)


def left_out(run: Analysis, name: str, terms: tuple[str, ...]) -> Analysis:
    """Say that a drop was left out beside a model with some terms."""
    candidate = CandidateFit.of(run.model.structure.with_terms(terms), run.decays, run.fit)
    wrong = Hypothesis(run.excluded[name], "left out", Correction(), candidate.table, candidate, recording=name)
    return replace(run, corrected=(wrong,))


def test_a_sound_drop_is_used_again() -> None:
    campaign = recorded(is_sound=True)
    name = campaign.drops[-1].recording.name
    before = left_out(analysed(campaign, [name]), name, ())
    after = take_back_corrections(before, silent)
    assert [decay.file for decay in before.decays] == [drop.recording.name for drop in campaign.drops[:-1]]
    assert [decay.file for decay in after.decays] == [drop.recording.name for drop in campaign.drops]
    assert (after.corrected, dict(after.excluded), after.campaign.faults) == ((), {}, campaign.faults)
    assert after.trace[-1].stage == "take_back_corrections"
    assert name in after.trace[-1].why
    # It is as if it had never been left out: both fits end within a tenth of a standard error of the optimum.
    never = analysed(campaign)
    apart = np.abs(after.fit.values / never.fit.values - 1)
    assert apart.max() < 1e-3


def test_a_drop_of_a_heavier_car_stays_left_out() -> None:
    campaign = recorded(is_sound=False)
    name = campaign.drops[-1].recording.name
    before = left_out(analysed(campaign, [name]), name, ())
    after = take_back_corrections(before, silent)
    assert after.corrected == before.corrected
    assert after.decays == before.decays
    assert after.trace == before.trace


def test_what_was_isolated_beside_the_same_model_is_not_asked_again() -> None:
    campaign = recorded(is_sound=True)
    name = campaign.drops[-1].recording.name
    before = left_out(analysed(campaign, [name]), name, ("zener",))
    assert take_back_corrections(before, silent) is before


@pytest.mark.parametrize("twice", [True, False], ids=["made up for by another", "needed"])
def test_corrections_that_make_up_for_each_other_go_together(twice: bool) -> None:
    """A sound channel was corrected one way, and beside the whole model back again."""
    campaign = recorded(is_sound=True)
    run = analysed(campaign)
    base = CandidateFit.of(run.model.structure.with_terms(()), run.decays, run.fit)

    def scaling(factor: float) -> Hypothesis:
        fault = Fault("gain", campaign.sensors[4].channel, f"reads {factor:g} times", "Check it.")
        return Hypothesis(fault, "corrected", scale_channel(4, factor), base.table, base)

    wrong = [scaling(SHIFTED), scaling(1 / SHIFTED)] if twice else [scaling(SHIFTED)]
    stated = campaign if twice else scale_channel(4, 1 / SHIFTED).of_campaign(campaign)
    corrected = replace(run, corrected=tuple(wrong), preprocessed=stated)
    after = take_back_corrections(corrected, silent)
    assert after.corrected == (() if twice else tuple(wrong))


def test_a_wrong_statement_stays_corrected() -> None:
    campaign = recorded(is_sound=True)
    run = analysed(campaign)
    base = CandidateFit.of(run.model.structure.with_terms(()), run.decays, run.fit)
    fault = Fault("known", "vehicle.wheelbase", "is contradicted", "Measure it again.")
    right = Correction(description=lambda stated: replace(stated, wheelbase=campaign.wheelbase))
    wrong = replace(campaign, wheelbase=KnownValue(0.96 * TABLE_1_CAR.wheelbase, 0.0))
    corrected = (Hypothesis(fault, "corrected", right, base.table, base),)
    after = take_back_corrections(replace(run, corrected=corrected, preprocessed=wrong), silent)
    assert after.corrected == corrected
    assert after.campaign is campaign

"""Recordings of two vehicles are divided between them, and none of one vehicle is, whatever it has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import pytest
from real_campaigns import record
from real_kinds import RealTest, draw_test

import sprung
from sprung.analysis import analyse
from sprung.analysis.analysis import AnalysisOptions
from sprung.campaign import Campaign
from sprung.estimation import fit_linear
from sprung.preprocess import prepare
from sprung.selection import ModelSearch, choose_structure, divide_drops
from sprung.vehicle import TABLE_1_CAR, Vehicle

STIFFER = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"k_sf": 21_000.0, "k_tr": 165_000.0})
BALLAST = {"name": "ballast", "items": [{"mass": 150.0, "position": [-1.8, 0.2, 0.6]}]}
WAYS = (("fl", "fr"), ("rl", "rr"), ("fl", "rl"), ("fr", "rr"), ("fl", "fr", "rl", "rr"))
DROPS = [{"wheels": wheels, "load": load} for load in ("empty", "ballast") for wheels in WAYS]
REAL = (("air", 0), ("air", 7), ("knee", 4), ("tyre", 2), ("usual", 3), ("twist", 0))
"""Kinds of cars and their numbers."""


def simulated(vehicle: Vehicle, seed: int) -> Campaign:
    known = {"m_s": TABLE_1_CAR.m_s}
    return sprung.simulate(vehicle, loads=[BALLAST], drops=DROPS, seed=seed, known=known, rate=250.0, noise=0.02)


def mixed(of_other: Sequence[int]) -> tuple[Campaign, tuple[str, ...]]:
    """Return a campaign of which some recordings are of another vehicle, and the names of these."""
    own, others = simulated(TABLE_1_CAR, 1), simulated(STIFFER, 2)
    recordings = [
        other if i in of_other else one
        for i, (one, other) in enumerate(zip(own.recordings, others.recordings, strict=True))
    ]
    return own.with_recordings(recordings), tuple(own.recordings[i].name for i in of_other)


def linear(campaign: Campaign) -> ModelSearch:
    """Fit the plain vehicle to the decays of all drops."""
    structure, decays = choose_structure(campaign, "shared", ()), prepare(campaign).decays
    fit = fit_linear(decays, structure.linear_models, structure.sensors, structure.known)
    return ModelSearch(structure, fit, decays)


@cache
def real_campaigns() -> list[Campaign]:
    """Return campaigns of cars that the plain model does not describe, recorded at once, which saves time."""
    return [campaign for campaign, _ in record([draw_test(kind, seed) for kind, seed in REAL])]


@pytest.mark.parametrize("of_other", [(5, 6, 7, 8, 9), (1, 3, 5, 7, 9), (0, 2, 3, 6, 7, 8), (2, 4, 9)])
def test_drops_are_divided_as_they_were_mixed(of_other: tuple[int, ...]) -> None:
    """But by loads: springs whose rates follow the load do the same."""
    campaign, names = mixed(of_other)
    groups = divide_drops(linear(campaign))
    by_load = of_other == (5, 6, 7, 8, 9)
    assert (groups is None) == by_load
    assert by_load or {*names} in map(set, groups or ())


def test_single_mishaps_are_no_vehicle() -> None:
    campaign, _ = mixed((2, 7))
    assert divide_drops(linear(campaign)) is None


@pytest.mark.parametrize("number", range(len(REAL)))
@pytest.mark.slow
def test_what_a_model_lacks_divides_nothing(number: int) -> None:
    """Levelled air springs are others with each load; a knee shows more in some drops than in others."""
    assert divide_drops(linear(real_campaigns()[number])) is None


@pytest.mark.slow
def test_recordings_of_two_vehicles_are_rejected_and_told_apart() -> None:
    campaign, names = mixed((1, 3, 5, 7, 9))
    run = analyse(campaign, AnalysisOptions())
    result = run.result
    assert result is not None
    assert result.verdict.state == "reject"
    (reason,) = result.verdict.reasons
    assert reason.startswith("one vehicle explains ")
    (fault,) = result.faults
    assert (fault.code, fault.where) == ("unlike-repeats", ", ".join(names))
    assert result.fit.model == ()
    # What no model explains is no reason to try any.
    assert [step.what for step in run.trace].count("no term is tried") == 3


@pytest.mark.slow
def test_a_requested_model_is_fitted_all_the_same() -> None:
    campaign, _ = mixed((1, 3, 5, 7, 9))
    result = sprung.identify(campaign, extras=["anti-roll"])
    assert (result.verdict.state, result.fit.model) == ("reject", ("anti-roll",))


def of_two(kind: str, seed: int) -> RealTest:
    """Return a test of which every second drop is of another car of the same kind and type."""
    test = draw_test(kind, seed)
    others = (draw_test(kind, other).car for other in range(seed + 1000, seed + 1100))
    return replace(test, other=next(car for car in others if car.name == test.car.name))


@pytest.mark.slow
def test_two_vehicles_with_every_usual_term_are_told_apart() -> None:
    """Each has a law of its own for dampers and tyres: there was no result after 400 s."""
    ((campaign, _),) = record([of_two("usual", 1)])
    result = sprung.identify(campaign)
    (fault,) = result.faults
    every_second = ", ".join(one.name for one in campaign.recordings[1::2])
    assert (result.verdict.state, fault.code, fault.where) == ("reject", "unlike-repeats", every_second)

"""The table of model terms: complete, and consistent with the vehicle's parameters."""

from __future__ import annotations

import numpy as np
import pytest

from sprung.selection import SEPARATE_TRACKS, TERMS, ModelTerm, choose_structure
from sprung.selection.starts import neutral_values, start_values
from sprung.selection.structure import SEAT_LOAD
from sprung.simulation import simulate
from sprung.vehicle import EXTRAS, LINEAR_EXTRAS, PARAMETERS, REFINED, TABLE_1_CAR, Tracks

ROWS = pytest.mark.parametrize("term", TERMS.values(), ids=TERMS)


def test_every_term_of_the_vehicle_has_a_row() -> None:
    assert set(TERMS) == {*EXTRAS, SEPARATE_TRACKS}
    assert {name for name, term in TERMS.items() if term.is_linear} == {*LINEAR_EXTRAS, SEPARATE_TRACKS}


@ROWS
@pytest.mark.parametrize("tracks", ["shared", "separate"])
def test_a_term_that_is_absent_has_no_size_and_one_that_begins_has_what_its_fit_needs(
    term: ModelTerm, tracks: Tracks
) -> None:
    """At neutral values there is next to no effect; of an engine without mass the place would be undefined."""
    if term.name == SEPARATE_TRACKS:
        tracks = "separate"
    people = {"name": "people", "items": [{"mass": 75.0, "position": (-1.0, 0.0, 0.6), "on": "seat"}]}
    loads = [people] if term.name == SEAT_LOAD else []
    campaign = simulate(TABLE_1_CAR, loads=loads, rate=250.0, noise=0.02, seed=1)
    refined = REFINED.get(term.refines, "")
    terms = () if term.name == SEPARATE_TRACKS else tuple(name for name in (refined, term.refines, term.name) if name)
    structure = choose_structure(campaign, tracks, terms)
    values = neutral_values(structure, TABLE_1_CAR.parameters)
    assert tuple(values) == structure.names
    assert abs(term.size(values)) < 0.2 * term.negligible
    for name, other in term.neutral(tracks):
        expected = values[other] if isinstance(other, str) else other
        if np.isinf(expected):
            assert values[name] > 1e3 * start_values(structure, TABLE_1_CAR.parameters)[name]
        else:
            scale = 2e-3 * TABLE_1_CAR.k_sf if PARAMETERS[name].unit == "N/m" else 2e-2
            assert values[name] == pytest.approx(expected, abs=scale)
    assert set(term.parameters(tracks)) <= set(structure.names)
    first = start_values(structure, TABLE_1_CAR.parameters)
    assert np.isfinite(list(first.values())).all()
    if term.name in ("friction", "engine"):
        assert abs(term.size(first)) == pytest.approx(term.typical, rel=1e-9)


@ROWS
def test_sizes_are_ordered_and_the_usual_one_is_the_most_plausible(term: ModelTerm) -> None:
    """One spread away is one standard deviation of the logarithm; what is negligible is no less plausible below that."""
    assert 0 < term.negligible < term.typical
    assert term.implausibility(term.typical) == 0
    assert term.implausibility(term.typical * term.spread) == pytest.approx(1)
    assert term.implausibility(-term.typical / term.spread**2) == pytest.approx(4)
    assert term.implausibility(0.0) == term.implausibility(term.negligible)


def test_what_physics_forbids_to_be_negative() -> None:
    """A friction that drives is none; a difference between left and right may have either sign."""
    assert TERMS["friction"].not_negative("shared") == ("F_f", "F_r")
    assert TERMS["anti-roll"].not_negative("shared") == ("k_af", "k_ar")
    assert TERMS["asymmetry"].not_negative("shared") == ()
    assert TERMS[SEPARATE_TRACKS].not_negative("separate") == ()


def test_what_most_vehicles_have_beside_a_term_is_there_with_it() -> None:
    """A mount and a tyre that stiffens have damping; tyres as such may hide theirs."""
    assert TERMS["mount-damping"].is_usual_beside(("zener", "damper-mount"))
    assert TERMS["tyre-damping"].is_usual_beside(("tyre-curve",))
    assert not TERMS["tyre-damping"].is_usual_beside(())
    assert not TERMS["tyre-damping"].is_usual_beside(("damper-mount",))
    assert not TERMS["second-knee"].is_usual_beside(("damper-curve",))


def test_what_takes_the_place_of_a_term_is_never_that_term_again() -> None:
    """A search that follows counterparts comes to an end."""
    for name in TERMS:
        followed = [name]
        while counterpart := TERMS[followed[-1]].counterpart:
            assert counterpart not in followed
            followed.append(counterpart)

"""Contact in the search for the model: models whose decays begin at different samples are compared on the same ones."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sprung.estimation import fit_linear
from sprung.preprocess import prepare
from sprung.selection import SEPARATE_TRACKS, ModelSearch, choose_structure
from sprung.selection.contact import begin_no_later, from_contact, is_likelier
from sprung.selection.stepwise import accept_likeliest
from sprung.simulation import simulate
from sprung.uncertainty import KnownValue
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Vehicle


@pytest.fixture(scope="module")
def plain() -> ModelSearch:
    barred = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"k_af": 400.0, "k_ar": 400.0})
    drops = [{"wheels": wheels} for wheels in (("fl", "fr"), ("fl", "rl"))]
    campaign = simulate(barred, drops=drops, rate=500, noise=0.02, seed=4)
    structure, decays = choose_structure(campaign, "shared", ()), prepare(campaign).decays
    return ModelSearch(
        structure, fit_linear(decays, structure.linear_models, structure.sensors, structure.known), decays
    )


@pytest.fixture(scope="module")
def with_bar(plain: ModelSearch) -> ModelSearch:
    return plain.refit(plain.with_terms(["anti-roll"]))


@pytest.mark.parametrize("late", ["plain", "with bar"])
def test_models_are_compared_from_the_later_start_on(plain: ModelSearch, with_bar: ModelSearch, late: str) -> None:
    """A likelihood grows with the samples: that of shorter decays says nothing beside that of longer ones."""

    def shortened(search: ModelSearch) -> ModelSearch:
        decays = tuple(decay.shifted(40) for decay in search.decays)
        return replace(search, decays=decays).refit(search.structure)

    one, other = (shortened(plain), with_bar) if late == "plain" else (plain, shortened(with_bar))
    assert is_likelier(other, one)
    assert not is_likelier(one, other)


def test_decays_that_a_model_let_begin_later_begin_where_the_accelerometers_show_contact(plain: ModelSearch) -> None:
    """Its own states lead back there, but for 15 samples, 30 ms, in which a filter may ring."""

    def begun(samples: int) -> ModelSearch:
        decays = (plain.decays[0].shifted(samples), plain.decays[1])
        return replace(plain, decays=decays).refit(plain.structure)

    later, expected = begun(40), begun(15)
    found = begin_no_later(later, plain.decays)
    assert [decay.start for decay in found.decays] == pytest.approx([decay.start for decay in expected.decays])
    assert found.fit.loglikelihood == pytest.approx(expected.fit.loglikelihood, abs=0.1)
    assert begin_no_later(found, plain.decays) is found


def test_a_fit_that_went_astray_is_no_better(with_bar: ModelSearch) -> None:
    """Beside a fit that leaves nothing but noise there is no misfit, of which another one might leave a part."""
    truth = TABLE_1_CAR.parameters
    known = {"k_tf": KnownValue(1.5 * truth["k_tf"]), "m_s": KnownValue(truth["m_s"])}
    astray = with_bar.refit(replace(with_bar.structure, known=known))
    assert with_bar.is_better_than(astray.fit)
    assert not with_bar.is_better_than(with_bar.fit)
    assert not astray.is_better_than(with_bar.fit)
    assert not astray.leaves_misfit(with_bar.fit, 0.1)


@pytest.mark.parametrize("first", ["gravity", SEPARATE_TRACKS])
def test_of_terms_with_scores_that_differ_little_the_likelier_is_included(first: str) -> None:
    """Gravity and separate half-distances both make a bus roll more slowly; one of them leaves a misfit."""
    wheels = (("fl", "fr", "rl", "rr"), ("fl", "rl"), ("fr", "rr"))
    campaign = simulate(SCHOOL_BUS, drops=[{"wheels": dropped} for dropped in wheels], noise=0.1, seed=1)
    structure, decays = choose_structure(campaign, None, None), prepare(campaign).decays
    fit = fit_linear(decays, structure.linear_models, structure.sensors, structure.known)
    terms = sorted(["gravity", SEPARATE_TRACKS], key=lambda term: term != first)
    search = from_contact(ModelSearch(structure, fit, decays))
    found, accepted = accept_likeliest(search, terms, dict.fromkeys(terms, (1e3, 0.5)))
    assert accepted
    assert (found.structure.terms, found.structure.tracks) == ((), "separate")
    against = {step.extra: step.against for step in found.steps if not step.taken}
    if "gravity" in against:
        assert against["gravity"] == f"{SEPARATE_TRACKS} explains more"

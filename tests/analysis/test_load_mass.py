"""A load's mass with an uncertainty: it enters the fit as the mass and its prior, and nothing else."""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

import sprung
from sprung.errors import InputError
from sprung.results import Result
from sprung.vehicle import PARAMETERS, TABLE_1_CAR, Added, Heights, Item, LinearModel, linear_elements

TRUE = 150.0  # kg
PLACE = (-1.0, 0.2, 0.5)


def load(mass: Any) -> sprung.Load:
    item: Any = {"mass": mass, "position": PLACE}
    return sprung.Load(name="bags", items=(item,))


@pytest.fixture(scope="module")
def campaign() -> sprung.Campaign:
    model = {"extras": (), "tracks": "shared", "fall": False}
    return sprung.simulate(TABLE_1_CAR, seed=3, duration=1.6, loads=[load(TRUE)], model=model)


def identified(campaign: sprung.Campaign, mass: Any, known: Any = None) -> Result:
    loads = (campaign.loads[0], load(mass))
    return sprung.identify(replace(campaign, loads=loads, known=known or {}))


def relative(result: Result, name: str) -> float:
    found = result.parameters[name]
    assert found.value
    assert found.std is not None
    return found.std / found.value


def test_where_the_load_gives_scale_relative_variances_add(campaign: sprung.Campaign) -> None:
    """error² = error₀² + (std / mass)² for what scales, nothing for lengths: the scale is the load's mass times a ratio."""
    std = 3.0
    exact, uncertain = identified(campaign, TRUE), identified(campaign, {"value": TRUE, "std": std})
    for name, found in exact.parameters.items():
        if found.status == "estimated":
            grown = relative(uncertain, name) ** 2 - relative(exact, name) ** 2
            assert grown == pytest.approx((std / TRUE) ** 2 * PARAMETERS[name].scales, rel=1e-3, abs=1e-9), name
            assert uncertain.parameters[name].value == pytest.approx(found.value, rel=1e-6)
    mass = uncertain.derived["mass of bags"]
    assert mass.value == pytest.approx(TRUE, rel=1e-6)
    assert mass.std == pytest.approx(std, rel=1e-4)
    assert "mass of bags" not in uncertain.parameters
    assert "mass of bags" not in uncertain.correlation.names


def test_a_weighing_overrules_a_load_that_is_hardly_known(campaign: sprung.Campaign) -> None:
    """Stated 20 kg too light, ± 30 kg: with the vehicle weighed exactly, the fit finds vehicle and load."""
    found = identified(campaign, {"value": TRUE - 20, "std": 30}, {"total_mass": TABLE_1_CAR.total_mass})
    assert found.verdict.state == "accept"
    for name, value in TABLE_1_CAR.parameters.items():
        assert abs((found.parameters[name].value or 0) - value) < 4.5 * (found.parameters[name].std or 1e-9), name
    mass = found.derived["mass of bags"]
    assert mass.std is not None
    assert mass.std < 1.0
    assert abs((mass.value or 0) - TRUE) < 4.5 * mass.std


def test_two_uncertain_scales_are_weighed(campaign: sprung.Campaign) -> None:
    """Load ± 2 % and weighing ± 1 % of it: the inverse variances of the scale add."""
    total = {"value": TABLE_1_CAR.total_mass, "std": 0.01 * TABLE_1_CAR.total_mass}
    exact = relative(identified(campaign, TRUE), "m_s") ** 2
    both = relative(identified(campaign, {"value": TRUE, "std": 0.02 * TRUE}, {"total_mass": total}), "m_s") ** 2
    # To the errors of the ratios m_s / total and load / total, which are common to neither.
    assert both == pytest.approx(1 / (1 / (0.02**2 + exact) + 1 / 0.01**2), rel=0.01)


def test_it_is_written_and_read_back(campaign: sprung.Campaign, tmp_path: Path) -> None:
    totals = sprung.Load(name="totals", added=Added(mass=100, mass_std=1, I_yy=3))
    several: Any = [{"mass": 20, "on": "fl"}, {"mass": {"value": 30, "std": 0.5}, "on": "fr"}]
    loads = (*campaign.loads[:1], load({"value": TRUE, "std": 0.5}), totals, sprung.Load(name="two", items=several))
    file = sprung.write(replace(campaign, loads=loads), tmp_path)
    assert sprung.read(file).loads == loads
    assert list(loads[-1].uncertain_masses) == ["mass of two, item 2"]
    document = tomllib.loads(file.read_text(encoding="utf-8"))
    assert document["load"][0]["items"][0]["mass"] == {"value": TRUE, "std": 0.5}
    assert not list(Draft202012Validator(json.loads(sprung.schema_text())).iter_errors(document))
    document["load"][0]["items"][0]["mass"]["sdt"] = 1
    assert list(Draft202012Validator(json.loads(sprung.schema_text())).iter_errors(document))


def test_masses_that_cannot_be_are_refused(campaign: sprung.Campaign, tmp_path: Path) -> None:
    bad: Any
    for bad in ({"value": -3, "std": 1}, {"value": 3, "std": -1}, {"std": 1}, {"value": 3, "sd": 1}):
        with pytest.raises(InputError, match="Item"):
            Item(mass=bad, on="fl")
    file = sprung.write(replace(campaign, loads=(campaign.loads[0], load({"value": TRUE, "std": 0.5}))), tmp_path)
    text = file.read_text(encoding="utf-8")
    for old, new, what in (("std = 0.5", "std = -0.5", "0 or more"), (f"value = {TRUE}", 'value = "3"', "number")):
        file.write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(InputError, match=r"load\[1\]\.items\[1\].*" + what):
            sprung.read(file)


def test_as_a_parameter_it_gives_the_same_matrices() -> None:
    """With and without heights: the mass as a parameter at its value, and as the number."""
    names = (*TABLE_1_CAR.parameters, "mass of bags")
    values = [*TABLE_1_CAR.parameters.values(), TRUE]
    given = load({"value": TRUE, "std": 1.0})
    for heights in (Heights(), Heights(0.55, 0.3, 0.2)):
        elements = linear_elements(heights=heights)
        as_number = LinearModel.of(elements + given.elements(heights), names[:-1]).matrices(values[:-1])
        as_parameter = LinearModel.of(elements + given.elements(heights, names), names)
        for one, other in zip(as_number, as_parameter.matrices(values), strict=True):
            assert one == pytest.approx(other, rel=1e-12, abs=1e-9)
        known = as_parameter.with_known({"mass of bags": TRUE})
        assert known.names == names[:-1]
        assert pytest.approx(as_number.M, rel=1e-12) == known.matrices(values[:-1]).M


@pytest.mark.slow
def test_a_plan_counts_the_uncertainty_of_a_planned_load() -> None:
    """Beside no scales the relative variances add, as in a fit: error² = error₀² + (std / mass)² for what scales."""
    std = 3.0
    exact, uncertain = (sprung.plan(TABLE_1_CAR, loads=[load(mass)]) for mass in (TRUE, {"value": TRUE, "std": std}))
    without, beside = ({row.label: row.bound.percents for row in plan.rows if row.bound} for plan in (exact, uncertain))
    assert list(beside["as planned"]) == list(without["as planned"])
    for name, percent in without["as planned"].items():
        grown = (beside["as planned"][name] or 0) ** 2 - (percent or 0) ** 2
        assert grown == pytest.approx((100 * std / TRUE) ** 2 * PARAMETERS[name].scales, rel=1e-3, abs=1e-6), name
    # A weighing, which is exact, leaves little of it.
    assert (beside["total mass"]["m_s"] or 0) < 0.2

"""A rejected result gives no estimates, whoever asks: every number that was one is looked for in everything that is shown."""

from __future__ import annotations

import dataclasses
import json
import re

import pytest

import sprung
from goldens import stored_result
from layouts import tables_of
from sprung.assessment import Verdict
from sprung.errors import InputError
from sprung.report import report_html, result_view, text_of
from sprung.report.terminal.result import residual_table
from sprung.results import PriorComparison, Result
from sprung.results.withholding import withhold_estimates
from sprung.tables import value_cells
from sprung.uncertainty import Estimate

REASON = "the model does not explain the records: in wheel_fl its error is 7.0 % of the signal"


@pytest.fixture(scope="module")
def sound() -> Result:
    return stored_result("accept")


@pytest.fixture(scope="module")
def rejected(sound: Result) -> Result:
    return withhold_estimates(dataclasses.replace(sound, verdict=Verdict("reject", (REASON,))))


def numbers_of(result: Result) -> set[str]:
    """What was estimated, as tables round it, and as JSON writes it; short figures may stand elsewhere by chance."""
    found = [one for one in (*result.parameters.values(), *result.derived.values()) if one.status == "estimated"]
    shown = (
        {value_cells(one)[0] for one in found} | {repr(one.value) for one in found} | {repr(one.std) for one in found}
    )
    for modes in result.modes.values():
        shown |= {repr(mode.frequency) for mode in modes} | {f"{mode.frequency:.5f}" for mode in modes}
    return {text for text in shown if len(re.sub(r"\D", "", text)) >= 4}


def test_nothing_shows_an_estimate(sound: Result, rejected: Result) -> None:
    numbers = numbers_of(sound)
    assert len(numbers) > 30
    shown = {
        "terminal": text_of(result_view(rejected)),
        "notebook": rejected._repr_html_(),
        "repr": repr(rejected),
        "report": report_html(rejected),
        "results.json": rejected.to_json(),
    }
    for where, text in shown.items():
        # Of whole numbers, not of their parts: 17000 is in 117000.
        there = {number for number in numbers if re.search(rf"(?<![\d.]){re.escape(number)}(?![\d.])", text)}
        assert there == set(), where
    for text in (shown["terminal"], shown["notebook"]):
        assert "no estimates are reported" in " ".join(text.split())
        assert REASON[:40] in " ".join(text.split())


def test_results_json_says_so_as_the_contract_has_it(rejected: Result) -> None:
    document = json.loads(rejected.to_json())
    estimates = document["parameters"].values()
    assert {one["status"] for one in estimates} <= {"known", "unidentifiable"}
    assert all(one["value"] is None and one["std"] is None for one in estimates if one["status"] == "unidentifiable")
    assert document["scale"]["per_total_mass"] == {}
    assert document["correlation"] == {"names": [], "matrix": []}
    assert all(modes == [] for modes in document["modes"].values())
    assert (document["amplitude"] or [], document["next_step"]) == ([], None)
    # Why it was rejected can still be seen.
    assert document["fit"]["noise"]
    assert document["fit"]["misfit"]
    assert document["validation"]


def test_it_is_compared_and_drawn_without(sound: Result, rejected: Result) -> None:
    found = sprung.compare([sound, rejected], names=["one", "other"])
    assert all(row.values[1].value is None for rows in (found.parameters, found.modes) for row in rows.values())
    for draw in (sprung.plot.correlation, sprung.plot.amplitude):
        with pytest.raises(InputError):
            draw(rejected)
    with pytest.raises(InputError):
        _ = rejected.vehicle


def test_a_result_that_is_not_rejected_stays_as_it_is(sound: Result) -> None:
    assert withhold_estimates(sound) is sound


def test_its_reasons_say_nothing_that_only_the_rejected_fit_says() -> None:
    """How well a fit determines its parameters is no reason where the fit itself does not hold."""
    reasons = " ".join(stored_result("reject").verdict.reasons)
    assert "does not explain the records" in reasons
    assert "determine" not in reasons
    assert "only known" not in reasons


@pytest.mark.slow
def test_what_was_known_is_not_compared_with_a_model_that_does_not_hold(sound: Result) -> None:
    """Neither an uncertain quantity, whose estimate is withheld, nor an exact one."""
    uncertain, exact = (
        PriorComparison(2.7, std, "m", Estimate(2.7, 0.1, None, "m", "estimated"), 1.65) for std in (0.1, 0.0)
    )
    known = {"total_mass": uncertain, "wheelbase": exact}
    compared = dataclasses.replace(sound, setup=dataclasses.replace(sound.setup, known=known))
    fixed = "Difference of a fixed quantity"
    assert report_html(compared).count("1.6 standard uncertainties") + report_html(compared).count("1.7 standard") == 2
    assert fixed in report_html(compared)
    refused = withhold_estimates(dataclasses.replace(compared, verdict=Verdict("reject", (REASON,))))
    assert [prior.missed for prior in refused.setup.known.values()] == [None, None]
    page = report_html(refused)
    assert "standard uncertainties</td>" not in page
    assert fixed not in page


def test_where_nothing_is_modelled_no_error_of_it_is_given(rejected: Result) -> None:
    """Noise has no signal: the residual is all that was recorded, and the model error is not zero."""
    noise = dict.fromkeys(rejected.fit.misfit, 0.0)
    fit = dataclasses.replace(rejected.fit, misfit=noise)
    drops = {name: dataclasses.replace(one, fitted=0.999) for name, one in rejected.validation.items()}
    cells = {
        part: {row[1] for row in next(tables_of(residual_table(shown))).rows}
        for part, shown in (
            ("noise", dataclasses.replace(rejected, fit=fit, validation=drops)),
            ("modelled", dataclasses.replace(rejected, fit=fit)),
        )
    }
    assert cells == {"noise": {"-"}, "modelled": {"0.0"}}

"""The results that displays are made from are those that the program gives of campaigns in the repository."""

from __future__ import annotations

import copy
import json

import pytest

import sprung
from goldens import RESULTS, STORED, differences

VERDICTS = {"accept": "accept", "doubtful": "doubtful", "reject": "reject", "unidentifiable": "doubtful"}


@pytest.fixture(scope="module", params=RESULTS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def made(name: str) -> sprung.Result:
    return RESULTS[name]()


@pytest.mark.slow
def test_a_stored_result_is_what_the_program_makes(name: str, made: sprung.Result) -> None:
    """If this fails, `pytest tests/report --regenerate` makes results and displays anew: read what changed."""
    stored = json.loads((STORED / f"{name}.json").read_text(encoding="utf-8"))
    assert list(differences(stored, json.loads(made.to_json()))) == []


@pytest.mark.slow
def test_it_has_the_verdict_that_it_is_stored_for(name: str, made: sprung.Result) -> None:
    assert made.verdict.state == VERDICTS[name]


def test_a_result_that_no_longer_matches_is_noticed() -> None:
    stored = json.loads((STORED / "accept.json").read_text(encoding="utf-8"))
    made = copy.deepcopy(stored)
    made["parameters"]["k_sf"]["value"] += 0.2 * made["parameters"]["k_sf"]["std"]
    made["parameters"]["k_sr"]["value"] += 0.01 * made["parameters"]["k_sr"]["std"]
    made["modes"]["empty"][0]["damping_ratio"] += 0.2 * made["modes"]["empty"][0]["damping_ratio_std"]
    made["verdict"]["state"] = "doubtful"
    made["fit"]["iterations"] += 5
    made["verdict"]["reasons"][0] = made["verdict"]["reasons"][0].replace("0.1 %", "0.2 %")
    made["drops"][0]["colour"] = "red"
    del made["fit"]["since"]
    found = [one.partition(":")[0] for one in differences(stored, made)]
    assert found == [
        *("result.drops[0]", "result.fit", "result.modes.empty[0].damping_ratio"),
        *("result.parameters.k_sf.value", "result.verdict.state"),
    ]

"""One fault takes few fits: what a score excludes is not fitted, nor what a fit tells of its neighbours."""

from __future__ import annotations

from functools import cache
from zlib import crc32

import numpy as np
import pytest
from fleet import FLEET
from outcomes import INJURIES, names_all

from sprung.analysis import Analysis, identify_campaign

SEED = 5
ONE_FAULT = [
    ("low-pass", 1),  # of an AC-coupled sensor: what rings before the release was a drift
    ("low-pass", 2),  # terms were tried that explain half of what it leaves
    ("low-pass", 4),  # the later part of a decay does not tell it from a delay
    ("clipped, body", 3),  # the decays start so late that the half-distances of the axles are needed
]


@cache
def analysed(name: str, number: int) -> tuple[Analysis, tuple[str, ...]]:
    """Analyse a campaign with one fault; and the channels that are at fault."""
    test, injury = FLEET[number], INJURIES[name]
    campaign = test.campaign(SEED)
    injured = injury.act(test, campaign, np.random.default_rng([number, SEED, crc32(name.encode())]))
    assert injured is not None
    return identify_campaign(injured.campaign), injured.names


@pytest.mark.long
@pytest.mark.parametrize(("name", "number"), ONE_FAULT)
def test_one_fault_takes_few_fits(name: str, number: int) -> None:
    run, names = analysed(name, number)
    assert run.fits <= 8
    assert run.preparations <= 3
    assert run.result is not None
    assert all(fault.code in INJURIES[name].codes and names_all(fault, names) for fault in run.result.faults)
    assert run.result.verdict.state == "accept"


@pytest.mark.parametrize("number", [pytest.param(2, marks=pytest.mark.long), 4])
@pytest.mark.slow
def test_a_low_pass_is_no_delay(number: int) -> None:
    """Shortly after the landing, when the wheels hop, the two differ by far more than by chance."""
    run, (channel,) = analysed("low-pass", number)
    assert run.result is not None
    (fault,) = run.result.faults
    assert (fault.code, fault.where) == ("low-pass", channel)

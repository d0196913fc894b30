"""Channels upside down or in another unit, told by gravity at rest, against the same campaign without the mistake."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sprung
from sprung.prepare import prepare
from sprung.vehicle import TABLE_1_CAR

CLEAN = sprung.simulate(TABLE_1_CAR, noise=0.02, seed=4, known={"total_mass": TABLE_1_CAR.total_mass})


def changed(factors: dict[int, float], offset: float = 0.0) -> sprung.Campaign:
    factor = np.ones(8)
    factor[list(factors)] = list(factors.values())
    recordings = [replace(one, values=(one.values + offset) * factor[:, None]) for one in CLEAN.recordings]
    return replace(CLEAN, recordings=tuple(recordings))


@pytest.mark.parametrize(
    ("factors", "codes"),
    [
        ({5: -1.0}, {"sign"}),
        ({0: 1 / 9.80665}, {"unit"}),
        ({7: 1000.0}, {"unit"}),
        ({1: -1.0, 4: 1 / 9.80665, 6: 1000.0}, {"sign", "unit"}),
    ],
)
def test_they_are_put_right_and_named(factors: dict[int, float], codes: set[str]) -> None:
    result, clean = sprung.identify(changed(factors)), sprung.identify(CLEAN)
    assert {fault.code for fault in result.faults} == codes
    assert {fault.where for fault in result.faults} == {CLEAN.sensors[channel].channel for channel in factors}
    assert result.verdict.state == "accept"
    for name, one in clean.parameters.items():
        assert one.value is not None
        assert result.parameters[name].value == pytest.approx(one.value, rel=1e-4)


def test_nothing_is_changed_without_need() -> None:
    for campaign in (CLEAN, changed({}, offset=0.4)):
        assert all(decay.faults == () for decay in prepare(campaign).decays)
    # AC-coupled sensors read nothing at rest: they tell nothing of sign or unit.
    assert all(decay.faults == () for decay in prepare(changed({}, offset=-9.80665)).decays)


def test_where_all_are_upside_down_nobody_can_say_which() -> None:
    """It would be the frame, not one sensor: the fit sees the same motion either way, and nothing is changed."""
    upside_down = prepare(changed(dict.fromkeys(range(8), -1.0)))
    assert all(fault.code != "sign" for decay in upside_down.decays for fault in decay.faults)

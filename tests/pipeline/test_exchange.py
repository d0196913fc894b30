"""Two channels exchanged, against the same campaign as it should have been."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sprung
from sprung.vehicle import TABLE_1_CAR

CLEAN = sprung.simulate(TABLE_1_CAR, noise=0.02, seed=6, known={"total_mass": TABLE_1_CAR.total_mass})


@pytest.mark.parametrize("pair", [(0, 1), (0, 3), (4, 5), (5, 6), (2, 7)])
def test_they_are_changed_about_and_named(pair: tuple[int, int]) -> None:
    order = np.arange(8)
    order[list(pair)] = pair[::-1]
    recordings = tuple(replace(one, values=one.values[order]) for one in CLEAN.recordings)
    result, clean = sprung.identify(replace(CLEAN, recordings=recordings)), sprung.identify(CLEAN)
    (fault,) = result.faults
    assert fault.code == "exchanged"
    assert fault.where == ", ".join(CLEAN.sensors[channel].channel for channel in pair)
    assert result.verdict.state == "accept"
    for name, one in clean.parameters.items():
        found = result.parameters[name]
        assert one.value is not None
        assert one.std is not None
        assert found.value == pytest.approx(one.value, abs=one.std)


def test_nothing_is_changed_where_it_explains_nothing() -> None:
    """One channel holds something else altogether: no exchange makes sense of it, and the verdict says so."""
    noise = np.random.default_rng(1)
    recordings = []
    for one in CLEAN.recordings:
        values = one.values.copy()
        values[3] = 9.8 + 0.1 * np.cumsum(noise.standard_normal(values.shape[1]))
        recordings.append(replace(one, values=values))
    result = sprung.identify(replace(CLEAN, recordings=tuple(recordings)))
    assert "exchanged" not in {fault.code for fault in result.faults}
    assert result.verdict.state != "accept"

"""Repeated drops: each is told from the others, however many files recorded it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sprung
from sprung.campaign import Campaign, Recording, merge_loggers
from sprung.vehicle import TABLE_1_CAR, WHEELS


def by_two_loggers(campaign: Campaign) -> Campaign:
    """Return a campaign as if one logger had recorded the wheels and one the body."""
    drops = []
    for drop in campaign.drops:
        one = drop.recording
        parts = tuple(
            Recording(
                f"{drop.label}_{logger}.csv",
                tuple(one.channels[i] for i in own),
                one.values[own],
                one.start,
                one.rate,
            )
            for logger, own in (
                ("body", [i for i, sensor in enumerate(campaign.sensors) if sensor.on == "body"]),
                ("wheels", [i for i, sensor in enumerate(campaign.sensors) if sensor.on != "body"]),
            )
        )
        whole = Recording(f"{drop.label}*", one.channels, np.empty((len(one.channels), 0)), 0.0, 1.0, parts=parts)
        recording = merge_loggers(whole, [part.start for part in parts])
        drops.append(replace(drop, file=None, files=tuple(part.name for part in parts), recording=recording))
    return replace(campaign, drops=tuple(drops))


@pytest.mark.slow
def test_repeats_by_several_loggers_each_have_their_series(tmp_path: Path) -> None:
    twice = [{"wheels": wheels, "height": 0.05} for wheels in (WHEELS, WHEELS, ("fl", "fr"), ("fl", "rl"))]
    simulated = sprung.simulate(TABLE_1_CAR, drops=twice, rate=200, noise=0.02, seed=3, known={"total_mass": 1551.8})
    campaign = sprung.read(sprung.write(by_two_loggers(simulated), tmp_path))
    result = sprung.identify(campaign)
    assert sorted(result.series) == ["empty_bounce", "empty_bounce_2", "empty_pitch_front", "empty_roll_left"]
    one, other = result.series["empty_bounce"], result.series["empty_bounce_2"]
    samples = min(one.measured.shape[1], other.measured.shape[1])
    assert np.abs(one.measured[:, :samples] - other.measured[:, :samples]).max() > 0
    result.save(tmp_path / "results")
    assert sorted(sprung.load(tmp_path / "results").series) == sorted(result.series)

"""Drops and their recordings, put together in memory."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import sprung
from sprung.campaign import Recording
from sprung.errors import InputError

CHANNELS = ("fl", "fr", "rl")
SENSORS: Any = [{"channel": name, "on": name} for name in CHANNELS]


def recording(name: str) -> Recording:
    return Recording(name, CHANNELS, np.zeros((3, 5)), start=0.0, rate=500.0)


def test_a_campaign_is_made_of_drops_with_their_recordings() -> None:
    front = sprung.Drop(name="front", wheels=("fl", "fr")).with_recording(recording("one"))
    by_keys: Any = {"wheels": ("rl", "rr"), "recording": recording("two")}
    campaign = sprung.Campaign(name="car", sensors=SENSORS, drops=(front, by_keys))
    assert [(drop.kind, drop.recording.name) for drop in campaign.drops] == [
        ("pitch front", "one"),
        ("pitch rear", "two"),
    ]
    assert campaign.recordings == tuple(drop.recording for drop in campaign.drops)
    assert front == replace(front, recording=recording("another")) != replace(front, height=0.05)


def test_a_drop_without_a_recording_is_refused() -> None:
    without: Any = (sprung.Drop(name="front"),)
    with pytest.raises(InputError, match=r"drop front: found no recording.*with_recording"):
        sprung.Campaign(name="car", sensors=SENSORS, drops=without)


def test_every_drop_needs_one_recording() -> None:
    campaign = sprung.Campaign(name="car", sensors=SENSORS, drops=(sprung.DropTest(recording=recording("one")),))
    assert campaign.with_recordings([recording("two")]).drops[0].recording.name == "two"
    with pytest.raises(ValueError, match="zip"):
        campaign.with_recordings([])

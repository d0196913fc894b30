"""Drawings of the recordings: what is drawn is what was measured, where it was, and stays small."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import sprung
from sprung.campaign import Campaign
from sprung.checking import Check
from sprung.report import (
    Band,
    Curve,
    Panel,
    Picture,
    Points,
    Rule,
    draw_check,
    landing_picture,
    recording_picture,
    write_check,
)
from sprung.report.pictures.lanes import thin_out
from sprung.vehicle import TABLE_1_CAR

M = TypeVar("M", Band, Curve, Points, Rule)


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    """One drop, with a wheel that clips when it lands and a body channel that is flat."""
    made = sprung.simulate(TABLE_1_CAR, drops=[{"wheels": ["fl", "rl"], "load": "empty"}], noise=0.02, seed=1)
    values = made.recordings[0].values.copy()
    values[4] = values[4].clip(-25, 25)
    values[0] = 9.81
    return made.with_recordings((replace(made.recordings[0], values=values),))


@pytest.fixture(scope="module")
def check(campaign: Campaign) -> Check:
    return sprung.check(campaign)


def texts(svg: str) -> list[str]:
    return ["".join(node.itertext()) for node in ET.fromstring(svg).iter() if node.tag.endswith("}text")]  # noqa: S314


def test_words(check: Check) -> None:
    [(name, svg)] = draw_check(check).items()
    drop = check.drops[0]
    said = texts(svg)
    assert name == "empty_roll_left.svg"
    assert "empty_roll_left.csv" in said
    assert "roll left (fl, rl), load empty, 500 Hz" in said
    assert "release 0.400 s" in said
    assert f"landing {drop.landing:.3f} s" in said
    assert f"decay from {drop.start:.3f} s" in said
    assert f"free decay from {drop.start:.3f} s ({drop.why_start})" in said
    assert f"to {drop.end:.3f} s (the recording ends)" in said
    assert all(channel.name in said for channel in drop.channels)
    assert "left out: flat" in said
    assert f"clipped: {check.recorded[0].marks[0].samples.size}" in said


def pictures(check: Check) -> tuple[Picture, Picture]:
    drop, recorded = check.drops[0], check.recorded[0]
    close = landing_picture(drop, recorded)
    assert close is not None
    return recording_picture(drop, recorded), close


def marks(panel: Panel, kind: type[M]) -> list[M]:
    return [mark for mark in panel.marks if isinstance(mark, kind)]


def test_signals(check: Check) -> None:
    """Each lane holds its channel, the first on top, at a scale that it shares with its like."""
    whole, _ = pictures(check)
    recorded = check.recorded[0]
    assert [panel.name for panel in whole.panels] == [channel.name for channel in check.drops[0].channels]
    for panel, values in zip(whole.panels, recorded.values.astype(float), strict=True):
        [curve] = marks(panel, Curve)
        np.testing.assert_array_equal(curve.y, values)
        np.testing.assert_allclose(curve.x, recorded.time)
        inside = panel.y.at(curve.y)
        assert 0 <= inside.min() <= inside.max() <= 1  # no signal leaves its lane
        assert all(0 <= panel.y.at(np.array(value)) <= 1 for value, _ in panel.y.ticks)
    roles = [marks(panel, Curve)[0].role for panel in whole.panels]
    assert roles == ["unused", *["signal"] * 7]  # the channel left out
    spans = [panel.y.high - panel.y.low for panel in whole.panels]
    assert len({round(span, 9) for span in spans[1:4]}) == 1
    assert len({round(span, 9) for span in spans[4:]}) == 1


def test_events_and_marks_are_where_they_were(check: Check) -> None:
    drop, recorded = check.drops[0], check.recorded[0]
    for picture in pictures(check):
        for panel in picture.panels:
            [band] = marks(panel, Band)
            assert (band.low, band.high) == (drop.start, drop.end)
            assert [rule.at for rule in marks(panel, Rule)] == [drop.release, drop.landing, drop.start]
        marked = np.concatenate([points.x for panel in picture.panels for points in marks(panel, Points)])
        np.testing.assert_allclose(marked, recorded.time[recorded.marks[0].samples])


def test_the_same_recordings_give_the_same_drawing(campaign: Campaign, check: Check) -> None:
    assert draw_check(check) == draw_check(sprung.check(campaign))


def test_a_drop_left_out_and_one_without_release(campaign: Campaign) -> None:
    recording = campaign.recordings[0]
    short = sprung.check(campaign.with_recordings((replace(recording, values=recording.values[:, :300]),)))
    assert any(text.startswith("left out: ") and "no-decay" in text for text in texts(*draw_check(short).values()))
    late = sprung.check(campaign.with_recordings((replace(recording, values=recording.values[:, 230:]),)))
    said = texts(*draw_check(late).values())
    assert not any(text.startswith("release") for text in said)
    assert any("no release was found" in text for text in said)


def test_wheels_that_fell_otherwise_are_told(campaign: Campaign) -> None:
    stated = replace(campaign.drops[0], wheels=("fr", "rr"))
    said = texts(*draw_check(sprung.check(replace(campaign, drops=(stated,)))).values())
    assert "wheels detected at the release: fl, rl" in said


@pytest.mark.slow
def test_long_recordings_stay_small(campaign: Campaign) -> None:
    recording = campaign.recordings[0]
    random = np.random.default_rng(1)
    rest = recording.values[:, -1:] + random.normal(0, 0.02, (8, 400_000))
    long = campaign.with_recordings((replace(recording, values=np.hstack([recording.values, rest])),))
    [svg] = draw_check(sprung.check(long)).values()
    assert len(svg) < 700_000


signals = st.lists(st.floats(-1e6, 1e6) | st.just(float("nan")), min_size=1, max_size=400)


@settings(max_examples=200, deadline=None)
@given(signals, st.integers(1, 20))
def test_thinning_keeps_what_can_be_seen(signal: list[float], bins: int) -> None:
    values = np.array(signal)
    kept = thin_out(values, bins)
    assert np.all(np.diff(kept) > 0)
    if np.isnan(values).all():
        assert kept.size == 0
        return
    assert kept.size <= max(4 * bins, 2 * bins + 2)
    assert (kept[0], kept[-1]) == (0, values.size - 1)
    for stretch in stretches(values.size, bins):
        part, shown = values[stretch], values[np.intersect1d(stretch, kept)]
        if np.isfinite(part).any():
            assert (np.nanmin(shown), np.nanmax(shown)) == (np.nanmin(part), np.nanmax(part))


def stretches(size: int, bins: int) -> Iterator[NDArray[np.int64]]:
    if size > 4 * bins:
        edges = np.linspace(0, size, bins + 1).astype(np.int64).tolist()
        yield from (np.arange(begin, end) for begin, end in pairwise(edges))


NAMES = [
    "a.csv",
    "A.csv",
    "sub/a.csv",
    "sub_a.csv",
    "a.mat",
    ".hidden",
    "x$y$z <&> \x07 試験.csv",
    "../up.csv",
    "b c*.csv",
]


def test_names_of_every_kind(check: Check, tmp_path: Path) -> None:
    drops = tuple(replace(check.drops[0], file=name, load="<&>$x$") for name in NAMES)
    count = len(NAMES)
    many = Check(drops, (), check.recorded * count)
    written = write_check(many, tmp_path / "check", page=False, drawings=True)
    assert len({path.name.lower() for path in written}) == len(NAMES)
    assert all(path.parent == tmp_path / "check" for path in written)
    for path, name in zip(written, NAMES, strict=True):
        assert not set(path.name) & set('\\/:*?"<>| ')
        assert name.replace("\x07", "\N{REPLACEMENT CHARACTER}") in texts(path.read_text(encoding="utf-8"))


def test_names_of_channels(campaign: Campaign) -> None:
    odd = ("$a$", '<b> & "c"', "d" * 200, *campaign.recordings[0].channels[3:])
    sensors = tuple(replace(sensor, channel=name) for sensor, name in zip(campaign.sensors, odd, strict=True))
    renamed = replace(campaign.with_recordings((replace(campaign.recordings[0], channels=odd),)), sensors=sensors)
    said = texts(*draw_check(sprung.check(renamed)).values())
    assert {"$a$", '<b> & "c"'} <= set(said)
    assert any(text.startswith("ddd") and text.endswith("…") for text in said)

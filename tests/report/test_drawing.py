"""Drawings of the recordings: what is drawn is what was measured, where it was, and stays small."""

from __future__ import annotations

import subprocess
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

import sprung
from sprung.errors import InputError
from sprung.pipeline import Check
from sprung.recording import Campaign
from sprung.report import draw_check, drawing, write_check
from sprung.report.figure import figure_of
from sprung.report.lanes import thinned
from sprung.vehicle import TABLE_1_CAR


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    """One drop, with a wheel that clips when it lands and a body channel that is flat."""
    made = sprung.simulate(TABLE_1_CAR, drops=[{"wheels": ["fl", "rl"], "load": "empty"}], noise=0.02, seed=1)
    values = made.recordings[0].values.copy()
    values[4] = values[4].clip(-25, 25)
    values[0] = 9.81
    return replace(made, recordings=(replace(made.recordings[0], values=values),))


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
    assert "roll left (fl, rl), load empty, 500 samples per second" in said
    assert "release 0.400 s" in said
    assert f"landing {drop.landing:.3f} s" in said
    assert f"decay from {drop.start:.3f} s" in said
    assert f"decay from {drop.start:.3f} s: {drop.why_start}" in said
    assert f"to {drop.end:.3f} s: the recording ends" in said
    assert all(channel.name in said for channel in drop.channels)
    assert "left out: flat" in said
    assert f"clipped: {check.recorded[0].marks[0].samples.size}" in said


def panels(check: Check) -> tuple[Axes, Axes]:
    whole, close = figure_of(check.drops[0], check.recorded[0]).axes
    return whole, close


def test_signals(check: Check) -> None:
    """Each lane holds its channel, the first on top, with what its ticks say."""
    whole, _ = panels(check)
    recording = check.recorded[0]
    signals = [line for line in whole.lines if len(np.asarray(line.get_xdata())) == recording.values.shape[1]]
    assert len(signals) == len(check.drops[0].channels)
    low, *_, high = list(zip(whole.get_yticks(), whole.get_yticklabels(), strict=True))[-3:]  # of the lowest lane
    bottom, top = (float(label.get_text().replace("\N{MINUS SIGN}", "-")) for _, label in (low, high))
    drawn = (np.asarray(signals[-1].get_ydata(), dtype=float) - low[0]) / (high[0] - low[0]) * (top - bottom) + bottom
    np.testing.assert_allclose(drawn, recording.values[-1], atol=1e-9)
    for number, line in enumerate(signals):
        inside = np.asarray(line.get_ydata(), dtype=float) + number
        assert np.abs(inside).max() <= 0.5  # no signal leaves its lane
        np.testing.assert_allclose(np.asarray(line.get_xdata(), dtype=float), recording.time)
    greys = [to_hex(str(line.get_color())) for line in signals]
    assert greys[0] != greys[1]  # the channel left out
    assert len(set(greys[1:])) == 1


def test_events_and_marks_are_where_they_were(check: Check) -> None:
    whole, close = panels(check)
    drop, seen = check.drops[0], check.recorded[0]
    for axes in (whole, close):
        [shade] = [patch for patch in axes.patches if isinstance(patch, Rectangle)]
        assert (shade.get_x(), shade.get_x() + shade.get_width()) == pytest.approx((drop.start, drop.end))
        marked = [np.asarray(line.get_xdata(), dtype=float) for line in axes.lines if line.get_marker() == "."]
        times = np.concatenate(marked)
        np.testing.assert_allclose(np.unique(times), seen.time[seen.marks[0].samples])
    places = [np.asarray(line.get_xdata(), dtype=float) for line in close.lines]
    upright = {float(place[0]) for place in places if np.ptp(place) == 0}
    assert upright >= {drop.release, drop.landing, drop.start}


def test_the_same_recordings_give_the_same_drawing(campaign: Campaign, check: Check) -> None:
    assert draw_check(check) == draw_check(sprung.check(campaign))


def test_a_drop_left_out_and_one_without_release(campaign: Campaign) -> None:
    recording = campaign.recordings[0]
    short = sprung.check(replace(campaign, recordings=(replace(recording, values=recording.values[:, :300]),)))
    assert any(text.startswith("left out: ") and "no-decay" in text for text in texts(*draw_check(short).values()))
    late = sprung.check(replace(campaign, recordings=(replace(recording, values=recording.values[:, 230:]),)))
    said = texts(*draw_check(late).values())
    assert not any(text.startswith("release") for text in said)
    assert any("no release was found" in text for text in said)


def test_wheels_that_fell_otherwise_are_told(campaign: Campaign) -> None:
    stated = campaign.drops[0].model_copy(update={"wheels": ("fr", "rr")})
    said = texts(*draw_check(sprung.check(replace(campaign, drops=(stated,)))).values())
    assert "the release shows fl, rl to have fallen" in said


def test_long_recordings_stay_small(campaign: Campaign) -> None:
    recording = campaign.recordings[0]
    random = np.random.default_rng(1)
    rest = recording.values[:, -1:] + random.normal(0, 0.02, (8, 400_000))
    long = replace(campaign, recordings=(replace(recording, values=np.hstack([recording.values, rest])),))
    [svg] = draw_check(sprung.check(long)).values()
    assert len(svg) < 700_000


signals = st.lists(st.floats(-1e6, 1e6) | st.just(float("nan")), min_size=1, max_size=400)


@settings(max_examples=200, deadline=None)
@given(signals, st.integers(1, 20))
def test_thinning_keeps_what_can_be_seen(signal: list[float], bins: int) -> None:
    values = np.array(signal)
    kept = thinned(values, bins)
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
    written = write_check(many, tmp_path / "check")
    assert len({path.name.lower() for path in written}) == len(NAMES)
    assert all(path.parent == tmp_path / "check" for path in written)
    for path, name in zip(written, NAMES, strict=True):
        assert not set(path.name) & set('\\/:*?"<>| ')
        assert name.replace("\x07", "\N{REPLACEMENT CHARACTER}") in texts(path.read_text(encoding="utf-8"))


def test_names_of_channels(campaign: Campaign) -> None:
    odd = ("$a$", '<b> & "c"', "d" * 200, *campaign.recordings[0].channels[3:])
    sensors = tuple(
        sensor.model_copy(update={"channel": name}) for sensor, name in zip(campaign.sensors, odd, strict=True)
    )
    renamed = replace(campaign, sensors=sensors, recordings=(replace(campaign.recordings[0], channels=odd),))
    said = texts(*draw_check(sprung.check(renamed)).values())
    assert {"$a$", '<b> & "c"'} <= set(said)
    assert any(text.startswith("ddd") and text.endswith("…") for text in said)


def test_without_matplotlib(check: Check, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(_: str) -> None:
        raise ModuleNotFoundError("No module named 'matplotlib'", name="matplotlib.axes")

    monkeypatch.setattr(drawing, "import_module", missing)
    with pytest.raises(InputError, match=r'matplotlib.*pip install "sprung\[plot\]"'):
        draw_check(check)


def test_a_defect_is_not_taken_for_a_missing_library(check: Check, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawing, "import_module", lambda _: import_module("sprung.report.nothing"))
    with pytest.raises(ModuleNotFoundError, match=r"sprung\.report\.nothing"):
        draw_check(check)


def test_matplotlib_is_loaded_when_something_is_drawn_and_its_global_state_never() -> None:
    code = (
        "import sys, sprung; from sprung.vehicle import TABLE_1_CAR\n"
        "check = sprung.check(sprung.simulate(TABLE_1_CAR, drops=[{}]))\n"
        "sprung.report.check_view(check)\n"
        "assert 'matplotlib' not in sys.modules\n"
        "sprung.report.draw_check(check)\n"
        "assert 'matplotlib' in sys.modules and 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)  # noqa: S603 (our own interpreter)

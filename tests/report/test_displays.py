"""What people see, whole and line by line; `pytest tests/report --regenerate` writes it anew, to be read before it is kept.

The results shown are real ones, kept as JSON beside their displays, so that a display changes only when its layout does.
"""

from __future__ import annotations

import dataclasses
import html
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Literal

import pytest
from rich.console import Console

import sprung
from layouts import check_view_is_whole
from sprung.errors import Fault
from sprung.estimate import Estimate, Known
from sprung.pipeline import ChannelReport, Check, DropReport, Result
from sprung.recording import Campaign
from sprung.report import check_view, comparison_view, modes_view, page_of, result_view, text_of
from sprung.vehicle import TABLE_1_CAR, WHEELS

HERE = Path(__file__).parent
DATA = HERE.parent / "data"
CONSOLE = Console(width=80, highlight=False, color_system=None)


def sedan() -> Campaign:
    return sprung.read(DATA / "sedan")


def leafbus() -> Campaign:
    return sprung.read(DATA / "leafbus")


def drops_without_load() -> Campaign:
    """Two drops of the empty car; in the first one a wheel's cable was loose."""
    whole = sedan()
    fault = Fault(
        "missing",
        "empty_bounce.csv: wheel_fl",
        "1 of 1800 samples are missing, the first in line 502; the channel is left out of this drop",
        "Check the sensor's cable and the logger, or export the recording again.",
    )
    values = whole.recordings[0].values.copy()
    values[list(whole.recordings[0].channels).index("wheel_fl")] = float("nan")
    recording = dataclasses.replace(whole.recordings[0], values=values, faults=(fault,))
    return dataclasses.replace(whole, drops=whole.drops[:2], recordings=(recording, whole.recordings[1]))


def weighed_wrongly() -> Campaign:
    """The car and its known load, with a weight that contradicts them: it is 1551.8 kg."""
    return dataclasses.replace(sedan(), known={"total_mass": Known(1700.0, 1.0)})


RESULTS: dict[str, Callable[[], Campaign]] = {
    "accept": sedan,
    "doubtful": weighed_wrongly,
    "reject": leafbus,
    "unidentifiable": drops_without_load,
}


def compare(name: str, shown: str, regenerate: bool, ending: str = "txt") -> None:
    path = HERE / f"{name}.{ending}"
    if regenerate:
        path.write_text(shown, encoding="utf-8")
    assert shown == path.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", RESULTS)
def test_a_result(name: str, regenerate: bool) -> None:
    path = HERE / f"{name}.json"
    if regenerate:
        path.write_text(sprung.identify(RESULTS[name]()).to_json(), encoding="utf-8")
    result = sprung.load(path, series=False)
    check_view_is_whole(result_view(result), tables=2)
    compare(name, text_of(result_view(result), CONSOLE), regenerate)


def read(name: str) -> Result:
    return sprung.load(HERE / f"{name}.json", series=False)


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_in_a_notebook(name: str, regenerate: bool) -> None:
    shown = read(name)._repr_html_()
    ET.fromstring(f"<div>{shown}</div>")  # noqa: S314 (well-formed, or it raises)
    compare(name, shown, regenerate, "html")


@pytest.mark.parametrize("name", RESULTS)
def test_the_words_of_a_report(name: str, regenerate: bool) -> None:
    """All but the doubtful one were written by an older sprung, without setup and shapes: what is missing is said."""
    page = page_of(read(name))
    body = re.sub(r"<(style|script|svg)\b.*?</\1>", "", page[page.index("<body>") :], flags=re.DOTALL)
    lines = (" ".join(html.unescape(re.sub(r"<[^>]+>", " ", line)).split()) for line in body.splitlines())
    compare(name, "".join(f"{line}\n" for line in lines if line), regenerate, "page.txt")


@pytest.mark.parametrize("name", RESULTS)
def test_the_displays_show_what_their_names_say(name: str) -> None:
    text = (HERE / f"{name}.txt").read_text(encoding="utf-8")
    words = {
        "accept": ("Verdict: accept", "k_sf"),
        "doubtful": ("Verdict: doubtful", "total_mass"),
        "reject": ("Verdict: reject", "does not explain"),
        "unidentifiable": ("Not determined", "unidentifiable", "Divided by the empty vehicle's total mass", "missing"),
    }
    assert all(word in text for word in words[name])
    assert all(len(line) <= 80 and line == line.rstrip() for line in text.splitlines())


def test_intervals_from_profiles(regenerate: bool) -> None:
    """Open to one side, to the other, far from even, of a derived quantity; and residuals that are coloured."""
    result = sprung.load(HERE / "accept.json", series=False)
    limits = {"k_sf": (16821.3, 17352.9), "k_tf": (188123.0, None), "c_sf": (None, 1515.2), "t_f": (0.00123, 0.7452)}
    parameters = dict(result.parameters)
    for name, interval in limits.items():
        parameters[name] = dataclasses.replace(parameters[name], interval95=interval, interval_from="profile")
    derived = {"total_mass": Estimate(1553.1, 5.0, (1543.4, 1562.9), "kg", "estimated", "profile")}
    fit = replace(result.fit, inflated_by="coloured residuals", most_coloured="wheel_rl")
    changed = replace(result, parameters=parameters, derived=derived, fit=fit)
    check_view_is_whole(result_view(changed), tables=3)
    compare("profiles", text_of(result_view(changed), CONSOLE), regenerate)


def changed(result: sprung.Result, name: str, by: float) -> sprung.Result:
    """The same with one parameter larger by so many of its standard uncertainties, and of another vehicle."""
    one = result.parameters[name]
    assert one.value is not None
    assert one.std is not None
    moved = {**result.parameters, name: dataclasses.replace(one, value=one.value + by * one.std)}
    return replace(result, parameters=moved)


def test_two_results_beside_each_other(regenerate: bool) -> None:
    """With dampers of which one is 8 standard uncertainties, and so 5.7 of the difference, stronger."""
    first = sprung.load(HERE / "accept.json", series=False)
    found = sprung.compare([first, changed(first, "c_sf", 8.0)], names=["before", "after"])
    check_view_is_whole(comparison_view(found), tables=3)
    compare("comparison", text_of(comparison_view(found), CONSOLE), regenerate)


def test_many_results_beside_each_other(regenerate: bool) -> None:
    """Eight alike, one that stands out, and one that was rejected."""
    first = sprung.load(HERE / "accept.json", series=False)
    alike = [changed(first, "k_sf", by) for by in (0.0, 0.5, -0.5, 1.0, -1.0, 0.2, -0.2, 0.7)]
    others = [changed(first, "c_sf", 30.0), sprung.load(HERE / "reject.json", series=False)]
    names = [*(f"car {i + 1}" for i in range(len(alike))), "worn", "bus"]
    found = sprung.compare([*alike, *others], names=names)
    check_view_is_whole(comparison_view(found), tables=3)
    compare("comparisons", text_of(comparison_view(found), CONSOLE), regenerate)


def test_a_check(regenerate: bool) -> None:
    late = Fault(
        "no-decay", "loaded_bounce.csv", "0.10 s of free vibration, at least 0.5 s are needed", "Record longer."
    )
    gap = Fault(
        "missing", "empty_roll.csv: wheel_rr", "every sample is missing; the channel is left out", "Check its cable."
    )
    clipped = Fault("clipped", "empty_bounce.csv: wheel_fl", "14 samples are at full scale", "Use a larger range.")
    check = Check((bounce(), roll(), left_out()), (clipped, gap, late))
    check_view_is_whole(check_view(check), tables=2)
    compare("check", text_of(check_view(check), CONSOLE), regenerate)


def test_a_check_that_an_older_sprung_could_have_made() -> None:
    shown = text_of(check_view(Check((DropReport("a.csv", "empty", 0.4, 3.5, ()),), ())), CONSOLE)
    assert "a.csv" in shown
    assert "Limits" not in shown
    assert "Channels" not in shown


def channels(used: bool, *peaks: float | None, **faults: tuple[str, ...]) -> tuple[ChannelReport, ...]:
    """Give three channels, without a peak of those that are left out."""
    names: tuple[tuple[str, Literal["body", "fl", "rr"]], ...] = (
        ("body", "body"),
        ("wheel_fl", "fl"),
        ("wheel_rr", "rr"),
    )
    return tuple(
        ChannelReport(name, on, None if peak is None else 0.0203, peak, used and peak is not None, faults.get(name, ()))
        for (name, on), peak in zip(names, peaks, strict=True)
    )


def bounce() -> DropReport:
    """Whole, but for a wheel that clipped."""
    return DropReport(
        file="empty_bounce.csv",
        load="empty",
        start=0.466,
        end=3.598,
        faults=("clipped",),
        kind="bounce",
        wheels=WHEELS,
        wheels_seen=WHEELS,
        release=0.4,
        landing=0.438,
        last_lift_off=0.44,
        why_start="until then wheel_fl clipped",
        why_end="the recording ends",
        rate=500.0,
        channels=channels(True, 10.94, 101.2, 77.34, wheel_fl=("clipped",)),
    )


def roll() -> DropReport:
    """On another clock, of other wheels than stated, with limits that were given and a channel that is missing."""
    return DropReport(
        file="empty_roll.csv",
        load="empty",
        start=12.4425,
        end=15.598,
        faults=("missing",),
        kind="roll left",
        wheels=("fl", "rl"),
        wheels_seen=("fr", "rr"),
        release=12.3,
        why_start="given as start",
        why_end="given as end",
        rate=512.0,
        channels=channels(True, 3.1, 2.05, None, wheel_rr=("missing",)),
    )


def left_out() -> DropReport:
    return DropReport(
        file="loaded_bounce.csv",
        load="ballast",
        start=None,
        end=None,
        faults=("no-decay",),
        kind="bounce",
        wheels=WHEELS,
        release=0.41,
        rate=500.0,
        channels=channels(False, 9.0, 111.7, 89.6),
    )


def test_modes_without_uncertainty(regenerate: bool) -> None:
    # Four drops without noise have the modes of the Table 1 car to all digits shown.
    campaign = sprung.simulate(TABLE_1_CAR, noise=0.0)
    compare("modes", text_of(modes_view(sprung.modes(campaign)), CONSOLE), regenerate)

"""What people see, whole and line by line; `pytest tests/report --regenerate` writes it anew, to be read before it is kept.

The results shown are real ones, kept as JSON beside their displays, so that a display changes only when its layout does;
`goldens.py` has their campaigns.
"""

from __future__ import annotations

import dataclasses
import html
import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import pytest
from rich.console import Console

import sprung
from goldens import RESULTS, stored_result
from layouts import check_view_is_whole
from sprung.checking import ChannelReport, Check, DropReport
from sprung.errors import Fault
from sprung.modal_survey import IdentifiedMode, LoadModes
from sprung.report import check_view, comparison_view, modes_view, report_html, result_view, text_of
from sprung.uncertainty import Estimate
from sprung.vehicle import WHEELS

HERE = Path(__file__).parent
CONSOLE = Console(width=80, highlight=False, color_system=None)


def compare(name: str, shown: str, regenerate: bool, ending: str = "txt") -> None:
    path = HERE / f"{name}.{ending}"
    if regenerate:
        path.write_text(shown, encoding="utf-8")
    assert shown == path.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", RESULTS)
def test_a_result(name: str, regenerate: bool) -> None:
    view = result_view(stored_result(name))
    check_view_is_whole(view, tables=1 if name == "reject" else 2)  # what remains are the residuals
    compare(name, text_of(view, CONSOLE), regenerate)


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_in_a_notebook(name: str, regenerate: bool) -> None:
    shown = stored_result(name)._repr_html_()
    ET.fromstring(f"<div>{shown}</div>")  # noqa: S314 (well-formed, or it raises)
    compare(name, shown, regenerate, "html")


@pytest.mark.parametrize("name", RESULTS)
def test_the_words_of_a_report(name: str, regenerate: bool) -> None:
    page = report_html(stored_result(name))
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
    result = stored_result("accept")
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
    first = stored_result("accept")
    found = sprung.compare([first, changed(first, "c_sf", 8.0)], names=["before", "after"])
    check_view_is_whole(comparison_view(found), tables=3)
    compare("comparison", text_of(comparison_view(found), CONSOLE), regenerate)


def test_many_results_beside_each_other(regenerate: bool) -> None:
    """Eight alike, one that stands out, and one that was rejected."""
    first = stored_result("accept")
    alike = [changed(first, "k_sf", by) for by in (0.0, 0.5, -0.5, 1.0, -1.0, 0.2, -0.2, 0.7)]
    others = [changed(first, "c_sf", 30.0), stored_result("reject")]
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


def test_a_drop_without_anything_observed() -> None:
    shown = text_of(check_view(Check((DropReport("a.csv", "empty", 0.4, 3.5, ()),), ())), CONSOLE)
    assert "a.csv" in shown
    assert "Limits" not in shown
    assert "Channels" not in shown


def channels(used: bool, *peaks: float | None, **faults: tuple[str, ...]) -> tuple[ChannelReport, ...]:
    """Return three channels, without a peak of those that are left out."""
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


def mode(name: str, frequency: float, ratio: float, *std: float, **more: Any) -> IdentifiedMode:
    """Make up a mode; without standard uncertainties of frequency and damping ratio its method tells none."""
    rate = 2 * math.pi * frequency
    damped = frequency * math.sqrt(1 - ratio**2)
    return IdentifiedMode(
        name=name,
        pole=(-ratio * rate, 2 * math.pi * damped),
        frequency=frequency,
        frequency_std=std[0] if std else None,
        damped_frequency=damped,
        damping_ratio=ratio,
        damping_ratio_std=std[1] if std else None,
        **more,
    )


def test_modes(regenerate: bool) -> None:
    """With their uncertainties; one without noise, one that is not resolved, one that was followed through its decay."""
    followed: dict[str, Any] = {
        "amplitudes": ((31.2, 10.62, 0.013, 0.2311, 0.0012), (1.04, 11.03, 0.024, 0.2042, 0.0021)),
        "frequency_trend": (-2.61, 0.17),
    }
    modes = (
        mode(
            "body bounce",
            1.05107,
            0.26627,
            0.00027,
            0.00017,
            fft_frequency=0.95,
            fft_difference=-6.19,
            collinearity=0.994,
        ),
        mode("body pitch", 1.3078189, 0.2502047, 8e-8, 7e-8, collinearity=0.991),
        mode("wheel roll", 10.7678, 0.25412, 0.0023, 0.00021, fft_frequency=10.1, fft_difference=-2.97, **followed),
        mode("wheel pitch", 11.3, 0.26, status="unresolved"),
    )
    said = ("These records do not determine wheel pitch near 11.3 Hz: other drops, or less noise, would.",)
    missing = Fault(
        "missing", "loaded_roll.csv: wheel_fl", "every sample is missing; the channel is left out", "Check it."
    )
    found = {
        "empty": LoadModes(modes, "ml", ("body", "wheel_fl"), ("empty_bounce", "empty_roll"), unresolved=said),
        "ballast": LoadModes((mode("mode 1", 1.0029, 0.25328),), "itd", ("body",), ("loaded_bounce",)),
    }
    compare("modes", text_of(modes_view(found, [missing]), CONSOLE), regenerate)

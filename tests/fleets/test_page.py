"""The page of a fleet: alarms named, everything drawn, nothing fetched."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from fleet_population import NAMES, draw_fleet
from sprung.batch import BatchCounts
from sprung.fleets import Fleet, FleetType
from sprung.fleets.survey import _survey
from sprung.report import fleet_html, fleet_pictures, fleet_view, text_of


@pytest.fixture(scope="module")
def disturbed() -> FleetType:
    """A rig that drifts from vehicle 61 on by 4 %, and vehicle 31 with weak dampers."""
    estimates = draw_fleet(120, np.random.default_rng(12), drift=60)
    estimates.positions[60:, :11] += 0.03
    estimates.positions[30, NAMES.index("c_sf")] -= 0.25
    return _survey("van <1>", estimates)


def fleet_of(one: FleetType) -> Fleet:
    problems = "\n".join(f"body_{i}.csv: found <nothing>; expected samples." for i in range(18))
    return Fleet(
        Path("out"),
        BatchCounts(one.estimates.count, 1, 0),
        121,
        gone=("/old/campaign.toml",),
        verdicts={"accept": 119, "reject": 1},
        failures={"/data/bad/campaign.toml": problems},
        rejected={"/data/no/campaign.toml": "the model does not explain <1> of the records"},
        types=(one,),
        small_types={"bus": 2},
    )


def test_alarms_are_named(disturbed: FleetType) -> None:
    page, shown = fleet_html(fleet_of(disturbed)), text_of(fleet_view(fleet_of(disturbed)))
    for text in (page, shown):
        plain = " ".join(text.split())
        assert re.search(r"rig: scale \+[34]\.\d ± 0\.\d % in all vehicles since number \d+", plain)
        assert re.search(r"vehicle car 31 \(number 31\) deviates: c_sf -2\d\.\d ± \d\.\d %", plain)
        assert "1 campaign of an earlier run not among the given ones, the first /old/campaign.toml: kept" in plain
        assert "bus (2)" in plain
    assert "120 campaigns identified (119 accept, 1 reject), 1 failed." in shown


def test_the_page_is_whole_escaped_and_fetches_nothing(disturbed: FleetType) -> None:
    page = fleet_html(fleet_of(disturbed))
    assert page.count('<svg class="picture"') == page.count("</svg>") == 3 + len(NAMES)
    assert "van &lt;1&gt;" in page
    assert "van <1>" not in page
    assert "&lt;nothing&gt;" in page
    assert not re.search(r"(src|href)=\"(https?:)?//", page)
    assert "nan" not in re.sub(r"<style>.*?</style>", "", page, flags=re.DOTALL).lower().replace("nano", "")


def test_a_failure_takes_one_line_of_the_terminal_and_rejected_campaigns_are_named(disturbed: FleetType) -> None:
    fleet = fleet_of(disturbed)
    shown, page = (" ".join(text.split()) for text in (text_of(fleet_view(fleet)), fleet_html(fleet)))
    first = "/data/bad/campaign.toml: body_0.csv: found <nothing>; expected samples."
    assert f"{first} (17 more problems: see fleet.html)" in shown
    assert shown.count("expected samples") == 1
    assert page.count("expected samples") == 18
    assert "rejected: /data/no/campaign.toml: the model does not explain <1> of the records" in shown
    assert "<code>/data/no/campaign.toml</code>: the model does not explain &lt;1&gt; of the records" in page
    assert fleet.document()["rejected"] == dict(fleet.rejected)


def test_units_are_those_of_the_table(disturbed: FleetType) -> None:
    page = fleet_html(fleet_of(disturbed))
    assert "kg m^2" not in page
    assert "I_yy, kg m²" in page


def test_the_pictures_describe_themselves(disturbed: FleetType) -> None:
    pictures = fleet_pictures(disturbed)
    assert list(pictures) == ["spread", "rig", "vehicle", *NAMES]
    assert "Alarms: vehicle car 31." in pictures["vehicle"].description
    assert "alarm at vehicle" in pictures["rig"].description


def test_estimates_since_the_drift_are_pooled_apart(disturbed: FleetType) -> None:
    """A drift is not shared out: estimates before it keep their scale, those since then have theirs."""
    alarm = disturbed.chart.rig_alarms[-1]
    spread = disturbed.parameters
    before, since = slice(0, alarm.since - 1), slice(alarm.since - 1, None)
    own, joint = disturbed.estimates.positions, disturbed.hierarchical.positions
    for period in (before, since):
        error = (joint[period] - own[period]).mean(axis=0)
        assert np.abs(error).max() < 0.004
    assert spread["m_s"].spread == pytest.approx(2, abs=4 * 2 / np.sqrt(240))

"""The walk in a real browser: from ten raw recordings to an accepted report, with reloads, a second tab and a cancelled job."""

from __future__ import annotations

import re
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import sprung
from browser_page import Tabs, chromium, tabs
from raw_recordings import HATCHBACK, ITEMS, POSITIONS, write_recordings
from served import Served, served


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Ten raw recordings: five drops empty, five with sandbags."""
    return write_recordings(tmp_path_factory.mktemp("raw"))


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as opened:
        yield opened


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with served(tmp_path_factory.mktemp("work")) as started:
        yield started


@pytest.fixture
def user(browser: Any, server: Served) -> Iterator[Tabs]:
    with tabs(browser, server) as opened:
        yield opened


@pytest.mark.slow
def test_ten_recordings_become_an_accepted_report(user: Tabs, server: Served, recordings: list[Path]) -> None:
    begun = time.monotonic()
    page = user.open()
    page.get_by_label("Add recordings").set_input_files(recordings)
    page.get_by_text("10 recordings").wait_for()
    page.get_by_role("button", name="Draft a campaign").click()
    page.get_by_role("link", name="Complete campaign.toml").click()
    campaign = server.folder / "campaign.toml"
    drafted = campaign.read_text()

    # What only the user can know, with a decimal comma; the problems go away while it is typed.
    assert page.locator("#state").inner_text() == "No problems; 7 places to be filled in."
    fill(page, "Wheelbase, m", "2,55")
    fill(page, "Total mass, kg", "1194")
    fill(page, "Total mass, standard uncertainty, kg", "2")
    page.locator("#state", has_text="5 places to be filled in").wait_for()
    for number, (channel, place) in enumerate(POSITIONS.items()):
        assert page.input_value(f"[id='sensor.{number}.channel']") == channel
        for axis, value in enumerate(place):
            page.fill(f"[id='sensor.{number}.position.{axis}']", f"{value:.2f}".replace(".", ","))
    for number, (mass, place) in enumerate(ITEMS):
        page.get_by_role("button", name="Add an item").click()
        page.locator(f"[id='load.0.items.{number}.mass.value']").wait_for()
        page.fill(f"[id='load.0.items.{number}.mass.value']", str(mass))
        for axis, value in enumerate(place):
            page.fill(f"[id='load.0.items.{number}.position.{axis}']", str(value))
    page.locator("#state", has_text="nothing is missing").wait_for()

    # A recording with its limits; nothing is stated of them.
    first = page.locator("[data-drop='0']")
    first.scroll_into_view_if_needed()
    first.get_by_text("Free decay from 0.448 s").wait_for()
    assert first.get_by_role("slider").count() == 4

    # Without the file, another program could not check what is written here.
    page.get_by_role("button", name="Save").last.click()
    page.get_by_text("Saved.").wait_for()
    document = tomllib.loads(campaign.read_text())
    assert document["vehicle"]["wheelbase"] == 2.55
    assert document["known"]["total_mass"] == {"value": 1194, "std": 2}
    assert [sensor.get("position") for sensor in document["sensor"][:4]] == [
        list(place) for place in POSITIONS.values()
    ]
    comments = [line for line in drafted.splitlines() if line.startswith("#")]
    assert [line for line in campaign.read_text().splitlines() if line.startswith("#")] == comments

    page.get_by_role("link", name="Check", exact=True).click()
    page.get_by_role("button", name="Check").click()
    frame = page.frame_locator("iframe")
    frame.get_by_text("10 of 10 drops").wait_for()

    page.get_by_role("link", name="Identify").first.click()
    page.get_by_role("button", name="Identify").click()
    page.get_by_role("button", name="Cancel").wait_for()
    page.reload()  # in the middle
    other = user.open("/identify?campaign=campaign.toml")  # a second tab shows the same job
    assert re.search(r"job=([\w-]+)", other.url)[1] == re.search(r"job=([\w-]+)", page.url)[1]  # type: ignore[index]
    other.close()
    page.get_by_role("heading", name="Verdict: accept").wait_for()
    page.get_by_role("link", name="Report", exact=True).first.click()
    report = page.frame_locator("iframe")
    report.get_by_role("heading", name="Hatchback").or_(report.get_by_role("heading", name="work")).first.wait_for()
    assert "accept" in page.locator(".verdict").inner_text()
    assert time.monotonic() - begun < 120  # with every wait; clicking and typing by hand comes on top
    estimate = sprung.load(server.folder / "results").parameters["k_sf"]
    assert estimate.value == pytest.approx(HATCHBACK.k_sf, rel=0.05)  # 5 standard uncertainties of 0.7 % to 1 %


@pytest.mark.slow  # cancels what the walk has identified
def test_an_identification_is_cancelled_and_nothing_is_changed(user: Tabs, server: Served) -> None:
    before = {path: path.read_bytes() for path in (server.folder / "results").iterdir()}
    page = user.open("/identify?campaign=campaign.toml")
    page.get_by_role("button", name="Identify").click()
    page.get_by_role("button", name="Cancel").click()
    page.get_by_text("Cancelled after").wait_for()
    assert {path: path.read_bytes() for path in (server.folder / "results").iterdir()} == before
    page.goto(f"{server.origin}/jobs")
    assert page.locator(".job.cancelled").count() == 1


def fill(page: Any, label: str, value: str) -> None:
    page.get_by_label(label, exact=True).fill(value)

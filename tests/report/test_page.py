"""The report of the demo: built from its folder alone, small, quick, and looked at in a real browser where there is one."""

from __future__ import annotations

import hashlib
import re
import shutil
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sprung
from command_line import run
from sprung.pipeline import Result
from sprung.report import page_of, write_results

WIDTHS = (390, 1440)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `sprung demo` leaves in its results folder, as a path."""
    campaign = sprung.write(sprung.study.demo_campaign(), tmp_path_factory.mktemp("demo"))
    results = campaign.parent / "results"
    write_results(sprung.identify(sprung.read(campaign), amplitude=True), results)
    return results


@pytest.fixture(scope="module")
def result(folder: Path) -> Result:
    return sprung.load(folder)


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return (folder / "report.html").read_text(encoding="utf-8")


def test_it_is_small_and_asks_for_nothing(page: str) -> None:
    assert len(page.encode()) < 5e6
    assert not re.search(r"https?:|//[a-z]|@import|url\(|<link[^>]*href=\"(?!data:)|src=", page)


def test_the_folder_alone_gives_it_again_byte_for_byte(folder: Path, tmp_path: Path) -> None:
    for name in ("results.json", "series.npz"):
        shutil.copy(folder / name, tmp_path)
    said = run("report", tmp_path)
    assert (said.status, said.out) == (0, f"Written: {tmp_path / 'report.html'}\n")
    assert (tmp_path / "report.html").read_bytes() == (folder / "report.html").read_bytes()
    assert run("report", tmp_path, "--json").json == {"written": [str(tmp_path / "report.html")]}


def test_it_says_everything(result: Result, page: str) -> None:
    words = re.sub(r"<[^>]+>", " ", page)
    sections = re.findall(r'<section id="([a-z]+)"', page)
    assert sections == [
        *("parameters", "known", "recordings", "spectra", "stabilisation", "modes", "comparison", "amplitude"),
        *("correlation", "next", "settings", "literature"),
    ]
    assert [name for name in sections if f'href="#{name}"' not in page] == []
    assert page.index("The numbers may be used") < page.index('id="parameters"')
    assert all(reason in words for reason in result.verdict.reasons)
    assert result.setup is not None
    assert {one.name for one in result.setup.files} == {"campaign.toml", *(drop.file for drop in result.drops)}
    assert all(one.sha256 in words for one in result.setup.files)
    assert all(f"{name} {number}" in words for name, number in result.setup.software.items())
    assert "5240.0" in words  # what the campaign file says was weighed
    assert page.count('<svg class="car"') == 7


def test_checksums_are_those_of_the_files(folder: Path, result: Result) -> None:
    assert result.setup is not None
    for one in result.setup.files:
        content = (folder.parent / one.name).read_bytes()
        assert (one.size, one.sha256) == (len(content), hashlib.sha256(content).hexdigest())


def test_curves_are_where_the_numbers_are(result: Result, page: str) -> None:
    """Read back from the picture of a drop, the measured vertical acceleration is what the result holds."""
    [figure] = re.findall(r"<figcaption>empty_roll_left</figcaption>(.*?)</figure>", page, flags=re.DOTALL)
    series = result.series["empty_roll_left"]
    assert series.body_measured is not None
    measured = series.body_measured[0].astype(float)
    [path, *_] = re.findall(
        r'class="curve measured" stroke-width="[\d.]+" transform="scale\(0.1\)" d="M([^"]+)"', figure
    )
    first, steps = path.split("l")
    numbers = [int(one) for one in re.findall(r"-?\d+", steps)]
    places = np.cumsum([[int(one) for one in first.split()], *zip(numbers[::2], numbers[1::2], strict=True)], axis=0)
    # Ticks tell the scale: two of them, and where they stand.
    ticks = re.findall(r'<text class="tick" x="\d+" y="([\d.]+)" text-anchor="end">([−\d.]+)</text>', figure)[:3]
    heights, values = zip(*((float(y) - 3, float(text.replace("−", "-"))) for y, text in ticks), strict=True)
    slope, offset = np.polyfit(heights, values, 1)
    read = slope * places[:, 1] / 10 + offset
    # A tenth of a unit is how finely a curve is drawn, and ticks are placed.
    assert (read.min(), read.max()) == pytest.approx((measured.min(), measured.max()), abs=3 * abs(slope) * 0.1)
    assert read[0] == pytest.approx(measured[0], abs=3 * abs(slope) * 0.1)


def test_forty_drops_take_no_ten_seconds(result: Result) -> None:
    copies = [f"{name}_{count}" for count in range(4) for name in result.series]
    many = replace(
        result,
        drops=tuple(replace(drop, name=f"{drop.name}_{count}") for count in range(4) for drop in result.drops),
        series={name: result.series[name.rpartition("_")[0]] for name in copies},
        recordings={name: result.recordings[name.rpartition("_")[0]] for name in copies},
        validation={name: result.validation[name.rpartition("_")[0]] for name in copies},
    )
    begun = time.perf_counter()
    page = page_of(many)
    assert time.perf_counter() - begun < 10
    assert page.count("<figcaption>The whole recording</figcaption>") == 40
    assert page.count("<details") == 42
    assert page.count(" open>") == 1  # of many that are alike one is shown, the others unfold


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Debian's Chromium, or whatever the system calls its own."""
    playwright = pytest.importorskip("playwright.sync_api")
    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if program is None:
        pytest.skip("needs Chromium")
    with playwright.sync_playwright() as running:
        opened = running.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture
def opened(browser: Any, folder: Path) -> Iterator[Any]:
    """Open the report; when the test is done, nothing must have gone wrong and nothing have been asked for."""
    wrong: list[str] = []
    pages: list[Any] = []

    def open_it(width: int, **how: str) -> Any:
        page = browser.new_page(viewport={"width": width, "height": 900}, **how)
        pages.append(page)
        page.on("console", lambda message: wrong.append(message.text))
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("request", lambda request: wrong.append(request.url) if not request.url.startswith("file:") else None)
        page.goto((folder / "report.html").as_uri())
        return page

    yield open_it
    for page in pages:
        page.close()
    assert wrong == []


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_reads_well(opened: Any, width: int, scheme: str) -> None:
    page = opened(width, color_scheme=scheme)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    # On the screen no word of a picture is so small that it cannot be read.
    heights = page.evaluate(
        "[...document.querySelectorAll('svg.picture text')].map(one => one.getBoundingClientRect()).filter(one => one.width)"
        ".map(one => Math.min(one.height, one.width))"
    )
    assert min(heights) > 4.5  # a single narrow digit
    assert sorted(heights)[len(heights) // 2] > 8
    # The verdict can be seen at once.
    assert page.locator(".verdict .word").bounding_box()["y"] < 300
    assert (
        contrast(
            *page.evaluate("[getComputedStyle(document.body).color, getComputedStyle(document.body).backgroundColor]")
        )
        > 7
    )
    quiet = (
        "getComputedStyle(document.querySelector('.meaning'))"
        if width > 700
        else "getComputedStyle(document.querySelector('.kicker'))"
    )
    assert (
        contrast(page.evaluate(f"{quiet}.color"), page.evaluate("getComputedStyle(document.body).backgroundColor"))
        > 4.5
    )
    dark = contrast(page.evaluate("getComputedStyle(document.body).backgroundColor"), "rgb(0, 0, 0)") < 2
    assert dark == (scheme == "dark")


def contrast(one: str, other: str) -> float:
    """Give the contrast ratio of two colours (WCAG 2.2, 1.4.3)."""

    def luminance(colour: str) -> float:
        parts = np.array([int(part) for part in re.findall(r"\d+", colour)[:3]]) / 255
        linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_the_modes_move(opened: Any) -> None:
    page = opened(1440, reduced_motion="no-preference")
    edges = "[...document.querySelectorAll('svg.car .edges')].map(one => one.getAttribute('d'))"
    before = page.evaluate(edges)
    page.wait_for_timeout(250)
    assert all(one != other for one, other in zip(before, page.evaluate(edges), strict=True))
    page.get_by_role("button", name="Pause").click()
    still = page.evaluate(edges)
    page.wait_for_timeout(100)
    assert page.evaluate(edges) == still
    assert page.get_by_role("button", name="Play").is_visible()


def test_nothing_moves_for_who_does_not_want_it(opened: Any) -> None:
    page = opened(1440, reduced_motion="reduce")
    edges = "document.querySelector('svg.car .edges').getAttribute('d')"
    before = page.evaluate(edges)
    page.wait_for_timeout(100)
    assert page.evaluate(edges) == before
    page.get_by_role("button", name="Play").click()
    page.wait_for_timeout(250)
    assert page.evaluate(edges) != before


def test_printed_it_is_whole_and_still(opened: Any, result: Result) -> None:
    page = opened(1440, reduced_motion="no-preference", color_scheme="dark")
    assert page.locator("details:not([open])").count() == len(result.drops) - 1
    written = page.pdf(format="A4")
    assert written.startswith(b"%PDF")
    assert page.locator("details:not([open])").count() == 0
    assert page.get_by_role("button", name="Play").is_visible()
    page.emulate_media(media="print", color_scheme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert not page.locator("nav").is_visible()

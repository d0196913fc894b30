"""The report of the demo: built from its folder alone, small, quick, and looked at in a real browser where there is one."""

from __future__ import annotations

import csv
import hashlib
import re
import shutil
import struct
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import image

import sprung
from browser_page import wait_until
from command_line import run
from sprung.report import add_report, report_html, save_result
from sprung.results import Result

WIDTHS = (390, 1000, 1440)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `sprung demo` leaves in its results folder, as a path."""
    campaign = sprung.write(sprung.study.demo_campaign(), tmp_path_factory.mktemp("demo"))
    results = campaign.parent / "results"
    saved = save_result(sprung.identify(sprung.read(campaign), amplitude=True), results)
    add_report(saved.result, results)
    return results


@pytest.fixture(scope="module")
def result(folder: Path) -> Result:
    return sprung.load(folder)


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return (folder / "report.html").read_text(encoding="utf-8")


def test_it_is_small_and_asks_for_nothing(page: str) -> None:
    assert len(page.encode()) < 5e6
    page = re.sub(r'"bytes":"[A-Za-z0-9+/=]*"', "", page)  # packed data, which may look like anything
    assert not re.search(r"https?:|//[a-z]|@import|url\(|<link[^>]*href=\"(?!data:)|src=", page)


@pytest.mark.slow
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
        *("characteristics", "parameters", "geometry", "known", "recordings", "spectra", "stabilisation", "modes"),
        *("comparison", "ride", "amplitude", "correlation", "next", "trace", "settings", "literature"),
    ]
    assert [name for name in sections if f'href="#{name}"' not in page] == []
    assert page.index("The estimates may be used") < page.index('id="parameters"')
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
        r'class="curve measured" data-curve="0" stroke-width="[\d.]+" transform="scale\(0.1\)" d="M([^"]+)"', figure
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


@pytest.mark.slow
def test_forty_drops_take_no_ten_seconds(result: Result) -> None:
    copies = [f"{name}_{count}" for count in range(4) for name in result.series]
    many = replace(
        result,
        drops=tuple(replace(drop, name=f"{drop.name}_{count}") for count in range(4) for drop in result.drops),
        series={name: result.series[name.rpartition("_")[0]] for name in copies},
        recordings={name: result.recordings[name.rpartition("_")[0]] for name in copies},
        validation={name: result.validation[name.rpartition("_")[0]] for name in copies},
    )
    begun = time.process_time()
    page = report_html(many)
    assert time.process_time() - begun < 10
    assert page.count("<figcaption>The whole recording</figcaption>") == 40
    assert page.count("<details") == 81
    assert page.count(" open>") == 2  # the worst is shown, in both sections; the others unfold


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
@pytest.mark.slow
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
    # Every text is as clear as WCAG 2.2 AA asks of small ones: its colour against the ground below it.
    pairs = page.evaluate(TEXTS_AND_GROUNDS)
    assert len(pairs) > 10
    assert [pair for pair in pairs if contrast(*pair) < 4.5] == []
    dark = contrast(page.evaluate("getComputedStyle(document.body).backgroundColor"), "rgb(0, 0, 0)") < 2
    assert dark == (scheme == "dark")


TEXTS_AND_GROUNDS = """() => {
  document.querySelectorAll("details").forEach((one) => { one.open = true; });
  const blend = (colours) => colours.reduceRight((below, colour) => {
    const [red, green, blue, alpha = 1] = colour.match(/[\\d.]+/g).map(Number);
    return [red, green, blue].map((part, i) => alpha * part + (1 - alpha) * below[i]);
  }, [255, 255, 255]);
  const found = new Set();
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement;
    if (!node.textContent.trim() || parent.closest("script, style, title, desc") || !parent.getClientRects().length) continue;
    const style = getComputedStyle(parent);
    const grounds = [];
    for (let one = parent; one; one = one.parentElement) grounds.push(getComputedStyle(one).backgroundColor);
    const panel = parent.closest("svg")?.querySelector(".band");
    if (panel) grounds.unshift(getComputedStyle(panel).fill);
    const ground = blend(grounds).map(Math.round);
    found.add(JSON.stringify([parent instanceof SVGElement ? style.fill : style.color, `rgb(${ground.join(", ")})`]));
  }
  return [...found].map((one) => JSON.parse(one));
}"""


def contrast(one: str, other: str) -> float:
    """Return the contrast ratio of two colours (WCAG 2.2, 1.4.3)."""

    def luminance(colour: str) -> float:
        parts = np.array([int(part) for part in re.findall(r"\d+", colour)[:3]]) / 255
        linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.slow
def test_the_modes_move(opened: Any) -> None:
    page = opened(1440, reduced_motion="no-preference")
    edges = "[...document.querySelectorAll('svg.car .edges')].map(one => one.getAttribute('d'))"
    before = page.evaluate(edges)
    page.wait_for_function(f"before => {edges}.every((edge, number) => edge !== before[number])", arg=before)
    page.get_by_role("button", name="Pause").click()
    still = page.evaluate(edges)
    page.wait_for_timeout(100)
    assert page.evaluate(edges) == still
    assert page.get_by_role("button", name="Play").is_visible()


@pytest.mark.slow
def test_nothing_moves_for_who_does_not_want_it(opened: Any) -> None:
    page = opened(1440, reduced_motion="reduce")
    edges = "document.querySelector('svg.car .edges').getAttribute('d')"
    before = page.evaluate(edges)
    page.wait_for_timeout(100)
    assert page.evaluate(edges) == before
    page.get_by_role("button", name="Play").click()
    page.wait_for_function(f"before => {edges} !== before", arg=before)


@pytest.mark.slow
def test_printed_it_is_whole_and_still(opened: Any, result: Result) -> None:
    page = opened(1440, reduced_motion="no-preference", color_scheme="dark")
    folded = page.locator("details.drop:not([open])")
    assert folded.count() == 2 * (len(result.drops) - 1)
    written = page.pdf(format="A4")
    assert written.startswith(b"%PDF")
    assert folded.count() == 0
    assert page.get_by_role("button", name="Play").is_visible()
    page.emulate_media(media="print", color_scheme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert not page.locator("nav").is_visible()


def open_figure(page: Any, section: str) -> Any:
    """Return the first figure of a section that is not folded away, with its drawing focused by keyboard."""
    figure = page.locator(f"#{section} figure:visible").first
    figure.locator("svg.picture").focus()
    return figure


def said(figure: Any) -> tuple[float, float]:
    """Return time, s, and the first measured value at the cursor, as a screen reader has them."""
    text = figure.locator(".spoken").text_content().replace("−", "-")
    time_, value = re.findall(r"^([-\d.]+) s; vertical, m/s²: measured ([-\d.]+)", text)[0]
    return float(time_), float(value)


def samples_of(result: Result, name: str) -> tuple[np.ndarray, np.ndarray]:
    series = result.series[name]
    assert series.body_measured is not None
    return series.time, series.body_measured[0].astype(float)


@pytest.mark.slow
def test_a_fit_is_read_out_and_zoomed_by_keyboard(opened: Any, result: Result) -> None:
    page = opened(1440)
    figure = open_figure(page, "comparison")
    name = figure.locator("xpath=ancestor::details").get_attribute("data-drop")
    time_, measured = samples_of(result, name)
    page.keyboard.press("ArrowRight")
    figure.locator(".cursor").first.wait_for(state="attached")
    at, value = said(figure)
    # Four figures are written, and a column is kept in 2^15 steps.
    near = int(np.argmin(np.abs(time_ - at)))
    assert value == pytest.approx(measured[near], rel=1e-3, abs=1e-3 * float(np.ptp(measured)))
    across = figure.locator(".across .tick")
    whole = across.all_text_contents()
    page.keyboard.press("+")
    wait_until(page, lambda: across.all_text_contents() != whole)
    page.keyboard.press("ArrowRight")
    wait_until(page, lambda: said(figure)[0] > at)
    page.keyboard.press("0")
    wait_until(page, lambda: across.all_text_contents() == whole)
    page.keyboard.press("Escape")
    figure.locator(".cursor").first.wait_for(state="detached")


@pytest.mark.slow
def test_channels_are_switched_off_and_a_pull_zooms(opened: Any) -> None:
    page = opened(1000)
    figure = open_figure(page, "recordings")
    drawing = figure.locator("svg.picture")
    tall = drawing.bounding_box()["height"]
    figure.locator("summary").click()
    figure.get_by_label("body_fr").uncheck()
    assert drawing.bounding_box()["height"] < tall
    assert figure.locator("g.panel:visible").count() == 7
    box = drawing.bounding_box()
    curve = "one => one.querySelector('[data-curve]').getAttribute('d')"
    before = drawing.evaluate(curve)
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 40)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.7 * box["width"], box["y"] + 50, steps=3)
    page.mouse.up()
    page.wait_for_function(f"([one, before]) => ({curve})(one) !== before", arg=[drawing.element_handle(), before])


@pytest.mark.slow
def test_a_figure_is_saved_by_a_click(opened: Any, result: Result, tmp_path: Path) -> None:
    page = opened(1440, color_scheme="dark")
    figure = open_figure(page, "comparison")
    name = figure.locator("xpath=ancestor::details").get_attribute("data-drop")
    with page.expect_download() as download:
        figure.get_by_role("button", name="CSV").click()
    assert download.value.suggested_filename == f"School_bus-{name}.csv"
    download.value.save_as(tmp_path / "figure.csv")
    with (tmp_path / "figure.csv").open(encoding="utf-8-sig", newline="") as file:
        heads, *rows = csv.reader(file)
    assert heads[:3] == ["time on the recording's clock, s", "measured: vertical, m/s²", "simulated: vertical, m/s²"]
    assert heads[3] == "residual: vertical, m/s²"
    time_, measured = samples_of(result, name)
    values = np.array(rows, dtype=float)
    np.testing.assert_allclose(values[:, 0], time_, atol=1e-6)
    np.testing.assert_allclose(values[:, 1], measured, atol=0.6 * float(np.ptp(measured)) / 2**15 + 1e-5 * 10)
    with page.expect_download() as download:
        figure.get_by_role("button", name="PNG").click()
    download.value.save_as(tmp_path / "figure.png")
    written = (tmp_path / "figure.png").read_bytes()
    assert written.startswith(b"\x89PNG")
    width, height = struct.unpack(">II", written[16:24])
    assert width == 3 * 440
    # On the light ground of paper, whatever the page's own: what was drawn is there, and most of it is white.
    pixels = image.imread(tmp_path / "figure.png")
    assert pixels.shape[:2] == (height, width)
    assert 0.6 < float((pixels[..., :3] > 0.99).all(axis=2).mean()) < 0.99
    for section in ("spectra", "stabilisation", "amplitude"):
        with page.expect_download() as download:
            page.locator(f"#{section} figure").first.get_by_role("button", name="CSV").click()
        assert download.value.path().read_text(encoding="utf-8-sig").count("\n") > 5


@pytest.mark.slow
def test_without_a_script_everything_is_there(browser: Any, folder: Path) -> None:
    page = browser.new_page(java_script_enabled=False)
    page.goto((folder / "report.html").as_uri())
    assert page.locator("#comparison svg.picture:visible").count() == 1
    assert page.locator(".tools").count() == 0
    page.locator("#comparison summary").first.click()
    assert page.locator("#comparison svg.picture:visible").count() == 2
    page.close()


@pytest.mark.slow
def test_everything_is_reached_by_keyboard(opened: Any) -> None:
    """Tab goes through links, tables that scroll, buttons, and drawings, each with a mark that shows where one is."""
    page = opened(1000)
    reached = set()
    for _ in range(60):
        page.keyboard.press("Tab")
        kind, marked = page.evaluate(
            "[document.activeElement.tagName.toLowerCase(), getComputedStyle(document.activeElement).outlineStyle !== 'none']"
        )
        assert marked, kind
        reached.add(kind)
    assert {"a", "div", "summary", "button", "svg"} <= reached


@pytest.mark.long
def test_on_paper_no_page_is_a_third_empty(result: Result) -> None:
    weasyprint = pytest.importorskip("weasyprint")
    document = weasyprint.HTML(string=report_html(result, unfolded=True)).render()

    def lowest(box: Any) -> float:
        inside = [
            lowest(child) for child in getattr(box, "children", ()) if not type(child).__name__.startswith("Margin")
        ]
        own = box.position_y + box.height if not inside and isinstance(box.height, float | int) else 0.0
        return float(max([own, *inside]))

    heights = [(page.height, lowest(page._page_box)) for page in document.pages]
    margin = 17 / 25.4 * 96  # above and below
    filled = [(bottom - margin) / (height - 2 * margin) for height, bottom in heights]
    assert min(filled[:-1]) > 2 / 3
    texts = [" ".join(text_of_margins(page._page_box)) for page in document.pages]
    assert all(f"page {number} of {len(texts)}" in text for number, text in enumerate(texts, start=1))
    assert ["School bus" in text for text in texts] == [False] + [True] * (len(texts) - 1)


def text_of_margins(page: Any) -> Iterator[str]:
    """Return the words beside the text of a page: running head and page number."""
    for box in page.children:
        if type(box).__name__ == "MarginBox":
            yield "".join(one.text for one in box.descendants() if hasattr(one, "text"))

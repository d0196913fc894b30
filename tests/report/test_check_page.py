"""The page of `sprung check`: one file, everything in it, each problem beside its drop; in a browser where there is one."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from html import unescape
from pathlib import Path
from typing import Any

import pytest

import sprung
from command_line import copy_sedan
from sprung.checking import Check
from sprung.report import check_html

CONTRAST = """() => {
  const rgb = (text) => text.match(/[\\d.]+/g).map(Number);
  const luminance = ([r, g, b]) => {
    const part = (c) => (c / 255 <= 0.03928 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4);
    return 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
  };
  const ground = (one) => {
    for (let at = one; at; at = at.parentElement) {
      const colour = rgb(getComputedStyle(at).backgroundColor);
      if (colour.length < 4 || colour[3] > 0) return colour;
    }
    return [255, 255, 255];
  };
  const low = [];
  for (const one of document.querySelectorAll("body *")) {
    const own = [...one.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
    if (!own || one.closest("script, style, title, desc") || !one.getClientRects().length) continue;
    const style = getComputedStyle(one);
    const colour = rgb(one instanceof SVGElement ? style.fill : style.color);
    const [high, dim] = [luminance(colour), luminance(ground(one))].sort((a, b) => b - a);
    const ratio = (high + 0.05) / (dim + 0.05);
    if (ratio < 4.5) low.push(`${one.textContent.trim().slice(0, 30)}: ${ratio.toFixed(2)}`);
  }
  return low;
}"""
"""Texts whose contrast with what is behind them is below that of WCAG 2.2, 1.4.3, level AA."""


@pytest.fixture(scope="module")
def spoilt(tmp_path_factory: pytest.TempPathFactory) -> Check:
    """Four drops: a good one, one with a clipped channel, one too short, one that cannot be read; no sensor positions."""
    folder = copy_sedan(tmp_path_factory.mktemp("spoilt") / "sedan")
    folder.column("wheel_fl", lambda _, value: str(max(min(float(value), 30.0), -30.0)))
    folder.lines(lambda lines: lines[:300], "empty_roll_left.csv")
    (folder.path / "loaded_bounce.csv").write_text("<b>no</b>\nrecording\n")
    text = re.sub(r"(?m)^position .*$\n", "", (folder.path / "campaign.toml").read_text())
    (folder.path / "campaign.toml").write_text(text)
    return sprung.check(folder.path)


@pytest.fixture(scope="module")
def page(spoilt: Check) -> str:
    return check_html(spoilt)


def drops_of(page: str) -> dict[str, str]:
    """What the page says of each drop."""
    found = re.findall(r"(?s)<details class=\"drop\".*?</details>", page)
    return {re.sub(r"(?s).*<summary>(\S+) .*", r"\1", one): one for one in found}


def test_it_is_one_file_that_requests_nothing(page: str) -> None:
    assert not re.search(r"(?:src|href)=\"(?!#|data:,)", page)
    assert "@import" not in page
    assert "url(" not in page
    assert len(page) < 600_000


def test_the_summary_comes_first(page: str, spoilt: Check) -> None:
    assert spoilt.summary == "2 of 4 drops usable; missing: sensor positions"
    assert page.index(spoilt.summary) < page.index('<section id="vehicle">') < page.index('<section id="drops">')
    assert "sensor positions</strong> (body_fl, body_fr, body_rl, body_rr): where it sits, m" in page


def test_each_problem_stands_beside_its_drop(page: str, spoilt: Check) -> None:
    drops = drops_of(page)
    assert set(drops) == {drop.file for drop in spoilt.drops}
    assert spoilt.common_faults == ()
    for drop in spoilt.drops:
        for fault in spoilt.faults_of(drop):
            assert fault.what in unescape(drops[drop.file])
            assert fault.do in unescape(drops[drop.file])
    assert sum(len(spoilt.faults_of(drop)) for drop in spoilt.drops) == len(spoilt.faults) == 3
    assert "<strong>wheel_fl</strong>" in drops["empty_bounce.csv"]
    assert "note wrong" in drops["empty_bounce.csv"]  # at its channel in the drawing too
    opened = {file for file, text in drops.items() if re.match(r"<details[^>]* open>", text)}
    assert opened == {"empty_bounce.csv", "empty_roll_left.csv", "loaded_bounce.csv"}


def test_every_recording_is_drawn_with_units(page: str) -> None:
    drops = drops_of(page)
    for file in ("empty_bounce.csv", "empty_pitch_front.csv", "empty_roll_left.csv"):
        assert drops[file].count("<svg") == 2
        assert "time on the recording&#x27;s clock, s" in drops[file]
        assert drops[file].count(">m/s²</text>") == 16  # eight channels, whole and near the release
    assert '<rect class="band"' in drops["empty_pitch_front.csv"]
    assert "<svg" not in drops["loaded_bounce.csv"]


def test_the_vehicle_is_sketched(page: str) -> None:
    assert page.count('<svg class="sketch"') == 2
    assert "positions of body_fl, body_fr, body_rl, body_rr" in page


def test_names_are_escaped(page: str) -> None:
    assert "<b>no</b>" not in page
    assert "&lt;b&gt;no" in page or "&#39;&lt;b&gt;" in page


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api")
    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if program is None:
        pytest.skip("no browser here")
    with playwright.sync_playwright() as running:
        opened = running.chromium.launch(executable_path=program, args=["--no-sandbox", "--disable-gpu"])
        yield opened
        opened.close()


@pytest.mark.slow
def test_in_a_browser(browser: Any, page: str, tmp_path: Path) -> None:
    """At three widths, light and dark: nothing sticks out, every text has enough contrast, nothing is complained of."""
    (tmp_path / "check.html").write_text(page, encoding="utf-8")
    for width in (390, 1000, 1440):
        for scheme in ("light", "dark"):
            view = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
            complaints: list[str] = []
            view.on("console", lambda message, into=complaints: into.append(message.text))
            view.on("pageerror", lambda error, into=complaints: into.append(str(error)))
            view.goto((tmp_path / "check.html").as_uri())
            view.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
            assert view.evaluate("document.documentElement.scrollWidth - innerWidth") == 0
            assert view.evaluate(CONTRAST) == []
            assert complaints == []
            view.close()


@pytest.mark.slow
def test_by_keyboard_and_on_paper(browser: Any, page: str, tmp_path: Path) -> None:
    (tmp_path / "check.html").write_text(page, encoding="utf-8")
    view = browser.new_page()
    view.goto((tmp_path / "check.html").as_uri())
    folded = view.locator("details:not([open]) summary")
    assert folded.count() == 1
    folded.focus()
    view.keyboard.press("Enter")
    assert view.locator("details:not([open])").count() == 0
    view.reload()
    view.locator("nav a", has_text="empty_pitch_front.csv").press("Enter")  # a link unfolds what it leads to
    view.wait_for_function("document.querySelectorAll('details:not([open])').length === 0")
    view.reload()
    view.goto((tmp_path / "check.html").as_uri())
    view.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert view.locator("details:not([open])").count() == 0
    view.close()

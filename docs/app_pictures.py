"""Take the pictures of docs/app.md: the walk of the tutorial's car on the local page. Needs Chromium and playwright.

``python docs/app_pictures.py`` writes docs/app-*.png.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

HERE = Path(__file__).parent
SIZE = {"width": 1200, "height": 800}
POSITIONS = {"fl": (0.10, 0.58), "fr": (0.10, -0.58), "rl": (-2.65, 0.56), "rr": (-2.65, -0.56)}
"""Positions x and y of the body sensors as the tutorial states them, m; all are 0.50 m above the ground."""


def vehicle_file() -> str:
    """Return the vehicle of the tutorial."""
    found = re.search(r"```toml\n# file: hatchback\.toml\n(.*?)```", (HERE / "tutorial.md").read_text(), re.DOTALL)
    if found is None:
        raise SystemExit("docs/tutorial.md has no hatchback.toml any more")
    return found[1]


def sprung(*arguments: str | Path) -> list[str]:
    """Return the command line of a command."""
    return [sys.executable, "-m", "sprung", *map(str, arguments)]


@contextmanager
def page_of(folder: Path) -> Iterator[Any]:
    """Serve a folder, and open its page in a browser."""
    server = subprocess.Popen(  # noqa: S603 (this Python)
        sprung("app", folder, "--no-browser"), stdout=subprocess.PIPE, text=True
    )
    try:
        if server.stdout is None:
            raise SystemExit("the server has no output")
        address = server.stdout.readline().strip()
        program = shutil.which("chromium") or shutil.which("google-chrome")
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
            page = browser.new_page(viewport=SIZE, color_scheme="light")
            page.goto(address)
            yield page
            browser.close()
    finally:
        server.terminate()
        server.wait()


def walk(page: Any, take: Any) -> None:
    """Go from the recordings to the report."""
    take("folder")
    page.get_by_role("button", name="Draft a campaign").click()
    page.get_by_role("link", name="Complete measurements/campaign.toml").click()
    page.get_by_label("Wheelbase, m", exact=True).fill("2.55")
    page.get_by_label("Total mass, kg", exact=True).fill("1194")
    page.get_by_label("Total mass, standard uncertainty, kg").fill("2")
    for number, (x, y) in enumerate(POSITIONS.values()):
        for axis, value in enumerate((x, y, 0.50)):
            page.fill(f"[id='sensor.{number}.position.{axis}']", f"{value:.2f}")
        if number == 1:
            page.locator("svg[aria-label='Plan view'] [data-channel='body_fr']").wait_for()
            page.evaluate("scrollTo(0, 330)")
            take("campaign")
    page.locator("#state", has_text="nothing is missing").wait_for()
    drop = page.locator("[id='drop.0']")
    drop.scroll_into_view_if_needed()
    drop.get_by_role("slider", name="Free decay from").wait_for()
    drop.evaluate("(group) => group.scrollIntoView()")
    take("recording")
    page.get_by_role("button", name="Save").last.click()
    page.get_by_text("Saved.").wait_for()
    page.get_by_role("link", name="Identify", exact=True).first.click()
    page.get_by_role("button", name="Identify").click()
    page.locator("[data-part='steps'] li").nth(12).wait_for()
    take("identify")
    page.get_by_role("heading", name="Verdict").wait_for(timeout=120_000)
    page.get_by_role("link", name="Report", exact=True).first.click()
    page.frame_locator("iframe").get_by_role("heading", name="measurements").first.wait_for()
    take("report")


def after_the_report(page: Any, take: Any) -> None:
    """Show a drop in slow motion, and two recordings side by side."""
    page.get_by_role("link", name="Show the motion").click()
    page.locator("#dampers svg").first.wait_for()
    page.get_by_role("button", name="Pause").click()
    drop = page.locator("#motion optgroup").last.locator("option").first.get_attribute("value")
    page.locator("#motion").select_option(drop)
    page.locator(f"#frame[data-ready='{drop.removeprefix('drop:')}']").wait_for()
    page.locator("#time").fill("0.07")
    page.set_viewport_size({"width": SIZE["width"], "height": 1500})
    take("motion")
    page.set_viewport_size(SIZE)
    page.get_by_role("link", name="Recordings").click()
    for number in (0, 1):
        page.locator("#files input").nth(number).check()
        page.locator("#chosen li").nth(number).wait_for()
    page.locator("#channels input").nth(4).check()
    offset = page.locator("#chosen input").nth(1)
    offset.fill("0.1")
    offset.press("Tab")
    page.locator("#plot").press("+")
    page.locator("#plot").press("ArrowLeft")
    page.wait_for_timeout(1500)
    take("recordings")


def main() -> None:
    """Write the pictures."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "tests of November"
        vehicle = Path(place) / "hatchback.toml"
        vehicle.write_text(vehicle_file())
        target = folder / "measurements"
        command = sprung("simulate", vehicle, "-o", target, "--rate", "250", "--noise", "0.05")
        subprocess.run(command, check=True)  # noqa: S603 (this Python)
        for path in target.iterdir():
            if path.suffix != ".csv":
                path.unlink()
        with page_of(folder) as page:

            def take(name: str) -> None:
                page.screenshot(path=HERE / f"app-{name}.png")

            walk(page, take)
            after_the_report(page, take)


if __name__ == "__main__":
    main()

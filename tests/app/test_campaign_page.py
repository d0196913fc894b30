"""The page of a campaign in a real browser: sketch and recordings by mouse and keys, two tabs, text, labels, widths."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import sprung
from browser_page import Tabs, chromium, tabs
from raw_recordings import simulated
from served import Served, served

PAGE = "/campaign?campaign=car/campaign.toml"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as opened:
        yield opened


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("work")
    sprung.write(simulated(("sandbags",)), folder / "car")
    with served(folder) as started:
        yield started


@pytest.fixture
def file(server: Served) -> Iterator[Path]:
    """The campaign file; as it was, after the test."""
    path = server.folder / "car" / "campaign.toml"
    before = path.read_bytes()
    yield path
    path.write_bytes(before)


@pytest.fixture
def user(browser: Any, server: Served) -> Iterator[Tabs]:
    with tabs(browser, server) as opened:
        yield opened


def position(page: Any, sensor: int = 0) -> list[float]:
    return [float(page.input_value(f"[id='sensor.{sensor}.position.{axis}']")) for axis in range(3)]


def mark(page: Any, channel: str, view: str = "Plan view") -> Any:
    return page.locator(f"svg[aria-label='{view}'] [data-channel='{channel}']")


def saved(page: Any, file: Path) -> dict[str, Any]:
    page.get_by_role("button", name="Save").last.click()
    page.get_by_text("Saved.").wait_for()
    return tomllib.loads(file.read_text())


@pytest.mark.slow
def test_a_sensor_is_moved_with_the_mouse_and_with_keys(user: Tabs, file: Path) -> None:
    page = user.open(PAGE)
    assert position(page) == [0.1, 0.58, 0.5]
    scale = float(page.locator("svg[aria-label='Plan view'] g.frame").get_attribute("data-scale"))
    box, frame = mark(page, "body_fl").bounding_box(), page.locator("svg[aria-label='Plan view']").bounding_box()
    metre = scale * frame["width"] / 360  # pixels; a sketch is 360 units wide
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 0.3 * metre, y + 0.2 * metre, steps=4)
    page.mouse.up()
    assert position(page) == pytest.approx([-0.2, 0.38, 0.5], abs=0.02)  # a pixel is 1 cm
    page.locator("#changes:not([hidden])").wait_for()
    moved = position(page)
    mark(page, "body_fl").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowDown")
    assert position(page) == pytest.approx([moved[0] + 0.01, moved[1] - 0.1, 0.5], abs=1e-9)
    mark(page, "body_fl", "Side view").focus()
    page.keyboard.press("Shift+ArrowUp")
    assert position(page)[2] == 0.6
    mark(page, "wheel_fl").focus()
    page.keyboard.press("ArrowDown")  # to the right side
    assert page.input_value("[id='sensor.4.on']") == "fr"
    document = saved(page, file)
    assert document["sensor"][0]["position"] == pytest.approx([moved[0] + 0.01, moved[1] - 0.1, 0.6])
    assert document["sensor"][4]["on"] == "fr"


@pytest.mark.slow
def test_the_limits_of_a_recording_are_moved(user: Tabs, file: Path) -> None:
    page = user.open(PAGE)
    drop = page.locator("[data-drop='0']")
    drop.scroll_into_view_if_needed()
    start = drop.get_by_role("slider", name="Free decay from")
    start.wait_for()
    detected = float(start.get_attribute("aria-valuenow"))
    start.focus()
    page.keyboard.press("ArrowRight")
    assert float(page.input_value("[id='drop.0.start']")) == pytest.approx(detected + 0.01, abs=1e-3)
    box = drop.get_by_role("slider", name="Free decay to").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] - 100, box["y"] + box["height"] / 2, steps=3)
    page.mouse.up()
    end = float(page.input_value("[id='drop.0.end']"))
    assert detected + 0.5 < end < 3.5
    document = saved(page, file)
    assert document["drop"][0]["start"] == pytest.approx(detected + 0.01, abs=1e-3)
    assert document["drop"][0]["end"] == end


@pytest.mark.slow
def test_two_tabs_do_not_overwrite_each_other(user: Tabs, file: Path) -> None:
    first, second = user.open(PAGE), user.open(PAGE)
    first.fill("[id='vehicle.wheelbase.value']", "2,56")
    assert saved(first, file)["vehicle"]["wheelbase"] == 2.56
    second.fill("[id='vehicle.name']", "Saloon")
    second.get_by_role("button", name="Save").last.click()
    second.get_by_role("heading", name="was changed meanwhile").wait_for()
    assert tomllib.loads(file.read_text())["vehicle"] == {"name": "Hatchback", "wheelbase": 2.56}
    both = second.locator("pre").first.inner_text()
    assert re.search(r'^-name\s+= "Hatchback"', both, re.MULTILINE)
    assert re.search(r'^\+name\s+= "Saloon"', both, re.MULTILINE)
    second.get_by_role("button", name="Save what I entered over it").click()
    second.get_by_text("Saved.").wait_for()
    assert tomllib.loads(file.read_text())["vehicle"] == {"name": "Saloon", "wheelbase": 2.55}
    user.forgive("409 (Conflict)")


@pytest.mark.slow
def test_the_text_is_checked_while_it_is_typed(user: Tabs, file: Path) -> None:
    page = user.open(f"{PAGE}&as=text")
    text = page.input_value("#text")
    assert text == file.read_text()
    page.fill("#text", text.replace('name      = "Hatchback"', "name = "))
    page.locator("#general", has_text="campaign.toml: line 7").wait_for()
    page.fill("#text", text.replace("wheelbase = 2.55", "wheelbase = 255"))
    page.locator("#general", has_text="vehicle.wheelbase").wait_for()
    page.get_by_role("button", name="Edit as a form").click()
    assert page.input_value("[id='vehicle.wheelbase.value']") == "255"
    problem = page.locator("[data-problem='vehicle.wheelbase']")
    assert problem.inner_text().startswith("Found 255; expected")
    page.fill("[id='vehicle.wheelbase.value']", "2,55")
    page.locator("#state", has_text="No problems").wait_for()
    assert problem.inner_text() == ""
    assert file.read_text() == text  # nothing was saved


@pytest.mark.slow
def test_what_was_entered_remains_where_saving_fails(user: Tabs, file: Path) -> None:
    page = user.open(PAGE)
    before = file.read_text()
    page.route(re.compile(r"/campaign\?"), lambda route: route.abort())
    page.fill("[id='vehicle.wheelbase.value']", "2,58")
    page.keyboard.press("Control+s")
    page.locator("#failure", has_text="sprung does not answer").wait_for()
    assert page.evaluate("document.activeElement.id") == "vehicle.wheelbase.value"
    assert file.read_text() == before
    page.unroute_all()
    page.keyboard.press("Control+s")
    page.get_by_text("Saved.").wait_for()
    assert page.locator("#failure").is_hidden()
    assert page.input_value("[id='vehicle.wheelbase.value']") == "2,58"
    assert tomllib.loads(file.read_text())["vehicle"]["wheelbase"] == 2.58
    page.locator("#changes").wait_for(state="hidden")
    page.fill("[id='vehicle.wheelbase.value']", "2,59")
    assert page.locator("#saved").is_hidden()
    assert saved(page, file)["vehicle"]["wheelbase"] == 2.59
    user.forgive("net::ERR_FAILED")


@pytest.mark.slow
def test_two_sensors_of_one_name_are_moved_each(user: Tabs, file: Path) -> None:
    file.write_text(file.read_text().replace('"body_fr"', '"body_fl"'))
    page = user.open(PAGE)
    first, second = position(page, 0), position(page, 1)
    mark(page, "body_fl").nth(1).focus()
    page.keyboard.press("ArrowRight")
    assert position(page, 0) == first
    assert position(page, 1) == pytest.approx([second[0] + 0.01, *second[1:]], abs=1e-9)


@pytest.mark.slow
def test_what_is_added_has_the_focus(user: Tabs) -> None:
    page = user.open(PAGE)
    page.get_by_role("button", name="Add a sensor").click()
    page.locator("[id='sensor.8.channel']:focus").wait_for()
    page.get_by_role("button", name="Remove Sensor 9").click()
    page.locator("[id='sensor.8.channel']").wait_for(state="detached")
    page.select_option("#quantity", label="Spring rate, each front wheel (k_sf)")
    page.locator("#add-known").click()
    page.locator("[id='known.k_sf.value']:focus").wait_for()
    page.locator("[data-gap='known.k_sf']").wait_for()


@pytest.mark.slow
def test_every_input_has_a_name_and_nothing_is_wider_than_the_page(browser: Any, server: Served) -> None:
    with tabs(browser, server, color_scheme="dark") as user:
        for path in (
            "/",
            PAGE,
            f"{PAGE}&as=text",
            "/check?campaign=car/campaign.toml",
            "/identify?campaign=car/campaign.toml",
        ):
            page = user.open(path)
            for width in (390, 768, 1280, 1920):
                page.set_viewport_size({"width": width, "height": 900})
                fits = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
                assert page.evaluate(fits), (path, width)
            nameless = "input:not([type=hidden]), select, textarea, button, a, [role=slider], iframe"
            assert page.evaluate(NAMELESS, nameless) == [], path
            assert page.locator("h1").count() == 1
            page.close()


NAMELESS = """(selector) => [...document.querySelectorAll(selector)].filter((one) => {
  const labels = [...(one.labels ?? [])].map((label) => label.textContent).join("");
  return !(labels || one.getAttribute("aria-label") || one.textContent || one.title).trim();
}).map((one) => one.outerHTML)"""


@pytest.mark.slow
def test_the_keyboard_alone_suffices(user: Tabs, file: Path) -> None:
    page = user.open(PAGE)
    reached = set()
    for _ in range(400):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("document.activeElement.id || document.activeElement.textContent.trim()"))
        if page.evaluate("document.activeElement.id") == "drop.0.file":
            break
    assert {"Skip to the content", "Edit as text", "vehicle.wheelbase.value", "sensor.7.on", "add-sensor"} <= reached
    page.fill("[id='vehicle.wheelbase.value']", "2.57")
    page.keyboard.press("Control+s")
    page.get_by_text("Saved.").wait_for()
    assert tomllib.loads(file.read_text())["vehicle"]["wheelbase"] == 2.57

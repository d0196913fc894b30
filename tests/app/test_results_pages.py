"""The pages after the report in a real browser: result, compare, validate, plan, export, ride, motion, recordings."""

from __future__ import annotations

import csv
import json
import re
import shlex
import shutil
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import sprung
from browser_page import Tabs, chromium, tabs
from served import Served, served
from sprung.errors import InputError
from sprung.report import add_report, save_result
from sprung.vehicle import TABLE_1_CAR

PAGES = (
    "/report?results=before/results",
    "/compare?results=before/results&results=after/results",
    "/validate?campaign=before/campaign.toml",
    "/plan?campaign=before/campaign.toml",
    "/export?results=before/results",
    "/ride?results=before/results",
    "/motion?results=before/results",
    "/recordings?file=before/empty_bounce.csv&offset=0&file=after/empty_bounce.csv&offset=0.1&channel=wheel_fl",
)


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two campaigns of one car, the second with stiffer dampers, both identified, with three drops each."""
    folder = tmp_path_factory.mktemp("work")
    for name, car in (("before", TABLE_1_CAR), ("after", TABLE_1_CAR.with_values(c_sf=1.2 * TABLE_1_CAR.c_sf))):
        drops = [
            {"wheels": wheels, "load": "empty"} for wheels in (["fl", "fr", "rl", "rr"], ["fl", "rl"], ["fl", "fr"])
        ]
        known = {"total_mass": car.total_mass}
        campaign = sprung.write(sprung.simulate(car, drops=drops, noise=0.02, seed=1, known=known), folder / name)
        result = sprung.identify(sprung.read(campaign), extras=(), tracks="shared", fall=False)
        add_report(save_result(result, folder / name / "results").result, folder / name / "results")
    return folder


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as opened:
        yield opened


@pytest.fixture(scope="module")
def server(work: Path) -> Iterator[Served]:
    with served(work) as started:
        yield started


@pytest.fixture
def user(browser: Any, server: Served) -> Iterator[Tabs]:
    with tabs(browser, server) as opened:
        yield opened


@pytest.mark.slow
def test_a_result_says_what_to_measure_next_and_leads_on(user: Tabs) -> None:
    page = user.open(PAGES[0])
    assert page.locator(".verdict .state").inner_text() == "Verdict: accept"
    wanted = page.get_by_role("region", name="What to measure next")
    assert re.search(r"Measure|Nothing more|Add|Drop|Weigh", wanted.inner_text())
    report = page.frame_locator("iframe")
    report.get_by_role("heading", name="Table 1 car").wait_for()
    # The report is a site of its own: its scripts run, and reach neither the page nor the folder.
    assert page.locator("iframe").get_attribute("sandbox") == "allow-scripts allow-downloads"
    frame = next(frame for frame in page.frames if "/files/" in frame.url)
    assert (
        frame.evaluate("() => { try { return parent.document.title } catch (error) { return error.name } }")
        == "SecurityError"
    )
    what = page.get_by_role("group", name="What can be done with this result")
    for name in ("Validate", "Show the motion", "Ride numbers", "Export", "Compare with another result"):
        assert what.get_by_role("link", name=name, exact=True).count() == 1
    page.get_by_text("Show as commands").click()
    assert "sprung identify before/campaign.toml -o before/results" in page.locator("details.commands").inner_text()
    page.get_by_role("link", name="Plan the next measurement").click()
    page.get_by_role("heading", name="Plan the next measurement").wait_for()


@pytest.mark.long
def test_results_are_compared(user: Tabs) -> None:
    page = user.open("/compare")
    page.get_by_label("Compare before/results").check()
    page.get_by_label("Compare after/results").check()
    page.get_by_label("before/results is the reference").check()
    page.get_by_role("button", name="Compare").click()
    text = page.locator("#outcome pre")
    text.wait_for()
    row = next(line for line in text.inner_text().splitlines() if line.startswith("c_sf") and "certain" in line)
    assert float(re.findall(r"[+-][\d.]+", row)[0]) == pytest.approx(0.2 * TABLE_1_CAR.c_sf, rel=0.02)
    picture = page.locator("figure.differences svg")
    assert "c_sf" in picture.text_content()
    assert re.search(r"c_sf \+(19|20)[.\d]* %", picture.locator("desc").text_content())
    page.get_by_text("Show as commands").click()
    assert page.locator("details.commands code").inner_text() == "sprung compare before/results after/results --json"
    address = page.url
    page.reload()
    assert page.locator("#outcome pre").inner_text() == text.inner_text()
    alone = user.open("/compare")
    for box in alone.get_by_role("checkbox").all():
        box.uncheck()
    alone.get_by_role("button", name="Compare").click()
    assert "found no result; expected two or more" in alone.get_by_role("alert").inner_text()
    assert address.count("results=") == 2
    user.complaints[:] = [text for text in user.complaints if "400 (Bad Request)" not in text]  # as it should


@pytest.mark.long
def test_a_campaign_is_validated_and_drawn(user: Tabs, server: Served) -> None:
    page = user.open(PAGES[2])
    page.get_by_role("button", name="Validate").click()
    page.get_by_role("heading", name="Measured and simulated motion of the body").wait_for()
    drawings = page.locator("figure img")
    assert drawings.count() == 4  # three drops, and the modes against amplitude
    for drawing in drawings.all():
        drawing.scroll_into_view_if_needed()
        page.wait_for_function("image => image.complete && image.naturalWidth > 100", arg=drawing.element_handle())
    assert (server.folder / "before/validation/validation.json").is_file()
    assert "Verdict: accept" in page.locator("#outcome pre").inner_text()


@pytest.mark.long
def test_a_plan_is_made_with_a_decimal_comma(user: Tabs) -> None:
    page = user.open(PAGES[3])
    page.get_by_label("Largest acceptable").fill("0,5")
    page.get_by_role("button", name="Plan", exact=True).click()
    page.locator("#next").wait_for()
    assert "> 0.5 %" in page.locator("#outcome pre").inner_text()
    assert page.get_by_label("Largest acceptable").input_value() == "0,5"
    page.get_by_label("Largest acceptable").fill("a lot")
    page.get_by_role("button", name="Plan", exact=True).click()
    assert "found 'a lot'" in page.get_by_role("alert").inner_text()
    user.complaints[:] = [text for text in user.complaints if "400 (Bad Request)" not in text]


def export(page: Any, title: str, folder: Path) -> Path | str:
    """Press the button of a format; return the downloaded file, or why there is none."""
    page.get_by_role("button", name=f"Export to {title}", exact=True).click()
    page.get_by_role("link", name="Download").or_(page.locator(".problems")).first.wait_for()
    link = page.get_by_role("link", name="Download")
    if not link.count():
        return str(page.locator(".problems").inner_text())
    with page.expect_download() as download:
        link.click()
    file = folder / str(download.value.suggested_filename)
    download.value.save_as(file)
    return file


@pytest.mark.long
def test_a_vehicle_is_exported_or_the_reason_is_stated(user: Tabs, tmp_path: Path) -> None:
    page = user.open(PAGES[4])
    titles = [title.inner_text() for title in page.locator(".card h2").all()]
    assert len(titles) == len(sprung.export.FORMATS)
    page.get_by_label("Number of draws").fill("30")
    file = export(page, "Draws of the parameters", tmp_path)
    assert isinstance(file, Path)
    assert len(file.read_text().splitlines()) >= 30
    assert page.get_by_label("Number of draws").input_value() == "30"
    refused = export(page, "CommonRoad", tmp_path)
    assert isinstance(refused, str)
    assert "Export to CommonRoad: not possible" in refused
    assert "expected" in refused


@pytest.mark.long
def test_every_format_is_exported(user: Tabs, server: Served, tmp_path: Path) -> None:
    page = user.open(PAGES[4])
    written = {title.inner_text() for title in page.locator(".card h2").all()}
    files = {title: export(page, title, tmp_path) for title in written}
    exported = {title: file.stat().st_size for title, file in files.items() if isinstance(file, Path)}
    assert {"State space (MAT)", "Modelica", "FMU", "Draws of the parameters", "Markdown", "LaTeX"} <= set(exported)
    assert min(exported.values()) > 200
    assert len(list((server.folder / "before/results").glob("*.mat"))) == 1


@pytest.mark.long
def test_ride_numbers_have_the_options_of_the_command(user: Tabs) -> None:
    page = user.open(PAGES[5])
    for road in "ABDE":
        page.get_by_label(road, exact=True).uncheck()
    page.get_by_label("Speeds").fill("50 72,5")
    page.get_by_label("Seats").fill("-1,4 0,4\n-1.4,-0.4")
    page.get_by_role("button", name="Compute").click()
    page.locator("#outcome pre").wait_for()
    text = page.locator("#outcome pre").inner_text()
    assert "C, 72.5 km/h" in text
    assert "A, 50 km/h" not in text
    page.get_by_text("Show as commands").click()
    typed = "--road C --speed 50 --speed 72.5 --seat -1.4,0.4 --seat -1.4,-0.4"
    assert typed in page.locator("details.commands code").inner_text()
    assert page.get_by_label("Seats").input_value().splitlines() == ["-1,4 0,4", "-1.4,-0.4"]


@pytest.mark.slow
def test_the_motion_turns_stops_and_is_saved_on_white(user: Tabs, tmp_path: Path) -> None:
    page = user.open(PAGES[6])
    page.locator("#frame[data-ready]").wait_for()
    frame = page.locator("#frame")
    page.get_by_role("button", name="Pause").click()
    picture = "frame => frame.toDataURL()"
    still = frame.evaluate(picture)
    frame.press("ArrowLeft")
    turned = frame.evaluate(picture)
    assert turned != still
    frame.press("Home")
    assert frame.evaluate(picture) == still  # nothing moves while it is paused, and the view is the first one again
    frame.press(".")
    assert frame.evaluate(picture) != still
    frame.press(" ")
    page.wait_for_function("before => document.querySelector('#frame').toDataURL() !== before", arg=still)
    page.get_by_role("button", name="Pause").click()
    box = frame.bounding_box()
    before = frame.evaluate(picture)
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 260, box["y"] + 220)
    page.mouse.up()
    assert frame.evaluate(picture) != before

    page.locator("#motion").select_option("drop:empty_roll_left")
    page.locator("#frame[data-ready=empty_roll_left]").wait_for()
    assert "free decay of the identified vehicle" in page.locator("#note").inner_text()
    with page.expect_download() as download:
        page.get_by_role("button", name="Save the picture").click()
    assert download.value.suggested_filename == "Table_1_car-empty_roll_left.png"
    download.value.save_as(tmp_path / "still.png")
    assert corner_of(tmp_path / "still.png") == b"\xff\xff\xff"

    page.locator("#motion").select_option("mode:3")
    page.locator("#speed").select_option("0.05")
    with page.expect_download() as download:
        page.get_by_role("button", name="Save the animation").click()
    download.value.save_as(tmp_path / "moving.png")
    frames = frames_of(tmp_path / "moving.png")
    assert len(frames) >= 12
    assert len(set(frames)) > len(frames) / 3  # it moves; half of a period is the other half backwards
    # The dampers, with points of the drop that is chosen.
    assert page.locator("#dampers svg").count() == 2
    assert page.locator("#dampers svg path.points").count() >= 4


@pytest.mark.slow
def test_a_recording_that_is_marked_before_the_script_arrives_is_shown(user: Tabs) -> None:
    page, held = user.open("/"), list[Any]()
    page.route("**/scripts/recordings.js", lambda route: held.append(route))  # noqa: PLW0108 (playwright marks it)
    page.goto(page.url.split("?")[0].rstrip("/") + "/recordings", wait_until="commit")
    page.locator("#files input").first.check()
    held[0].continue_()
    page.locator("#chosen li").wait_for()


@pytest.mark.slow
def test_recordings_are_shown_side_by_side(user: Tabs, tmp_path: Path) -> None:
    page = user.open("/recordings")
    page.get_by_label("Search files and channels").fill("after/empty_b")
    page.get_by_role("checkbox", name="empty_bounce.csv").check()
    page.get_by_label("Search files and channels").fill("before/empty_bounce")
    page.get_by_role("checkbox", name="empty_bounce.csv").check()
    page.get_by_label("Search files and channels").fill("")
    page.get_by_role("checkbox", name="wheel_fl").check()
    page.wait_for_function(
        "() => document.querySelectorAll('#plot path.curve').length === 4"
    )  # two channels of two files
    offset = page.get_by_label("Time offset of before/empty_bounce.csv in s")
    offset.fill("0,25")
    offset.press("Tab")
    plot = page.locator("#plot")
    plot.press("+")
    plot.press("ArrowRight")
    page.wait_for_function("() => new URLSearchParams(location.search).has('low')")
    address = page.url
    assert "offset=0.25" in address
    box = plot.bounding_box()
    page.mouse.move(box["x"] + 200, box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 500, box["y"] + 60)
    page.mouse.up()
    page.wait_for_function("before => location.href !== before", arg=address)
    low, high = (float(re.search(rf"{name}=([\d.]+)", page.url)[1]) for name in ("low", "high"))  # type: ignore[index]
    with page.expect_download() as download:
        page.get_by_role("button", name="Save what is visible").click()
    download.value.save_as(tmp_path / "visible.csv")
    rows = list(csv.DictReader((tmp_path / "visible.csv").read_text(encoding="utf-8-sig").splitlines()))
    assert {row["file"] for row in rows} == {"before/empty_bounce.csv", "after/empty_bounce.csv"}
    assert all(low - 1e-6 <= float(row["time in the picture, s"]) <= high + 1e-6 for row in rows)
    own = [row for row in rows if row["file"].startswith("before")]
    assert len(own) == pytest.approx((high - low) * 500, abs=1)  # sampled at 500 Hz
    for row in own:
        assert float(row["time in the picture, s"]) == pytest.approx(float(row["time of the file, s"]) + 0.25)
    # A reload shows the same, and the search finds channels in recordings that are not shown.
    page.reload()
    page.locator("#plot[data-begun]").wait_for()
    assert plot.locator("path.curve").count() == 4
    page.get_by_label("Search files and channels").fill("wheel_rr")
    page.get_by_role("button", name="Read the channels of all").click()
    page.get_by_text("6 of 6 recordings; channels of 6 are known").wait_for()
    plot.press("0")
    page.wait_for_function("() => !new URLSearchParams(location.search).has('low')")


@pytest.mark.long
def test_every_page_fits_and_every_field_has_a_name(user: Tabs) -> None:
    for path in PAGES:
        page = user.open(path)
        if path.startswith("/motion"):
            page.locator("#dampers svg").first.wait_for()
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            for width in (390, 1920):
                page.set_viewport_size({"width": width, "height": 900})
                assert page.evaluate("document.documentElement.scrollWidth") <= width, path
            assert page.evaluate(UNNAMED) == [], path
            assert page.evaluate(FAINT) == [], path
        page.close()


UNNAMED = """() => {
  const fields = "input:not([type=hidden]), select, textarea, button, canvas, iframe, a";
  const named = (one) => one.labels?.length || one.getAttribute("aria-label") || one.title || one.textContent.trim();
  const unnamed = [...document.querySelectorAll(fields)].filter((one) => one.checkVisibility() && !named(one));
  return unnamed.map((one) => one.outerHTML);
}"""
"""Controls that a screen reader could not name."""

FAINT = """() => {
  const parse = (text) => text.match(/[\\d.]+/g).map(Number);
  const linear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  const light = ([r, g, b]) => 0.2126 * linear(r / 255) + 0.7152 * linear(g / 255) + 0.0722 * linear(b / 255);
  const ground = (one) => {
    for (; one; one = one.parentElement) {
      const colour = parse(getComputedStyle(one).backgroundColor);
      if (colour.length < 4 || colour[3] > 0) return colour;
    }
    return [255, 255, 255];
  };
  const found = new Set();
  for (const one of document.querySelectorAll("main *, header *")) {
    const texts = [...one.childNodes].some((node) => node.nodeType === 3 && node.data.trim());
    if (!texts || !one.checkVisibility() || one.disabled || one.closest("svg, noscript")) continue;
    const [a, b] = [light(parse(getComputedStyle(one).color)), light(ground(one))].sort((x, y) => y - x);
    if ((a + 0.05) / (b + 0.05) < 4.5) found.add(`${one.tagName} ${one.className}: ${one.textContent.trim().slice(0, 30)}`);
  }
  return [...found];
}"""
"""Texts whose contrast is below 4.5 to 1 (WCAG 2.2, 1.4.3)."""


def test_a_result_that_was_changed_is_refused(server: Served) -> None:
    folder = server.folder / "changed"
    shutil.copytree(server.folder / "before/results", folder)
    document = json.loads((folder / "results.json").read_text())
    document["parameters"]["k_sf"]["value"] *= 2
    (folder / "results.json").write_text(json.dumps(document))
    answer = server.ask("/report?results=changed", headers={"Accept": "text/html"})
    assert answer.status == 400
    assert "changed after it was written" in answer.text
    shutil.rmtree(folder)


@pytest.mark.parametrize(
    "path",
    ["/report?results=..", "/motion/scene?results=../..", "/motion/drop?results=before/results&drop=../x",
     "/recordings/visible?file=../../etc/passwd&low=0&high=1", "/recordings/channels?file=/etc/passwd",
     "/recordings/visible?file=before/empty_bounce.csv&low=nan&high=1", "/motion", "/export?results=before"],
)  # fmt: skip
@pytest.mark.slow
def test_nothing_outside_the_folder_is_read(server: Served, path: str) -> None:
    answer = server.ask(path)
    assert answer.status in {400, 404}
    assert "root:" not in answer.text


@pytest.mark.parametrize(
    ("path", "body", "command"),
    [
        (PAGES[2], "", "sprung validate before/campaign.toml -o before/validation"),
        (PAGES[3], "wanted=0%2C5&terms=yes", "sprung plan before/campaign.toml --wanted 0.5 --terms"),
        (PAGES[4], "to=mjcf&approximate=yes", "sprung export before/results --to mjcf --approximate --json"),
        (
            PAGES[4],
            "to=state-space&amplitude=0%2C02&number=5",
            "sprung export before/results --to state-space --amplitude 0.02 --json",
        ),
        (
            PAGES[4],
            "to=draws&number=50&table=parquet",
            "sprung export before/results -o before/results/draws.parquet --to draws --number 50 --json",
        ),
        (
            PAGES[5],
            "road=C&speed=50+72%2C5&seat=-1%2C4+0%2C4%0D%0A-1.4%2C-0.4&hours=2",
            "sprung ride before/results --road C --speed 50 --speed 72.5 --seat=-1.4,0.4 --seat=-1.4,-0.4 --hours 2",
        ),
    ],
)
def test_a_form_starts_the_command_that_it_describes(server: Served, path: str, body: str, command: str) -> None:
    headers = {"Content-Type": "application/x-www-form-urlencoded"}
    answer = server.ask(path, "POST", body.encode(), headers)
    assert answer.status == 303
    job = re.search(r"job=([\w-]+)", answer.headers["location"])
    assert job is not None
    typed = server.ask(f"/jobs/{job[1]}", headers={"Accept": "application/json"}).json["command"]
    server.ask(f"/jobs/{job[1]}/cancel", "POST", b"", {"Accept": "application/json"})
    assert shlex.split(typed.replace("--seat=", "--seat ")) == shlex.split(command.replace("--seat=", "--seat "))


def test_an_option_is_never_taken_from_a_form_as_it_is(server: Served) -> None:
    body = b"to=--force&load=--json"
    headers = {"Content-Type": "application/x-www-form-urlencoded", "Accept": "text/html"}
    answer = server.ask("/export?results=before/results", "POST", body, headers)
    assert answer.status == 400
    assert "--force" in answer.text


@pytest.mark.parametrize("state", ["reject", "doubtful"])
def test_an_export_that_can_only_fail_is_not_offered(server: Served, state: str) -> None:
    """Neither of a rejected result nor of one whose parameters are not determined; tables can be written of both."""
    stored = {"reject": "reject.json", "doubtful": "unidentifiable.json"}[state]
    folder = server.folder / f"{state} result"
    folder.mkdir()
    shutil.copy(Path(__file__).parents[1] / "report" / stored, folder / "results.json")
    page = server.ask(f"/export?results={state}%20result", headers={"Accept": "text/html"}).text
    shutil.rmtree(folder)
    offered = dict(re.findall(r'name="to" value="([\w-]+)".*?<button type="submit"( disabled)?>', page, re.DOTALL))
    assert {name for name, disabled in offered.items() if not disabled} == {"markdown", "latex"}
    assert len(offered) == 8
    note = {"reject": "The result is rejected: only the tables", "doubtful": "are not determined: only the tables"}[
        state
    ]
    assert note in page
    whole = server.ask(PAGES[4], headers={"Accept": "text/html"}).text
    assert "disabled" not in whole


def test_speeds_have_the_limits_of_the_command_and_may_be_several(server: Served) -> None:
    headers = {"Content-Type": "application/x-www-form-urlencoded", "Accept": "text/html"}
    answer = server.ask(PAGES[5], "POST", b"speed=50+541", headers)
    assert answer.status == 400
    assert "speeds from 1.8 to 540 km/h" in answer.text
    assert "Write numbers with blanks between them" in answer.text
    with pytest.raises(InputError, match=r"1\.8 to 540 km/h"):
        sprung.ride.ride_numbers(TABLE_1_CAR, speeds=(541 / 3.6,))


def test_an_address_without_a_campaign_is_refused_in_a_whole_sentence(server: Served) -> None:
    for path in ("/campaign?campaign=", "/validate?campaign=", "/plan"):
        answer = server.ask(path, headers={"Accept": "text/html"})
        assert answer.status == 400
        assert "The address names no campaign." in answer.text


def chunks_of(path: Path) -> Iterator[tuple[bytes, bytes]]:
    """Chunks of a PNG file, each with a right checksum."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at = 8
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, content = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        (checksum,) = struct.unpack(">I", data[at + 8 + length : at + 12 + length])
        assert zlib.crc32(kind + content) == checksum
        yield kind, content
        at += 12 + length


def corner_of(path: Path) -> bytes:
    """Colour of the first pixel of a PNG file."""
    pixels = zlib.decompress(b"".join(content for kind, content in chunks_of(path) if kind == b"IDAT"))
    return pixels[1:4]  # after the filter of the first line, which has nothing before it to differ from


def frames_of(path: Path) -> list[bytes]:
    """Pixels of each picture of an animated PNG file (PNG, third edition, section 11.3.6), as they are filtered."""
    frames: list[bytes] = []
    sequence = []
    number = 0
    for kind, content in chunks_of(path):
        if kind == b"acTL":
            number, repeats = struct.unpack(">II", content)
            assert repeats == 0
        elif kind == b"fcTL":
            sequence.append(struct.unpack(">I", content[:4])[0])
            frames.append(b"")
        elif kind == b"IDAT":
            frames[-1] += content
        elif kind == b"fdAT":
            sequence.append(struct.unpack(">I", content[:4])[0])
            frames[-1] += content[4:]
    assert len(frames) == number
    assert sequence == list(range(len(sequence)))
    return [zlib.decompress(frame) for frame in frames]

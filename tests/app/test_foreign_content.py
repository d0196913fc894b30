"""In a real browser: names and texts of files are never markup, and other sites reach nothing though the cookie is there."""

from __future__ import annotations

import html
import threading
from collections.abc import Iterator
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import quote

import pytest

from browser_page import chromium
from command_line import copy_sedan, run
from served import Served, served

MARK = "<img src=x onerror=document.title=1>"
QUOTES = "\"'><b class=mark>b</b><script>document.title=1</script>"
CHANNEL, VEHICLE, LOAD = f"a{MARK}", f"car {MARK}{QUOTES}", f"bags {MARK}"
FOLDER, RECORDING = f"f {MARK}", f"d {MARK}.csv"

REPORT = """<title>waits</title><script>
try { document.cookie; parent.document; } catch { document.title = 'alone'; }
fetch('/jobs').then(a => a.text()).then(t => { document.title = 'read ' + t; });
</script>"""

MARKED = (
    "document.querySelectorAll('img[src=x], b.mark, script:not([src]), [onerror], [onload], iframe[srcdoc]').length"
)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("workspace")
    car = copy_sedan(folder / FOLDER)
    (car.path / "empty_bounce.csv").rename(car.path / RECORDING)
    car.edit("wheel_rr", CHANNEL, RECORDING)
    for drop in car.path.glob("*_*.csv"):
        car.edit("wheel_rr", CHANNEL, drop.name)
    vehicle = VEHICLE.replace("\\", "\\\\").replace('"', '\\"')
    car.edit("wheel_rr", CHANNEL).edit('name = "sedan"', f'name = "{vehicle}"').edit(
        '"empty_bounce.csv"', f"'{RECORDING}'"
    )
    text = (car.path / "campaign.toml").read_text().replace('"ballast"', f"'{LOAD}'")
    (car.path / "campaign.toml").write_text(f"# {QUOTES}\n{text}")
    (folder / "wrong").mkdir()
    (folder / "wrong" / "campaign.toml").write_text(
        f"[vehicle]\nname = 3\nwheelbase = '{MARK}'\n'{MARK}' = 1\n[[sensor]]\nchannel = '{MARK}'\non = '{MARK}'\n"
    )
    (folder / "broken").mkdir()
    (folder / "broken" / "campaign.toml").write_text(f"x = {QUOTES}")
    (folder / "report.html").write_text(REPORT)
    with served(folder) as running:
        yield running


@pytest.fixture(scope="module")
def results(server: Served) -> str:
    """The name of a results folder, for an address."""
    assert run("identify", server.folder / FOLDER).status == 0
    return quote(f"{FOLDER}/results")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as opened:
        yield opened


@pytest.fixture(scope="module")
def user(browser: Any, server: Served) -> Iterator[Any]:
    """A browser in which the page was opened, with its cookie."""
    context = browser.new_context()
    page = context.new_page()
    page.goto(server.address)
    page.close()
    yield context
    context.close()


def opened(user: Any, server: Served, path: str) -> Any:
    """Open a page, and check that nothing of a file is markup in it."""
    page = user.new_page()
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("dialog", lambda dialog: complaints.append(dialog.message))
    page.goto(f"{server.origin}{path}")
    page.wait_for_timeout(100)  # of the scripts' questions
    check(page)
    assert [text for text in complaints if "Failed to load resource" not in text] == []
    return page


def check(page: Any) -> None:
    assert page.evaluate(MARKED) == 0, page.url
    assert page.title() != "1"


@pytest.mark.slow
def test_names_and_texts_of_files_are_text(user: Any, server: Served) -> None:
    campaign = quote(f"{FOLDER}/campaign.toml")
    first = opened(user, server, "/")
    assert RECORDING in first.inner_text("body")
    assert VEHICLE in first.inner_text("body")
    form = opened(user, server, f"/campaign?campaign={campaign}")
    assert form.input_value("[id='sensor.7.channel']") == CHANNEL
    assert form.locator(f"[data-channel='{CHANNEL}']").count() > 0
    form.fill("[id='vehicle.name']", f"{VEHICLE}2")  # what the script shows is no markup either
    form.locator("#diff", has_text=f"{MARK}").wait_for(state="attached")
    recording = form.locator("details.recording").first
    recording.scroll_into_view_if_needed()
    recording.locator("svg").wait_for()
    assert "a<img src=x" in recording.text_content()  # the picture cuts long names
    check(form)
    assert MARK in opened(user, server, f"/campaign?as=text&campaign={campaign}").input_value("textarea[name=text]")
    for name in ("wrong", "broken"):
        shown = opened(user, server, f"/campaign?campaign={name}/campaign.toml").content()
        assert (MARK if name == "wrong" else "<b class=mark>") in html.unescape(shown)
    for path in ("/files/", "/campaign?campaign=", "/report?results=", "/jobs/"):
        opened(user, server, path + quote(f"{MARK}{QUOTES}", safe=""))


@pytest.mark.long
def test_names_and_texts_of_files_are_text_on_every_other_page(user: Any, server: Served, results: str) -> None:
    campaign = quote(f"{FOLDER}/campaign.toml")
    page = opened(user, server, f"/check?campaign={campaign}")
    page.get_by_role("button", name="Check", exact=True).first.click()
    page.locator("iframe").wait_for(timeout=60_000)
    page.wait_for_load_state("networkidle")
    check(page)
    for path in (
        "/",
        "/jobs",
        "/compare",
        "/recordings",
        f"/validate?campaign={campaign}",
        f"/plan?campaign={campaign}",
    ):
        opened(user, server, path)
    for name in ("report", "motion", "export", "ride"):
        assert "car <img" in opened(user, server, f"/{name}?results={results}").inner_text("body")
    for path in ("/check?campaign=", "/draft?folder=", "/motion?results=", "/"):
        opened(user, server, path + quote(f"{MARK}{QUOTES}", safe=""))


def test_the_reports_of_a_folder_are_alone(user: Any, server: Served) -> None:
    """A report that somebody sent, with a script that asks the server."""
    page = user.new_page()
    page.goto(f"{server.origin}/files/report.html")
    page.wait_for_timeout(500)
    assert page.title() == "alone"
    assert page.evaluate("window.origin") == "null"


@pytest.mark.long
def test_the_report_in_its_page_is_alone(user: Any, server: Served, results: str) -> None:
    shown = opened(user, server, f"/report?results={results}")
    frame = next(frame for frame in shown.frames if "/files/" in frame.url)
    assert frame.evaluate("window.origin") == "null"
    assert frame.evaluate(MARKED.replace("script:not([src]), ", "")) == 0


ATTACK = """<!DOCTYPE html><title>attack</title>
<img id=image src="{target}/files/report.html"><img id=drawing src="{target}/styles/icon.svg">
<iframe src="{target}/"></iframe><script src="{target}/scripts/page.js" onload="document.title='ran'"></script>
<link rel=stylesheet href="{target}/styles/app.css" onload="document.title='styled'">
<form id=form method=post target=answer action="{target}/identify?campaign={campaign}"><input name=force value=yes></form>
<iframe name=answer></iframe>
<script>
document.getElementById('form').submit();
const ask = (path, options) =>
  fetch('{target}' + path, {{credentials: 'include', ...options}}).then(a => a.status, e => 'refused');
Promise.all([
  ask('/jobs'), ask('/jobs', {{mode: 'no-cors'}}),
  ask('/upload/attack.csv', {{method: 'PUT', body: 'x'}}),
  ask('/identify?campaign={campaign}', {{method: 'POST', mode: 'no-cors', body: new URLSearchParams({{force: 'yes'}})}}),
]).then(found => {{ document.body.dataset.found = JSON.stringify(found); }});
</script>"""


@pytest.fixture
def attacker(server: Served) -> Iterator[str]:
    """Another server on this machine, whose page attacks: to a browser it is the same site with another origin."""
    campaign = quote(f"{FOLDER}/campaign.toml")
    body = ATTACK.format(target=server.origin, campaign=campaign).encode()

    class Page(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            pass

    other = ThreadingHTTPServer(("127.0.0.1", 0), Page)
    thread = threading.Thread(target=partial(other.serve_forever, 0.05))
    thread.start()
    yield str(other.server_address[1])
    other.shutdown()
    thread.join()
    other.server_close()


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost"])
def test_a_page_of_another_server_reaches_nothing(user: Any, server: Served, attacker: str, host: str) -> None:
    before = server.ask("/jobs").json
    page = user.new_page()
    sent: list[str] = []
    answers: list[tuple[str, int]] = []
    page.on("request", lambda request: sent.append(request.url))
    page.on("response", lambda answer: answers.append((answer.url, answer.status)))
    page.goto(f"http://{host}:{attacker}/")
    page.wait_for_function("() => document.body.dataset.found")
    page.wait_for_load_state("networkidle")
    assert page.evaluate("document.body.dataset.found") == '["refused","refused","refused","refused"]'
    assert page.title() == "attack"
    assert (
        page.evaluate("document.getElementById('image').naturalWidth + document.getElementById('drawing').naturalWidth")
        == 0
    )
    assert len([url for url in sent if url.startswith(server.origin)]) >= 10
    assert {status for url, status in answers if url.startswith(server.origin)} == {403}  # or none that it may read
    assert server.ask("/jobs").json == before
    assert not (server.folder / "attack.csv").exists()


def test_the_printed_address_opens_from_a_link_of_another_page(browser: Any, server: Served) -> None:
    """As in a terminal that is itself a page: a redirection would be followed without the new, strict cookie."""
    context = browser.new_context()
    page = context.new_page()
    page.set_content(f'<a href="{server.address}">open</a>')
    page.get_by_text("open").click()
    page.wait_for_url(f"{server.origin}/")
    page.get_by_role("heading", name="Campaigns").wait_for()
    context.close()

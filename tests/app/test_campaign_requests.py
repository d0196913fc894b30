"""The page of a campaign by plain requests: shown, saved, refused; and what is wrong with a request."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import pytest

from raw_recordings import write_recordings
from served import Answer, Served, served

PAGE = "/campaign?campaign=car/campaign.toml"
TEXT = """[vehicle]
name = "<b>&amp;"            # "quoted"
wheelbase = 2.55\t# tape
[[sensor]]
channel = "body_fl"
on = "body"
position = [0.10, 0.58, 0.50]
[[drop]]
file = "empty_bounce.csv"
wheels = ["fl", "fr", "rl", "rr"]
[[drop]]
file = "../../elsewhere.csv"
"""


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    place = tmp_path_factory.mktemp("place")
    (place / "elsewhere.csv").write_text("secret")
    write_recordings(place / "work" / "car", ("empty",))
    with served(place / "work") as started:
        yield started


@pytest.fixture
def file(server: Served) -> Path:
    path = server.folder / "car" / "campaign.toml"
    path.write_bytes(TEXT.replace("\n", "\r\n").encode())
    return path


def sent(server: Served, path: str = PAGE, accept: str = "text/html", **fields: Any) -> Answer:
    """Send the form as it was shown, with some fields changed or added."""
    page = server.ask(path.replace("/live?", "?").replace("/drop?", "?").removesuffix("&as=text")).text
    form: dict[str, Any] = {name: json.dumps(carried(page, name)) for name in ("base", "original")}
    form["version"] = re.search(r'name="version" value="(\w*)"', page)[1]  # type: ignore[index]
    form |= {name.replace("__", "."): value for name, value in fields.items()}
    headers = {"Content-Type": "application/x-www-form-urlencoded", "Accept": accept}
    return server.ask(path, "POST", urlencode(form, doseq=True).encode(), headers)


def carried(page: str, name: str) -> str:
    import html  # noqa: PLC0415

    found = re.search(rf'name="{name}" value="([^"]*)"', page)
    assert found is not None
    text = json.loads(html.unescape(found[1]))
    assert isinstance(text, str)
    return text


@pytest.mark.slow
def test_names_are_no_markup_and_the_file_is_carried_byte_by_byte(server: Served, file: Path) -> None:
    page = server.ask(PAGE).text
    assert "<b>" not in page
    assert 'value="&lt;b&gt;&amp;amp;"' in page
    assert carried(page, "base").encode() == file.read_bytes()
    assert "../../elsewhere.csv leads out of the folder work" in page
    check = server.ask("/check?campaign=car/campaign.toml")
    assert (check.status, "leads out of the folder" in check.text) == (404, True)


def test_only_what_was_entered_is_written(server: Served, file: Path) -> None:
    entered = {"vehicle.wheelbase.value": "2,6", "vehicle.wheelbase.std": "", "sensor.0.unit": "g"}
    answer = sent(server, action="save", **{name.replace(".", "__"): value for name, value in entered.items()})
    assert answer.status == 303
    expected = TEXT.replace("2.55", "2.6").replace("0.50]\n", '0.50]\nunit     = "g"\n')
    assert file.read_bytes() == expected.replace("\n", "\r\n").encode()


def test_a_file_that_changed_meanwhile_is_not_overwritten(server: Served, file: Path) -> None:
    server.ask(PAGE)
    answer = sent(server, action="save", version="0" * 64, vehicle__name="Other")
    assert answer.status == 409
    assert "was changed meanwhile" in answer.text
    assert "Other" in answer.text
    assert file.read_bytes() == TEXT.replace("\n", "\r\n").encode()


def test_what_is_not_understood_is_not_saved(server: Served, file: Path) -> None:
    answer = sent(server, action="save", vehicle__wheelbase__value="two", vehicle__wheelbase__std="", vehicle__name="x")
    assert answer.status == 400
    assert "Nothing was saved" in answer.text
    assert "Found &#39;two&#39;; expected a number such as 2.55 or 2,55." in answer.text
    assert file.read_bytes() == TEXT.replace("\n", "\r\n").encode()


def test_problems_are_answered_without_saving(server: Served, file: Path) -> None:
    answer = sent(server, PAGE.replace("?", "/live?"), vehicle__wheelbase__value="255", vehicle__wheelbase__std="")
    found = answer.json
    assert found["fields"]["vehicle.wheelbase"]["problems"][0].startswith("Found 255; expected")
    assert found["diff"][1:] == [
        ' name = "<b>&amp;"            # "quoted"',
        "-wheelbase = 2.55\t# tape",
        "+wheelbase = 255\t# tape",
        " [[sensor]]",
    ]
    assert 'data-channel="body_fl"' in found["sketch"]["drawings"][0]["svg"]
    assert file.read_bytes() == TEXT.replace("\n", "\r\n").encode()


@pytest.mark.usefixtures("file")
@pytest.mark.slow
def test_a_recording_is_drawn_and_one_elsewhere_is_not_read(server: Served) -> None:
    found = sent(server, f"{PAGE.replace('?', '/drop?')}&drop=0").json
    assert found["svg"].startswith("<svg")
    # `sprung simulate` releases 0.4 s after the start; one body sensor does not show the landing.
    assert found["times"]["release"] == pytest.approx(0.4, abs=0.005)
    assert found["limits"] == pytest.approx([0, 3.596])
    frame = found["frame"]
    assert (frame["low"], frame["high"]) == pytest.approx((0, 3.596))
    outside = sent(server, f"{PAGE.replace('?', '/drop?')}&drop=1")
    assert outside.status == 400
    assert "which lies elsewhere" in outside.text
    assert "secret" not in outside.text
    for index in ("9", "-1", "x", "²"):
        assert sent(server, f"{PAGE.replace('?', '/drop?')}&{urlencode({'drop': index})}").status == 400


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("/campaign", 400),
        ("/campaign?campaign=none.toml", 404),
        ("/campaign?campaign=../elsewhere.toml", 404),
        ("/campaign?campaign=car/empty_bounce.csv", 400),
        ("/campaign?campaign=car", 400),
        ("/check?campaign=../x.toml", 404),
        ("/identify?campaign=/etc/passwd", 404),
        ("/draft?folder=..", 404),
        ("/plan?campaign=../x.toml", 404),
        ("/plan?campaign=none.toml", 404),
        ("/plan?campaign=car/empty_bounce.csv", 400),
        ("/validate?campaign=none.toml", 404),
        ("/validate?campaign=car/empty_bounce.csv", 400),
    ],
)
def test_other_addresses(server: Served, path: str, status: int) -> None:
    assert server.ask(path, headers={"Accept": "text/html"}).status == status


def test_a_script_saves_without_another_page(server: Served, file: Path) -> None:
    entered = {"vehicle__wheelbase__value": "2,6", "vehicle__wheelbase__std": ""}
    answer = sent(server, accept="application/json", action="save", **entered)
    assert (answer.status, answer.json["saved"]) == (200, True)
    assert answer.json["text"].encode() == file.read_bytes()
    again = sent(server, accept="application/json", action="save", version=answer.json["version"], vehicle__name="x")
    assert again.json["saved"]
    # Everything else has a page that the browser asks for; nothing is saved.
    saved = file.read_bytes()
    for changes in ({"action": "add sensor"}, {"version": "0" * 64}, {"vehicle__wheelbase__value": "two"}):
        assert sent(server, accept="application/json", **{**entered, **changes}).json == {"saved": False}
    assert file.read_bytes() == saved


def test_the_form_remains_where_saving_fails(server: Served) -> None:
    name = "c" * 240 + ".toml"  # beside which no temporary file can be made
    (server.folder / "car" / name).write_text(TEXT)
    page = f"/campaign?campaign=car/{name}"
    answer = sent(server, page, action="save", vehicle__name="entered")
    assert answer.status == 400
    assert "a place that cannot be written to" in answer.text
    assert 'value="entered"' in answer.text
    answer = sent(server, f"{page}&as=text", action="save", text="# entered")
    assert answer.status == 400
    assert "a place that cannot be written to" in answer.text
    assert "# entered</textarea>" in answer.text
    answer = sent(server, page, accept="application/json", action="save", vehicle__name="entered")
    assert (answer.status, "a place that cannot be written to" in answer.text) == (400, True)


@pytest.mark.usefixtures("file")
def test_a_quantity_is_added_without_a_script(server: Served) -> None:
    answer = sent(server, action="add known", quantity="k_sf")
    assert answer.status == 200
    assert 'name="known.k_sf.value"' in answer.text


@pytest.mark.usefixtures("file")
@pytest.mark.parametrize(
    ("action", "focus"),
    [
        ("remove sensor.0", 'id="add-sensor" autofocus'),
        ("remove vehicle.wheelbase", 'invalid="false" autofocus'),
        ("add drop", 'id="drop.2.file" name="drop.2.file" value="" aria-describedby="problem-drop.2.file" '),
    ],
)
def test_the_focus_stays_where_something_was_removed_or_added(server: Served, action: str, focus: str) -> None:
    page = sent(server, action=action).text
    assert focus in page
    assert page.count(" autofocus") == 1


def test_what_was_changed_meanwhile_is_not_lost_without_a_word(server: Served, file: Path) -> None:
    mine = sent(server, action="save", version="0" * 64, vehicle__name="Other").text
    assert '<button type="submit" name="action" value="as form" class="main">' in mine
    page = sent(server, action="as form", text=TEXT, meanwhile="yes").text
    assert "Saving replaces that version" in page
    assert file.read_bytes() == TEXT.replace("\n", "\r\n").encode()


def test_what_is_missing_in_a_file_that_cannot_be_read_is_not_known(server: Served, file: Path) -> None:
    file.write_text("[[drop")
    assert "nothing is missing" not in server.ask(PAGE).text
    assert "What is missing in it is known once" in server.ask(PAGE).text
    file.write_text(TEXT)
    found = sent(server, PAGE.replace("?", "/live?"), text="[[drop").json
    assert "nothing is missing" not in found["state"]


@pytest.mark.parametrize("field", ["base", "original"])
@pytest.mark.parametrize("text", ["{", "3", "[]", "nan"])
def test_a_form_that_was_tampered_with_is_refused(server: Served, file: Path, field: str, text: str) -> None:
    assert sent(server, action="save", **{field: text}).status == 400
    assert file.read_bytes() == TEXT.replace("\n", "\r\n").encode()


def test_a_campaign_as_deep_as_python_permits(server: Served, file: Path) -> None:
    file.write_text("x = " + "[" * 5000 + "]" * 5000)
    assert server.ask(PAGE, headers={"Accept": "text/html"}).status in {200, 400}
    assert server.ask("/").status == 200

"""The first page: campaigns, recordings and results of a folder, without opening a recording; drafts as jobs."""

from __future__ import annotations

import json
import os
from pathlib import Path
from urllib.parse import quote

import pytest

from raw_recordings import write_recordings
from served import Served, served, wait_for
from sprung.app.folder_content import folder_content
from sprung.app.jobs import Job, Jobs
from sprung.app.pages.identification import check_output
from sprung.app.result_files import default_results, results_folders
from sprung.app.workspace import Workspace
from sprung.errors import InputError

DRAFT = '[vehicle]\nname = "Van"\nwheelbase = "TODO: m"\n[known]\ntotal_mass = "TODO: kg"\n[[drop]]\nfile = "a.csv"\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("van/a.csv", "van/deep/b.mf4", "van/deep/notes.md", "other/c.csv", "van/results/series.npz"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("0")
    (tmp_path / "van" / "campaign.toml").write_text(DRAFT)
    (tmp_path / "van" / "results" / "results.json").write_text(
        json.dumps({"vehicle": {"name": "Van"}, "verdict": {"state": "accept"}})
    )
    (tmp_path / "car.toml").write_text("[parameters]\nm_s = 1\n")
    (tmp_path / "pyproject.toml").write_text("[project]\nname = 'x'\n")
    (tmp_path / "broken.toml").write_text("[[drop")
    return tmp_path


def test_what_is_in_a_folder(folder: Path) -> None:
    content = folder_content(Workspace(folder))
    campaigns = {entry.name: (entry.vehicle, entry.drops, entry.gaps, bool(entry.fault)) for entry in content.campaigns}
    # A vehicle file and other programs' files are no campaigns; a file that is no TOML may be one.
    assert campaigns == {"van/campaign.toml": ("Van", 1, 2, False), "broken.toml": ("", 0, 0, True)}
    found = {group.name: ([file.name for file in group.files], group.campaign) for group in content.recordings}
    assert found == {
        "other": (["other/c.csv"], "broken.toml"),
        "van": (["van/a.csv"], "van/campaign.toml"),
        "van/deep": (["van/deep/b.mf4"], "van/campaign.toml"),
    }
    assert [(result.name, result.vehicle, result.verdict) for result in content.results] == [
        ("van/results", "Van", "accept")
    ]
    assert content.folders == ("", "other", "van", "van/deep")
    own = next(entry for entry in content.campaigns if entry.name == "van/campaign.toml")
    assert own.results == content.results[0]


def test_a_result_belongs_to_the_campaign_that_it_was_made_from(folder: Path) -> None:
    workspace = Workspace(folder)
    (folder / "van" / "campaign.toml").rename(folder / "van" / "summer.toml")
    (folder / "van" / "winter.toml").write_text(DRAFT)
    write_result(folder / "van" / "results", "summer.toml", "accept")
    own = {entry.name: entry.results and entry.results.name for entry in folder_content(workspace).campaigns}
    assert own == {"van/summer.toml": "van/results", "van/winter.toml": None, "broken.toml": None}
    assert default_results(workspace, "van/summer.toml") == "van/results"
    assert default_results(workspace, "van/winter.toml") == "van/results-winter"
    # Also one that lies elsewhere below the folder of its campaign file.
    write_result(folder / "van" / "deep" / "trial", "winter.toml", "reject")
    own = {entry.name: entry.results and entry.results.name for entry in folder_content(workspace).campaigns}
    assert own["van/winter.toml"] == "van/deep/trial"
    assert {one.name: one.campaign for one in results_folders(workspace)} == {
        "van/results": "van/summer.toml",
        "van/deep/trial": "van/winter.toml",
    }
    (folder / "van" / "winter.toml").unlink()
    assert [result.campaign for result in folder_content(workspace).results] == ["", "van/summer.toml"]


def write_result(folder: Path, campaign: str, verdict: str) -> None:
    """Write what the folder's page reads of a result."""
    folder.mkdir(exist_ok=True)
    document = {"setup": {"files": [{"name": campaign}]}, "vehicle": {"name": "Van"}, "verdict": {"state": verdict}}
    (folder / "results.json").write_text(json.dumps(document))


def test_a_results_folder_that_cannot_be_used_is_said_at_its_field(folder: Path) -> None:
    """Neither outside, nor among other files, nor where another identification writes."""
    workspace, jobs = Workspace(folder), Jobs()
    (folder / "van" / "campaign.toml").write_text("[vehicle]\n")
    for name in ("../x", "/abs/x", "van/.x", "van/deep", "van/a.csv", "van/check"):
        with pytest.raises(InputError, match=r"^Results folder: found"):
            check_output(workspace, jobs, "van/campaign.toml", name)
    for name in ("van/results", "van/new", "van/results zwei/ü"):
        check_output(workspace, jobs, "van/campaign.toml", name)
    jobs._jobs["1"] = Job("1", "Identify other", ("identify", "broken.toml", "-o", "van/new"), folder, "running")
    with pytest.raises(InputError, match="“Identify other” writes"):
        check_output(workspace, jobs, "van/campaign.toml", "van/new")
    check_output(workspace, jobs, "broken.toml", "van/new")  # the same one: its page is shown


@pytest.mark.parametrize("text", ["{", "[]", '{"verdict": 3}', '{"vehicle": {"name": {}}}', "\x00", "[" * 50_000])
def test_results_that_cannot_be_read_are_listed_all_the_same(folder: Path, text: str) -> None:
    (folder / "van" / "results" / "results.json").write_text(text)
    (entry,) = folder_content(Workspace(folder)).results
    assert (entry.name, entry.verdict) == ("van/results", "")


def test_names_are_no_markup(folder: Path) -> None:
    name = "<img src=x onerror=alert(1)>&amp;.csv"
    try:
        (folder / name).write_text("0")
    except OSError:
        pytest.skip("needs a file system that permits such names")
    (folder / "van" / "campaign.toml").write_text(DRAFT.replace("Van", "<script>alert(1)</script>"))
    with served(folder) as server:
        page = server.ask("/").text
    assert "<script>alert" not in page
    assert "<img" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page


@pytest.mark.slow
def test_three_hundred_recordings_are_seen_at_once(tmp_path: Path) -> None:
    """300 recordings of 8 channels, and a campaign of all of them; benchmarks/local_page.py measures how soon."""
    first = write_recordings(tmp_path / "first", ("empty",))[0].read_bytes()
    for number in range(300):
        (tmp_path / f"drop_{number:03}.csv").write_bytes(first)
    sections = "".join(f'[[drop]]\nfile = "drop_{number:03}.csv"\nwheels = ["fl"]\n' for number in range(300))
    (tmp_path / "campaign.toml").write_text(DRAFT.replace('[[drop]]\nfile = "a.csv"\n', sections))
    with served(tmp_path) as server:
        page = server.ask("/").text
        assert "300 recordings" in page
        assert page.count('data-name="drop_') == 300
        assert server.memory() < 120
        campaign = server.ask("/campaign?campaign=campaign.toml")
        assert campaign.status == 200
        assert campaign.text.count('class="entry-group drop"') == 300


@pytest.mark.slow
def test_a_draft_is_a_job_that_writes_the_campaign(tmp_path: Path) -> None:
    write_recordings(tmp_path / "measured <1>" if os.name != "nt" else tmp_path / "measured 1", ("empty",))
    (inside,) = tmp_path.iterdir()
    inside = inside.rename(tmp_path / "measured 1")
    with served(tmp_path) as server:
        answer = post(server, "/draft", folder="measured 1", settings="yes")
        assert answer.startswith("/draft?folder=measured+1&job=")
        job = answer.rpartition("=")[2]
        wait_for(lambda: server.ask(f"/jobs/{job}", headers={"Accept": "application/json"}).json["state"] == "done", 60)
        page = server.ask(answer).text
        assert 'href="/campaign?campaign=measured%201/campaign.toml"' in page
        assert "sprung new &#39;measured 1&#39;" in page
        campaign = inside / "campaign.toml"
        campaign.write_text(campaign.read_text() + "# mine\n")
        answer = post(server, "/draft", folder="measured 1", settings="yes")
        job = answer.rpartition("=")[2]
        wait_for(
            lambda: server.ask(f"/jobs/{job}", headers={"Accept": "application/json"}).json["state"] == "failed", 60
        )
        page = server.ask(answer).text
        assert "a folder that has none yet" in page
        assert 'name="force"' in page
        assert campaign.read_text().endswith("# mine\n")
        answer = post(server, "/draft", folder="measured 1", settings="yes", force="yes")
        job = answer.rpartition("=")[2]
        wait_for(lambda: server.ask(f"/jobs/{job}", headers={"Accept": "application/json"}).json["state"] == "done", 60)
        assert "# mine" not in campaign.read_text()


def post(server: Served, path: str, **fields: str) -> str:
    """Send a form, and return the address to which the answer leads."""
    body = "&".join(f"{name}={quote(value)}" for name, value in fields.items()).encode()
    headers = {"Content-Type": "application/x-www-form-urlencoded", "Accept": "text/html"}
    answer = server.ask(path, "POST", body, headers)
    assert answer.status == 303, answer.text
    return answer.headers["location"]

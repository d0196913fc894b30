"""Killed at any moment: files of the user are whole, no process goes on, and the next start goes on from there."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import pytest

import sprung
from command_line import copy_sedan
from served import SOURCE, Served, connect, processes_in, served, start, wait_for

WRITER = """
import sys
from sprung.app.workspace import Workspace
workspace = Workspace(sys.argv[1])
texts = [letter * 400_000 for letter in "ab"]
for number in range(10**9):
    workspace.write_text("campaign.toml", texts[number % 2], workspace.read_text("campaign.toml")[1])
    print(number, flush=True)
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    copy_sedan(tmp_path / "car")
    return tmp_path


def identify(server: Served) -> str:
    """Press the button, and return the job."""
    form = {"Content-Type": "application/x-www-form-urlencoded"}
    sent = server.ask("/identify?campaign=car/campaign.toml", "POST", b"force=yes", form)
    assert sent.status == 303, sent.text
    return parse_qs(urlsplit(sent.headers["location"]).query)["job"][0]


def whole(results: Path) -> bool:
    """Whether there is no result, or one that can be read."""
    return not (results / "results.json").exists() or sprung.load(results).verdict.state == "accept"


def state_at_the_end(server: Served, job: str) -> str:
    wait_for(lambda: server.ask(f"/jobs/{job}").json["state"] not in {"waiting", "running"}, 60)
    return str(server.ask(f"/jobs/{job}").json["state"])


@pytest.mark.parametrize(
    "after", [0.3, 1.5, pytest.param(2.5, marks=pytest.mark.long), pytest.param(4, marks=pytest.mark.long)]
)
@pytest.mark.slow
def test_a_killed_server_takes_its_jobs_with_it_and_the_next_one_goes_on(folder: Path, after: float) -> None:
    before = {path.name: path.read_bytes() for path in (folder / "car").iterdir()}
    process = start(folder)
    server = connect(folder, process)
    identify(server)
    wait_for(lambda: processes_in(folder))
    time.sleep(after)
    process.kill()
    process.communicate()
    wait_for(lambda: not processes_in(folder), 10)
    assert {path.name: path.read_bytes() for path in (folder / "car").iterdir() if path.name in before} == before
    assert whole(folder / "car" / "results")
    if after != 0.3:
        return
    with served(folder) as again:
        assert again.ask("/jobs").json == []
        assert state_at_the_end(again, identify(again)) == "done"
    assert whole(folder / "car" / "results")
    assert (folder / "car" / "results" / "report.html").exists()
    assert not [path for path in folder.rglob(".*") if path.name != ".sprung-files.json"]


@pytest.mark.slow
def test_a_killed_worker_is_reported_and_the_job_can_be_started_again(folder: Path) -> None:
    with served(folder) as server:
        job = identify(server)
        (worker,) = wait_for(lambda: processes_in(folder))
        time.sleep(1)
        os.kill(worker, signal.SIGKILL)
        wait_for(lambda: server.ask(f"/jobs/{job}").json["state"] == "failed")
        assert "ended from outside (signal 9)" in server.ask(f"/jobs/{job}").json["messages"]
        assert whole(folder / "car" / "results")
        again = identify(server)
        assert again != job
        wait_for(lambda: server.ask(f"/jobs/{again}").json["state"] == "running")


@pytest.mark.slow
def test_a_text_is_whole_whenever_its_writer_is_killed(tmp_path: Path) -> None:
    wait = random.Random(3)  # noqa: S311 (moments)
    for _ in range(10):
        command = [sys.executable, "-c", WRITER, str(tmp_path)]
        environment = {**os.environ, "PYTHONPATH": str(SOURCE)}
        writer = subprocess.Popen(command, stdout=subprocess.PIPE, env=environment, text=True)  # noqa: S603
        assert writer.stdout is not None
        assert writer.stdout.readline().strip() == "0"
        time.sleep(wait.uniform(0, 0.1))
        writer.kill()
        writer.communicate()
        assert (tmp_path / "campaign.toml").read_text() in {"a" * 400_000, "b" * 400_000}
    with served(tmp_path):
        assert [path.name for path in tmp_path.iterdir()] == ["campaign.toml"]

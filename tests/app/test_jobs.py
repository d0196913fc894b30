"""Jobs are commands of sprung in processes of their own: two at a time, followed, cancelled, limited."""

from __future__ import annotations

import asyncio
import json
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from command_line import copy_sedan, run
from served import memory_of, processes_in, served, wait_for
from sprung.app import jobs as module
from sprung.app.events import _states as stream_states
from sprung.app.job_process import LEAST
from sprung.app.jobs import Job, Jobs, TooManyJobsError
from zip_bomb import write_zip_bomb


@pytest.fixture
def jobs() -> Iterator[Jobs]:
    running = Jobs()
    yield running
    running.close()


def ended(jobs: Jobs, job: Job, limit: float = 60.0) -> Job:
    wait_for(lambda: jobs.get(job.id).is_over, limit)
    return jobs.get(job.id)


@pytest.mark.slow
def test_a_job_does_what_the_command_does(jobs: Jobs, tmp_path: Path) -> None:
    copy_sedan(tmp_path / "car")
    job = ended(jobs, jobs.start(("check", "car", "--json"), tmp_path, "Check"))
    assert (job.state, job.status, job.messages) == ("done", 0, "")
    said = run("check", tmp_path / "car", "--json").json
    assert {**json.loads(job.output), "page": None} == {**said, "page": None}
    assert job.steps[0].text == "reading the recordings"
    assert [(step.step, step.of) for step in job.steps if step.text.endswith(".csv")][:2] == [(1, 4), (2, 4)]
    assert job.document()["elapsed"] > 0


@pytest.mark.slow
def test_a_job_that_fails_says_what_the_command_says(jobs: Jobs, tmp_path: Path) -> None:
    job = ended(jobs, jobs.start(("check", "nothing"), tmp_path, "Check"))
    assert (job.state, job.status, job.output) == ("failed", 2, "")
    assert "nothing: found no such file; expected a campaign file" in job.messages
    assert "progress" not in job.messages


@pytest.mark.slow
def test_a_module_in_the_folder_of_recordings_is_not_imported(jobs: Jobs, tmp_path: Path) -> None:
    """With ``python -m`` alone the working folder is the first place where modules are looked for."""
    for name in ("numpy", "json", "sprung", "sitecustomize"):
        (tmp_path / f"{name}.py").write_text(f"open('imported-{name}', 'w')\n")
    assert "found no such file" in ended(jobs, jobs.start(("check", "nothing"), tmp_path, "Check")).messages
    assert list(tmp_path.glob("imported-*")) == []


def test_the_same_command_is_not_started_twice(jobs: Jobs, tmp_path: Path) -> None:
    first = jobs.start(("study", "x"), tmp_path, "A")
    assert jobs.start(("study", "x"), tmp_path, "A").id == first.id
    assert jobs.start(("study", "y"), tmp_path, "A").id != first.id


def test_two_run_and_others_wait_and_are_cancelled(jobs: Jobs, tmp_path: Path) -> None:
    copy_sedan(tmp_path / "car")
    started = [jobs.start(("validate", "car", "-o", name), tmp_path, name) for name in ("a", "b", "c")]
    wait_for(lambda: len(processes_in(tmp_path)) == 2)
    assert [jobs.get(job.id).state for job in started] == ["running", "running", "waiting"]
    for job in reversed(started):
        assert jobs.cancel(job.id).state == "cancelled"
    wait_for(lambda: not processes_in(tmp_path))
    assert [jobs.get(job.id).status for job in started] == [None] * 3
    assert jobs.cancel(started[0].id) == jobs.get(started[0].id)
    assert [path.name for path in tmp_path.iterdir()] == ["car"]  # nothing was written


def test_too_many_are_refused(jobs: Jobs, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "WAITING", 3)
    for number in range(3):
        jobs.start(("check", str(number)), tmp_path, "")
    with pytest.raises(TooManyJobsError, match="3 jobs"):
        jobs.start(("check", "3"), tmp_path, "")


def test_a_process_that_does_not_end_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_GRACE", 0.3)
    script = "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); print(1, flush=True); time.sleep(60)"
    command = [sys.executable, "-c", script]
    stubborn = subprocess.Popen(command, stdout=subprocess.PIPE, start_new_session=True)  # noqa: S603
    assert stubborn.stdout is not None
    stubborn.stdout.readline()
    module._stop(stubborn)
    assert stubborn.wait(5) < 0
    stubborn.stdout.close()


def test_closing_ends_everything(tmp_path: Path) -> None:
    copy_sedan(tmp_path / "car")
    jobs = Jobs()
    job = jobs.start(("validate", "car"), tmp_path, "")
    wait_for(lambda: processes_in(tmp_path))
    jobs.close()
    assert processes_in(tmp_path) == []
    assert jobs.get(job.id).state == "cancelled"
    with pytest.raises(TooManyJobsError):
        jobs.start(("check", "car"), tmp_path, "")


@pytest.mark.slow
def test_a_process_has_a_limit_of_memory(tmp_path: Path) -> None:
    """A WAV file of 3 GB, of holes only, of which half of the samples would be 6 GB of numbers."""
    size, path = 3_000_000_000, tmp_path / "x.wav"
    head = struct.pack("<4sI8sIHHIIHH4sI", b"RIFF", 36 + size, b"WAVEfmt ", 16, 1, 2, 1000, 4000, 4, 16, b"data", size)
    with path.open("wb") as file:
        file.write(head)
        file.truncate(44 + size)
    jobs = Jobs(memory=LEAST)
    job = ended(jobs, jobs.start(("check", "."), tmp_path, "Check"))
    jobs.close()
    assert (job.state, job.status) == ("failed", 2)
    assert "x.wav: found content for which the memory is not sufficient" in job.messages


@pytest.mark.slow
def test_a_zip_bomb_is_refused_in_little_memory(jobs: Jobs, tmp_path: Path) -> None:
    write_zip_bomb(tmp_path / "x.xlsx", 300)
    job = jobs.start(("check", ".", "--no-page"), tmp_path, "Check")
    largest = 0.0
    while not jobs.get(job.id).is_over:
        for process in processes_in(tmp_path):
            with suppress(OSError):
                largest = max(largest, memory_of(process))
        time.sleep(0.02)
    job = jobs.get(job.id)
    assert (job.state, job.status) == ("failed", 2)
    assert "that unpack to 307" in job.messages
    assert 20 < largest < 400


def states(jobs: Jobs, last: int, wanted: str | None, most: int) -> list[tuple[int, dict[str, object]]]:
    """Follow the stream of events to its end, or to the greatest number of states."""

    async def follow() -> list[tuple[int, dict[str, object]]]:
        found = []
        async for text in stream_states(jobs, last, wanted):
            if "event: job" in text:
                number, _, content = text.splitlines()[:3]
                found.append((int(number.rpartition("-")[2]), json.loads(content.removeprefix("data: "))))
            if len(found) == most:
                break
        return found

    return asyncio.run(asyncio.wait_for(follow(), 60))


@pytest.mark.slow
def test_a_stream_has_every_state_and_goes_on_after_an_interruption(jobs: Jobs, tmp_path: Path) -> None:
    copy_sedan(tmp_path / "car")
    job = jobs.start(("check", "car"), tmp_path, "Check")
    first = states(jobs, 0, job.id, 2)
    rest = states(jobs, first[-1][0], job.id, 10_000)
    numbers = [number for number, _ in first + rest]
    assert numbers == sorted(set(numbers))
    assert first[0][1]["state"] in {"waiting", "running"}
    assert {state["id"] for _, state in first + rest} == {job.id}
    assert rest[-1][1]["state"] == "done"
    assert jobs.get(job.id).is_over
    again = states(jobs, 0, job.id, 10_000)  # a page that was loaded anew
    assert [state for _, state in again] == [jobs.get(job.id).document()]


def test_a_stream_ends_with_the_server(jobs: Jobs) -> None:
    threading.Timer(0.5, jobs.refuse_more).start()
    begun = time.monotonic()
    assert states(jobs, 0, None, 1) == []
    assert time.monotonic() - begun < 5


def test_the_page_asks_about_jobs(tmp_path: Path) -> None:
    with served(tmp_path) as server:
        assert server.ask("/jobs").json == []
        assert "Nothing has been started" in server.ask("/jobs", headers={"Accept": "text/html"}).text
        assert server.ask("/events?job=none").status == 204
        assert server.ask("/jobs/none").status == 404
        assert server.ask("/jobs/none/cancel", "POST", b"").status == 404

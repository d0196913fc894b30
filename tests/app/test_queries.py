"""Processes that answer short questions: answers, errors, a process that is killed, one whose server is gone."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from sprung.app.queries import Queries, QueryError
from sprung.app.query_process import answer
from sprung.errors import InputError

TEXT = '[vehicle]\nname = "a"\nwheelbase = 2.5\n[[sensor]]\nchannel = "b"\non = "body"\nposition = [0.1, 0.6, 0.5]\n'


@pytest.fixture(scope="module")
def queries() -> Iterator[Queries]:
    started = Queries()
    yield started
    started.close()


def ask(queries: Queries, question: str, **arguments: object) -> object:
    return asyncio.run(queries.ask("form", question, **arguments))


@pytest.mark.slow
def test_a_form_is_answered_and_errors_come_back(queries: Queries, tmp_path: Path) -> None:
    path = str(tmp_path / "campaign.toml")
    found = ask(queries, "form_view:form_view", path=path, text=TEXT, entered={"vehicle.wheelbase.value": ["2,6"]})
    assert isinstance(found, dict)
    assert "wheelbase = {" not in found["text"]  # the standard uncertainty was not in the form: the field is unchanged
    entered = {"vehicle.wheelbase.value": ["2,6"], "vehicle.wheelbase.std": [""]}
    found = ask(queries, "form_view:form_view", path=path, text=TEXT, entered=entered)
    assert isinstance(found, dict)
    assert found["text"] == TEXT.replace("2.5", "2.6")
    assert 'data-channel="b"' in found["sketch"]["drawings"][0]["svg"]
    with pytest.raises(InputError, match="line 1, column 5"):
        ask(queries, "form_view:form_view", path=path, text="x = ")
    with pytest.raises(QueryError, match="defect"):
        ask(queries, "form_view:form_view", path=path)


@pytest.mark.slow
def test_a_process_that_was_killed_is_started_again(queries: Queries) -> None:
    lane = queries._lanes["form"]
    ask(queries, "form_view:ready")
    assert lane._process is not None
    lane._process.send_signal(signal.SIGKILL)
    lane._process.wait()
    assert ask(queries, "form_view:ready") is True


def test_it_ends_with_the_server_in_the_middle_of_a_question() -> None:
    """A server that is killed closes the pipe; nothing else tells its processes."""
    process = subprocess.Popen(
        [sys.executable, "-m", "sprung.app.query_process"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=os.environ,
    )
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(json.dumps({"question": "form_view:ready", "arguments": {}}).encode() + b"\n")
    process.stdin.close()
    begun = time.monotonic()
    process.wait(20)
    process.stdout.close()
    assert time.monotonic() - begun < 20


def test_only_functions_of_the_room_are_asked() -> None:
    assert "defect" in answer({"question": "nothing:at_all", "arguments": {}})
    assert "defect" in answer({"question": "form_view:nothing", "arguments": {}})

"""A recording of 500 MB: listed at once, drawn in a process of its own, while the server remains small and answers."""

from __future__ import annotations

import json
import threading
import time
from pathlib import Path
from urllib.parse import urlencode

import pytest

from raw_recordings import write_recordings
from served import served

SIZE = 500_000_000
TEXT = """[vehicle]
name = "long"
[[sensor]]
channel = "body_fl"
on = "body"
[[sensor]]
channel = "body_fr"
on = "body"
[[sensor]]
channel = "body_rl"
on = "body"
[[drop]]
file = "long.csv"
window = [100, 104]
"""


def write_long(folder: Path) -> None:
    """Write one drop again and again, 3.6 s each, until the file is large enough."""
    first = write_recordings(folder / "first", ("empty",))[0]
    head, *rows = first.read_text().splitlines()
    rests = [row.partition(",")[2] for row in rows]
    with (folder / "long.csv").open("w") as file:
        file.write(head + "\n")
        drop = 0
        while file.tell() < SIZE:
            start = drop * len(rests)
            file.writelines(f"{(start + i) * 0.004:.3f},{rest}\n" for i, rest in enumerate(rests))
            drop += 1
    (folder / "campaign.toml").write_text(TEXT)


@pytest.mark.long
def test_a_recording_of_500_mb(tmp_path: Path) -> None:
    write_long(tmp_path)
    with served(tmp_path) as server:
        begun = time.monotonic()
        assert "500 MB" in server.ask("/").text
        assert time.monotonic() - begun < 5
        form = {"base": json.dumps(TEXT), "original": json.dumps(TEXT), "version": ""}
        answers = []

        def draw() -> None:
            headers = {"Content-Type": "application/x-www-form-urlencoded"}
            path = "/campaign/drop?campaign=campaign.toml&drop=0"
            answers.append(server.ask(path, "POST", urlencode(form).encode(), headers, timeout=120))

        drawing = threading.Thread(target=draw)
        drawing.start()
        slowest = 0.0
        while drawing.is_alive():
            asked = time.monotonic()
            server.ask("/")
            slowest = max(slowest, time.monotonic() - asked)
            time.sleep(0.2)
        (answer,) = answers
        assert answer.status == 200, answer.text
        # A drop every 3.6 s, released 0.4 s after its beginning: the first one in the window is the 29th.
        assert answer.json["times"]["release"] == pytest.approx(28 * 3.6 + 0.4, abs=0.01)
        assert slowest < 2
        assert server.memory() < 120

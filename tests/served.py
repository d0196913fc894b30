"""The local page in a process of its own, as `sprung app` starts it, and plain requests to it."""

from __future__ import annotations

import http.client
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar


def memory_of(process: int) -> float:
    """Return the memory of a process that is in use, MB; 0 if it has ended."""
    found = re.search(r"VmRSS:\s*(\d+) kB", Path(f"/proc/{process}/status").read_text())
    return int(found[1]) / 1e3 if found else 0.0


Found = TypeVar("Found")

SOURCE = Path(__file__).resolve().parents[1] / "src"


@dataclass(frozen=True)
class Answer:
    """What the server answered."""

    status: int
    headers: dict[str, str]
    body: bytes

    @property
    def text(self) -> str:
        return self.body.decode()

    @property
    def json(self) -> Any:
        return json.loads(self.body)


@dataclass(frozen=True)
class Served:
    """A running server."""

    folder: Path
    process: subprocess.Popen[str]
    address: str
    port: int
    cookie: str

    @property
    def origin(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def ask(
        self,
        path: str,
        method: str = "GET",
        body: bytes | None = None,
        headers: Mapping[str, str] | None = None,
        timeout: float = 30,
    ) -> Answer:
        """Send a request as a page of the app would; a header with an empty value is left out."""
        own = {"Cookie": self.cookie, "Origin": self.origin if method not in {"GET", "HEAD"} else ""}
        sent = {name: value for name, value in {**own, **(headers or {})}.items() if value}
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        try:
            connection.request(method, path, body, sent)
            answer = connection.getresponse()
            return Answer(answer.status, {k.lower(): v for k, v in answer.getheaders()}, answer.read())
        finally:
            connection.close()

    def memory(self) -> float:
        """Memory of the server process that is in use, MB."""
        return memory_of(self.process.pid)


def wait_for(condition: Callable[[], Found], limit: float = 20.0) -> Found:
    """Return what a function returns once it is true."""
    end = time.monotonic() + limit
    while not (found := condition()):
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.02)
    return found


def processes_in(folder: Path) -> list[int]:
    """Return the processes of jobs that work in a folder."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and (entry / "cwd").readlink() == folder:
                found += [int(entry.name)] * (b"sprung.app.job_process" in (entry / "cmdline").read_bytes())
        except OSError:  # it has ended meanwhile
            continue
    return found


def start(folder: Path, *options: str, **environment: str) -> subprocess.Popen[str]:
    """Start the command without waiting for it."""
    return subprocess.Popen(  # noqa: S603 (this Python)
        [sys.executable, "-P", "-m", "sprung", "app", str(folder), "--no-browser", *options],
        env={**os.environ, "PYTHONPATH": str(SOURCE), **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def connect(folder: Path, process: subprocess.Popen[str]) -> Served:
    """Read the address that a server prints, and get the cookie for it."""
    assert process.stdout is not None
    address = process.stdout.readline().strip()
    found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?token=[\w-]{43}", address)
    assert found is not None, f"{address!r} is no address; {process.communicate()[1] if process.poll() else ''}"
    first = Served(folder, process, address, int(found[1]), "").ask(address[address.index("/?") :])
    assert first.status == 303
    return Served(folder, process, address, int(found[1]), first.headers["set-cookie"].partition(";")[0])


@contextmanager
def served(folder: Path, *options: str, **environment: str) -> Iterator[Served]:
    """Serve a folder while the block runs."""
    process = start(folder, *options, **environment)
    try:
        yield connect(folder, process)
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        try:
            process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()

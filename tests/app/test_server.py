"""`sprung app`: one address on this machine, until Ctrl-C; quick to start, small, and nothing of it in other commands."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from command_line import run
from served import SOURCE, connect, served, start
from sprung.cli import page


def test_it_listens_on_this_machine_only(tmp_path: Path) -> None:
    with served(tmp_path) as server:
        for line in Path("/proc/net/tcp").read_text().splitlines()[1:]:
            place, _, state = line.split()[1:4]
            if state == "0A" and int(place.rpartition(":")[2], 16) == server.port:  # listens
                assert place.startswith("0100007F:")  # 127.0.0.1, its bytes reversed
                break
        else:
            pytest.fail("it listens nowhere")
        listening6 = [line.split()[1] for line in Path("/proc/net/tcp6").read_text().splitlines()[1:]]
        assert not any(int(place.rpartition(":")[2], 16) == server.port for place in listening6)


def test_ctrl_c_ends_it_and_leaves_nothing(tmp_path: Path) -> None:
    process = start(tmp_path)
    server = connect(tmp_path, process)
    with socket.create_connection(("127.0.0.1", server.port)) as following:  # a page that follows the jobs
        head = f"GET /events HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nCookie: {server.cookie}\r\n\r\n"
        following.sendall(head.encode())
        assert b"200 OK" in following.recv(1000)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=20)
    assert (process.returncode, out) == (0, "")
    assert err == "Open this address in a browser of this machine. Ctrl-C ends the page.\nThe page has ended.\n"
    assert list(tmp_path.iterdir()) == []


def test_sigterm_ends_it_with_the_status_of_shells(tmp_path: Path) -> None:
    process = start(tmp_path)
    connect(tmp_path, process)
    process.terminate()
    _, err = process.communicate(timeout=20)
    assert process.returncode == 143
    assert err.endswith("sprung was terminated.\n")


@pytest.mark.slow
def test_a_port_that_is_taken_is_named_with_a_remedy(tmp_path: Path) -> None:
    with served(tmp_path) as server:
        second = run("app", tmp_path, "--no-browser", "--port", str(server.port))
        assert second.status == 2
        assert f"--port {server.port}: found a port that another program uses; expected a free port." in second.err
        assert "Leave --port out" in second.err
        assert server.ask("/jobs").status == 200
    with served(tmp_path, "--port", str(server.port)) as again:  # its last connections are just being closed
        assert again.port == server.port


def test_no_folder_and_no_libraries(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    said = run("app", tmp_path / "nowhere", "--no-browser")
    assert (said.status, said.out) == (2, "")
    assert "nowhere: found no folder; expected a folder." in said.err
    monkeypatch.setattr(page, "_LIBRARIES", ("starlette", "not_installed"))
    said = run("app", tmp_path, "--no-browser")
    assert (said.status, said.out) == (2, "")
    assert (
        'without not_installed; expected the libraries of the page. Install what it needs with: pip install "sprung[app]"'
        in said.err
    )


def test_json_is_one_document_with_the_address(tmp_path: Path) -> None:
    process = start(tmp_path, "--json")
    assert process.stdout is not None
    document = json.loads("".join(process.stdout.readline() for _ in range(3)))
    assert document["address"].startswith("http://127.0.0.1:")
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=20)[0] == ""


@pytest.mark.slow
def test_a_new_run_has_new_keys(tmp_path: Path) -> None:
    with served(tmp_path) as first:
        pass
    with served(tmp_path, "--port", str(first.port)) as second:
        assert second.ask("/jobs", headers={"Cookie": first.cookie}).status == 403


def test_the_first_page_needs_no_numerics_and_the_server_is_small(tmp_path: Path) -> None:
    """They would take most of the time to the first page, which benchmarks/local_page.py measures; and under 120 MB."""
    with served(tmp_path) as server:
        assert server.ask("/", headers={"Accept": "text/html"}).status == 200
        loaded = Path(f"/proc/{server.process.pid}/maps").read_text()
        assert [name for name in ("/numpy/", "/scipy/", "/matplotlib/", "/pandas/") if name in loaded] == []
        assert server.memory() < 120


@pytest.mark.parametrize(
    "program",
    ["import sprung.report, sprung.study, sprung.ride", "import sprung.cli", "import sprung; sprung.identify"],
)
@pytest.mark.slow
def test_nobody_else_imports_anything_of_it(program: str) -> None:
    libraries = ("starlette", "uvicorn", "anyio", "h11", "sprung.app")
    check = f"{program}; import sys; print([name for name in {libraries} if name in sys.modules])"
    environment = {**os.environ, "PYTHONPATH": str(SOURCE)}
    said = subprocess.run([sys.executable, "-c", check], env=environment, capture_output=True, text=True, check=True)  # noqa: S603
    assert said.stdout == "[]\n"

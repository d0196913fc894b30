"""Recordings that are dropped on the page arrive whole or not at all, and never over a file that is there."""

from __future__ import annotations

import hashlib
import http.client
import socket
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote

import pytest

from served import Served, served, wait_for
from sprung.app.uploads import LARGEST

SPELLINGS = (
    *("../x.csv", "..%2fx.csv", "%2e%2e/x.csv", "%2e%2e%2fx.csv", "car/../../x.csv", "car%2f..%2f..%2fx.csv"),
    *("/etc/x.csv", "%2fetc%2fx.csv", "//x.csv", "..%5cx.csv", "..\\x.csv", "%252e%252e%252fx.csv/..", "out/x.csv"),
    *("out%2fx.csv", "car/%00/../../x.csv", "x.csv%00", "%c0%ae%c0%ae/x.csv", "..;/x.csv", ".x.csv", "car/.ssh/x.csv"),
    *("new/x.csv", "", "car/", "%0d%0aSet-Cookie:x", "con", "x:y"),
)
"""Names of places outside the folder, of hidden ones, and of none."""


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("outer") / "work"
    (folder / "car").mkdir(parents=True)
    (folder / "out").symlink_to(folder.parent)
    with served(folder) as running:
        yield running


def everything(server: Served) -> list[str]:
    return sorted(str(path.relative_to(server.folder.parent)) for path in server.folder.parent.rglob("*"))


@pytest.mark.parametrize("name", ["drop 1.csv", "Stoß, weich #2 (50 %).csv", "a&b;c.csv"])
def test_a_file_arrives_as_it_is(server: Served, name: str) -> None:
    content = bytes(range(256)) * 5000
    sent = server.ask(f"/upload/car/{quote(name)}", "PUT", content)
    assert (sent.status, sent.json) == (201, {"name": f"car/{name}", "size": len(content)})
    written = (server.folder / "car" / name).read_bytes()
    assert hashlib.sha256(written).digest() == hashlib.sha256(content).digest()
    again = server.ask(f"/upload/car/{quote(name)}", "PUT", b"other")
    assert again.status == 409
    assert "exists already" in again.text
    assert (server.folder / "car" / name).read_bytes() == content


@pytest.mark.parametrize("name", SPELLINGS)
def test_no_spelling_leads_out_of_the_folder(server: Served, name: str) -> None:
    before = everything(server)
    answer = server.ask(f"/upload/{name}", "PUT", b"1")
    assert answer.status in {404, 405, 409, 400}
    assert "set-cookie" not in answer.headers
    assert everything(server) == before


@pytest.mark.parametrize("name", ["../secret.txt", "%2e%2e/secret.txt", "..%2fsecret.txt", "car/../../secret.txt"])
@pytest.mark.parametrize("start", ["/files/", "/scripts/", "/styles/", "/files/out/"])
def test_nothing_outside_is_read(server: Served, start: str, name: str) -> None:
    (server.folder.parent / "secret.txt").write_text("secret")
    answer = server.ask(f"{start}{name}")
    (server.folder.parent / "secret.txt").unlink()
    assert answer.status in {400, 404, 405}
    assert answer.body != b"secret"


def raw(server: Served, head: str, body: bytes = b"", wait: float = 10.0) -> bytes:
    """Send a request byte for byte, and return the answer."""
    with socket.create_connection(("127.0.0.1", server.port), timeout=wait) as connection:
        own = f"Host: 127.0.0.1:{server.port}\r\nOrigin: {server.origin}\r\nCookie: {server.cookie}\r\n"
        connection.sendall(f"{head}\r\n{own}\r\n".encode() + body)
        answer = b""
        try:
            while piece := connection.recv(1 << 16):
                answer += piece
        except ConnectionResetError:
            pass
        return answer


@pytest.mark.parametrize(
    ("path", "length"),
    [
        ("/upload/x.csv", 10_000_000_000),
        ("/upload/x.csv", LARGEST + 1),
        ("/upload/x.csv", 10**30),
        ("/jobs/x/cancel", 10**10),
    ],
)
def test_a_body_of_ten_gigabytes_is_refused_before_it_is_sent(server: Served, path: str, length: int) -> None:
    before, memory = everything(server), server.memory()
    answer = raw(
        server, f"{'PUT' if 'upload' in path else 'POST'} {path} HTTP/1.1\r\nContent-Length: {length}", b"1" * 1000
    )
    assert b" 413 " in answer or b" 400 " in answer
    assert everything(server) == before
    assert server.memory() < memory + 10


def test_a_body_that_does_not_state_its_length_is_refused(server: Served) -> None:
    before = everything(server)
    piece = b"10000\r\n" + b"1" * 65536 + b"\r\n"
    for lengths in ("", "Content-Length: 5\r\n"):
        answer = raw(server, f"PUT /upload/x.csv HTTP/1.1\r\n{lengths}Transfer-Encoding: chunked", piece)
        assert b" 411 " in answer or b" 400 " in answer
    assert everything(server) == before


def test_a_file_that_breaks_off_leaves_nothing(server: Served) -> None:
    before = everything(server)
    with socket.create_connection(("127.0.0.1", server.port)) as connection:
        head = f"PUT /upload/cut.csv HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nOrigin: {server.origin}"
        connection.sendall(
            f"{head}\r\nCookie: {server.cookie}\r\nContent-Length: 100000\r\n\r\n".encode() + b"1" * 50_000
        )
        hidden = wait_for(lambda: [path.name for path in server.folder.iterdir() if path.name.startswith(".cut.csv.")])
        assert len(hidden) == 1
        assert not (server.folder / "cut.csv").exists()
    wait_for(lambda: everything(server) == before)


def test_what_a_killed_server_left_is_removed_by_the_next(tmp_path: Path) -> None:
    with served(tmp_path) as server, socket.create_connection(("127.0.0.1", server.port)) as connection:
        head = f"PUT /upload/cut.csv HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nOrigin: {server.origin}"
        connection.sendall(f"{head}\r\nCookie: {server.cookie}\r\nContent-Length: 9\r\n\r\n1".encode())
        wait_for(lambda: list(tmp_path.iterdir()))
        server.process.kill()
        server.process.wait()
    assert len(list(tmp_path.iterdir())) == 1
    with served(tmp_path):
        assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_recording_of_500_mb_goes_to_the_disk_and_not_into_memory(server: Served, tmp_path: Path) -> None:
    large = tmp_path / "large.csv"
    with large.open("wb") as file:
        file.truncate(500_000_000)
    before = server.memory()
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=60)
    with large.open("rb") as content:
        headers = {"Cookie": server.cookie, "Origin": server.origin, "Content-Length": "500000000"}
        connection.request("PUT", "/upload/large.csv", content, headers)
        answer = connection.getresponse()
    assert (answer.status, answer.read()) == (201, b'{"name":"large.csv","size":500000000}')
    connection.close()
    assert (server.folder / "large.csv").stat().st_size == 500_000_000
    assert server.memory() < before + 50
    (server.folder / "large.csv").unlink()

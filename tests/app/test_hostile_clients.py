"""A thousand requests at once and slow clients: held or refused, in little memory, and others are answered."""

from __future__ import annotations

import resource
import socket
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager

import pytest

from served import Served, served, wait_for
from sprung.app.application import LARGEST_BODY

MANY = 1000
MEMORY = 400.0
"""Most memory of the server, MB."""
NO_REQUESTS = (
    *(b"\x00" * 1000, b"GET / HTTP/9.9\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00\r\n\r\n", b"GET /" + b"a" * 1_000_000),
    *(b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 100_000, b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"),
    b"GET / HTTP/1.1\r\nHost :x\r\n\r\n",
)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("workspace")
    for number in range(300):
        (folder / f"drop_{number}.csv").write_text("time,a\n0,1\n")
    with (folder / "large.html").open("wb") as file:
        file.truncate(50_000_000)
    with served(folder) as running:
        yield running


@contextmanager
def opened(server: Served, count: int) -> Iterator[list[socket.socket]]:
    """Connect many times."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft < MANY + 200:
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(MANY + 200, hard), hard))
    with ExitStack() as stack:
        place = ("127.0.0.1", server.port)
        yield [stack.enter_context(socket.create_connection(place, timeout=60)) for _ in range(count)]


def head(server: Served, path: str, method: str = "GET", more: str = "") -> bytes:
    own = f"Host: 127.0.0.1:{server.port}\r\nOrigin: {server.origin}\r\nCookie: {server.cookie}\r\n{more}\r\n"
    return f"{method} {path} HTTP/1.1\r\n{own}".encode()


@pytest.mark.parametrize(
    "path",
    [
        "/",
        *(pytest.param(path, marks=pytest.mark.long) for path in ("/jobs", "/files/drop_7.csv", "/files/large.html")),
    ],
)
@pytest.mark.slow
def test_a_thousand_requests_at_once_are_all_answered(server: Served, path: str) -> None:
    with opened(server, MANY) as connections:
        for connection in connections:
            connection.sendall(head(server, path, more="Accept: text/html\r\n"))
        assert {connection.recv(12) for connection in connections} == {b"HTTP/1.1 200"}
        assert server.memory() < MEMORY
    assert server.ask("/jobs").status == 200


def test_a_thousand_strangers_are_all_refused(server: Served) -> None:
    with opened(server, MANY) as connections:
        for connection in connections:
            connection.sendall(f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n\r\n".encode())
        assert {connection.recv(12) for connection in connections} == {b"HTTP/1.1 403"}


def test_clients_that_read_slowly_are_held(server: Served) -> None:
    """300 clients ask for 50 MB each and read nothing: 15 GB that must not be read into memory for them."""
    with opened(server, 300) as connections:
        for connection in connections:
            connection.sendall(head(server, "/files/large.html"))
        time.sleep(1)
        assert server.memory() < MEMORY
        assert server.ask("/files/drop_1.csv").status == 200


def test_clients_that_send_slowly_are_held(server: Served) -> None:
    with opened(server, 500) as heads, opened(server, 100) as bodies:
        for connection in heads:
            connection.sendall(b"GET / HTTP/1.1\r\nHost: 127")
        for number, connection in enumerate(bodies):
            connection.sendall(head(server, f"/upload/slow_{number}.csv", "PUT", "Content-Length: 1000000\r\n") + b"1")
        assert server.ask("/jobs").status == 200
        assert server.memory() < MEMORY
    wait_for(lambda: not list(server.folder.glob(".slow*")))
    assert not list(server.folder.glob("slow*"))


def test_many_pages_that_follow_the_jobs_do_not_keep_others_out(server: Served) -> None:
    with opened(server, 200) as connections:
        for connection in connections:
            connection.sendall(head(server, "/events"))
        statuses = [connection.recv(12) for connection in connections]
        assert statuses.count(b"HTTP/1.1 200") == 50
        assert statuses.count(b"HTTP/1.1 503") == 150
        assert server.ask("/jobs").status == 200
    wait_for(lambda: server.ask("/events?job=none").status == 204)


@pytest.mark.parametrize("sent", NO_REQUESTS)
def test_what_is_no_request_is_refused(server: Served, sent: bytes) -> None:
    with socket.create_connection(("127.0.0.1", server.port), timeout=10) as connection:
        try:
            connection.sendall(sent)
            answer = connection.recv(1000)
        except (ConnectionResetError, BrokenPipeError):
            answer = b""
    assert answer[:12] in {b"", b"HTTP/1.1 400", b"HTTP/1.1 403", b"HTTP/1.1 431"}
    assert server.ask("/jobs").status == 200


@pytest.mark.long
def test_a_client_that_stops_is_disconnected(server: Served) -> None:
    """20 s for the head of a request, and 30 s without a byte of its body."""
    with opened(server, 3) as (no_head, no_body, answered):
        no_head.sendall(b"GET / HTTP/1.1\r\n")
        no_body.sendall(head(server, "/upload/slow.csv", "PUT", "Content-Length: 1000000\r\n") + b"1")
        answered.sendall(head(server, "/jobs"))
        assert answered.recv(12) == b"HTTP/1.1 200"
        begun = time.monotonic()
        assert no_head.recv(1) == b""
        assert 15 < time.monotonic() - begun < 25
        assert no_body.recv(12) == b"HTTP/1.1 400"
        assert 25 < time.monotonic() - begun < 35
    assert not list(server.folder.glob("*slow*"))


@pytest.mark.slow
def test_many_large_forms_at_once_are_read_one_after_the_other(server: Served) -> None:
    """400 MB of forms, which are read into memory, and several times as much with their fields."""
    body = b"a=" + b"x" * (LARGEST_BODY - 2)
    more = f"Content-Length: {len(body)}\r\nContent-Type: application/x-www-form-urlencoded\r\n"
    with opened(server, 100) as connections, ThreadPoolExecutor(100) as threads:
        sent = head(server, "/compare", "POST", more) + body
        list(threads.map(lambda connection: connection.sendall(sent), connections))
        statuses = [connection.recv(12) for connection in connections]
    assert set(statuses) == {b"HTTP/1.1 400"}  # a comparison of no results
    assert server.memory() < MEMORY

"""Nobody is answered but the browser that opened the printed address, and only on behalf of the app's own pages."""

from __future__ import annotations

import asyncio
import http.client
from collections.abc import Iterator
from typing import Any

import pytest

from served import Served, served
from sprung.app.access import REPORT_POLICY, Access, Keys

CONTENT = "the content of a file of the user"
HOSTS = (
    *("attacker.example", "attacker.example:{port}", "127.0.0.1", "127.0.0.1:1", "127.0.0.2:{port}", "0.0.0.0:{port}"),
    *("[::1]:{port}", "localhost.attacker.example:{port}", "127.0.0.1:{port}.attacker.example", "127.1:{port}"),
    *("127.0.0.1:{port}@attacker.example", "2130706433:{port}", "user@127.0.0.1:{port}", "localhost:{port}:{port}"),
)
ORIGINS = (
    *("https://attacker.example", "null", "http://127.0.0.1", "http://127.0.0.1:1", "https://127.0.0.1:{port}"),
    *("file://", "http://localhost:{port}", "http://127.0.0.1:{port}.attacker.example", "http://127.0.0.1:{port}/"),
)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("workspace")
    (folder / "notes.txt").write_text(CONTENT)
    (folder / "report.html").write_text("<script>1</script>")
    with served(folder) as running:
        yield running


def refused(server: Served, path: str = "/files/notes.txt", **changes: str) -> bool:
    headers = {name.replace("_", "-"): value for name, value in changes.items()}
    answer = server.ask(path, headers=headers)
    assert CONTENT not in answer.text
    assert "set-cookie" not in answer.headers
    return answer.status == 403


def test_the_cookie_of_the_printed_address_opens_the_folder(server: Served) -> None:
    answer = server.ask("/files/notes.txt")
    assert (answer.status, answer.text) == (200, CONTENT)


def test_without_the_cookie_nothing_is_answered(server: Served) -> None:
    name, _, value = server.cookie.partition("=")
    assert refused(server, Cookie="")
    assert refused(server, Cookie=f"{name}=")
    assert refused(server, Cookie=f"{name}={value[:-1]}")
    assert refused(server, Cookie=f"{name}={value}x")
    assert refused(server, Cookie=f"other={value}")
    assert refused(server, Cookie=f"{name}={server.address.partition('token=')[2]}")
    assert refused(server, "/styles/app.css", Cookie="")
    assert refused(server, "/events", Cookie="")


@pytest.mark.parametrize("token", ["", "x", "%C3%A9", "%00", "x" * 43, "x" * 10_000])
def test_a_wrong_token_gives_no_cookie(server: Served, token: str) -> None:
    path = f"/?token={token}"
    assert refused(server, path)
    assert refused(server, path, Cookie="")


def test_the_right_token_works_for_the_first_page_only(server: Served) -> None:
    query = server.address[server.address.index("?") :]
    assert refused(server, f"/files/notes.txt{query}", Cookie="")
    assert server.ask(f"/{query}", "POST", b"").status == 403
    again = server.ask(f"/{query}", headers={"Cookie": ""})
    assert (again.status, again.headers["location"]) == (303, "/")
    assert again.headers["set-cookie"] == f"{server.cookie}; HttpOnly; SameSite=Strict; Path=/"


def test_a_link_from_another_page_opens_it_without_a_redirection(server: Served) -> None:
    """A browser would follow a redirection that began elsewhere without the cookie, as SameSite=Strict demands."""
    query = server.address[server.address.index("?") :]
    linked = server.ask(f"/{query}", headers={"Cookie": "", "Sec-Fetch-Site": "cross-site"})
    assert (linked.status, linked.headers["refresh"]) == (200, "0; url=/")


def test_the_ticket_of_the_opened_address_is_valid_once() -> None:
    keys = Keys()
    ticket = keys.ticket()
    assert not keys.admits(keys.cookie)
    assert [keys.admits(ticket), keys.admits(ticket)] == [True, False]
    assert [keys.admits(keys.token), keys.admits(keys.token)] == [True, True]


@pytest.mark.parametrize("host", HOSTS)
def test_a_name_that_resolves_to_this_machine_is_refused(server: Served, host: str) -> None:
    name = host.format(port=server.port)
    assert refused(server, Host=name)
    assert refused(server, server.address[server.address.index("/?") :], Host=name, Cookie="")


def test_two_hosts_or_none_are_refused(server: Served) -> None:
    for hosts in ((), (f"127.0.0.1:{server.port}", "attacker.example"), (f"127.0.0.1:{server.port}",) * 2):
        connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=10)
        connection.putrequest("GET", "/files/notes.txt", skip_host=True)
        for host in hosts:
            connection.putheader("Host", host)
        connection.putheader("Cookie", server.cookie)
        connection.endheaders()
        assert connection.getresponse().status in {400, 403}
        connection.close()


@pytest.mark.parametrize("origin", ORIGINS)
@pytest.mark.parametrize("method", ["GET", "POST", "PUT", "OPTIONS", "DELETE"])
def test_another_origin_is_refused(server: Served, origin: str, method: str) -> None:
    answer = server.ask("/upload/new.csv", method, b"1" * 9, {"Origin": origin.format(port=server.port)})
    assert answer.status == 403
    assert "access-control-allow-origin" not in answer.headers
    assert not (server.folder / "new.csv").exists()


def test_a_request_that_changes_something_must_state_its_origin(server: Served) -> None:
    assert server.ask("/upload/new.csv", "PUT", b"1", {"Origin": ""}).status == 403
    assert not (server.folder / "new.csv").exists()


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
@pytest.mark.parametrize("kind", ["image", "iframe", "script", "document", "empty"])
def test_what_another_site_loads_is_refused(server: Served, site: str, kind: str) -> None:
    """``same-site`` is a server on another port of this machine."""
    assert refused(server, Sec_Fetch_Site=site, Sec_Fetch_Dest=kind)


def test_a_form_of_another_site_is_refused_though_the_cookie_came_with_it(server: Served) -> None:
    headers = {"Origin": "https://attacker.example", "Sec-Fetch-Site": "cross-site"}
    headers["Content-Type"] = "application/x-www-form-urlencoded"
    assert server.ask("/jobs/x/cancel", "POST", b"a=b", headers).status == 403
    typed = {"Sec-Fetch-Site": "none"}  # no page of ours sent it
    assert server.ask("/jobs/x/cancel", "POST", b"a=b", typed).status == 403


def test_every_answer_has_the_headers(server: Served) -> None:
    for answer in (server.ask("/jobs"), server.ask("/nowhere"), server.ask("/jobs", headers={"Cookie": ""})):
        policy = answer.headers["content-security-policy"]
        assert policy.startswith("default-src 'self';")
        assert "unsafe" not in policy
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["cross-origin-resource-policy"] == "same-origin"
        assert answer.headers["cache-control"] == "no-store"
        assert "server" not in answer.headers
    # With `no-referrer` the app's own forms would have the Origin null.
    assert server.ask("/jobs").headers["referrer-policy"] == "same-origin"


def test_a_page_from_the_folder_is_a_site_of_its_own(server: Served) -> None:
    answer = server.ask("/files/report.html")
    assert answer.headers["content-security-policy"] == REPORT_POLICY
    assert "allow-same-origin" not in REPORT_POLICY
    assert "connect-src" not in REPORT_POLICY  # default-src 'none' holds for it
    assert answer.headers["content-disposition"].startswith("inline")
    assert server.ask("/files/notes.txt").headers["content-disposition"].startswith("attachment")


def test_a_web_socket_is_not_opened(server: Served) -> None:
    headers = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}
    assert server.ask("/events?job=x", headers={**headers, "Sec-WebSocket-Key": "x" * 22 + "=="}).status != 101


def status_of(port: int, path: str, host: str, **headers: str) -> int:
    """Status with which a request with the cookie is answered, without a network."""
    keys, sent = Keys(), []

    async def page(scope: Any, receive: Any, send: Any) -> None:  # noqa: ARG001 (an ASGI application)
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def send(message: Any) -> None:
        sent.append(message)

    given = {"host": host, "cookie": f"sprung-{port}={keys.cookie}", **headers}
    scope: dict[str, Any] = {
        "type": "http",
        "method": "POST" if "origin" in headers else "GET",
        "path": path,
        "query_string": b"",
    }
    scope["headers"] = [(name.encode(), value.encode()) for name, value in given.items()]

    async def ask() -> None:
        await Access(page, keys, port, {"/": 1000})(scope, None, send)  # type: ignore[arg-type]

    asyncio.run(ask())
    assert (b"x-content-type-options", b"nosniff") in sent[0]["headers"]
    return int(sent[0]["status"])


def test_browsers_leave_out_the_usual_port() -> None:
    assert status_of(80, "/", "127.0.0.1") == status_of(80, "/", "localhost") == 200
    body = {"content-length": "0", "sec-fetch-site": "same-origin"}
    assert status_of(80, "/", "127.0.0.1", origin="http://127.0.0.1", **body) == 200
    assert status_of(80, "/", "127.0.0.1", origin="http://127.0.0.1:81", **body) == 403
    assert status_of(80, "/", "127.0.0.1:81") == status_of(8000, "/", "127.0.0.1") == 403


@pytest.mark.parametrize("path", ["http://evil.example/jobs", "*", "", "evil.example:443"])
def test_a_request_for_a_proxy_is_refused(path: str) -> None:
    assert status_of(8000, path, "127.0.0.1:8000") == 400

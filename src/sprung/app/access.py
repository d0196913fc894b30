"""Who may ask: the checks that every request passes before any page sees it.

The server listens on 127.0.0.1 only, but every program and every web page on this machine can send requests there. A request is
answered if its Host is this server's name, if no other site caused it, and if it has the cookie that the address printed at
the start gave to the browser. A web page elsewhere has none of these: its requests have its own Origin, a name that it lets
resolve to 127.0.0.1 has its own Host, and a cookie with SameSite=Strict is not sent with them.
"""

from __future__ import annotations

import asyncio
import hmac
import secrets
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING
from urllib.parse import parse_qs

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

PAGE_POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; "
    "base-uri 'none'; form-action 'self'; frame-ancestors 'self'"
)
"""Content-Security-Policy of the app's own pages: no inline script or style, nothing from elsewhere."""

REPORT_POLICY = (
    "sandbox allow-scripts allow-downloads; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; font-src data:; frame-ancestors 'self'"
)
"""Content-Security-Policy of files from the folder, such as reports: each is a site of its own that can request nothing."""

BODY_PAUSE = 30.0
"""Longest time without a byte of a body, s."""

_USUAL_PORT = 80
"""Port of HTTP."""

_LARGE = 100_000
"""Bytes from which a form counts as large..."""

_LARGE_AT_ONCE = 4
"""...and number of such forms that are read at the same time; the others wait."""

_HEADERS = {
    b"content-security-policy": PAGE_POLICY.encode(),
    b"x-content-type-options": b"nosniff",
    # With no-referrer, browsers would send `Origin: null` with the app's own forms.
    b"referrer-policy": b"same-origin",
    b"cross-origin-opener-policy": b"same-origin",
    b"cross-origin-resource-policy": b"same-origin",
    b"cache-control": b"no-store",
}
_SAFE = frozenset({"GET", "HEAD"})


class Keys:
    """The secrets of one run: tokens of the address that is printed and of the one that is opened, and the cookie's value.

    Attributes
    ----------
    token
        Of the printed address; valid until the server ends.
    cookie
        Value of the cookie.
    """

    def __init__(self) -> None:
        self.token = secrets.token_urlsafe(32)
        self.cookie = secrets.token_urlsafe(32)
        self._tickets: set[str] = set()

    def ticket(self) -> str:
        """Return a token that is valid once.

        The address that a browser is started with stands in the list of processes, which every user of the machine may read.
        """
        ticket = secrets.token_urlsafe(32)
        self._tickets.add(ticket)
        return ticket

    def admits(self, token: str) -> bool:
        """Return whether a token is valid; a ticket no longer is afterwards."""
        if _equal(token, self.token):
            return True
        used = [ticket for ticket in self._tickets if _equal(token, ticket)]
        self._tickets.difference_update(used)
        return bool(used)


class Access:
    """ASGI application that passes on what is permitted, and answers the rest itself.

    Parameters
    ----------
    application
        Receives the permitted requests.
    keys
        Token and cookie.
    port
        Port on which the server listens.
    body_limits
        Largest body of a request in bytes, by the beginning of its path; the longest that fits holds. That of ``/`` is for
        forms, which are read into memory.
    """

    def __init__(self, application: ASGIApp, keys: Keys, port: int, body_limits: Mapping[str, int]) -> None:
        self._application = application
        self._keys = keys
        end = "" if port == _USUAL_PORT else f":{port}"  # browsers leave out the usual one
        self._hosts = {f"127.0.0.1{end}".encode(), f"localhost{end}".encode()}
        self._cookie = f"sprung-{port}"  # cookies do not tell ports apart
        self._large = asyncio.Semaphore(_LARGE_AT_ONCE)
        self._body_limits = dict(sorted(body_limits.items(), key=lambda item: len(item[0]), reverse=True))

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or pass it on."""
        if scope["type"] != "http":
            await send({"type": "websocket.close", "code": 1008})
            return
        headers: list[tuple[bytes, bytes]] = scope["headers"]
        if not scope["path"].startswith("/"):  # `GET http://other/` is for a proxy, and `GET *` names nothing
            await refuse(send, 400, "The request names no page of this server.")
        elif not self._is_for_this_server(scope, headers):
            await refuse(send, 403, "This address is not the one that sprung printed. Open that one.")
        elif (token := _token(scope)) is not None:
            await self._admit(scope, headers, token, send)
        elif not self._is_from_this_site(scope, headers):
            await refuse(send, 403, "The request comes from another site. sprung answers only its own pages.")
        elif not self._has_cookie(headers):
            await refuse(send, 403, "Open the address that sprung printed in the terminal; it contains a key.")
        elif (refusal := self._body_refusal(scope, headers)) is not None:
            await refuse(send, *refusal)
        elif self._is_large(scope, headers):
            async with self._large:
                await self._application(scope, _with_deadline(receive), _with_headers(send))
        else:
            await self._application(scope, _with_deadline(receive), _with_headers(send))

    def _is_for_this_server(self, scope: Scope, headers: list[tuple[bytes, bytes]]) -> bool:
        """Whether the one Host is this server's, and the Origin, if there is one, too."""
        hosts, origins = _values(headers, b"host"), _values(headers, b"origin")
        if len(hosts) != 1 or hosts[0].lower() not in self._hosts or len(origins) > 1:
            return False
        if not origins:
            return scope["method"] in _SAFE
        return origins[0] == b"http://" + hosts[0].lower()

    @staticmethod
    def _is_from_this_site(scope: Scope, headers: list[tuple[bytes, bytes]]) -> bool:
        """Whether a page of this server, or the user, caused the request, as the browser says; another port is another site."""
        sites = _values(headers, b"sec-fetch-site")
        allowed = {b"same-origin", b"none"} if scope["method"] in _SAFE else {b"same-origin"}
        return all(site in allowed for site in sites)

    def _has_cookie(self, headers: list[tuple[bytes, bytes]]) -> bool:
        pairs = (pair.strip().partition(b"=") for value in _values(headers, b"cookie") for pair in value.split(b";"))
        return any(
            name == self._cookie.encode() and _equal(value.decode("latin-1"), self._keys.cookie)
            for name, _, value in pairs
        )

    async def _admit(self, scope: Scope, headers: list[tuple[bytes, bytes]], token: str, send: Send) -> None:
        """Send the cookie to a browser that opens the printed address, and the browser to the first page."""
        if scope["method"] != "GET" or scope["path"] != "/" or not self._keys.admits(token):
            await refuse(send, 403, "This key is not valid. Open the address that sprung printed in the terminal last.")
            return
        cookie = f"{self._cookie}={self._keys.cookie}; HttpOnly; SameSite=Strict; Path=/"
        # After a link from another site a browser would follow a redirection without the new cookie.
        elsewhere = any(site not in {b"same-origin", b"none"} for site in _values(headers, b"sec-fetch-site"))
        status, location = (200, b"refresh") if elsewhere else (303, b"location")
        target = b"0; url=/" if elsewhere else b"/"
        await _respond(send, status, "sprung opens its page.", {location: target, b"set-cookie": cookie.encode()})

    def _is_large(self, scope: Scope, headers: list[tuple[bytes, bytes]]) -> bool:
        """Whether a body is large and will be read into memory; uploads are written to the disk."""
        lengths = _values(headers, b"content-length")
        return self._limit(scope) == self._body_limits["/"] and bool(lengths) and int(lengths[0]) > _LARGE

    def _limit(self, scope: Scope) -> int:
        return next(limit for start, limit in self._body_limits.items() if scope["path"].startswith(start))

    def _body_refusal(self, scope: Scope, headers: list[tuple[bytes, bytes]]) -> tuple[int, str] | None:
        """Return status and reason if a body is too large or does not state its length, else None."""
        lengths = _values(headers, b"content-length")
        if scope["method"] in _SAFE and not lengths and not _values(headers, b"transfer-encoding"):
            return None
        limit = self._limit(scope)
        if not lengths or _values(headers, b"transfer-encoding"):  # the one that counts is not the length
            return (411, "The request does not state the length of its body.")
        length = int(lengths[0]) if lengths[0].isdigit() and len(lengths[0]) < 20 else limit + 1
        return (413, f"The request has {length} bytes; at most {limit} are accepted.") if length > limit else None


async def refuse(send: Send, status: int, reason: str) -> None:
    """Answer a request with a reason in plain text, and close the connection: nothing more of its body is read."""
    await _respond(send, status, reason, {b"connection": b"close"})


async def _respond(send: Send, status: int, text: str, headers: Mapping[bytes, bytes]) -> None:
    body = f"{text}\n".encode()
    own = {b"content-type": b"text/plain; charset=utf-8", b"content-length": str(len(body)).encode(), **headers}
    await _with_headers(send)({"type": "http.response.start", "status": status, "headers": list(own.items())})
    await send({"type": "http.response.body", "body": body})


def _with_headers(send: Send) -> Send:
    """Return a function that sends a response with the security headers that it does not set itself."""

    async def send_with_headers(message: Mapping[str, object]) -> None:
        if message["type"] == "http.response.start":
            given: Iterable[tuple[bytes, bytes]] = message.get("headers", ())  # type: ignore[assignment]
            present = {name.lower() for name, _ in given}
            added = [item for item in _HEADERS.items() if item[0] not in present]
            message = {**message, "headers": [*given, *added]}
        await send(dict(message))

    return send_with_headers


def _with_deadline(receive: Receive) -> Receive:
    """Return a function that receives a body, and reports a client that sends nothing for a while as gone."""
    is_complete = False

    async def receive_in_time() -> Message:
        nonlocal is_complete
        if is_complete:  # what follows is the end of the connection, for which a stream of events waits
            return await receive()
        try:
            message = await asyncio.wait_for(receive(), BODY_PAUSE)
        except TimeoutError:
            message = {"type": "http.disconnect"}
        is_complete = not message.get("more_body", False)
        return message

    return receive_in_time


def _token(scope: Scope) -> str | None:
    """Return the token in the address of a request; None if there is none."""
    values = parse_qs(scope["query_string"].decode("latin-1"), keep_blank_values=True).get("token")
    return values[0] if values else None


def _values(headers: Iterable[tuple[bytes, bytes]], name: bytes) -> list[bytes]:
    return [value for key, value in headers if key == name]


def _equal(one: str, other: str) -> bool:
    return hmac.compare_digest(one.encode(), other.encode())

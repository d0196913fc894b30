"""The local page in a real browser: Debian's Chromium, or whatever the system calls its own."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from served import Served


@contextmanager
def chromium() -> Iterator[Any]:
    """Start the browser; a test is skipped where there is none."""
    playwright = pytest.importorskip("playwright.sync_api")
    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if program is None:
        pytest.skip("needs Chromium")
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(executable_path=program, args=["--no-sandbox", "--disable-gpu"])
        yield browser
        browser.close()


def wait_until(page: Any, condition: Callable[[], bool], seconds: float = 10.0) -> None:
    """Wait until a condition holds: how quick the machine is decides nothing."""
    for _ in range(round(50 * seconds)):
        if condition():
            return
        page.wait_for_timeout(20)
    assert condition()


class Tabs:
    """Tabs of one user, with everything that they complained about.

    Attributes
    ----------
    complaints
        Messages on the consoles and errors of scripts.
    """

    def __init__(self, browser: Any, server: Served, **context: Any) -> None:
        self._context = browser.new_context(**{"viewport": {"width": 1280, "height": 900}, **context})
        self._server = server
        self.complaints: list[str] = []

    def open(self, path: str = "") -> Any:
        """Open the printed address in a new tab, or a page of the same user."""
        tab = self._context.new_page()
        tab.set_default_timeout(30_000)
        tab.on("console", self._note)
        tab.on("pageerror", lambda error: self.complaints.append(str(error)))
        tab.goto(f"{self._server.origin}{path}" if path else self._server.address)
        return tab

    def _note(self, message: Any) -> None:
        # A test that clicks before the page has set its focus is a user who is quick, not a fault of the page.
        if not message.text.startswith("Autofocus processing was blocked"):
            self.complaints.append(f"{message.type}: {message.text} ({message.location['url']})")

    def forgive(self, complaint: str) -> None:
        """Take out the one complaint that was to be expected; it must have come."""
        (expected,) = (text for text in self.complaints if complaint in text)
        self.complaints.remove(expected)

    def close(self) -> None:
        """Close the tabs; they must not have complained."""
        self._context.close()
        assert not self.complaints, "\n".join(self.complaints)


@contextmanager
def tabs(browser: Any, server: Served, **context: Any) -> Iterator[Tabs]:
    """Open tabs on a server while the block runs; a first one gets the cookie."""
    opened = Tabs(browser, server, **context)
    try:
        opened.open().close()
        yield opened
    except BaseException:
        opened._context.close()
        raise
    opened.close()

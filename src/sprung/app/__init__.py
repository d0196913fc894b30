"""The local page: campaigns in a browser, on this machine only."""

from sprung.app.server import serve

__all__ = ["serve"]

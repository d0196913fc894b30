"""Style sheets and scripts of the pages; all of them are part of the program."""

from __future__ import annotations

from starlette.routing import Mount
from starlette.staticfiles import StaticFiles

routes = [
    Mount(f"/{kind}", StaticFiles(packages=[("sprung.app", kind)], follow_symlink=False), name=kind)
    for kind in ("styles", "scripts")
]

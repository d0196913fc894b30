"""How soon the local page is there and how much memory its server takes. Writes local-page.md beside this file.

Run with `python benchmarks/local_page.py` on a machine that does nothing else: these are seconds, no ratios.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[0] / "tests"))

from served import Served, served  # noqa: E402 (the path above)

RUNS, RECORDINGS, REQUESTS = 7, 300, 1000

_PAGE = """\
# Speed of the local page

`python benchmarks/local_page.py` starts `sprung app` and measures what a user waits for; medians of {runs} runs, in s. The
Python interpreter alone starts in {interpreter:.2f} s.

| what | time | required |
|---|---:|---:|
| from the command to the first page | {start:.2f} s | 1.5 s |
| the first page of a folder with {recordings} recordings, from the command on | {folder:.2f} s | 5 s |
| {requests} requests at once, all answered | {requests_time:.1f} s | |

The server takes {idle:.0f} MB after the first page (120 MB are required), and {busy:.0f} MB after the {requests} requests
(400 MB).
"""


def first_page(folder: Path) -> tuple[float, float]:
    """Return the time from the command to the first page, s, and the memory of the server after it, MB."""
    begun = time.perf_counter()
    with served(folder) as server:
        assert server.ask("/", headers={"Accept": "text/html"}).status == 200
        return time.perf_counter() - begun, server.memory()


def many_requests(folder: Path) -> tuple[float, float]:
    """Return the time in which as many requests are answered that come at once, s, and the memory after them, MB."""

    def ask(server: Served) -> int:
        return server.ask("/", timeout=120).status

    with served(folder) as server, ThreadPoolExecutor(200) as pool:
        begun = time.perf_counter()
        statuses = list(pool.map(ask, [server] * REQUESTS))
        assert statuses == [200] * REQUESTS
        return time.perf_counter() - begun, server.memory()


def interpreter() -> float:
    """Return the time in which the interpreter alone starts and ends, s."""
    begun = time.perf_counter()
    subprocess.run([sys.executable, "-c", ""], check=True)
    return time.perf_counter() - begun


def main() -> None:
    """Measure, and write the page."""
    with tempfile.TemporaryDirectory() as empty, tempfile.TemporaryDirectory() as full:
        samples = "time,a\n" + "".join(f"{i / 250},{i % 7}\n" for i in range(500))
        for number in range(RECORDINGS):
            (Path(full) / f"drop_{number:03}.csv").write_text(samples)
        starts = [first_page(Path(empty)) for _ in range(RUNS)]
        folders = [first_page(Path(full)) for _ in range(RUNS)]
        requests, busy = many_requests(Path(empty))
    text = _PAGE.format(
        runs=RUNS,
        recordings=RECORDINGS,
        requests=REQUESTS,
        interpreter=statistics.median(interpreter() for _ in range(RUNS)),
        start=statistics.median(seconds for seconds, _ in starts),
        folder=statistics.median(seconds for seconds, _ in folders),
        requests_time=requests,
        idle=statistics.median(memory for _, memory in starts),
        busy=busy,
    )
    (HERE / "local-page.md").write_text(text, encoding="utf-8")
    sys.stdout.write(text)


if __name__ == "__main__":
    main()

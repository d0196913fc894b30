"""Workers of an existing Dask cluster."""

from __future__ import annotations

import queue
import time
from contextlib import suppress
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any, NoReturn

from sprung.batch.task import Failure, Row, Task, Work, attempt, content_key
from sprung.errors import InputError, Problem

CONNECTION_TIMEOUT = 10.0
"""Longest time to wait for a scheduler and for its first worker, s."""

_AHEAD = 2
"""Tasks for each thread of the cluster at a time."""

_OFTEN = 2.0
"""Time after which the size of the cluster is asked for again, s."""

_KEPT = "What was finished is kept: start the command again when the cluster runs."


class DaskWorkers:
    """Workers of an existing Dask cluster, which must have this version of sprung installed and see the same files.

    Parameters
    ----------
    work
        Function of a module, done for the argument of each task.
    address
        Of the scheduler, such as ``tcp://10.0.0.7:8786``.
    timeout
        Longest time to wait for the scheduler and for its first worker, s.

    Raises
    ------
    InputError
        If Dask is not installed, the scheduler does not answer, it has no workers, or their sprung is another one.
    """

    def __init__(self, work: Work, address: str, timeout: float = CONNECTION_TIMEOUT) -> None:
        if find_spec("distributed") is None:
            do = 'Install it: pip install "sprung[dask]".'
            raise InputError([Problem("scheduler", "no package distributed", "Dask's distributed", do)])
        import distributed  # noqa: PLC0415 (optional, and slow to import)

        self._dask: Any = distributed
        self._work, self._address = work, address
        self._tasks: dict[str, Task] = {}
        self._futures: dict[str, Any] = {}
        self._finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._asked, self._threads = -_OFTEN, 0
        try:
            self._client: Any = self._dask.Client(address, timeout=timeout, set_as_default=False)
        except (OSError, TimeoutError, ValueError) as error:
            do = "Check the address and that `dask scheduler` runs there; a firewall may stand between."
            _refuse(
                address,
                f"no answer within {timeout:g} s ({_text(error)})",
                "the scheduler of a Dask cluster",
                do,
                error,
            )
        try:
            self._check_workers(timeout)
        except BaseException:
            self._client.close()
            raise

    def _check_workers(self, timeout: float) -> None:
        try:
            self._client.wait_for_workers(1, timeout=timeout)
        except TimeoutError as error:
            do = f"Start some: dask worker {self._address} --nthreads 1."
            _refuse(self._address, "a scheduler without workers", "one worker or more", do, error)
        own = version("sprung")
        found = self._client.run(_installed_version, on_error="return")
        others = {address: text for address, text in found.items() if text != own}
        if others:
            first, what = next(iter(others.items()))
            what_runs = f"sprung {what}" if isinstance(what, str) else f"no usable sprung ({_text(what)})"
            do = "Install the same version on every machine of the cluster."
            _refuse(f"{self._address}: worker {first}", what_runs, f"sprung {own}, as here", do)

    @property
    def capacity(self) -> int:
        """Number of tasks that it takes at a time; it grows with the cluster."""
        if time.monotonic() - self._asked > _OFTEN:
            try:
                self._threads = sum(self._client.nthreads().values())
            except OSError as error:
                self._lost(error)
            self._asked = time.monotonic()
        return _AHEAD * max(int(self._threads), 1)

    def submit(self, task: Task) -> None:
        """Hand over a task.

        Parameters
        ----------
        task
            Its outcome comes from `collect`.
        """
        key = f"sprung-{content_key([task.campaign, task.key])}"  # two copies of a campaign are two tasks
        try:
            future = self._client.submit(attempt, self._work, task.argument, key=key, pure=False)
        except OSError as error:
            self._lost(error)
        self._tasks[key], self._futures[key] = task, future
        future.add_done_callback(self._finished.put)

    def collect(self, timeout: float) -> list[tuple[Task, Row | Failure]]:
        """Return what is finished.

        Parameters
        ----------
        timeout
            Longest time to wait for the first outcome, s.

        Returns
        -------
        list
            Tasks and their outcomes.

        Raises
        ------
        InputError
            If the connection to the scheduler is lost.
        """
        found: list[tuple[Task, Row | Failure]] = []
        with suppress(queue.Empty):
            future = self._finished.get(timeout=timeout)
            while True:
                if future.key in self._tasks:
                    found.append((self._tasks.pop(future.key), self._outcome(self._futures.pop(future.key))))
                future = self._finished.get_nowait()
        if not found and self._client.status != "running":
            self._lost()
        return found

    def _outcome(self, future: Any) -> Row | Failure:
        try:
            outcome: Row | Failure = future.result(timeout=CONNECTION_TIMEOUT)
        except self._dask.KilledWorker as error:
            return Failure("worker", f"ended its worker process repeatedly ({_text(error)})")
        except (self._dask.CancelledError, TimeoutError) as error:
            self._lost(error)
        except Exception as error:  # noqa: BLE001 (a failure is a row; the other campaigns are done)
            return Failure("worker", f"{type(error).__name__}: {_text(error)}")
        return outcome

    def close(self) -> None:
        """Close the connection; the cluster goes on."""
        self._tasks.clear()
        self._futures.clear()
        self._client.close(timeout=CONNECTION_TIMEOUT)

    def _lost(self, error: Exception | None = None) -> NoReturn:
        _refuse(self._address, "a scheduler that does not answer any more", "one that runs", _KEPT, error)


def _installed_version() -> str:
    return version("sprung")


def _refuse(where: str, found: str, expected: str, do: str, because: Exception | None = None) -> NoReturn:
    raise InputError([Problem(where, found, expected, do)]) from because


def _text(error: object) -> str:
    return " ".join(str(error).split()) or type(error).__name__

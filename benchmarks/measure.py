"""Measuring on a machine that others use too: contestants take turns, and what is told is a median of ratios."""

from __future__ import annotations

import time
import tracemalloc
from collections.abc import Callable, Mapping
from typing import TypeAlias

import numpy as np

Run: TypeAlias = Callable[[], object]


class Turns:
    """Contestants that run one after the other, round after round.

    Parameters
    ----------
    contestants
        What each of them runs, and how often in one round. These runs are spread over the round, so that the machine is as
        fast for everybody; their median counts.
    """

    def __init__(self, contestants: Mapping[str, tuple[Run, int]]) -> None:
        self.contestants = contestants
        self.seconds: dict[str, list[float]] = {name: [] for name in contestants}

    def __call__(self) -> None:
        """Run one round."""
        seconds: dict[str, list[float]] = {name: [] for name in self.contestants}
        for name in self.order:
            seconds[name].append(_seconds(self.contestants[name][0]))
        for name, those in seconds.items():
            self.seconds[name].append(float(np.median(those)))

    @property
    def order(self) -> list[str]:
        """Who runs after whom in a round."""
        turns = [
            ((i + (place + 0.5) / len(self.contestants)) / often, name)
            for place, (name, (_, often)) in enumerate(self.contestants.items())
            for i in range(often)
        ]
        return [name for _, name in sorted(turns)]

    def best(self, name: str) -> float:
        """Return the least time of any round, s."""
        return min(self.seconds[name])

    def ratio(self, name: str, other: str, **wanted: float) -> dict[str, float]:
        """Return time over time, round by round: their median and quartiles, with what is wanted, ``least`` or ``most``."""
        ratios = np.divide(self.seconds[name], self.seconds[other])
        low, median, high = np.quantile(ratios, [0.25, 0.5, 0.75]).tolist()
        return {"ratio": median, "low": low, "high": high} | wanted


def peak_memory(run: Run) -> int:
    """Return the most that a run has allocated at any time, bytes; NumPy tells of its arrays."""
    tracemalloc.start()
    try:
        run()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def _seconds(run: Run) -> float:
    begin = time.perf_counter()
    run()
    return time.perf_counter() - begin

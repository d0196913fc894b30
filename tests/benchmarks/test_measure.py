from __future__ import annotations

import numpy as np
import pytest

from measure import Turns, peak_memory


def test_peak_memory_counts_what_numpy_allocates_and_gives_back() -> None:
    assert 2_000_000 <= peak_memory(lambda: np.zeros(250_000)[:1]) < 2_100_000  # a quarter of a million doubles


def test_ratios_are_taken_round_by_round() -> None:
    """A machine that is slow for a whole round, as the second here, changes no ratio."""
    turns = Turns({"one": (lambda: None, 1), "other": (lambda: None, 1)})
    turns.seconds = {"one": [2.0, 20.0, 2.0], "other": [1.0, 10.0, 1.0]}
    assert turns.ratio("one", "other", least=1) == {"ratio": 2.0, "low": 2.0, "high": 2.0, "least": 1}


def test_contestants_take_turns() -> None:
    order: list[str] = []
    turns = Turns({"one": (lambda: order.append("one"), 4), "other": (lambda: order.append("other"), 2)})
    turns()
    turns()
    assert order == turns.order * 2
    assert turns.order == ["one", "one", "other", "one", "one", "other"]
    assert [len(seconds) for seconds in turns.seconds.values()] == [2, 2]
    assert turns.best("one") == pytest.approx(min(turns.seconds["one"]))

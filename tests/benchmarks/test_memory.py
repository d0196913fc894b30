"""A fit needs little memory beside the records."""

from __future__ import annotations

import pytest

from measure import peak_memory
from ten_drops import SAMPLES, ten_drops


@pytest.mark.long
def test_memory_stays_below_three_times_the_records() -> None:
    task = ten_drops(20)
    assert task.nbytes == 10 * 8 * 20 * SAMPLES * 8  # ten drops of eight channels in double precision
    peak = peak_memory(lambda: task.fit(starts=1))
    assert peak < 3 * task.nbytes

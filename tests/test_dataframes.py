"""pandas is optional."""

from __future__ import annotations

import re
import subprocess
import sys

import numpy as np
import pytest

from sprung.uncertainty import Covariance

WITHOUT = """
import sys
sys.modules["pandas"] = None
import sprung
from sprung.vehicle import TABLE_1_CAR
campaign = sprung.simulate(TABLE_1_CAR, drops=[{}], duration=1.0)
print(sprung.check(campaign).summary)
sprung.identify
"""


@pytest.mark.slow
def test_nothing_else_needs_pandas() -> None:
    done = subprocess.run(  # noqa: S603 (our own code)
        [sys.executable, "-c", WITHOUT],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.startswith("1 of 1 drop usable")


def test_without_pandas_a_table_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    covariance = Covariance(("a",), np.eye(1))
    assert covariance.to_dataframe().loc["a", "a"] == 1.0
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=re.escape('pip install "sprung[pandas]"')):
        covariance.to_dataframe()

"""One thread for everybody, and the machine and its libraries in the result."""

from __future__ import annotations

import os
import sys
from importlib.metadata import version
from typing import Any

import pytest

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
_LIBRARIES = ("numpy", "scipy", "lmfit", "sprung")

# Linear algebra reads these once, when NumPy is imported.
if "numpy" in sys.modules and any(os.environ.get(name) != "1" for name in _THREADS):
    raise pytest.UsageError(
        "NumPy was imported before its threads could be limited; set OMP_NUM_THREADS=1 and the like."
    )
os.environ.update(dict.fromkeys(_THREADS, "1"))


def pytest_benchmark_update_machine_info(config: pytest.Config, machine_info: dict[str, Any]) -> None:  # noqa: ARG001
    machine_info["threads"] = 1
    machine_info["libraries"] = {name: version(name) for name in _LIBRARIES}

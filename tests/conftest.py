"""What every test folder shares."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# Every matrix is small: threads would only wait for each other, on a busy machine for long. Read when NumPy is imported.
for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

# The same examples in every run, so that what lands is what was tested; HYPOTHESIS_PROFILE=default looks for new ones. How long
# an example takes is the machine's: none fails for that.
settings.register_profile("same", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("same")

REPORT = Path(__file__).resolve().parent / "report"
"""Folder of the stored results."""


@pytest.fixture(scope="session")
def shared() -> Path:
    """The development recordings beside the repository, which are not part of the project."""
    folder = Path(__file__).resolve().parents[2] / "shared"
    if not folder.is_dir():
        pytest.skip("needs ../shared")
    return folder


def pytest_addoption(parser: pytest.Parser) -> None:
    """What tests compare with is written anew with ``--regenerate``: ``pytest tests/report --regenerate``, for example."""
    parser.addoption("--regenerate", action="store_true", help="write what these tests compare with anew")


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> None:
    """Write the stored results anew before any test reads one of them, in one process."""
    named = [Path(argument.partition("::")[0]).resolve() for argument in config.args]
    has_results = any(REPORT.is_relative_to(path) or path.is_relative_to(REPORT) for path in named)
    if config.getoption("--regenerate") and has_results:
        import goldens  # noqa: PLC0415 (NumPy with it, which reads the above)

        config.option.numprocesses, config.option.dist = None, "no"
        goldens.regenerate_results()


@pytest.fixture
def regenerate(request: pytest.FixtureRequest) -> bool:
    """Whether displays are to be written anew."""
    return bool(request.config.getoption("--regenerate"))

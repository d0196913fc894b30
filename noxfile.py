"""Tasks: `nox -l` lists them, `nox -s NAME` runs one in an environment of its own."""

from __future__ import annotations

import nox

nox.options.sessions = ["tests", "style", "types", "imports", "docs"]
PYTHONS = ["3.11", "3.12", "3.13"]


@nox.session(python=PYTHONS)
def tests(session: nox.Session) -> None:
    """Run the tests, then those of which each takes seconds."""
    session.install(".[dev,all]")
    session.run("pytest", *session.posargs)
    session.run(
        "pytest", "-m", "slow and not long", *session.posargs, success_codes=[0, 5]
    )  # 5: none among those named


@nox.session
def long(session: nox.Session) -> None:
    """Run the tests that take minutes: statistics, searches, studies."""
    session.install(".[dev,all]")
    session.run("pytest", "-m", "long", *session.posargs)


@nox.session(python="3.11")
def lowest(session: nox.Session) -> None:
    """Run the tests with the oldest NumPy, SciPy and pandas that pyproject.toml admits."""
    project = nox.project.load_toml("pyproject.toml")["project"]
    declared = (*project["dependencies"], *project["optional-dependencies"]["pandas"])
    bounds = {requirement.partition(">=")[0]: requirement for requirement in declared}
    session.install(".[dev,all]")
    session.install(*(bounds[name].replace(">=", "==") for name in ("numpy", "scipy", "pandas")))
    session.run("pytest", *session.posargs)


KERNELS = ("Haswell", "Zen", "SkylakeX", "Nehalem")
"""Of OpenBLAS: each rounds in its own way, as do different numbers of threads."""


@nox.session
@nox.parametrize("threads", ["1", "2"])
@nox.parametrize("kernel", KERNELS)
def rounding(session: nox.Session, kernel: str, threads: str) -> None:
    """Run what is compared word by word as another processor would round it."""
    session.install(".[dev,all]")
    environment = {"OPENBLAS_CORETYPE": kernel, "OPENBLAS_NUM_THREADS": threads}
    compared = ("tests/report", "tests/test_examples.py", "tests/docs", "tests/modal", "tests/estimation")
    session.run("pytest", "-m", "not long", *(session.posargs or compared), env=environment)


@nox.session
def coverage(session: nox.Session) -> None:
    """Run the tests, also the slower ones, and show which branches they miss."""
    session.install("-e", ".[dev,all]")
    session.run("pytest", "-m", "not long", "--cov", "--cov-report=term-missing:skip-covered", *session.posargs)


@nox.session
def style(session: nox.Session) -> None:
    """Check style and format."""
    session.install("ruff")
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")


@nox.session
def types(session: nox.Session) -> None:
    """Check types, strictly."""
    session.install(".[dev,all]")
    session.run("mypy")


@nox.session
def imports(session: nox.Session) -> None:
    """Check that rooms import only from rooms below."""
    session.install("-e", ".[dev,all]")
    session.run("lint-imports")


@nox.session
def bench(session: nox.Session) -> None:
    """Measure speed as ratios, side by side; the result is kept in benchmarks/, and fails where one is not as wanted."""
    session.install(".[dev,all]")
    session.run("pytest", "benchmarks", "-n", "0", "--benchmark-json=benchmarks/result.json", *session.posargs)
    session.run("python", "benchmarks/table.py")


@nox.session
def mutation(session: nox.Session) -> None:
    """Make ten formulas wrong, one at a time, and see whether a test notices; `-- --seed 1` for other ones."""
    session.install("-e", ".[dev,all]")
    session.run("python", "benchmarks/mutation.py", *session.posargs)


@nox.session
def docs(session: nox.Session) -> None:
    """Build the documentation into build/docs; a warning is an error."""
    session.install(".[docs]")
    session.run("sphinx-build", "-W", "--keep-going", "-b", "html", "docs", "build/docs")


@nox.session
def picture(session: nox.Session) -> None:
    """Draw the README's picture, and the figures of the page about the paper."""
    session.install(".[dev,all]", "matplotlib")
    session.run("python", "docs/picture.py")
    session.run("python", "docs/paper_figures.py")


@nox.session
def studies(session: nox.Session) -> None:
    """Write the pages of docs/studies anew: thousands of campaigns, an hour or so; `-- --campaigns 40` for a look."""
    session.install(".[all,peers]", "matplotlib")
    for study in (
        "at_the_bound",
        "parts_of_a_vehicle",
        "exported_drops",
        "excitations",
        "pads",
        "quantities",
        "coloured",
        "no_guess",
        "faults",
        "loggers",
        "friction",
        "engine",
        "fall",
        "differences",
        "ride",
        "modal",
        "real_cars",
        "real_car_faults",
        "real_car_tests",
        "parts_as_they_are",
        "fleets",
    ):
        session.run("python", f"docs/studies/{study}.py", *(session.posargs or ("--processes", "2")))

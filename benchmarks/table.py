"""The page benchmarks/README.md, generated from benchmarks/result.json; reports ratios that miss their requirement."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent

_PAGE = """\
# Benchmarks

Computing time of the maximum likelihood fit compared with fits written with other libraries, with a lower bound of its
cost, and for increasing numbers of samples. `nox -s bench` measures, writes `result.json`, and generates this page with
`table.py`; do not edit it.

Machine: {machine}.

On another machine the ratios differ somewhat, and on a loaded machine they scatter. The programs are run in turns; the
table contains medians over the rounds, with quartiles.

| ratio | median | quartiles | required |
|---|---:|---:|---:|
{ratios}

**The task**: the paper's car, empty and with 200 kg of ballast, dropped ten times; 8 channels, 1500 samples at 500 Hz,
noise 0.02 m/s².

- *Whole fit from its own start*: `fit_jointly(..., starts=1)`. No start values and no noise levels are given; standard
  uncertainties are included. Usually three starts are optimised, to check whether they agree. `sprung.identify` also
  detects where the decays begin, selects the model and assesses the result.
- *Plain SciPy fit* and *lmfit* (`plain.py`): the same sum of squares over the same samples, minimised with derivatives by
  finite differences and each library's own tolerances (lmfit with twice its step: with its own step, rounding ends the
  optimisation too early). They are given a start a fifth from the true values, the noise levels, and the elimination of
  initial states and offsets. The SciPy fit computes no standard uncertainties.
- *Whole fit with friction*: the same drops of the same car with 100 N of dry friction at each wheel, starting from the
  linear fit, with coarse and fine steps. *solve_ivp and differences* (`plain_stepped.py`): the same sum of squares, every
  drop integrated by `scipy.integrate.solve_ivp` (LSODA, 1e-6), derivatives by differences, `least_squares`. It is given a
  start two percent from our optimum, our initial states and our noise levels.
- *On pads*: one minute at 500 Hz of the same car on four pads, with displacement and force of each beside eight
  accelerometers, beside ten drops of six seconds, which are as many samples of the accelerometers.
- *Floor*: one product of the recordings (80 × 1500) with the fourteen exponentials (1500 × 14, complex), in NumPy
  `records @ exponentials`. In real arithmetic the same product takes half the time.

## Agreement of the results

Largest difference of any parameter, in standard uncertainties:

| | standard uncertainties |
|---|---:|
{distances}

*Polished*: SciPy once more, untimed, from our optimum, with central differences and no tolerance. Rounding in the finite
differences changes even this optimum by a few 0.00001 of a standard uncertainty.

## Number of samples

The same three seconds at higher sampling rates:

| samples in a decay | time / time of {shortest} | fit / floor | memory / recordings |
|---:|---:|---:|---:|
{samples}

*Memory*: the maximum that a fit has allocated at any time (`tracemalloc`), divided by the size of the recordings.
"""


def page(result: Mapping[str, Any]) -> str:
    """Return the page for a result of pytest-benchmark."""
    extra = [benchmark["extra_info"] for benchmark in result["benchmarks"]]
    samples = {count: row for info in extra for count, row in info.get("samples", {}).items()}
    distances = {name: apart for info in extra for name, apart in info.get("standard_errors", {}).items()}
    return _PAGE.format(
        machine=_machine(result["machine_info"]),
        ratios="\n".join(
            f"| {name} | {_three(one['ratio'])} | {_quartiles(one)} | {_wanted(one)} |" for name, one in _ratios(result)
        ),
        distances="\n".join(f"| {name} | {apart:.1g} |" for name, apart in distances.items()),
        shortest=next(iter(samples), ""),
        samples="\n".join(
            f"| {count} | {_three(row['time'])} | {_three(row['floors'])} | {_three(row['memory'])} |"
            for count, row in samples.items()
        ),
    )


def missed(result: Mapping[str, Any]) -> list[str]:
    """Return the ratios that miss their requirement, as text."""
    return [
        f"{name}: {_three(one['ratio'])}, required {_bound(one)}" for name, one in _ratios(result) if not _reached(one)
    ]


def _ratios(result: Mapping[str, Any]) -> Iterator[tuple[str, dict[str, float]]]:
    for benchmark in result["benchmarks"]:
        yield from benchmark["extra_info"].get("ratios", {}).items()


def _reached(one: Mapping[str, float]) -> bool:
    return one.get("least", 0.0) <= one["ratio"] <= one.get("most", float("inf"))


def _bound(one: Mapping[str, float]) -> str:
    return f"≥ {one['least']:g}" if "least" in one else f"≤ {one['most']:g}" if "most" in one else ""


def _wanted(one: Mapping[str, float]) -> str:
    return _bound(one) + ("" if _reached(one) else ", **missed**")


def _quartiles(one: Mapping[str, float]) -> str:
    return f"{_three(one['low'])} to {_three(one['high'])}" if "low" in one else ""


def _three(ratio: float) -> str:
    """Return a number with three significant digits."""
    return f"{ratio:#.3g}".rstrip(".")


def _machine(info: Mapping[str, Any]) -> str:
    libraries = ", ".join(f"{name} {version}" for name, version in info["libraries"].items())
    threads = "one thread" if info["threads"] == 1 else f"{info['threads']} threads"
    return (
        f"{info['cpu'].get('brand_raw', info['machine'])} ({info['machine']}, {info['system']}), {threads}, "
        f"{info['python_implementation']} {info['python_version']}, {libraries}"
    )


def main() -> int:
    """Write the page; return 1 if a ratio misses its requirement."""
    result = json.loads((HERE / "result.json").read_text(encoding="utf-8"))
    (HERE / "README.md").write_text(page(result), encoding="utf-8")
    for one in missed(result):
        sys.stderr.write(f"missed: {one}\n")
    return 1 if missed(result) else 0


if __name__ == "__main__":
    sys.exit(main())

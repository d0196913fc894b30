"""The table of benchmarks/README.md, made from benchmarks/result.json; run after the benchmarks, says whether any missed."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent

_PAGE = """\
# Benchmarks

How long the joint fit takes beside what others would write, beside the least it could cost, and with ever more samples.
`nox -s bench` measures, writes `result.json`, and makes this page of it with `table.py`; do not edit it.

Machine: {machine}.

On another machine the ratios differ somewhat, on a busy one they scatter: contestants take turns, and what stands here are
medians over the rounds, with quartiles.

| ratio | median | quartiles | wanted |
|---|---:|---:|---:|
{ratios}

**The task**: the paper's car, empty and with 200 kg of ballast, dropped ten times; 8 channels, 1500 samples at 500 Hz, noise
0.02 m/s².

- *Whole fit from its own start*: `fit_jointly(..., starts=1)`. Nobody gives it a start or the noise; error bars are included.
  Usually three starts are refined, to see whether they agree. `sprung.identify` also finds where the decays begin, and judges.
- *Plain SciPy fit* and *lmfit* (`plain.py`): the same sum of squares over the same samples, minimised with derivatives by
  finite differences and each library's own tolerances (lmfit with twice its step: with its own, rounding stops
  it short). They are given a start a fifth beside the truth, the noise levels, and the elimination of initial states and
  offsets. SciPy's gives no error bars.
- *Whole fit with friction*: the same drops of the same car with 100 N of dry friction at each wheel, from the linear fit on,
  both coarse and fine steps. *solve_ivp and differences* (`plain_stepped.py`): the same sum of squares, every drop followed by
  `scipy.integrate.solve_ivp` (LSODA, 1e-6), derivatives by differences, `least_squares`; it is given a start two percent beside
  our end, our initial states and our noise levels.
- *Floor*: one product of the records (80 × 1500) with the fourteen exponentials (1500 × 14, complex), in NumPy
  `records @ exponentials`. In real arithmetic the same product takes half the time.

## The same answer

Largest difference of any parameter, in its standard errors:

| | standard errors |
|---|---:|
{distances}

*Polished*: SciPy once more, untimed, from our end on, with central differences and no tolerance. Rounding
in finite differences lets even that end move by a few 0.00001 of a standard error.

## With more samples

The same three seconds, sampled more often:

| samples in a decay | time / time of {shortest} | fit / floor | memory / records |
|---:|---:|---:|---:|
{samples}

*Memory*: the most that a fit has allocated at any time (`tracemalloc`), beside the records that it was given.
"""


def page(result: Mapping[str, Any]) -> str:
    """Make the page of what pytest-benchmark has written."""
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
    """Give the ratios that are not as wanted, in words."""
    return [
        f"{name}: {_three(one['ratio'])}, wanted {_bound(one)}" for name, one in _ratios(result) if not _reached(one)
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
    """Give three digits, and no more than that of a large number."""
    return f"{ratio:#.3g}".rstrip(".")


def _machine(info: Mapping[str, Any]) -> str:
    libraries = ", ".join(f"{name} {version}" for name, version in info["libraries"].items())
    threads = "one thread" if info["threads"] == 1 else f"{info['threads']} threads"
    return (
        f"{info['cpu'].get('brand_raw', info['machine'])} ({info['machine']}, {info['system']}), {threads}, "
        f"{info['python_implementation']} {info['python_version']}, {libraries}"
    )


def main() -> int:
    """Write the page; gives 1 where a ratio is not as wanted."""
    result = json.loads((HERE / "result.json").read_text(encoding="utf-8"))
    (HERE / "README.md").write_text(page(result), encoding="utf-8")
    for one in missed(result):
        sys.stderr.write(f"missed: {one}\n")
    return 1 if missed(result) else 0


if __name__ == "__main__":
    sys.exit(main())

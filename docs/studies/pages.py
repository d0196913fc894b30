"""What came of the campaigns of a study, in figures, and how they get on its page."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from campaigns import Case, Real, Trial

import sprung
from sprung.vehicle import PARAMETERS

Outcome = TypeVar("Outcome")

VERDICTS = ("accept", "doubtful", "reject")


@dataclass(frozen=True, eq=False)
class Summary:
    """What came of all campaigns of a case.

    Attributes
    ----------
    case
        The case.
    trials
        One for each campaign.
    """

    case: Case
    trials: tuple[Trial, ...]

    @cached_property
    def _errors(self) -> Real:
        return np.array([trial.error for trial in self.trials])

    @cached_property
    def names(self) -> tuple[str, ...]:
        """What was to be found."""
        return tuple(self.case.truth)

    @cached_property
    def rmse(self) -> Real:
        """Root-mean-square error over the bound, shape (quantity,)."""
        return np.sqrt(_mean(self._errors**2))

    @cached_property
    def bias(self) -> Real:
        """Mean error over the bound, shape (quantity,)."""
        return _mean(self._errors)

    @cached_property
    def stated(self) -> Real:
        """Root-mean-square of the stated standard uncertainty over the bound, shape (quantity,)."""
        return np.sqrt(_mean(np.array([trial.stated for trial in self.trials]) ** 2))

    @property
    def incomplete(self) -> int:
        """Count the campaigns of which a drop was left out."""
        return sum(trial.drops < self.case.drops for trial in self.trials)

    @property
    def wrong_models(self) -> int:
        """Count the campaigns whose half-distances were wrongly taken to be shared, or to be separate."""
        return sum(not trial.right_model for trial in self.trials)

    @property
    def coverage(self) -> float:
        """Percent of all 95 % intervals that hold the truth."""
        return 100 * float(np.nanmean(np.array([trial.covered for trial in self.trials])))

    @property
    def inflation(self) -> float:
        """Mean factor by which variances were enlarged."""
        return float(np.mean([trial.inflation for trial in self.trials]))

    def count(self, verdict: str) -> int:
        """Count the campaigns with a verdict."""
        return Counter(trial.verdict for trial in self.trials)[verdict]

    @property
    def verdicts(self) -> str:
        """Campaigns accepted, doubted and rejected."""
        return " / ".join(str(self.count(verdict)) for verdict in VERDICTS)

    def worst(self, values: Real) -> tuple[float, str]:
        """Return the value of largest magnitude and the name of its quantity."""
        i = int(np.nanargmax(np.abs(values)))
        return float(values[i]), self.names[i]

    def document(self) -> dict[str, Any]:
        """Return all figures for JSON."""
        case, errors = self.case, self._errors
        bound = case.bound(range(case.drops))
        columns = zip(self.names, bound, self.rmse, self.bias, self.stated, errors.T, strict=True)
        return {
            "vehicle": case.vehicle.name,
            "test": case.test,
            "noise": case.noise,
            "campaigns": len(self.trials),
            "rmse_over_bound": figures(np.nanmean(self.rmse)),
            "worst_rmse_over_bound": figures(np.nanmax(self.rmse)),
            "stated_over_bound": figures(np.nanmean(self.stated)),
            "coverage_percent": figures(self.coverage),
            "inflation": figures(self.inflation),
            "inflated": sum(trial.inflation > 1 for trial in self.trials),
            "verdicts": {verdict: self.count(verdict) for verdict in VERDICTS},
            "wrong_models": self.wrong_models,
            "incomplete": self.incomplete,
            "quantities": {
                name if case.scaled or not PARAMETERS[name].scales else f"{name} / total mass": {
                    "bound_percent": figures(100 * limit),
                    "rmse_over_bound": figures(rmse),
                    "bias_over_bound": figures(bias),
                    "stated_over_bound": figures(stated),
                    "undetermined": int(np.isnan(column).sum()),
                }
                for name, limit, rmse, bias, stated, column in columns
            },
        }


def _mean(values: Real) -> Real:
    """Return means over campaigns, NaN excluded, shape (quantity,)."""
    there = ~np.isnan(values)
    mean: Real = np.where(there, values, 0.0).sum(axis=0) / np.where(there.any(axis=0), there.sum(axis=0), np.nan)
    return mean


def figures(value: float | np.floating[Any]) -> float | None:
    """Round to four figures; None where there is no number."""
    return None if np.isnan(value) else float(f"{value:.4g}")


def run(
    work: Callable[..., Outcome], tasks: Sequence[tuple[Any, ...]], processes: int, chunk: int = 10
) -> Iterable[Outcome]:
    """Do work on every task, in order, in so many processes."""
    if processes <= 1:
        yield from (work(*task) for task in tasks)
        return
    with ProcessPoolExecutor(processes) as pool:
        yield from pool.map(work, *zip(*tasks, strict=True), chunksize=chunk)


def summarise(cases: Mapping[Case, int], processes: int) -> list[Summary]:
    """Identify so many campaigns of every case."""
    outcomes = iter(run(Case.identify, [(case, i) for case, count in cases.items() for i in range(count)], processes))
    summaries = []
    for case, count in cases.items():
        summaries.append(Summary(case, tuple(next(outcomes) for _ in range(count))))
        report_progress(f"{case.label}: {count} campaigns, {np.nanmean(summaries[-1].rmse):.3f} of the bound")
    return summaries


def report_progress(text: str) -> None:
    """Print progress on standard error."""
    sys.stderr.write(text + "\n")


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Write a table; every column but the first is set to the right."""
    rule = ["---", *("---:" for _ in head[1:])]
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, rule, *rows))


def arguments(description: str, campaigns: int) -> argparse.ArgumentParser:
    """Return a parser with the options of every study."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument(
        "--campaigns", type=int, default=campaigns, help="how many noisy campaigns (default %(default)s)"
    )
    parser.add_argument("--processes", type=int, default=1, help="how many at a time (default %(default)s)")
    here = Path(__file__).parent
    parser.add_argument(
        "--to", type=Path, default=here, help="folder of page and numbers (default: beside this script)"
    )
    return parser


def program() -> str:
    """Return the commit of the program that is run, `-dirty` where files differ from it; its version without a history."""
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--exclude=*", "--abbrev=8", "--dirty"]
    try:
        described = subprocess.run(command, capture_output=True, text=True, check=True)  # noqa: S603 (our own text)
    except (OSError, subprocess.CalledProcessError):
        return sprung.__version__
    return described.stdout.strip()


PROGRAM = program()
"""As it was when the study began: files may change while it runs."""


def write(
    folder: Path, name: str, page: str, numbers: Mapping[str, Sequence[Mapping[str, Any]]], made_by: str = PROGRAM
) -> None:
    """Write a study's page, its last line the program that made it all, and its numbers, one line for each case."""
    folder.mkdir(parents=True, exist_ok=True)
    made = f"\nMade by the program of commit {made_by}.\n" if made_by else ""
    (folder / f"{name}.md").write_text(page + made, encoding="utf-8")
    lists = []
    for key, cases in numbers.items():
        lines = ",\n".join("  " + json.dumps(case, ensure_ascii=False, allow_nan=False) for case in cases)
        lists.append(f'"{key}": [\n{lines}\n]')
    (folder / f"{name}.json").write_text("{\n" + ",\n".join(lists) + "\n}\n", encoding="utf-8")


def write_figure(figure: Any, path: Path) -> None:
    """Write a figure (matplotlib) as SVG; the same figure is the same file."""
    from matplotlib import rc_context  # noqa: PLC0415 (optional)

    path.parent.mkdir(parents=True, exist_ok=True)
    with rc_context({"svg.hashsalt": "sprung"}):
        figure.savefig(path, metadata={"Date": None})

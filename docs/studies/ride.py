"""Do the 95 % intervals of ride numbers contain the true value? Writes ride.md.

Run with `python docs/studies/ride.py --campaigns 200 --processes 1`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from campaigns import DURATION, RATE, WEIGHING, Case, Real
from pages import arguments, figures, report_progress, run, table, write
from parts_of_a_vehicle import PITCH_PLANE, QUARTER_CAR

import sprung
from sprung.ride import RideNumbers, ride_numbers
from sprung.vehicle import TABLE_1_CAR, Vehicle

ROAD = "C"
"""A linear vehicle answers other classes in proportion: their intervals contain the truth in the same campaigns."""

COVERAGE = (93.0, 97.0)
"""What is wanted, percent."""

RUBBING = QUARTER_CAR.with_values(F=60.0, s=1.5e5, r=1.6, name="Quarter car with friction and rebound")

GROUPS = {
    "axles": "quarter cars, their frequencies and damping ratios",
    "half_cars": "half cars",
    "peaks": "largest transmissibilities",
    "plates": "suspension testers",
    "places": "accelerations of places, VDV",
    "body": "pitch and roll",
    "wheels": "wheels on the road",
}


@dataclass(frozen=True)
class Test:
    """A vehicle, its test and the model terms that are stated."""

    case: Case
    terms: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """All of it in words."""
        return f"{self.case.vehicle.name}, {self.case.test}, {self.case.noise:g} m/s²"

    def judge(self, number: int) -> Trial:
        """Identify one campaign, and hold its ride numbers against the truth."""
        result = sprung.identify(self.case.campaign(number), extras=self.terms, fall=False)
        if result.verdict.state == "reject":
            return Trial(result.verdict.state, {})
        truth = true_numbers(self.case.vehicle)
        found = dict(ride_numbers(result, roads=ROAD).items())
        held = {}
        for name, estimate in found.items():
            if estimate.value is not None and estimate.std and estimate.interval95 is not None:
                low, high = (limit or 0.0 for limit in estimate.interval95)
                held[name] = (low <= truth[name] <= high, (estimate.value - truth[name]) / estimate.std, estimate.std)
        return Trial(result.verdict.state, held)


class Trial(NamedTuple):
    """What came of one campaign: its verdict, and by number whether the interval held, the error over the std, and the std."""

    verdict: str
    held: Mapping[str, tuple[bool, float, float]]


TESTS = (
    Test(Case(TABLE_1_CAR, False, ("total_mass",), 0.1)),
    Test(Case(TABLE_1_CAR, False, (), 0.1)),
    Test(Case(PITCH_PLANE, False, ("total_mass",), 0.1)),
    Test(Case(QUARTER_CAR, False, ("total_mass",), 0.1)),
    Test(Case(RUBBING, False, ("total_mass",), 0.02), ("friction", "rebound")),
)


def group_of(name: str) -> str:
    """Return the group of a number, from its full name: of numbers of a road the part before place and quantity."""
    parts = name.split(".")
    return parts[-3] if parts[0] == "roads" else parts[0]


@lru_cache
def true_numbers(vehicle: Vehicle) -> dict[str, float]:
    """Return the ride numbers of a vehicle whose parameters are known, SI."""
    found: RideNumbers = ride_numbers(vehicle, roads=ROAD)
    return {name: one.value for name, one in found.items() if one.value is not None}


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came of all campaigns of a test."""

    test: Test
    trials: Sequence[Trial]

    @property
    def names(self) -> tuple[str, ...]:
        """The ride numbers with an interval."""
        return tuple(dict.fromkeys(name for trial in self.trials for name in trial.held))

    def of(self, name: str) -> Real:
        """Return held, error over std and std of a number in each campaign, shape (campaign, 3)."""
        return np.array([trial.held[name] for trial in self.trials if name in trial.held], dtype=float)

    def coverage(self, name: str) -> float:
        """Return the percentage of intervals that held the true value."""
        return 100 * float(self.of(name)[:, 0].mean())

    @property
    def rows(self) -> list[list[str]]:
        """Rows of the page, one for each group of numbers."""
        found = []
        for group, words in GROUPS.items():
            own = [name for name in self.names if group == group_of(name)]
            if not own:
                continue
            covered = np.array([self.coverage(name) for name in own])
            scaled = np.array([np.sqrt((self.of(name)[:, 1] ** 2).mean()) for name in own])
            row = [words, f"{len(own)}", f"{covered.mean():.1f}", f"{covered.min():.1f}", f"{covered.max():.1f}"]
            found.append([*row, f"{scaled.min():.2f} to {scaled.max():.2f}"])
        return found

    def document(self) -> dict[str, Any]:
        """Return all figures for JSON."""
        covered = [self.coverage(name) for name in self.names]
        return {
            "vehicle": self.test.case.vehicle.name,
            "test": self.test.case.test,
            "noise": self.test.case.noise,
            "campaigns": len(self.trials),
            "rejected": sum(trial.verdict == "reject" for trial in self.trials),
            "coverage_percent": figures(float(np.mean(covered))),
            "numbers": {
                name: {
                    "coverage_percent": figures(self.coverage(name)),
                    "rms_error_over_std": figures(float(np.sqrt((self.of(name)[:, 1] ** 2).mean()))),
                    "mean_std": figures(float(self.of(name)[:, 2].mean())),
                }
                for name in self.names
            },
        }


def main() -> None:
    """Run the study."""
    options = arguments("Coverage of the intervals of ride numbers.", campaigns=200).parse_args()
    outcomes = []
    for test in TESTS:
        tasks = [(test, i) for i in range(options.campaigns)]
        outcomes.append(Outcome(test, tuple(run(Test.judge, tasks, options.processes))))
        report_progress(f"{test.label}: {outcomes[-1].document()['coverage_percent']} % of the intervals")
    write(options.to, "ride", page(outcomes), {"cases": [one.document() for one in outcomes]})


def page(outcomes: Sequence[Outcome]) -> str:
    """Write the page."""
    many = len(outcomes[0].trials)
    low, high = COVERAGE
    spread = 100 * np.sqrt(0.95 * 0.05 / many)
    every = [(one, name, one.coverage(name)) for one in outcomes for name in one.names]
    inside = sum(low <= covered <= high for _, _, covered in every)
    chance = sum(95 - 3 * spread <= covered <= 95 + 3 * spread for _, _, covered in every)
    worst_case, worst_name, worst = min(every, key=lambda one: -abs(one[2] - 95))
    head = ["numbers", "how many", "covered, mean, %", "lowest", "highest", "rms error over std"]
    sections = [f"### {one.test.label}\n\n{_rejections(one)}{table(head, one.rows)}\n" for one in outcomes]
    return f"""# Ride numbers

Every [ride number](../ride.md) has a 95 % interval that follows from the joint distribution of the parameters to first order.
Do 95 % of these intervals contain the true value?

## Method

Campaigns as in the study of [accuracy relative to the bound](at-the-bound.md): drops from blocks of 5 cm under all wheels and
under the wheels of each end and side, free decay for {DURATION:g} s, {RATE:g} Hz, white noise; what is weighed has a standard
uncertainty of {100 * WEIGHING:g} %. Each campaign is identified with the true model terms, and `sprung.ride.ride_numbers`
computes all numbers on a road of class {ROAD} at 80 km/h. The truth is what the same function gives for the vehicle that was
simulated: the study tests the intervals, not the methods, which the tests compare with closed forms and simulations.

## Result

{many} campaigns in every case. A coverage from so many has a standard uncertainty of {spread:.1f} %, and the numbers of a case
are strongly correlated. Of {len(every)} numbers {inside} are within {low:g} to {high:g} %, and {chance} within three standard
uncertainties of 95 %. The mean over all is {np.mean([covered for *_, covered in every]):.1f} %; the farthest from 95 % is
`{worst_name}` with {worst:.1f} % ({worst_case.test.label}).

{chr(10).join(sections)}
Every number is in [ride.json](ride.json).

## Reproduction

    python docs/studies/ride.py --campaigns {many} --processes 2
"""


def _rejections(outcome: Outcome) -> str:
    rejected = sum(trial.verdict == "reject" for trial in outcome.trials)
    return f"{rejected} of {len(outcome.trials)} campaigns were rejected and are left out.\n\n" if rejected else ""


if __name__ == "__main__":
    main()

"""Are errors at the Cramér-Rao bound where pads drive the vehicle, too? Writes pads.md.

Run with `python docs/studies/pads.py --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pages import arguments, figures, report_progress, run, table, write
from parts_of_a_vehicle import PITCH_PLANE, QUARTER_CAR, ROLL_PLANE

import sprung
from sprung.estimation.closed_form import linear_objective
from sprung.preprocess import prepare
from sprung.simulation import PadMotion
from sprung.vehicle import TABLE_1_CAR, Readout, Vehicle

Real = NDArray[np.float64]

NOISE: Mapping[str, float] = {"acceleration": 0.02, "displacement": 5e-5, "force": 8.0}
"""m/s², m and N root-mean-square: the force to 0.2 % of a wheel load."""

DURATION, RATE = 30.0, 500.0
"""s of each record on pads, samples per second."""

MEAN, COVERAGE = 1.05, (93.0, 97.0)
"""What is wanted: error over bound in the mean, and percent of intervals."""

WITH_DROPS: tuple[Mapping[str, Any], ...] = ({"excitation": "pads"}, {"wheels": ("fl", "fr")}, {"wheels": ("fl", "rl")})


@dataclass(frozen=True)
class Case:
    """A vehicle and how its pads move.

    Attributes
    ----------
    vehicle
        The vehicle.
    motion
        Of its pads.
    with_drops
        Whether it is also dropped, twice.
    """

    vehicle: Vehicle
    motion: PadMotion
    with_drops: bool = False

    @property
    def test(self) -> str:
        """The test in words."""
        return f"{self.motion.kind}, and two drops" if self.with_drops else self.motion.kind

    def campaign(self, number: int | None) -> sprung.Campaign:
        """Return one noisy campaign, or without a number the one without noise."""
        drops = WITH_DROPS if self.with_drops else ({"excitation": "pads"},)
        noise: Any = 0 if number is None else NOISE
        return sprung.simulate(self.vehicle, drops=drops, pads=self.motion, noise=noise, seed=number, rate=RATE)


CASES = (
    Case(TABLE_1_CAR, PadMotion("random", duration=DURATION)),
    Case(TABLE_1_CAR, PadMotion("random", duration=DURATION), with_drops=True),
    Case(PITCH_PLANE, PadMotion("sweep", duration=DURATION)),
    Case(ROLL_PLANE, PadMotion("random", duration=DURATION)),
    Case(QUARTER_CAR, PadMotion("sweep", duration=DURATION)),
    Case(QUARTER_CAR, PadMotion("step", duration=DURATION)),
)


@cache
def bound(case: Case) -> Real:
    """Return the Cramér-Rao bound of each parameter, relative, for noise levels that are known."""
    campaign = case.campaign(None)
    names, values = tuple(case.vehicle.parameters), np.array(list(case.vehicle.parameters.values()))
    models = {"empty": case.vehicle.linear_model()}
    # Where the free vibration of a drop begins is found by the fit; the bound is that of the decays as first extracted.
    decays = prepare(case.campaign(0)).decays
    clean = {drop.recording.name: drop.recording for drop in campaign.drops}
    exact = []
    for decay in decays:
        first = round((decay.start - clean[decay.file].start) * decay.rate)
        own = clean[decay.file].values[:, first : first + decay.samples]
        exact.append(replace(decay, values=np.where(decay.usable[:, None], own, np.nan)))
    weights = np.array([NOISE[sensor.quantity] for sensor in campaign.sensors]) ** -2.0
    objective = linear_objective(exact, models, Readout.of(campaign.sensors, names), campaign.sensors)
    information = objective.at(values, weights).information * np.outer(values, values)
    if "a" in names and "b" in names:  # the wheelbase is known exactly: b moves as a does
        step = np.eye(len(names))
        step[names.index("b"), names.index("a")] = -values[names.index("a")] / values[names.index("b")]
        step = np.delete(step, names.index("b"), axis=1)
        return np.sqrt(np.diag(step @ np.linalg.inv(step.T @ information @ step) @ step.T))
    return np.sqrt(np.diag(np.linalg.inv(information)))


def identify(case: Case, number: int) -> tuple[list[float], list[float], bool]:
    """Return errors and standard uncertainties of one campaign, relative, and whether it was accepted without further terms."""
    result = sprung.identify(case.campaign(number))
    truth = case.vehicle.parameters
    found = [result.parameters[name] for name in truth]
    errors = [
        np.nan if one.value is None else one.value / truth[name] - 1 for name, one in zip(truth, found, strict=True)
    ]
    stated = [np.nan if one.std is None else one.std / truth[name] for name, one in zip(truth, found, strict=True)]
    return errors, stated, result.verdict.state == "accept" and not result.fit.model


def summary(case: Case, trials: Sequence[tuple[list[float], list[float], bool]]) -> dict[str, Any]:
    """Return the figures of a case."""
    errors, stated = (np.array([trial[i] for trial in trials]) for i in (0, 1))
    limit = bound(case)
    rmse = np.sqrt(np.nanmean(errors**2, axis=0)) / limit
    names = list(case.vehicle.parameters)
    worst = int(np.nanargmax(rmse))
    return {
        "vehicle": case.vehicle.name,
        "test": case.test,
        "campaigns": len(trials),
        "accepted": sum(trial[2] for trial in trials),
        "rmse_over_bound": figures(np.nanmean(rmse)),
        "worst_rmse_over_bound": figures(rmse[worst]),
        "worst": names[worst],
        "largest_error_percent": figures(100 * np.nanmax(np.abs(errors))),
        "coverage_percent": figures(100 * float(np.mean(np.abs(errors) < 1.96 * stated))),
        "quantities": {
            name: {
                "bound_percent": figures(100 * limit[i]),
                "rmse_over_bound": figures(rmse[i]),
                "bias_over_bound": figures(np.nanmean(errors[:, i]) / limit[i]),
                "stated_over_bound": figures(np.sqrt(np.nanmean(stated[:, i] ** 2)) / limit[i]),
            }
            for i, name in enumerate(names)
        },
    }


def main() -> None:
    """Run the study."""
    options = arguments("Errors of vehicles on pads beside the Cramér-Rao bound.", campaigns=200).parse_args()
    summaries = []
    for case in CASES:
        trials = list(run(identify, [(case, number) for number in range(options.campaigns)], options.processes, 1))
        summaries.append(summary(case, trials))
        report_progress(f"{case.vehicle.name}, {case.test}: {summaries[-1]['rmse_over_bound']} of the bound")
    write(options.to, "pads", page(summaries), {"cases": summaries})


def page(summaries: Sequence[Mapping[str, Any]]) -> str:
    """Write the page."""
    many, (low, high) = summaries[0]["campaigns"], COVERAGE
    head = ["vehicle", "pads", "error, mean", "error, worst", "covered, %", "largest error, %", "accepted"]
    rows = [
        [
            one["vehicle"],
            one["test"],
            f"{one['rmse_over_bound']:.3f}",
            f"{one['worst_rmse_over_bound']:.3f} ({one['worst']})",
            f"{one['coverage_percent']:.1f}",
            f"{one['largest_error_percent']:.2f}",
            f"{one['accepted']}",
        ]
        for one in summaries
    ]
    return f"""# Vehicles on pads

A vehicle stands on a four-post rig or on inspection plates, which move it while their displacements and the forces under the
tyres are recorded ([the campaign file](../campaign.md#pads)). Nothing is weighed. Are the errors at the
{{term}}`Cramér-Rao bound`?

## Method

Each record takes {DURATION:g} s at {RATE:g} Hz. Noise: {NOISE["acceleration"]:g} m/s² of accelerometers on the body over each
wheel and on each wheel, {1e3 * NOISE["displacement"]:g} mm of the displacement and {NOISE["force"]:g} N of the force of
each pad, which is 0.2 % of a wheel load. *random*: all pads at once; *sweep*: one pad after the other from 0.5 to 25 Hz;
*step*: one pad after the other 6 mm up and down again. The complete `sprung.identify` analyses each campaign and selects the
model. The motion is integrated in the time domain by Gauss-Legendre quadrature, the likelihood is that of
[spectral lines](../theory.md#pads).

## Result

{many} campaigns in every row; a root-mean-square error from so many has a statistical uncertainty of
{100 / np.sqrt(2 * many):.1f} %. Required are at most {MEAN:g} in the mean over the parameters, and {low:g} to {high:g} % of the
95 % intervals containing the true value. Accepted are campaigns with that verdict and no further model term.

{table(head, rows)}

Every parameter of every case is in [pads.json](pads.json).

## Reproduction

    python docs/studies/pads.py --campaigns {many} --processes 2
"""


if __name__ == "__main__":
    main()

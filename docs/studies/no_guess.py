"""Is the global optimum found without given start values? Writes no-guess.md.

Run with `python docs/studies/no_guess.py --campaigns 500 --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import math
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from campaigns import AXLES, WEIGHING, Case, Real, Trial
from numpy.typing import NDArray
from pages import VERDICTS, arguments, figures, report_progress, run, table, write

from sprung.analysis import identify_campaign
from sprung.analysis.identify import result_of
from sprung.estimation import fit_linear
from sprung.vehicle import Vehicle

MASS = (400.0, 16_000.0)
"""Of the body, kg."""

BODY, HOP = (0.7, 4.0), (7.0, 30.0)
"""Undamped frequencies of the body's three and the wheels' four modes, Hz."""

DAMPING = (0.05, 1.2)
"""Of each end's dampers, as a part of what would be critical for that end of the body on its springs."""

NOISE = 0.02
"""m/s² root-mean-square."""

TESTS: tuple[tuple[bool, tuple[str, ...]], ...] = ((False, ("total_mass",)), (False, AXLES), (True, ()))
"""With a load or not, and what is weighed: one after the other."""

SAME = 0.01
"""Difference of log-likelihoods within which two fits have ended in the same place."""


class Search(NamedTuple):
    """How the fit of one vehicle went.

    Attributes
    ----------
    trial
        What came of it.
    gain
        Log-likelihood over that of a fit of the same decays started at the truth.
    agreeing, starts
        How many of the fit's own starts ended in the same place, and how many there were.
    real_poles
        How many real poles the vehicle has.
    reason
        The verdict's first one.
    """

    trial: Trial
    gain: float
    agreeing: int
    starts: int
    real_poles: int
    reason: str


def vehicle(number: int) -> Vehicle:
    """Draw a vehicle: drawn again until every mode is where it may be."""
    random = np.random.default_rng([2, number])
    while True:
        one = _draw(random, number)
        M, _, K = one.matrices()
        frequencies = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real)) / (2 * np.pi)
        body, hop = frequencies[:3], frequencies[3:]
        if BODY[0] <= body[0] and body[-1] <= BODY[1] and HOP[0] <= hop[0] and hop[-1] <= HOP[1]:
            return one


def _draw(random: np.random.Generator, number: int) -> Vehicle:
    def between(limits: tuple[float, float]) -> Real:
        drawn: Real = np.exp(random.uniform(math.log(limits[0]), math.log(limits[1]), 2))
        return drawn

    mass = float(between(MASS)[0])
    wheelbase = 2.2 * (mass / 400) ** 0.25 * random.uniform(0.9, 1.2)
    share = random.uniform(0.35, 0.65)
    a, b = (1 - share) * wheelbase, share * wheelbase
    corner = mass / 2 * np.array([share, 1 - share])
    wheel = mass * random.uniform(0.015, 0.06, 2)
    spring = corner * (2 * np.pi * between(BODY)) ** 2
    tyre = np.maximum(wheel * (2 * np.pi * between(HOP)) ** 2 - spring, spring)
    damper = 2 * between(DAMPING) * np.sqrt(spring * corner)
    track = wheelbase * random.uniform(0.2, 0.32, 2)
    return Vehicle(
        name=f"Vehicle {number}",
        m_s=mass,
        I_yy=mass * a * b * random.uniform(0.7, 1.3),
        I_xx=mass * float(track.mean()) ** 2 * random.uniform(0.5, 1.2),
        m_uf=float(wheel[0]),
        m_ur=float(wheel[1]),
        k_sf=float(spring[0]),
        k_sr=float(spring[1]),
        k_tf=float(tyre[0]),
        k_tr=float(tyre[1]),
        c_sf=float(damper[0]),
        c_sr=float(damper[1]),
        a=a,
        b=b,
        t_f=float(track[0]),
        t_r=float(track[1]),
    )


def search(case: Case, number: int) -> Search:
    """Identify a vehicle without a guess, from its free decays, and fit these from the truth."""
    run = identify_campaign(case.campaign(number), fall=False)
    structure, fit = run.model.structure, run.uncertainty
    truth = {name: float(getattr(case.vehicle, name)) for name in fit.names}
    from_truth = fit_linear(run.decays, structure.linear_models, run.campaign.sensors, structure.known, start=truth)
    poles = np.linalg.eigvals(case.vehicle.matrices().state)
    result = result_of(run)
    return Search(
        case.judge(result),
        fit.loglikelihood - from_truth.loglikelihood,
        fit.starts_agreeing,
        fit.starts,
        int(np.sum(np.abs(poles.imag) < 1e-9 * np.abs(poles))),
        result.verdict.reasons[0],
    )


def main() -> None:
    """Run the study."""
    options = arguments("Fits without a guess beside fits from the truth.", campaigns=500).parse_args()
    cases = [Case(vehicle(number), *TESTS[number % len(TESTS)], NOISE) for number in range(options.campaigns)]
    searches = []
    for case, one in zip(cases, run(search, [(case, 0) for case in cases], options.processes), strict=True):
        searches.append(one)
        if abs(one.gain) > SAME or one.trial.verdict != "accept":
            report_progress(f"{case.label}: {one.gain:+.3f} beside the fit from the truth, {one.trial.verdict}")
    write(options.to, "no-guess", page(cases, searches), {"vehicles": [*map(document, cases, searches)]})


def document(case: Case, one: Search) -> dict[str, object]:
    """Return the vehicle and the figures of its fit for JSON."""
    return {
        "parameters": {name: figures(value) for name, value in case.vehicle.parameters.items()},
        "test": case.test,
        "real_poles": one.real_poles,
        "gain_over_start_at_truth": round(one.gain, 4),
        "starts_agreeing": one.agreeing,
        "starts": one.starts,
        "verdict": one.trial.verdict,
        "inflation": figures(one.trial.inflation),
        "reason": None if one.trial.verdict == "accept" else one.reason,
        "worst_error_over_stated": figures(np.nanmax(np.abs(one.trial.error / one.trial.stated), initial=0.0)),
    }


def page(cases: Sequence[Case], searches: Sequence[Search]) -> str:
    """Write the page."""
    many = len(searches)
    gains = np.array([one.gain for one in searches])
    missed, beaten = int(np.sum(gains < -SAME)), int(np.sum(gains > SAME))
    real = np.array([one.real_poles > 0 for one in searches])
    covered = 100 * float(np.nanmean(np.array([one.trial.covered for one in searches])))
    agreeing = Counter(f"{one.agreeing} of {one.starts}" for one in searches)
    kinds = {"all": np.ones(many, dtype=bool), "with real poles": real, "without real poles": ~real}
    kinds |= {test: np.array([one.test == test for one in cases]) for test in dict.fromkeys(one.test for one in cases)}
    rows = [[what, *_row(searches, gains, those)] for what, those in kinds.items()]
    head = ["vehicles", "campaigns", "optimum missed", "lowest gain", *VERDICTS]
    ended = ", ".join(f"{key} in {count}" for key, count in sorted(agreeing.items(), reverse=True))
    missed_vehicles = "\n".join(
        f"- {case.vehicle.name}, by {-one.gain:.2f}; verdict: {one.trial.verdict}, {one.reason}."
        for case, one in zip(cases, searches, strict=True)
        if one.gain < -SAME
    )
    masses = f"{MASS[0]:g} kg to {MASS[1] / 1000:g} t"
    body, hop = f"{BODY[0]:g} and {BODY[1]:g} Hz", f"{HOP[0]:g} and {HOP[1]:g} Hz"
    damping = f"{DAMPING[0]:g} to {DAMPING[1]:g}"
    return f"""# Start values

The optimisation computes its own start values: modulating function estimates, and a grid of usual vehicles. No start
value is asked of the user. A likelihood may have several local maxima. Is the optimum found the global one for every
vehicle?

## Method

{many} two-axle vehicles were drawn at random: sprung mass from {masses}, body modes between {body},
wheel hop between {hop} (undamped frequencies of the whole vehicle), and damping ratios from {damping} of each
end of the body on its springs; {
        real.sum()
    } of the vehicles have real poles. Each was dropped from blocks of 5 cm, with all,
front, rear, left and right wheels, with {NOISE:g} m/s² of white noise, and was either weighed (total mass or both
axles, with an error drawn from an uncertainty of {
        100 * WEIGHING:g} % of its mass) or dropped again with a load. Only the wheelbase is
known.

Every campaign was analysed by the complete `sprung.identify` without the flight phase. Then the same free decays were
fitted once more, from a start at the true parameters, which converges to the maximum nearest to them. *Gain* is the
log-likelihood of the fit without given start values minus that of the fit from the true values; the optimum counts as
missed if it is below -{SAME:g}.

## Results

The optimum was missed {_times(missed)}; the fit from the truth ended lower than the one without a guess {
        _times(beaten)
    }.
Number of optimised starts that reached the same optimum: {ended}.
Of all 95 % intervals {covered:.1f} % contain the true value.

{table(head, rows)}
{
        f'''
Where it was missed:

{missed_vehicles}
'''
        if missed_vehicles
        else ""
    }
The verdict refers to the data, not to the search. Every vehicle, with its verdict, is in [no-guess.json](no-guess.json).

## Reproduction

    python docs/studies/no_guess.py --campaigns {many} --processes 2
"""


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _row(searches: Sequence[Search], gains: Real, those: NDArray[np.bool_]) -> list[str]:
    counts = Counter(one.trial.verdict for one, mine in zip(searches, those, strict=True) if mine)
    lowest = f"{round(gains[those].min(), 4) + 0.0:.4f}" if those.any() else "-"
    missed = int(np.sum(gains[those] < -SAME))
    return [f"{those.sum()}", f"{missed}", lowest, *(f"{counts[verdict]}" for verdict in VERDICTS)]


if __name__ == "__main__":
    main()

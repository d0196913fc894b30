"""Are errors at the Cramér-Rao bound for a part of a vehicle, too? Writes parts-of-a-vehicle.md.

Run with `python docs/studies/parts_of_a_vehicle.py --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Sequence

import numpy as np
from campaigns import DURATION, LOAD, RATE, WEIGHING, Case
from pages import VERDICTS, Summary, arguments, summarise, table, write

from sprung.vehicle import Vehicle

QUARTER_CAR = Vehicle(model="quarter", name="Quarter car", m_s=340.0, m_u=42.0, k_s=21e3, k_t=195e3, c_s=1450.0)
ROLL_PLANE = Vehicle(
    model="roll-plane",
    name="Roll plane",
    m_s=690.0,
    I_xx=170.0,
    m_u=44.0,
    k_s=23e3,
    k_t=190e3,
    c_s=1600.0,
    t=0.71,
)
PITCH_PLANE = Vehicle(
    model="pitch-plane",
    name="Pitch plane",
    m_s=650.0,
    I_yy=980.0,
    m_uf=40.0,
    m_ur=36.0,
    k_sf=19e3,
    k_sr=23e3,
    k_tf=190e3,
    k_tr=185e3,
    c_sf=1400.0,
    c_sr=1650.0,
    a=1.15,
    b=1.45,
)
"""Made up, each of one half or one quarter of a medium-sized car."""

TESTS: tuple[tuple[bool, tuple[str, ...]], ...] = ((True, ()), (True, ("total_mass",)), (False, ("total_mass",)))
"""With a load or not, and what is weighed."""

NOISE = (0.02, 0.1)
"""m/s² root-mean-square."""

VERDICT = " / ".join(VERDICTS)

MEAN, COVERAGE = 1.05, (93.0, 97.0)
"""What is wanted: error over bound in the mean, and percent of intervals."""


def main() -> None:
    """Run the study."""
    options = arguments("Errors of parts of a vehicle beside the Cramér-Rao bound.", campaigns=200).parse_args()
    cases = [
        Case(vehicle, *test, noise)
        for vehicle in (QUARTER_CAR, ROLL_PLANE, PITCH_PLANE)
        for test in TESTS
        for noise in NOISE
    ]
    summaries = summarise(dict.fromkeys(cases, options.campaigns), options.processes)
    numbers = {"cases": [one.document() for one in summaries]}
    write(options.to, "parts-of-a-vehicle", page(summaries), numbers)


def as_wanted(one: Summary) -> bool:
    """Whether a case meets the requirements."""
    low, high = COVERAGE
    return bool(np.nanmean(one.rmse) <= MEAN and low <= one.coverage <= high)


def page(summaries: Sequence[Summary]) -> str:
    """Write the page."""
    many = len(summaries[0].trials)
    met, (low, high) = sum(as_wanted(one) for one in summaries), COVERAGE
    head = ["vehicle", "test", "noise, m/s²", "error, mean", "error, worst", "covered, %", VERDICT, "requirement met"]
    rows = []
    for one in summaries:
        error, of = one.worst(one.rmse)
        row = [one.case.vehicle.name, one.case.test, f"{one.case.noise:g}", f"{np.nanmean(one.rmse):.3f}"]
        row += [f"{error:.3f} ({of})", f"{one.coverage:.1f}", one.verdicts, "yes" if as_wanted(one) else "no"]
        rows.append(row)
    return f"""# Parts of a vehicle

A quarter car, a roll plane and a pitch plane ([the campaign file](../campaign.md#a-part-of-a-vehicle)) are identified by the
same program from fewer sensors and fewer drops. Are their errors at the {{term}}`Cramér-Rao bound`, too?

## Method

As for whole vehicles ([accuracy relative to the bound](at-the-bound.md)): every campaign is simulated drop by drop from
blocks of 5 cm under all wheels and under each of two wheels, free decay for {DURATION:g} s, a sensor on the body over each
wheel and one on each wheel, {RATE:g} Hz, white noise. The load has {100 * LOAD:g} % of the vehicle's mass; the *weighed* total
mass has a standard uncertainty of {100 * WEIGHING:g} %. The complete `sprung.identify` analyses each campaign and selects the
model.

## Result

{many} campaigns in every row; a root-mean-square error from so many has a statistical uncertainty of
{100 / np.sqrt(2 * many):.1f} %. Required are at most {MEAN:g} in the mean over the parameters, and {low:g} to {high:g} % of the
95 % intervals containing the true value; {met} of {len(summaries)} rows meet both. Where only the load determines the scale,
the errors of all masses and rates are almost one error, so that their mean and their coverage are as uncertain as those of
one parameter.

{table(head, rows)}

Every parameter of every case is in [parts-of-a-vehicle.json](parts-of-a-vehicle.json).

## Reproduction

    python docs/studies/parts_of_a_vehicle.py --campaigns {many} --processes 2
"""


if __name__ == "__main__":
    main()

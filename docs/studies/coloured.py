"""Are the stated uncertainties correct if the noise is not white? Writes coloured.md.

Run with `python docs/studies/coloured.py --campaigns 500 --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Mapping, Sequence

import numpy as np
from campaigns import AXLES, RATE, Case, Measure, Real, white
from pages import VERDICTS, Summary, arguments, summarise, table, write
from scipy.signal import lfilter

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import TABLE_1_CAR

NOISE = 0.02
"""m/s² root-mean-square."""

TIME_CONSTANT = 0.02
"""s of the low-pass that colours the noise."""

DRIFT = 0.05
"""m/s² over a record."""

STEP = 20 * STANDARD_GRAVITY / 2**12
"""m/s²: twelve bits over ten g either way."""

WANTED = 90.0
"""Percent of the 95 % intervals that are to hold the truth, at least."""

TESTS: tuple[tuple[bool, tuple[str, ...]], ...] = ((True, ("total_mass",)), (False, AXLES))


def low_passed(record: Real, level: Real | float, random: np.random.Generator, rate: float = RATE) -> Real:
    """Add noise of the same power behind a first-order low-pass."""
    kept = np.exp(-1 / (rate * TIME_CONSTANT))
    before = int(20 * rate * TIME_CONSTANT)
    drawn = random.standard_normal((record.shape[0], before + record.shape[1]))
    coloured = lfilter([np.sqrt(1 - kept**2)], [1, -kept], drawn, axis=1)
    return record + level * np.asarray(coloured, dtype=np.float64)[:, before:]


def drifting(record: Real, level: Real | float, random: np.random.Generator) -> Real:
    """Add white noise, and let every channel drift up or down."""
    way = random.choice([-1.0, 1.0], (record.shape[0], 1))
    return white(record, level, random) + DRIFT * way * np.linspace(0.0, 1.0, record.shape[1])


def coarse(record: Real, level: Real | float, random: np.random.Generator) -> Real:
    """Add white noise, and round to the logger's steps."""
    return STEP * np.round(white(record, level, random) / STEP)


KINDS: Mapping[Measure, str] = {
    white: "white",
    low_passed: f"low-passed, time constant {1000 * TIME_CONSTANT:g} ms",
    drifting: f"white, and a drift of {DRIFT:g} m/s²",
    coarse: "white, 12 bits over ±10 g",
}
"""What sensors do to a record, in words."""


def main() -> None:
    """Run the study."""
    parser = arguments("Coverage of the intervals where noise is not white.", campaigns=500)
    parser.add_argument("--tests", type=int, default=len(TESTS), help="how many of the tests (default %(default)s)")
    options = parser.parse_args()
    cases = [Case(TABLE_1_CAR, *test, NOISE, kind) for test in TESTS[: options.tests] for kind in KINDS]
    summaries = summarise(dict.fromkeys(cases, options.campaigns), options.processes)
    numbers = {"cases": [{"kind": KINDS[one.case.measure], **one.document()} for one in summaries]}
    write(options.to, "coloured", page(summaries), numbers)


def page(summaries: Sequence[Summary]) -> str:
    """Write the page."""
    many = len(summaries[0].trials)
    rows = [
        [
            KINDS[one.case.measure],
            one.case.test,
            f"{np.nanmean(one.rmse):.2f}",
            f"{np.nanmean(one.stated):.2f}",
            f"{one.inflation:.2f}",
            f"{100 * np.mean([trial.inflation > 1 for trial in one.trials]):.0f}",
            f"{one.coverage:.1f}",
            one.verdicts,
        ]
        for one in summaries
    ]
    head = ["noise", "test", "error", "stated", "inflation", "inflated, %", "covered, %", " / ".join(VERDICTS)]
    low = min(summaries, key=lambda one: one.coverage)
    met = "every row meets this" if low.coverage >= WANTED else "rows below this do not"
    kept, milliseconds = np.exp(-1 / (RATE * TIME_CONSTANT)), 1000 * TIME_CONSTANT
    return f"""# Coloured noise

The likelihood assumes white noise. Real noise is coloured by filters, drifts with temperature, and is quantised by
converters. The estimates then lose some accuracy, but standard uncertainties computed for white noise are far
too small. `sprung.identify` tests the residuals for autocorrelation and for disagreement between drops, and multiplies every
variance by the {{term}}`overdispersion`. Is that sufficient?

## Method

The paper's car (Table 1) is dropped from blocks of 5 cm, with {NOISE:g} m/s² of noise in every channel at {RATE:g} Hz. Each
row has {many} campaigns, simulated and identified as in the [study of accuracy](at-the-bound.md). The noise is

- white;
- filtered by a first-order low-pass of {milliseconds:g} ms, with the same power: the correlation of successive samples is
  {kept:.2f};
- white, with a drift of {DRIFT:g} m/s² of every channel over the recording, of random sign;
- white, with quantisation to twelve bits over ±10 g, steps of {STEP:.3f} m/s²: {STEP / NOISE:.1f} times the noise.

*Error* and *stated* are the root-mean-square error and the stated uncertainty divided by the Cramér-Rao bound of white
noise, as means over the parameters; *inflation* is the mean factor on the variances, *inflated* the fraction of the
campaigns with a factor above 1; *covered* is the fraction of all 95 % intervals that contain the true value.

## Results

At least {WANTED:g} % of the intervals are required to contain the true value; {met}. The lowest coverage is
{low.coverage:.1f} % ({KINDS[low.case.measure]}; {low.case.test}).

{table(head, rows)}

Every parameter of every row is in [coloured.json](coloured.json).

## Reproduction

    python docs/studies/coloured.py --campaigns {many} --processes 2
"""


if __name__ == "__main__":
    main()

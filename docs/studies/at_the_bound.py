"""Are errors at the Cramér-Rao bound? Noisy campaigns of four vehicles; writes at-the-bound.md.

Run with `python docs/studies/at_the_bound.py --campaigns 2000 --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import importlib
import importlib.util
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from campaigns import AXLES, DURATION, LOAD, RATE, WEIGHING, WITH_LOAD, Case
from pages import VERDICTS, Summary, arguments, summarise, table, write, write_figure

from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Vehicle

SMALL_CAR = Vehicle(
    name="Small car",
    m_s=820,
    I_yy=1080,
    I_xx=270,
    m_uf=30,
    m_ur=27,
    k_sf=16_000,
    k_sr=14_500,
    k_tf=155_000,
    k_tr=155_000,
    c_sf=1150,
    c_sr=1050,
    a=0.98,
    b=1.37,
    t_f=0.68,
    t_r=0.67,
)
"""Made up: a front-driven car of a little under a ton, body at 1.3 and 1.5 Hz, damped to 0.3, wheel hop at 12 Hz."""

VAN = Vehicle(
    name="Van",
    m_s=1950,
    I_yy=4800,
    I_xx=950,
    m_uf=55,
    m_ur=70,
    k_sf=38_000,
    k_sr=52_000,
    k_tf=260_000,
    k_tr=300_000,
    c_sf=2600,
    c_sr=2900,
    a=1.45,
    b=1.85,
    t_f=0.8,
    t_r=0.68,
)
"""Made up: an empty van of 2.2 t on 3.3 m of wheelbase, body at 1.3 and 1.8 Hz, damped to 0.3, wheel hop at 11 to 12 Hz."""

TESTS: tuple[tuple[bool, tuple[str, ...]], ...] = (
    (True, ()),
    (True, ("total_mass",)),
    (True, AXLES),
    (False, ()),
    (False, ("total_mass",)),
    (False, AXLES),
)
"""With a load or not, and what is weighed."""

HEADLINE_TESTS = (TESTS[0], TESTS[1], TESTS[5])
HEADLINE_NOISE, NOISE = (0.02, 0.1), (0.005, 0.02, 0.1, 0.2)
"""m/s² root-mean-square."""

VERDICT = " / ".join(VERDICTS)

COLOURS = ("#2a6f97", "#d1495b", "#edae49")

MEAN, WORST, COVERAGE = 1.03, 1.08, (93.0, 97.0)
"""What is wanted of the headline: error over bound in the mean and in the worst parameter, and percent of intervals."""


def main() -> None:
    """Run the study."""
    parser = arguments("Errors of noisy campaigns beside the Cramér-Rao bound.", campaigns=2000)
    parser.add_argument("--each", type=int, default=200, help="campaigns of every other case (default %(default)s)")
    parser.add_argument(
        "--noise", type=float, nargs="+", default=NOISE, help="of the other cases, m/s² (default %(default)s)"
    )
    options = parser.parse_args()
    headline = [Case(TABLE_1_CAR, *test, noise) for noise in HEADLINE_NOISE for test in HEADLINE_TESTS]
    others = [
        Case(vehicle, *test, noise)
        for vehicle in (SMALL_CAR, VAN, SCHOOL_BUS)
        for test in TESTS
        for noise in options.noise
    ]
    counts = dict.fromkeys(headline, options.campaigns) | dict.fromkeys(others, options.each)
    summaries = summarise(counts, options.processes)
    first, rest = summaries[: len(headline)], summaries[len(headline) :]
    drawn = draw(first, rest, options.to / "at-the-bound.svg")
    numbers = {"headline": [one.document() for one in first], "others": [one.document() for one in rest]}
    write(options.to, "at-the-bound", page(first, rest, drawn), numbers)


def as_wanted(one: Summary) -> bool:
    """Whether a case meets the requirements."""
    low, high = COVERAGE
    return bool(one.rmse.mean() <= MEAN and one.rmse.max() <= WORST and low <= one.coverage <= high)


def page(headline: Sequence[Summary], others: Sequence[Summary], drawn: bool) -> str:
    """Write the page."""
    many, each = len(headline[0].trials), len(others[0].trials)
    everything = (*headline, *others)
    wrong, incomplete = sum(one.wrong_models for one in everything), sum(one.incomplete for one in everything)
    met = sum(as_wanted(one) for one in headline)
    low, high = COVERAGE
    picture = "![Errors over the bound](at-the-bound.svg)\n\n" if drawn else ""
    vehicles = dict.fromkeys(one.case.vehicle.name for one in others)
    sections = "\n\n".join(
        _section(name, [one for one in others if one.case.vehicle.name == name]) for name in vehicles
    )
    error = f"{100 / np.sqrt(2 * many):.1f} and {100 / np.sqrt(2 * each):.1f} %"
    mean_error = f"{1 / np.sqrt(many):.2f} and {1 / np.sqrt(each):.2f} bounds"
    return f"""# Accuracy relative to the Cramér-Rao bound

No unbiased estimator has a smaller variance than the {{term}}`Cramér-Rao bound`: the inverse of the Fisher information of the
recordings and the weighed masses about the parameters. How close does `sprung.identify` come to this bound, is it biased, and
do its 95 % intervals have the stated coverage?

## Method

Every campaign is simulated drop by drop: blocks of 5 cm under all, the front, rear, left and right wheels, release,
flight phase, landing, free decay for {DURATION:g} s, eight sensors at {RATE:g} Hz with white noise. *Ten drops* are these five
without a load and the same five with a load of {100 * LOAD:g} % of the vehicle's mass, off centre. The *weighed* quantity, the
total mass or both axle masses, has a standard uncertainty of {100 * WEIGHING:g} % of the vehicle's mass; its error is drawn
for every campaign. Each campaign is analysed by the complete `sprung.identify` and only the wheelbase is known: the program
detects release and landing, selects the model and computes its own start values. The flight phase is not used, because its
information is not in the bound ([the flight phase](fall.md)).

The bound is computed by `sprung.planning` at the true parameters, from the drops that were used. Each free decay begins
at the last contact of the last tyre. Errors are relative, in units of the bound. *Error* is the root-mean-square error
divided by the bound, as the mean over the parameters and for the worst parameter; *bias* is the largest mean error;
*stated* is the standard uncertainty in the results, as the mean over the parameters; *covered* is the fraction of all 95
% intervals that contain the true value. Without a load or a weighing the recordings do not determine the absolute scale;
masses and rates are then evaluated per total mass.

These figures have statistical uncertainties: a root-mean-square error from {many} or from {each} campaigns {error}, a
mean error {mean_error}. The worst of fifteen parameters is a maximum and therefore biased upwards.
If only the load determines the scale, the errors of all masses and rates are almost fully correlated, so that
their mean is as uncertain as each of them.

## The paper's car

The car of Table 1, {many} campaigns in every row. The requirements are at most {MEAN:g} as the mean over the parameters and
{WORST:g} for the worst, and {low:g} to {high:g} % of the intervals containing the true value; {met} of {len(headline)} rows
meet them.

{_headline(headline)}

{picture}## Other vehicles

A small car, a van, and the paper's school bus, whose springs and dampers have different half-distances; {each}
campaigns for every test and noise level. Each column contains the mean error, the error of the worst parameter, and the
coverage; the verdicts are those of the whole row.

{sections}

## Remaining figures

Of all campaigns on this page, {wrong} used a wrong model of the half-distances (shared or separate), and {incomplete}
excluded a drop. A parameter that a campaign does not determine counts neither as an error nor as an interval; the number
of such cases is in [at-the-bound.json](at-the-bound.json), with every parameter of every case.

## Reproduction

    python docs/studies/at_the_bound.py --campaigns {many} --each {each} --processes 2

The seeds depend on the case and the number of the campaign: the campaigns are the same for any number of processes.
"""


def _headline(summaries: Sequence[Summary]) -> str:
    head = [
        "test",
        "noise, m/s²",
        "error, mean",
        "error, worst",
        "bias",
        "stated",
        "covered, %",
        VERDICT,
        "requirement met",
    ]
    rows = []
    for one in summaries:
        (error, of), (bias, whose) = one.worst(one.rmse), one.worst(one.bias)
        row = [one.case.test, f"{one.case.noise:g}", f"{np.nanmean(one.rmse):.3f}", f"{error:.3f} ({of})"]
        row += [f"{bias:+.2f} ({whose})", f"{np.nanmean(one.stated):.3f}", f"{one.coverage:.1f}", one.verdicts]
        rows.append([*row, "yes" if as_wanted(one) else "no"])
    return table(head, rows)


def _section(vehicle: str, summaries: Sequence[Summary]) -> str:
    """Write the table of one vehicle: a row for each test, a column for each noise."""
    levels = sorted({one.case.noise for one in summaries})
    rows = []
    for test in dict.fromkeys(one.case.test for one in summaries):
        line = sorted((one for one in summaries if one.case.test == test), key=lambda one: one.case.noise)
        cells = [f"{np.nanmean(one.rmse):.2f}, {np.nanmax(one.rmse):.2f}, {one.coverage:.1f} %" for one in line]
        counts = " / ".join(str(sum(one.count(verdict) for one in line)) for verdict in VERDICTS)
        rows.append([test, *cells, counts])
    return f"### {vehicle}\n\n{table(['test', *(f'{level:g} m/s²' for level in levels), VERDICT], rows)}"


def draw(headline: Sequence[Summary], others: Sequence[Summary], path: Path) -> bool:
    """Draw errors over the bound, of every parameter and of every case; without matplotlib there is no picture."""
    if importlib.util.find_spec("matplotlib") is None:
        return False
    plt: Any = importlib.import_module("matplotlib.pyplot")
    plt.rcParams.update({"font.size": 9, "svg.fonttype": "none"})
    plt.rcParams.update({"axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False})
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 3.8), width_ratios=(3, 2), layout="constrained")
    for axes, summaries in ((left, headline), (right, others)):
        chance = 2 / np.sqrt(2 * len(summaries[0].trials))  # two standard errors
        axes.axhspan(1 - chance, 1 + chance, color="#444444", alpha=0.08, lw=0)
        axes.axhline(1, color="#444444", lw=0.8)

    names = headline[0].names
    markers = dict(zip(dict.fromkeys(one.case.test for one in headline), "osd", strict=True))
    for place, one in enumerate(headline):
        x = np.arange(len(names)) + 0.12 * (place - (len(headline) - 1) / 2)
        colour = COLOURS[HEADLINE_NOISE.index(one.case.noise)]
        label = f"{one.case.test.replace(WITH_LOAD, '')}, {one.case.noise:g} m/s²"
        left.plot(x, one.rmse, markers[one.case.test], color=colour, ms=3.5, label=label)
    left.set_xticks(np.arange(len(names)), names, rotation=45)
    left.set(ylabel="root-mean-square error over bound", title=f"{headline[0].case.vehicle.name}, by parameter")
    left.legend(fontsize=7, ncols=2, loc="upper left", columnspacing=1, handletextpad=0)

    vehicles = tuple(dict.fromkeys(one.case.vehicle.name for one in others))
    for one in others:
        which = vehicles.index(one.case.vehicle.name)
        first = one is next(other for other in others if other.case.vehicle == one.case.vehicle)
        beside = one.case.noise * 1.12 ** (which - 1)
        legend = one.case.vehicle.name if first else None
        right.plot([beside], [np.nanmean(one.rmse)], "o", color=COLOURS[which], ms=3.5, label=legend)
    right.set(xscale="log", xlabel="noise, m/s²", title="other vehicles, in the mean")
    levels = sorted({one.case.noise for one in others})
    right.set_xticks(levels, [f"{level:g}" for level in levels])
    right.minorticks_off()
    right.legend(fontsize=7, ncols=3, loc="upper left", columnspacing=1, handletextpad=0)
    for axes in (left, right):
        low, high = axes.get_ylim()
        axes.set_ylim(low, high + 0.2 * (high - low))  # room for the legend
    write_figure(figure, path)
    return True


if __name__ == "__main__":
    main()

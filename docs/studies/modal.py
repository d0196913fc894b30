"""Accuracy of modal identification: the default method at the bound, the other methods, other programs.

Writes modal.md. Run with `python docs/studies/modal.py --campaigns 1000 --processes 2`, or `nox -s studies` for all studies.
Other programs are set beside ours where they are installed (`python -m pip install "sprung[peers]"`). `--hammer
HammerImpact.mat` adds the bolted beam of github.com/mattiacenedese/BRBtesting, which is not part of this project.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from textwrap import fill
from typing import Any, NamedTuple

import numpy as np
from modal_records import CAR, HEIGHT, PASSAGE, RATE, SECONDS, bound, bumps, noisy
from numpy.typing import NDArray
from pages import arguments, figures, report_progress, run, table, write
from peers import installed
from scipy.io import loadmat
from scipy.optimize import linear_sum_assignment

from sprung.errors import InputError
from sprung.modal import METHODS, amplitude_dependence, identify_modes
from sprung.vibration import Mode

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

HEADLINE = 40.0
LEVELS = (60.0, 40.0, 20.0)
"""Noise below the root-mean-square of each channel in the left-wheel record, dB."""

OWN, TURNS = "ml", 15
"""The default method, and how many times it is timed."""

SEEDS = 7
"""Noisy records in a row of the comparison."""

FOUND = 0.1
"""Error of a pole, as a part of it, up to which it is found."""

BODY = 3

WANTED_RMSE, COVERAGE = 1.1, (93.0, 97.0)
"""Error over bound, root-mean-square over everything; and percent of 95 % intervals that hold the truth."""

WANTED_FREQUENCY, WANTED_DAMPING, WANTED_TIME = 0.02, 0.08, 0.5
"""Percent of the body's frequencies and damping ratios; and time, in that of the fastest other program."""


class Trial(NamedTuple):
    """One noisy set of four records, fitted: how many modes, and errors of frequency and damping ratio of each.

    Errors in units of the bound, whether the 95 % intervals hold the truth, and errors in percent; shapes (mode, 2).
    """

    found: int
    errors: Real
    covered: Real
    percent: Real


class Reached(NamedTuple):
    """What a method makes of a set of records: modes found, and worst errors of body and wheels in percent.

    Of frequency and damping ratio; NaN where a mode is not found.
    """

    found: int
    body: tuple[float, float]
    wheels: tuple[float, float]
    seconds: float


def trial(seed: int) -> Trial:
    """Fit one noisy set of records."""
    clean = bumps()
    limits, modes = bound(clean, HEADLINE), identify_modes(noisy(clean, HEADLINE, seed), RATE)
    nan = np.full((len(CAR), 2), np.nan)
    if len(modes) != len(CAR):
        return Trial(len(modes), nan, nan, nan)
    _, own = linear_sum_assignment(np.abs(poles_of(CAR)[:, None] - poles_of(modes)))
    errors, covered, percent = nan.copy(), nan.copy(), nan.copy()
    for j, limit in enumerate(limits):
        mode = modes[int(own[j])]
        true = np.array([limit.frequency, limit.damping_ratio])
        off = np.array([mode.frequency, mode.damping_ratio]) - true
        errors[j] = off / np.array([limit.frequency_std, limit.damping_ratio_std], dtype=float)
        covered[j] = np.abs(off) < 1.96 * np.array([mode.frequency_std, mode.damping_ratio_std], dtype=float)
        percent[j] = 100 * np.abs(off) / true
    return Trial(len(modes), errors, covered, percent)


def poles_of(modes: Sequence[Mode]) -> Complex:
    """Return the poles, 1/s."""
    return np.array([mode.pole for mode in modes])


def reached(identify: Callable[[Sequence[Real], float], Complex], records: Sequence[Real]) -> Reached:
    """Run a method and match its poles with the true ones, each with its nearest."""
    begin = time.perf_counter()
    try:
        poles = identify(records, RATE)
    except InputError:
        poles = np.empty(0, dtype=complex)
    seconds = time.perf_counter() - begin
    true = poles_of(CAR)
    upper = poles[poles.imag >= 0]
    if not upper.size:
        return Reached(0, (np.nan, np.nan), (np.nan, np.nan), seconds)
    # No pole counts for two modes.
    distance = np.abs(true[:, None] - upper)
    rows, columns = linear_sum_assignment(distance)
    found = np.full(len(true), np.nan, dtype=complex)
    found[rows] = upper[columns]
    is_found = np.abs(found - true) < FOUND * np.abs(true)
    off = np.stack([np.abs(found) / np.abs(true), (found.real / np.abs(found)) / (true.real / np.abs(true))], axis=1)
    percent = np.where(is_found[:, None], 100 * np.abs(off - 1), np.nan)
    body, wheels = percent[:BODY].max(axis=0), percent[BODY:].max(axis=0)
    return Reached(int(is_found.sum()), (float(body[0]), float(body[1])), (float(wheels[0]), float(wheels[1])), seconds)


def ours(method: str) -> Callable[[Sequence[Real], float], Complex]:
    """Return one of our methods as a function from recordings to poles."""
    return lambda records, rate: poles_of(identify_modes(records, rate, method))


def main() -> None:
    """Run the study."""
    parser = arguments(
        "Modes of noisy records beside the Cramér-Rao bound, other methods and other programs.", campaigns=1000
    )
    parser.add_argument("--hammer", type=Path, help="HammerImpact.mat, which is not part of this project")
    options = parser.parse_args()
    trials = list(run(trial, [(seed,) for seed in range(options.campaigns)], options.processes))
    report_progress(
        f"{len(trials)} sets of records, {np.mean([one.found == len(CAR) for one in trials]):.1%} with all modes"
    )
    methods = {name: (ours(name), 4) for name in METHODS}
    rows = compared({**methods, **installed()})
    one = compared(
        {"ml": (ours("ml"), 1), **{label: (call, 1) for label, (call, drops) in installed().items() if drops == 1}}
    )
    hammer = beam(options.hammer) if options.hammer else []
    times = timed()
    turns = [{label: figures(value) for label, value in times.items()}]
    numbers = {"headline": headline(trials), "methods": rows, "one_drop": one, "milliseconds": turns, "beam": hammer}
    write(options.to, "modal", wrapped(page(trials, rows, one, times, hammer)), numbers)


def headline(trials: Sequence[Trial]) -> list[dict[str, Any]]:
    """Put figures for each mode, and for all, into rows."""
    whole = [one for one in trials if one.found == len(CAR)]
    errors, covered, percent = (
        np.array([getattr(one, what) for one in whole]) for what in ("errors", "covered", "percent")
    )
    rows: list[dict[str, Any]] = [
        {
            "mode": mode.name,
            "frequency": figures(mode.frequency),
            "rmse_over_bound": [figures(value) for value in np.sqrt((errors[:, j] ** 2).mean(axis=0))],
            "bias_over_bound": [figures(value) for value in errors[:, j].mean(axis=0)],
            "covered": [figures(100 * value) for value in covered[:, j].mean(axis=0)],
            "median_percent": [figures(value) for value in np.median(percent[:, j], axis=0)],
        }
        for j, mode in enumerate(CAR)
    ]
    body = np.median(percent[:, :BODY].max(axis=1), axis=0)
    rows.append(
        {
            "mode": "all",
            "sets": len(trials),
            "with_all_modes": len(whole),
            "rmse_over_bound": figures(float(np.sqrt((errors**2).mean()))),
            "worst_rmse_over_bound": figures(float(np.sqrt((errors**2).mean(axis=0)).max())),
            "covered": figures(100 * float(covered.mean())),
            "body_percent": [figures(value) for value in body],
        }
    )
    return rows


def compared(methods: dict[str, tuple[Callable[[Sequence[Real], float], Complex], int]]) -> list[dict[str, Any]]:
    """Run every method on the same records, without noise and with several levels of it."""
    clean = bumps()
    rows = []
    for name, (identify, drops) in methods.items():
        exact = reached(identify, clean[:drops])
        row: dict[str, Any] = {"method": name, "drops": drops, "without_noise": exact.found}
        for level in LEVELS:
            many = [reached(identify, noisy(clean, level, seed)[:drops]) for seed in range(SEEDS)]
            row[f"{level:g} dB"] = {
                "found": int(np.median([one.found for one in many])),
                "body": [figures(_median([one.body[k] for one in many])) for k in (0, 1)],
                "wheels": [figures(_median([one.wheels[k] for one in many])) for k in (0, 1)],
                "milliseconds": figures(1e3 * float(np.median([one.seconds for one in many]))),
            }
        report_progress(f"{name}: {row}")
        rows.append(row)
    return rows


def timed() -> dict[str, float]:
    """Time the default and other programs that take several drops in turns, as load may change: medians, ms."""
    records = noisy(bumps(), HEADLINE, 0)
    calls = {OWN: ours("ml"), **{label: call for label, (call, drops) in installed().items() if drops > 1}}
    taken: dict[str, list[float]] = {label: [] for label in calls}
    for _ in range(TURNS):
        for label, call in calls.items():
            taken[label].append(1e3 * reached(call, records).seconds)
    return {label: float(np.median(values)) for label, values in taken.items()}


def _median(values: Sequence[float]) -> float:
    """Return the median; a value that was not found counts as infinite."""
    middle = float(np.median([np.inf if np.isnan(value) else value for value in values]))
    return middle if np.isfinite(middle) else np.nan


def beam(path: Path) -> list[dict[str, Any]]:
    """Follow the first two bending modes of the bolted beam."""
    data = loadmat(path, squeeze_me=True, struct_as_record=False)["HIdata"]
    rate = 1 / float(np.diff(data.time).mean())
    record = np.stack([data.acc1, data.acc2, data.acc3])[:, int(0.02 * rate) :]
    modes = identify_modes([record], rate)
    traces = amplitude_dependence([record], rate, modes)
    rows = []
    for peak in (80.5, 297.7):
        trace = min(traces, key=lambda one, peak=peak: abs(one.mode.frequency - peak))  # type: ignore[misc]
        first, last = 0, len(trace.amplitude) - 1
        change, damping = trace.frequency_trend, trace.damping_trend
        rows.append(
            {
                "fft_peak": peak,
                "frequency": figures(trace.mode.frequency),
                "damping_ratio": figures(trace.mode.damping_ratio),
                "amplitude": [figures(trace.amplitude[i]) for i in (first, last)],
                "frequency_there": [float(f"{trace.frequency[i]:.6g}") for i in (first, last)],
                "damping_there": [figures(trace.damping_ratio[i]) for i in (first, last)],
                "frequency_per_decade": None
                if change is None
                else [figures(100 * change[0]), figures(100 * change[1])],
                "damping_per_decade": None if damping is None else [figures(damping[0]), figures(damping[1])],
            }
        )
    return rows


def page(
    trials: Sequence[Trial],
    rows: Sequence[dict[str, Any]],
    one: Sequence[dict[str, Any]],
    times: Mapping[str, float],
    hammer: Sequence[dict[str, Any]],
) -> str:
    """Write the page."""
    figured = headline(trials)
    every = figured[-1]
    lines = [
        [
            row["mode"],
            f"{row['frequency']:g}",
            *(f"{value:.3f}" for value in row["rmse_over_bound"]),
            *(f"{value:+.2f}" for value in row["bias_over_bound"]),
            *(f"{value:.1f}" for value in row["covered"]),
            *(f"{value:.2g}" for value in row["median_percent"]),
        ]
        for row in figured[:-1]
    ]
    head = ["mode", "Hz", "error f", "error ζ", "bias f", "bias ζ", "covered f, %", "covered ζ, %", "f, %", "ζ, %"]
    fastest = min(times, key=lambda label: times[label] if label != OWN else np.inf)
    speed = (
        "Other programs were not installed when this page was written."
        if fastest == OWN
        else f"Run in turns, {TURNS} times each at {HEADLINE:g} dB, the default took {times[OWN]:.3g} ms and the fastest other "
        f"program that takes several drops, {fastest}, {times[fastest]:.3g} ms, in the median: "
        f"{times[OWN] / times[fastest]:.2f} of its time (requirement: at most {WANTED_TIME:g})."
    )
    low, high = COVERAGE
    return f"""# Accuracy of modal identification

How close are the errors of the modes of `sprung modal` to the {{term}}`Cramér-Rao bound`, do their intervals have the stated
coverage, and how do other methods and other programs perform with the same recordings?

## Method

The car of the paper's Table 1 is driven over the paper's half-sine bump, {HEIGHT:g} m high and passed in {PASSAGE:g} s,
once each with the left wheels, with all, with the front wheels and with two diagonal wheels: four recordings of the
accelerations of its seven degrees of freedom, {RATE:g} Hz, {SECONDS:g} s from the end of the bump on. White noise is
{HEADLINE:g} dB below the root-mean-square of each channel in the left-wheel recording, the same in all four. No vehicle
model is used, the number of modes is not given, and the offset of each channel in each recording is unknown.

The Cramér-Rao bound is that for unknown poles, shapes, amplitudes and offsets and known noise. Errors of frequencies and
damping ratios are in units of the bound; *covered* is the fraction of the 95 % intervals that contain the true value. The
last two columns are the median errors in percent.

## The default method

{every["with_all_modes"]} of {every["sets"]} sets gave exactly seven modes. The overall root-mean-square error is
{every["rmse_over_bound"]:.3f} of the bound, that of the worst of the fourteen numbers {every["worst_rmse_over_bound"]:.3f}
(requirement: at most {WANTED_RMSE:g}), and {every["covered"]:.1f} % of all intervals contain the true value (requirement:
{low:g} to {high:g} %). The median error of the worst of the three body modes is {every["body_percent"][0]:.3f} % in
frequency and {every["body_percent"][1]:.3f} % in damping (requirements: {WANTED_FREQUENCY:g} and {WANTED_DAMPING:g} %).
The statistical uncertainty of a root-mean-square error from {every["sets"]} sets is
{100 / np.sqrt(2 * every["sets"]):.1f} %.

{table(head, lines)}

## Every method, and other programs

The same recordings without noise, and with three noise levels, {SEEDS} seeds each. The table contains the number of the
seven poles found (within {100 * FOUND:g} % of the true pole, no pole counted twice), and the largest error among the
three body modes and among the four wheel modes, in percent, as medians over the seeds; a dash means that one of them is
not found. The wheel-hop modes are pairs 0.003 Hz apart: finding a pole is easy, separating a pair is not. Times are
medians at {HEADLINE:g} dB of one thread on a shared machine. All our methods select their order themselves; the other
programs were given an order of fourteen poles, and recordings decimated by a factor of ten. {speed}

{_methods(rows)}

The method as printed, with a lag of one sample, finds few modes in the presence of noise: its regressor contains as much
noise as the dependent variable. Frequency-domain methods without a likelihood lose accuracy with damping, as the paper
states. `peaks` and `emd` are not exact even without noise.

## One drop

With the left-wheel recording alone the bound for each of the wheel-hop modes is about 100 %: no method can separate the
four, whatever it prints. The default method finds as many modes as the recording supports, and `sprung modal` states that
each may represent several.

{_methods(one)}

{_beam(hammer)}## Reproduction

    python -m pip install ".[peers]"
    python docs/studies/modal.py --campaigns {every["sets"]} --processes 2 --hammer HammerImpact.mat
"""


def wrapped(text: str) -> str:
    """Wrap paragraphs, and leave headings, tables and commands as they are."""
    parts = (part if part[:1] in "#| " else fill(part, 122, break_on_hyphens=False) for part in text.split("\n\n"))
    return "\n\n".join(parts).rstrip() + "\n"


def _methods(rows: Sequence[dict[str, Any]]) -> str:
    head = ["method", "drops", "no noise", *(f"{level:g} dB: found, body f, ζ; wheels f, ζ" for level in LEVELS), "ms"]
    lines = []
    for row in rows:
        cells = []
        for level in LEVELS:
            here = row[f"{level:g} dB"]
            numbers = [_number(value) for value in (*here["body"], *here["wheels"])]
            cells.append(f"{here['found']}; {numbers[0]}, {numbers[1]}; {numbers[2]}, {numbers[3]}")
        milliseconds = row[f"{HEADLINE:g} dB"]["milliseconds"]
        lines.append([row["method"], str(row["drops"]), str(row["without_noise"]), *cells, f"{milliseconds:.3g}"])
    return table(head, lines)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2g}"


def _beam(rows: Sequence[dict[str, Any]]) -> str:
    if not rows:
        return ""
    head = [
        "FFT peak, Hz",
        "f, Hz",
        "ζ",
        "amplitude, m/s²",
        "f at these, Hz",
        "ζ at these",
        "f per decade, %",
        "ζ per decade",
    ]
    lines = []
    for row in rows:
        change, damping = row["frequency_per_decade"], row["damping_per_decade"]
        lines.append(
            [
                f"{row['fft_peak']:g}",
                f"{row['frequency']:g}",
                f"{row['damping_ratio']:.2g}",
                " to ".join(f"{value:.2g}" for value in row["amplitude"]),
                " to ".join(f"{value:.2f}" for value in row["frequency_there"]),
                " to ".join(f"{value:.2g}" for value in row["damping_there"]),
                "-" if change is None else f"{change[0]:.2g} ± {change[1]:.1g}",
                "-" if damping is None else f"{damping[0]:.2g} ± {damping[1]:.1g}",
            ]
        )
    return f"""## A bolted beam

Two steel halves joined by bolts and excited by a hammer (github.com/mattiacenedese/BRBtesting, three accelerometers, 12.8
kHz): the first two bending modes from 20 ms on, and in windows in which they decay by a factor of e^0.5. Sliding joints
are less stiff and have more damping: with increasing amplitude frequencies must decrease and damping must increase.

{table(head, lines)}

"""


if __name__ == "__main__":
    main()

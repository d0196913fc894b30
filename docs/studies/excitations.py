"""Are errors at the Cramér-Rao bound after pushes and passes over a bump, too? Writes excitations.md.

Run with `python docs/studies/excitations.py --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from campaigns import DURATION, LOAD, RATE, WEIGHING, Case, Done
from other_engine import CAR, campaign_of_passes, is_installed, without_noise
from pages import VERDICTS, Summary, arguments, figures, summarise, table, write
from parts_of_a_vehicle import COVERAGE, MEAN, PITCH_PLANE, QUARTER_CAR, ROLL_PLANE, as_wanted

import sprung
from sprung.simulation import Push
from sprung.vehicle import PARAMETERS, TABLE_1_CAR

VERDICT = " / ".join(VERDICTS)

BY_HAND, BY_ROPE, PASSES = Done(("push",)), Done(("push",), Push(shape="rope")), Done(("pass",))
MIXED = Done(("drop", "push", "pass"))

DONE: Mapping[Done, str] = {
    BY_HAND: "pushed by hand",
    BY_ROPE: "pulled by a rope",
    PASSES: "over a bump",
    MIXED: "all three, and drops",
}

_WEIGHED = ("total_mass",)

CASES = (
    *(Case(TABLE_1_CAR, False, _WEIGHED, 0.02, done=done) for done in (BY_HAND, BY_ROPE, PASSES, MIXED)),
    Case(TABLE_1_CAR, False, _WEIGHED, 0.1, done=PASSES),
    *(
        Case(part, True, _WEIGHED, noise, done=done)
        for part in (QUARTER_CAR, ROLL_PLANE, PITCH_PLANE)
        for done, noise in ((BY_HAND, 0.01), (BY_ROPE, 0.02), (PASSES, 0.02))
    ),
)

TIMES, NOISE, SEED = 4, 0.05, 1
"""Of the passes of another engine's car: how often each is driven, m/s², and of the noise."""


def main() -> None:
    """Run the study."""
    options = arguments("Errors after pushes and passes beside the Cramér-Rao bound.", campaigns=200).parse_args()
    summaries = summarise(dict.fromkeys(CASES, options.campaigns), options.processes)
    engine = errors_of_another_engine() if is_installed() else []
    numbers = {"cases": [{**one.document(), "done": DONE[one.case.done]} for one in summaries], "engine": engine}
    write(options.to, "excitations", page(summaries, engine), numbers)


def errors_of_another_engine() -> list[dict[str, Any]]:
    """Return the errors of the car that MuJoCo drives over a bump, %: in ratios, and with an axle weighed."""
    found: dict[str, dict[str, Any]] = {name: {"parameter": name} for name in CAR.parameters}
    for known, noise in (((), NOISE), (("front_axle_mass",), NOISE), (("front_axle_mass",), 0.0)):
        campaign = campaign_of_passes(TIMES, noise, SEED, known)
        result = sprung.identify(campaign if noise else without_noise(campaign), tracks="shared")
        key = ("weighed" if known else "ratio") + ("" if noise else "_without_noise")
        for name, truth in CAR.parameters.items():
            scales = not known and PARAMETERS[name].scales
            stated = result.scale.per_total_mass[name] if scales else result.parameters[name]
            unit = truth / CAR.total_mass if scales else truth
            if stated.value is not None and stated.std is not None:
                found[name][f"{key}_error_percent"] = figures(100 * (stated.value / unit - 1))
                found[name][f"{key}_std_percent"] = figures(100 * stated.std / unit)
    return list(found.values())


def page(summaries: Sequence[Summary], engine: Sequence[Mapping[str, Any]]) -> str:
    """Write the page."""
    many = len(summaries[0].trials)
    met, (low, high) = sum(as_wanted(one) for one in summaries), COVERAGE
    head = [
        "vehicle",
        "test",
        "noise, m/s²",
        "bound, worst, %",
        "error, mean",
        "error, worst",
        "covered, %",
        VERDICT,
        "met",
    ]
    rows = []
    for one in summaries:
        error, of = one.worst(one.rmse)
        bound = 100 * float(np.max(one.case.bound(range(one.case.drops))))
        test = f"{DONE[one.case.done]}{', with and without load' if one.case.loaded else ''}"
        row = [one.case.vehicle.name, test, f"{one.case.noise:g}", f"{bound:.2g}", f"{np.nanmean(one.rmse):.3f}"]
        row += [f"{error:.3f} ({of})", f"{one.coverage:.1f}", one.verdicts, "yes" if as_wanted(one) else "no"]
        rows.append(row)
    return f"""# Pushes and passes over a bump

A vehicle need not be dropped: its body is pushed by hand or pulled by a rope that is released, or it drives over a bump onto
flat road ([how](../drop-test.md#without-blocks)). Only the beginning of the free decay is another one, and nobody measures
it: the fitted vehicle shows from when on the motion is free. Are the errors at the {{term}}`Cramér-Rao bound` of a decay
whose beginning is known?

## Method

As for drops ([accuracy relative to the bound](at-the-bound.md)): pushes act between all, the front, the rear, the left and
the right wheels, four half sines with 5 % of the vehicle's weight, or a rope with 10 % of it; passes lead all, the left and the
right wheels over a half sine of 0.05 m and 0.5 m at 5 m/s, which the wheels leave for a moment. {DURATION:g} s are recorded
behind it, {RATE:g} Hz, white noise. The total mass is weighed with {100 * WEIGHING:g} %; the load has {100 * LOAD:g} % of it.
The complete `sprung.identify` analyses each campaign, finds the beginnings and selects the model. The bound is that of decays
that begin with the last force, or with the last contact of a tyre.

## Result

{many} campaigns in every row; a root-mean-square error from so many has a statistical uncertainty of
{100 / np.sqrt(2 * many):.1f} %. Required are at most {MEAN:g} in the mean over the parameters, and {low:g} to {high:g} % of the
95 % intervals containing the true value; {met} of {len(summaries)} rows meet both.

{table(head, rows)}

A push by hand hardly moves the wheels against the body's motion: what it tells of unsprung masses and tyres is several times
less than what a pass tells. With five times the noise it determines neither, and the result says so (doubtful). Every
parameter of every case is in [excitations.json](excitations.json).

{_of_another_engine(engine)}
## Reproduction

    python docs/studies/excitations.py --campaigns {many} --processes 2
"""


def _of_another_engine(engine: Sequence[Mapping[str, Any]]) -> str:
    if not engine:
        return ""
    keys = ("ratio", "weighed", "weighed_without_noise")
    rows = [
        [one["parameter"], *(f"{one[f'{key}_error_percent']:.2f} ± {one[f'{key}_std_percent']:.2f}" for key in keys)]
        for one in engine
    ]
    worst = {key: max(abs(one[f"{key}_error_percent"]) for one in engine) for key in keys}
    return f"""## A car of another engine

MuJoCo drives a car over a half-sine bump of 0.05 m at 20 km/h: a free body with finite rotations, wheels that slide along its
own axis, tyres that cannot pull, accelerometers that turn with the body. {TIMES} passes each with all, the left and the right
wheels, white noise of {NOISE:g} m/s²; heights and wheelbase are stated. Errors with one standard uncertainty, %: masses
and rates per total mass, all parameters with the front axle weighed, and the same without noise, where the linear model
itself shows.

{table(["parameter", "nothing weighed", "front axle weighed", "the same without noise"], rows)}

At the worst {worst["ratio"]:.2f} %, {worst["weighed"]:.2f} % and {worst["weighed_without_noise"]:.2f} %.

"""


if __name__ == "__main__":
    main()

"""Are errors at the Cramér-Rao bound with sensors of other quantities, too? Writes quantities.md.

Run with `python docs/studies/quantities.py --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from campaigns import AXLES, DURATION, LOAD, RATE, WEIGHING, Case
from pages import Summary, arguments, summarise, table, write
from parts_of_a_vehicle import COVERAGE, MEAN, QUARTER_CAR, ROLL_PLANE, VERDICT, as_wanted

from sprung.simulation import USUAL_NOISE, default_sensors
from sprung.units import Quantity
from sprung.vehicle import TABLE_1_CAR, WHEELS, Sensor, Vehicle

NOISE = 0.02
"""m/s² root-mean-square of accelerometers; other sensors have their usual noise."""


def of_quantity(vehicle: Vehicle, quantity: Quantity) -> tuple[Sensor, ...]:
    """Return the usual sensors of a vehicle if all of them measured another quantity."""
    return tuple(replace(sensor, quantity=quantity) for sensor in default_sensors(vehicle))


def travel(vehicle: Vehicle) -> tuple[Sensor, ...]:
    """Return sensors of suspension travel over every wheel."""
    wheels = vehicle.layout.wheels
    return tuple(
        Sensor(channel=f"travel_{wheel}", on="body", quantity="displacement", relative_to=wheel) for wheel in wheels
    )


_GYROSCOPES = (
    Sensor(channel="pitch_rate", on="body", quantity="angular-rate", axis="pitch"),
    Sensor(channel="roll_rate", on="body", quantity="angular-rate", axis="roll"),
)

_HUBS = tuple(Sensor(channel=f"wheel_{wheel}", on=wheel) for wheel in WHEELS)

_MIDDLE = Sensor(channel="body", on="body", position=(-1.2, 0.0, 0.5))

_CAR = TABLE_1_CAR

TESTS: Mapping[str, tuple[Vehicle, tuple[Sensor, ...]]] = {
    "eight displacements": (_CAR, of_quantity(_CAR, "displacement")),
    "eight velocities": (_CAR, of_quantity(_CAR, "velocity")),
    "suspension travel, wheels' accelerometers": (_CAR, (*travel(_CAR), *_HUBS)),
    "eight accelerometers, suspension travel": (_CAR, (*default_sensors(_CAR), *travel(_CAR))),
    "one accelerometer on the body, gyroscopes, wheels' accelerometers": (_CAR, (_MIDDLE, *_GYROSCOPES, *_HUBS)),
    "roll plane, four displacements": (ROLL_PLANE, of_quantity(ROLL_PLANE, "displacement")),
    "quarter car, accelerometers and travel": (QUARTER_CAR, (*default_sensors(QUARTER_CAR), *travel(QUARTER_CAR))),
}
"""Vehicle and sensors of each test by its name."""


def case_of(name: str, noise: float = NOISE) -> Case:
    """Return the case of a test: with a load, and weighed."""
    vehicle, sensors = TESTS[name]
    weighed = AXLES if vehicle.layout.pitches else ("total_mass",)
    return Case(vehicle, True, weighed, noise, sensors=tuple(sensor.exact for sensor in sensors))


def main() -> None:
    """Run the study."""
    options = arguments("Errors with other sensors beside the Cramér-Rao bound.", campaigns=200).parse_args()
    cases = dict.fromkeys((case_of(name) for name in TESTS), options.campaigns)
    summaries = summarise(cases, options.processes)
    documents = [{"sensors": name, **one.document()} for name, one in zip(TESTS, summaries, strict=True)]
    write(options.to, "quantities", page(summaries), {"cases": documents})


def page(summaries: Sequence[Summary]) -> str:
    """Write the page."""
    many = len(summaries[0].trials)
    met, (low, high) = sum(as_wanted(one) for one in summaries), COVERAGE
    head = ["sensors", "error, mean", "error, worst", "covered, %", VERDICT, "requirement met"]
    rows = []
    for name, one in zip(TESTS, summaries, strict=True):
        error, of = one.worst(one.rmse)
        row = [name, f"{np.nanmean(one.rmse):.3f}", f"{error:.3f} ({of})", f"{one.coverage:.1f}", one.verdicts]
        rows.append([*row, "yes" if as_wanted(one) else "no"])
    return f"""# Other sensors

Sensors of displacement, velocity, suspension travel and angular rate ([the campaign file](../campaign.md#other-sensors)) enter
the same likelihood as accelerometers, each by its own row. Are the errors at the {{term}}`Cramér-Rao bound`, too?

## Method

As for accelerometers ([accuracy relative to the bound](at-the-bound.md)): every campaign is simulated drop by drop from
blocks of 5 cm under all wheels and under the wheels of each end and side, free decay for {DURATION:g} s, {RATE:g} Hz, with a
load of {100 * LOAD:g} % of the vehicle's mass; what is weighed, the axles or the whole, has a standard uncertainty of
{100 * WEIGHING:g} %. White noise: accelerometers {NOISE:g} m/s², displacements {1000 * USUAL_NOISE["displacement"]:g} mm,
velocities {1000 * USUAL_NOISE["velocity"]:g} mm/s, gyroscopes {USUAL_NOISE["angular-rate"]:g} rad/s. The complete
`sprung.identify` analyses each campaign and selects the model.

## Result

{many} campaigns in every row; a root-mean-square error from so many has a statistical uncertainty of
{100 / np.sqrt(2 * many):.1f} %. Required are at most {MEAN:g} in the mean over the parameters, and {low:g} to {high:g} % of the
95 % intervals containing the true value; {met} of {len(summaries)} rows meet both.

{table(head, rows)}

Every parameter of every case is in [quantities.json](quantities.json).

## Reproduction

    python docs/studies/quantities.py --campaigns {many} --processes 2
"""


if __name__ == "__main__":
    main()

"""Does a fleet tell more than its vehicles one by one? Writes fleets.md.

Run with `python docs/studies/fleets.py --processes 2`, or `nox -s studies` for all studies.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pages import arguments, figures, report_progress, run, table, write

import sprung
from sprung.fleets import (
    RUN_LENGTH,
    WHEELBASE,
    FleetEstimates,
    FleetType,
    Population,
    chart_vehicles,
    estimate_vehicles,
    fit_population,
)
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Vehicle

Real = NDArray[np.float64]

SPREAD: Mapping[str, float] = {
    "m_s": 2, "I_yy": 3, "I_xx": 3, "m_uf": 2, "m_ur": 2, "k_sf": 3, "k_sr": 3, "k_tf": 4, "k_tr": 4,
    "c_sf": 3, "c_sr": 3, "a": 0.5, "t_f": 0.5, "t_r": 0.5,
}  # fmt: skip
"""Standard deviation between vehicles, %; the wheelbase is that of the type."""

NOISE, RATE, DURATION, WEIGHING = 0.1, 500.0, 2.0, 0.003
"""m/s² root-mean-square, samples per second, s after the release; standard uncertainty of the scales, relative."""

DROPS: tuple[Mapping[str, Any], ...] = ({"wheels": ("fl", "fr")}, {"wheels": ("fl", "rl")})
"""Front wheels, and left wheels."""

DRIFT, WEAK = 0.01, 0.15
"""What the scales of the rig read too much from the middle of the fleet on, and what the front dampers of one vehicle lack."""


SMALL_FLEET = 30
"""Vehicles of the smaller fleets that are drawn for the coverage; the larger ones have as many as were identified."""


@dataclass(frozen=True)
class Member:
    """A vehicle of the fleet.

    Attributes
    ----------
    number
        From 1, in the order of the tests.
    vehicle
        Its true parameters.
    reading
        Of the scales over the true mass.
    """

    number: int
    vehicle: Vehicle
    reading: float

    def write(self, folder: Path) -> None:
        """Simulate its test and write the campaign."""
        total = self.vehicle.total_mass
        campaign = sprung.simulate(
            self.vehicle,
            drops=DROPS,
            noise=NOISE,
            rate=RATE,
            duration=DURATION,
            seed=self.number,
            known={"total_mass": KnownValue(total * self.reading, WEIGHING * total)},
        )
        named = replace(campaign, identification=f"{self.number:03d}")
        sprung.write(named, folder / f"{self.number:03d}", overwrite=True)


def members(count: int) -> list[Member]:
    """Return the fleet in control."""
    random = np.random.default_rng(2026)
    base, wheelbase = dict(TABLE_1_CAR.parameters), TABLE_1_CAR.wheelbase
    found = []
    for number in range(1, count + 1):
        own = {name: base[name] * np.exp(spread / 100 * random.standard_normal()) for name, spread in SPREAD.items()}
        vehicle = Vehicle({**own, "b": wheelbase - own["a"]}, name=TABLE_1_CAR.name)
        found.append(Member(number, vehicle, 1 + WEIGHING * random.standard_normal()))
    return found


def disturbed(fleet: Sequence[Member]) -> list[Member]:
    """Return the fleet with scales that drift from the middle on, and weak dampers of the vehicle at a quarter."""
    weak = len(fleet) // 4
    found = []
    for member in fleet:
        own = dict(member.vehicle.parameters)
        if member.number == weak:
            own["c_sf"] *= 1 - WEAK
        reading = member.reading * (1 + DRIFT * (member.number > len(fleet) // 2))
        found.append(Member(member.number, Vehicle(own, name=TABLE_1_CAR.name), reading))
    return found


def compared(one: FleetType, fleet: Sequence[Member]) -> list[dict[str, Any]]:
    """Return errors of the estimates of each parameter, from the vehicle's own test and with the others, % of the truth."""
    own, joint = one.estimates, one.hierarchical
    true = {
        f"{member.number:03d}": {**member.vehicle.parameters, WHEELBASE: member.vehicle.wheelbase} for member in fleet
    }
    truth = np.log([[true[label][name] for name in own.names] for label in own.labels])
    cases = []
    for j, name in enumerate(own.names):
        case: dict[str, Any] = {
            "parameter": name,
            "vehicles": own.count,
            "spread": figures(100 * one.population.std[j]),
        }
        for key, positions, stds in (
            ("single", own.positions, np.sqrt(np.diagonal(own.covariances, axis1=1, axis2=2))),
            ("hierarchical", joint.positions, joint.stds),
        ):
            errors = positions[:, j] - truth[:, j]
            case[f"{key}_rmse"] = figures(100 * np.sqrt(np.mean(errors**2)))
            case[f"{key}_stated"] = figures(100 * np.sqrt(np.mean(stds[:, j] ** 2)))
            case[f"{key}_coverage"] = figures(100 * float(np.mean(np.abs(errors) < 1.96 * stds[:, j])))
        cases.append(case)
    return cases


def drawn_coverage(own: FleetEstimates, vehicles: int, number: int) -> tuple[Real, Real, Real]:
    """Return what the hierarchical estimates of a fleet are worth that is drawn with the true spread between vehicles.

    Parameters
    ----------
    own
        Its vehicles have the covariance matrices of these tests.
    vehicles
        How many it has.
    number
        Of the fleet: with the number of its vehicles, the seed.

    Returns
    -------
    covered
        Part of the 95 % intervals that contain the truth, shape (parameter,).
    single, hierarchical
        Mean square errors from the vehicle's own test and with the others, dimensionless, shape (parameter,).
    """
    random = np.random.default_rng([vehicles, number])
    spread = np.array([SPREAD.get(name, 0.0) for name in own.names]) / 100
    true = spread * random.standard_normal((vehicles, len(spread)))
    covariances = own.covariances[random.integers(own.count, size=vehicles)]
    factors = np.linalg.cholesky(covariances)
    positions = true + np.einsum("nij,nj->ni", factors, random.standard_normal(true.shape))
    found = estimate_vehicles(positions, covariances, fit_population(positions, covariances))
    covered = np.mean(np.abs(found.positions - true) < 1.96 * found.stds, axis=0)
    return covered, np.mean((positions - true) ** 2, axis=0), np.mean((found.positions - true) ** 2, axis=0)


def coverages(own: FleetEstimates, vehicles: int, fleets: int, processes: int) -> list[dict[str, Any]]:
    """Return coverage and gain of the hierarchical estimates of each parameter over fleets that are drawn."""
    tasks = [(own, vehicles, number) for number in range(fleets)]
    covered, single, joint = (
        np.array(values) for values in zip(*run(drawn_coverage, tasks, processes, 1), strict=True)
    )
    gain = np.sqrt(single.mean(axis=0) / joint.mean(axis=0))
    return [
        {
            "parameter": name,
            "vehicles": vehicles,
            "fleets": fleets,
            "coverage": figures(100 * covered[:, j].mean()),
            "coverage_between_fleets": figures(100 * covered[:, j].std()),
            "least_coverage": figures(100 * covered[:, j].min()),
            "gain": figures(gain[j]),
        }
        for j, name in enumerate(own.names)
        if name in SPREAD
    ]


def redrawn(own: FleetEstimates, population: Population, number: int, drift: bool, weak: bool) -> FleetEstimates:
    """Return a fleet drawn from a population, with the errors of the real tests, drift and weak dampers."""
    random = np.random.default_rng([number, drift, weak])
    count, width = own.positions.shape
    true = population.mean + random.standard_normal((count, width)) @ np.linalg.cholesky(population.spread).T
    if drift:
        true[count // 2 :, [i for i, name in enumerate(own.names) if name in SCALED]] += np.log1p(DRIFT)
    if weak:
        true[count // 4 - 1, own.names.index("c_sf")] += np.log1p(-WEAK)
    factors = np.linalg.cholesky(own.covariances)
    return replace(own, positions=true + np.einsum("nij,nj->ni", factors, random.standard_normal((count, width))))


SCALED = ("m_s", "I_yy", "I_xx", "m_uf", "m_ur", "k_sf", "k_sr", "k_tf", "k_tr", "c_sf", "c_sr")
"""What a wrong weighing changes."""


def alarms(own: FleetEstimates, population: Population, number: int, drift: bool, weak: bool) -> dict[str, Any]:
    """Return the alarms of a fleet that is drawn anew."""
    drawn = redrawn(own, population, number, drift, weak)
    chart, _ = chart_vehicles(drawn)
    middle, quarter = own.count // 2, own.count // 4
    right = [alarm for alarm in chart.rig_alarms if alarm.number > middle and alarm.deviation.name == "scale"]
    found = [alarm for alarm in chart.vehicle_alarms if alarm.number == quarter]
    return {
        "rig": len(chart.rig_alarms),
        "vehicle": len(chart.vehicle_alarms),
        "drift_named": bool(right),
        "delay": right[0].number - middle if right else None,
        "size": right[0].deviation.percent if right else None,
        "weak_named": bool(found) and found[0].deviations[0].name == "c_sf",
    }


def charted(one: FleetType, fleets: int, processes: int, drift: bool, weak: bool, what: str) -> dict[str, Any]:
    """Return how often the charts of fleets that are drawn anew raise which alarms."""
    tasks = [(one.estimates, one.population, number, drift, weak) for number in range(fleets)]
    found = list(run(alarms, tasks, processes, 1))
    delays = [case["delay"] for case in found if case["delay"] is not None]
    sizes = [case["size"] for case in found if case["size"] is not None]
    expected = fleets * one.estimates.count / RUN_LENGTH
    return {
        "fleets": what,
        "count": fleets,
        "vehicles": one.estimates.count,
        "expected_false": figures(expected),
        "rig_alarms": sum(case["rig"] for case in found),
        "vehicle_alarms": sum(case["vehicle"] for case in found),
        "drift_named": sum(case["drift_named"] for case in found),
        "median_delay": figures(np.median(delays)) if delays else None,
        "mean_size_percent": figures(np.mean(sizes)) if sizes else None,
        "weak_named": sum(case["weak_named"] for case in found),
    }


def main() -> None:
    """Run the study."""
    parser = arguments("A fleet: estimates with those of the other vehicles, and control charts.", campaigns=300)
    parser.add_argument(
        "--fleets", type=int, default=100, help="how many fleets for each row of alarms (default %(default)s)"
    )
    parser.add_argument("--keep", type=Path, help="folder in which campaigns and rows are kept, to go on after a stop")
    options = parser.parse_args()
    fleet = members(options.campaigns)
    with tempfile.TemporaryDirectory() as temporary:
        kept = options.keep or Path(temporary)
        folder, output = kept / "campaigns", kept / "out"
        sound = identified(fleet, folder, output, options.processes)
        errors = compared(sound.types[0], fleet)
        report_progress(f"{sound.counts.done} vehicles in control")
        second = identified(disturbed(fleet), folder, output, options.processes)
        report_progress(f"{second.computed} vehicles identified again")
    cases = [
        charted(sound.types[0], options.fleets, options.processes, drift, weak, what)
        for drift, weak, what in (
            (False, False, "in control"),
            (True, False, "scales drift"),
            (False, True, "one vehicle with weak dampers"),
            (True, True, "both"),
        )
    ]
    own = sound.types[0].estimates
    drawn = [
        case
        for vehicles, times in ((SMALL_FLEET, 20), (own.count, 4))
        for case in coverages(own, vehicles, times * options.fleets, options.processes)
    ]
    real = [real_case("in control", sound), real_case("scales drift, and one vehicle with weak dampers", second)]
    numbers = {"errors": errors, "coverage": drawn, "identified": real, "charts": cases}
    write(options.to, "fleets", page(errors, drawn, real, cases), numbers)


def identified(fleet: Sequence[Member], folder: Path, output: Path, processes: int) -> sprung.fleets.Fleet:
    """Write the campaigns of a fleet and identify those that are new or have changed."""
    for member in fleet:
        member.write(folder)
    return sprung.fleet(folder, output, workers=processes)


def real_case(what: str, found: sprung.fleets.Fleet) -> dict[str, Any]:
    """Return the alarms of an identified fleet."""
    chart = found.types[0].chart
    return {
        "fleet": what,
        "vehicles": found.counts.done,
        "failed": found.counts.failed,
        "computed": found.computed,
        "verdicts": dict(found.verdicts),
        "rig": [{"since": one.since, "detected": one.number, **deviation(one.deviation)} for one in chart.rig_alarms],
        "vehicle": [
            {"number": one.number, "deviations": [deviation(each) for each in one.deviations]}
            for one in chart.vehicle_alarms
        ],
    }


def deviation(one: Any) -> dict[str, Any]:
    """Return a deviation in figures."""
    return {"name": one.name, "percent": figures(one.percent), "percent_std": figures(one.percent_std)}


def page(
    errors: Sequence[Mapping[str, Any]],
    drawn: Sequence[Mapping[str, Any]],
    real: Sequence[Mapping[str, Any]],
    cases: Sequence[Mapping[str, Any]],
) -> str:
    """Write the page."""
    count, fleets = errors[0]["vehicles"], cases[0]["count"]
    low, high = min(one["coverage"] for one in drawn), max(one["coverage"] for one in drawn)
    ratio = np.median([one["single_rmse"] / one["hierarchical_rmse"] for one in errors if one["hierarchical_rmse"]])
    rows = [
        [
            one["parameter"],
            f"{one['spread']:.2f}",
            f"{one['single_rmse']:.2f}",
            f"{one['single_stated']:.2f}",
            f"{one['single_coverage']:.1f}",
            f"{one['hierarchical_rmse']:.2f}",
            f"{one['hierarchical_stated']:.2f}",
            f"{one['hierarchical_coverage']:.1f}",
        ]
        for one in errors
    ]
    head = [
        "parameter", "spread", "own test: error", "stated", "covered", "with the others: error", "stated", "covered"
    ]  # fmt: skip
    chart_head = [
        "fleets",
        "rig alarms",
        "vehicle alarms",
        "drift named",
        "median delay",
        "mean size, %",
        "weak dampers named",
    ]
    chart_rows = [
        [
            one["fleets"],
            f"{one['rig_alarms']}",
            f"{one['vehicle_alarms']}",
            f"{one['drift_named']}",
            _text(one["median_delay"], "{:.0f}"),
            _text(one["mean_size_percent"], "{:.2f}"),
            f"{one['weak_named']}",
        ]
        for one in cases
    ]
    return f"""# What a fleet tells

Vehicles of one type are tested one after the other, each with two drops only. Does the fleet make the estimates of
each vehicle better
([hierarchical fit](../fleets.md)), and do its {{term}}`control charts <control chart>` tell a rig that drifts from a
vehicle that deviates?

## Method

{count} vehicles that differ as the column *spread* says, relative to the Table 1 car with one wheelbase. Each drops
from its front
wheels and from its left wheels, recorded by eight accelerometers for {DURATION:g} s at {RATE:g} Hz with noise of {NOISE:g} m/s²
root-mean-square, and is weighed to {100 * WEIGHING:g} %. `sprung.fleet` reads and identifies the campaigns, and
compares the estimates.

Then the fleet is disturbed, and identified again into the same folder: from its middle on the scales of the rig read
{100 * DRIFT:g} % too much, and one vehicle at a quarter has front dampers that are {100 * WEAK:g} % weak.
{real[1]["computed"]} of
{count} campaigns have changed, and only these were identified again.

For the rate of false alarms, {fleets} fleets were drawn for each row of the last table: vehicles from the estimated
population, with errors of the covariance matrices of the real tests.

## Errors

Root-mean-square error of the vehicles, stated standard uncertainty (root-mean-square), in percent; and percent of the 95 %
intervals that contain the truth.

{table(head, rows)}

The error of an estimate with the others is smaller by a factor of {ratio:.1f} (median of the parameters). Nearly all
errors of such a
test are common to several parameters: the position of the centre of gravity, which two drops hardly determine. Vehicles of one
type have nearly the same.

## Coverage over many fleets

How much the vehicles of a fleet differ is estimated once for all of them, and the worst determined direction is common to most
parameters: the vehicles of one fleet are no independent trials of an interval. For the next table fleets were drawn, with the
true spread
and errors of the covariance matrices of the real tests. *Covered* is the mean over the fleets, *between* the standard
deviation
between single fleets, *least* the fleet with the lowest, all in percent; *gain* is how much
smaller errors are than those of own tests.

{coverage_table(drawn)}

Over many fleets {low:.1f} to {high:.1f} % of the intervals contain the truth, parameter by parameter. Of a parameter that
varies less between
vehicles than a test can tell (*a*, *t_f*, *t_r*), a single fleet may state too much or too little, and with *a* of everything
that shares its direction.

## Alarms of the identified fleets

{chr(10).join(_sentences(real))}

## Alarms of fleets that were drawn

Promised is one false alarm of each chart in {RUN_LENGTH:.0f} vehicles: {cases[0]["expected_false"]:g} in {fleets}
fleets of {count} vehicles,
with a standard deviation of {np.sqrt(cases[0]["expected_false"]):.1f}. Named: the number of fleets in which the
drift is explained as one of
the scale, and in which the weak dampers are found as such. Delay: vehicles from the beginning of the drift to the alarm.

{table(chart_head, chart_rows)}

## Reproduction

    python docs/studies/fleets.py --campaigns {count} --fleets {fleets} --processes 2
"""


def coverage_table(drawn: Sequence[Mapping[str, Any]]) -> str:
    """Write the table of the coverage over drawn fleets, with columns for each number of vehicles."""
    sizes = list(dict.fromkeys(one["vehicles"] for one in drawn))
    by = {(one["parameter"], one["vehicles"]): one for one in drawn}
    head = ["parameter"]
    for size in sizes:
        fleets = next(one["fleets"] for one in drawn if one["vehicles"] == size)
        head += [f"{fleets} fleets of {size}: covered", "between", "least", "gain"]
    rows = [
        [
            name,
            *(
                text
                for size in sizes
                for text in (
                    f"{by[name, size]['coverage']:.1f}",
                    f"{by[name, size]['coverage_between_fleets']:.1f}",
                    f"{by[name, size]['least_coverage']:.0f}",
                    f"{by[name, size]['gain']:.1f}",
                )
            ),
        ]
        for name in dict.fromkeys(one["parameter"] for one in drawn)
    ]
    return table(head, rows)


def _text(value: float | None, form: str) -> str:
    return "" if value is None else form.format(value)


def _sentences(real: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    for case in real:
        found = [
            f"rig: {_size(one)} since vehicle {one['since']}, detected at {one['detected']}" for one in case["rig"]
        ]
        found += [
            f"vehicle {one['number']}: {', '.join(_size(each) for each in one['deviations'])}"
            for one in case["vehicle"]
        ]
        yield f"- {case['fleet']}: {'; '.join(found) or 'no alarm'}."


def _size(one: Mapping[str, Any]) -> str:
    return f"{one['name']} {one['percent']:+.2f} ± {one['percent_std']:.2f} %"


if __name__ == "__main__":
    main()

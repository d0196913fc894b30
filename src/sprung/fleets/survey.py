"""What a fleet tells: types, their spread beside each vehicle's own error, charts, and the estimates of each vehicle."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.batch import DONE, Row
from sprung.display import shown
from sprung.fleets.charts import ControlChart, chart_vehicles
from sprung.fleets.estimates import FleetEstimates, collect_estimates, quantity_of
from sprung.fleets.population import FEWEST, Population, VehicleEstimates, estimate_vehicles
from sprung.fleets.scale import UNDETERMINED
from sprung.uncertainty import NORMAL_95
from sprung.vehicle import PART_NAMES, layout_of

Real = NDArray[np.float64]

ALL_VEHICLES = "all vehicles"
"""Name of the type of all vehicles, whatever their own names."""


@shown
@dataclass(frozen=True, slots=True)
class ParameterSpread:
    """One parameter of the vehicles of a type.

    Attributes
    ----------
    unit
        SI.
    mean, mean_std
        Of the population, and its standard uncertainty, SI.
    spread, spread_std
        Standard deviation between vehicles, beyond the errors of their tests, and its standard error, % of the mean (of
        the usual size where a value may be zero).
    error, hierarchical_error
        Median standard uncertainty of a vehicle from its own test, and with the population, likewise in %; None
        where most tests do not determine it.
    limits
        Within them is a vehicle in control with a probability of 95 %, tested with the median uncertainty; SI.
    exact
        Whether every vehicle has this value, known exactly before its test; spread and uncertainties are then 0.
    """

    unit: str
    mean: float
    mean_std: float
    spread: float
    spread_std: float
    error: float | None
    hierarchical_error: float
    limits: tuple[float, float]
    exact: bool = False


@shown
@dataclass(frozen=True, eq=False)
class FleetType:
    """The vehicles of one type.

    Attributes
    ----------
    name
        Name of the type.
    estimates
        Of each vehicle from its own test.
    population
        Mean and spread.
    chart
        Control charts.
    hierarchical
        Estimates of each vehicle with the population; those of deviating vehicles are their own.
    """

    name: str
    estimates: FleetEstimates
    population: Population
    chart: ControlChart
    hierarchical: VehicleEstimates

    @property
    def parameters(self) -> dict[str, ParameterSpread]:
        """Spread and errors of each parameter, by name."""
        own, population = self.estimates, self.population
        varies = np.where(own.constant, 0.0, 1.0)
        error = np.median(own.own_stds, axis=0)
        hierarchical = np.median(np.where(own.exact, 0.0, self.hierarchical.stds), axis=0)
        mean_stds = varies * np.sqrt(np.diag(population.mean_covariance))
        spread = varies * population.std
        half = NORMAL_95 * np.sqrt(spread**2 + mean_stds**2 + np.where(error < UNDETERMINED, error, 0.0) ** 2)
        means = own.values(population.mean)
        low, high = own.values(population.mean - half), own.values(population.mean + half)
        mean_uncertainties = own.stds(population.mean, mean_stds)
        return {
            name: ParameterSpread(
                quantity_of(name).unit,
                float(means[j]),
                float(mean_uncertainties[j]),
                float(100 * spread[j]),
                float(100 * spread[j] * population.std_error[j]),
                float(100 * error[j]) if error[j] < UNDETERMINED else None,
                float(100 * hierarchical[j]),
                (float(low[j]), float(high[j])),
                bool(own.constant[j]),
            )
            for j, name in enumerate(own.names)
        }

    def rows(self) -> list[Row]:
        """Return a row for each parameter of each vehicle: value and standard uncertainty of its own test, and with the others.

        Returns
        -------
        list of Row
            With the columns of `sprung.fleets.HIERARCHICAL_COLUMNS`, SI.
        """
        own, joint = self.estimates, self.hierarchical
        single_stds = own.own_stds
        values, stds = own.values(own.positions), own.stds(own.positions, single_stds)
        # What is known exactly is not shared out; the floor of its covariance would move it by a rounding error.
        joint_positions = np.where(own.exact, own.positions, joint.positions)
        joint_stds = own.stds(joint_positions, np.where(own.exact, 0.0, joint.stds))
        joint_values = own.values(joint_positions)
        deviating = {alarm.campaign for alarm in self.chart.vehicle_alarms}
        rows: list[Row] = []
        for i, (campaign, label) in enumerate(zip(own.campaigns, own.labels, strict=True)):
            for j, name in enumerate(own.names):
                if not own.known[i, j]:
                    continue
                is_determined = single_stds[i, j] < UNDETERMINED
                rows.append(
                    {
                        "type": self.name,
                        "campaign": campaign,
                        "label": label,
                        "parameter": name,
                        "unit": quantity_of(name).unit,
                        "single": float(values[i, j]) if is_determined else None,
                        "single_std": float(stds[i, j]) if is_determined else None,
                        "hierarchical": float(joint_values[i, j]),
                        "hierarchical_std": float(joint_stds[i, j]),
                        "deviating": int(campaign in deviating),
                    }
                )
        return rows

    def document(self) -> dict[str, Any]:
        """Return the type as plain values."""
        chart = self.chart
        return {
            "name": self.name,
            "vehicles": self.estimates.count,
            "has_scale": self.estimates.has_scale,
            "undetermined": list(self.estimates.undetermined),
            "correlated": self.population.correlated,
            "parameters": {name: asdict(spread) for name, spread in self.parameters.items()},
            "run_length": chart.run_length,
            "vehicle_limit": chart.vehicle_limit,
            "rig_limit": chart.rig_limit,
            "vehicle_alarms": [asdict(alarm) for alarm in chart.vehicle_alarms],
            "rig_alarms": [asdict(alarm) for alarm in chart.rig_alarms],
        }


class Survey(NamedTuple):
    """What the vehicles of a fleet tell, type by type.

    Attributes
    ----------
    types
        In the order of their names.
    small
        Number of vehicles by name, of types with fewer than three.
    parts
        By name, of those whose vehicles are not all of one part of a vehicle: number of vehicles by part, each of which is a
        type of its own.
    """

    types: tuple[FleetType, ...]
    small: Mapping[str, int]
    parts: Mapping[str, Mapping[str, int]]


def survey_types(rows: Iterable[Row], one_type: bool = False) -> Survey:
    """Return the types of a fleet: vehicles of one name and of one part of a vehicle.

    Parameters
    ----------
    rows
        With the columns of `NEEDED`.
    one_type
        Whether all vehicles of one part are of one type; otherwise those of one name are.

    Returns
    -------
    Survey
    """
    by_name: dict[str, dict[str, list[Row]]] = {}
    for row in rows:
        if row["status"] == DONE and row["coordinates"]:
            name = ALL_VEHICLES if one_type else row["vehicle"] or "unnamed"
            part = PART_NAMES[layout_of(row["coordinates"]).model]
            by_name.setdefault(name, {}).setdefault(part, []).append(row)
    parts = {
        name: {part: len(group) for part, group in sorted(groups.items())}
        for name, groups in sorted(by_name.items())
        if len(groups) > 1
    }
    types, small = [], {}
    for name, groups in sorted(by_name.items()):
        for part, group in sorted(groups.items()):
            label = f"{name}, {part}" if name in parts else name
            if len(group) < FEWEST:
                small[label] = len(group)
            elif (estimates := collect_estimates(in_test_order(group))) is not None:
                types.append(_survey(label, estimates))
    return Survey(tuple(types), small, parts)


def _survey(name: str, estimates: FleetEstimates) -> FleetType:
    chart, population = chart_vehicles(estimates)
    offsets = chart.offsets
    joint = estimate_vehicles(estimates.positions + offsets, estimates.covariances, population)
    alone = np.isin(estimates.campaigns, [alarm.campaign for alarm in chart.vehicle_alarms])
    hierarchical = VehicleEstimates(
        np.where(alone[:, None], estimates.positions, joint.positions - offsets),
        np.where(alone[:, None, None], estimates.covariances, joint.covariances),
    )
    return FleetType(name, estimates, population, chart, hierarchical)


def in_test_order(rows: Sequence[Row]) -> list[Row]:
    """Return rows in the order of the tests: by date where every campaign states one, then by path, numbers by their size.

    Parameters
    ----------
    rows
        With the columns ``date`` and ``campaign``.

    Returns
    -------
    list of Row
    """
    dated = all(row["date"] for row in rows)
    return sorted(rows, key=lambda row: (row["date"] if dated else "", _natural(row["campaign"])))


def _natural(path: str) -> list[tuple[int, int, str]]:
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in re.split(r"(\d+)", path) if part]

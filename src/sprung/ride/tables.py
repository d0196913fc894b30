"""The tables of ride numbers, shared by terminal, notebook and report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sprung.ride.bench import PHASE_LIMIT
from sprung.ride.records import RideNumbers
from sprung.tables import Table
from sprung.uncertainty import Estimate, round_by_uncertainty

_AXLE_ROWS = (
    ("body, natural frequency, Hz", "body_frequency"),
    ("body, damping ratio", "body_damping"),
    ("wheel hop, natural frequency, Hz", "hop_frequency"),
    ("wheel hop, damping ratio", "hop_damping"),
    ("sprung mass on a {}, kg", "m_s"),
    ("unsprung mass of a {}, kg", "m_u"),
    ("spring rate, N/m", "k_s"),
    ("tyre rate, N/m", "k_t"),
    ("damper rate, N s/m", "c_s"),
    ("tyre damping, N s/m", "c_t"),
)
_PEAK_ROWS = (
    ("largest transmissibility to the body", "body", "gain"),
    ("frequency of this, Hz", "body", "frequency"),
    ("largest transmissibility to the wheel", "wheel", "gain"),
    ("frequency of this, Hz", "wheel", "frequency"),
)
_HALF_ROWS = (
    ("sprung mass, kg", "m_s"),
    ("pitch inertia, kg m²", "I_yy"),
    ("roll inertia, kg m²", "I_xx"),
    ("centre of gravity to front axle, m", "a"),
    ("centre of gravity to rear axle, m", "b"),
    ("dynamic index", "dynamic_index"),
    ("unsprung mass of a side, kg", "m_u"),
    ("spring rate of a side, N/m", "k_s"),
    ("tyre rate of a side, N/m", "k_t"),
    ("damper rate of a side, N s/m", "c_s"),
    ("anti-roll bars, N/m", "k_a"),
    ("half-distance of the springs, m", "t"),
)


_NOTHING = ("", "-")
"""Cells without a number."""


def ride_tables(numbers: RideNumbers) -> tuple[Table, ...]:
    """Return the tables of ride numbers.

    Parameters
    ----------
    numbers
        Of a vehicle.

    Returns
    -------
    tuple of Table
        Axles, suspension tester, comfort and wheels on each road, half cars; without rows in which nothing is determined.
    """
    tables = (
        _axles(numbers),
        _plates(numbers),
        *_comfort(numbers),
        *_seats(numbers),
        _wheels(numbers),
        *_half_cars(numbers),
    )
    trimmed = (
        replace(table, rows=tuple(row for row in table.rows if any(cell not in _NOTHING for cell in row[1:])))
        for table in tables
    )
    return tuple(table for table in trimmed if table.rows)


def _cell(estimate: Estimate | None, factor: float = 1.0) -> str:
    """Return a number with its standard uncertainty; "-" where it is not determined."""
    if estimate is None or estimate.value is None or estimate.std is None:
        return "-"
    if estimate.std == 0:
        return f"{factor * estimate.value:.5g}"
    value, std = round_by_uncertainty(factor * estimate.value, factor * estimate.std)
    return f"{value} ± {std}"


def _rows(names: Sequence[tuple[str, str]], columns: Sequence[Mapping[str, Estimate]]) -> Iterator[tuple[str, ...]]:
    """Yield the rows of numbers that any of the columns has, as far as they are determined."""
    for label, name in names:
        cells = [_cell(column[name]) if name in column else "" for column in columns]
        if any(cell not in _NOTHING for cell in cells):
            yield (label, *cells)


def _is_pitch_plane(numbers: RideNumbers) -> bool:
    """Return whether left and right are not told apart: both wheels of an axle are then one wheel station."""
    return "pitch" in numbers.half_cars and "roll" not in numbers.half_cars


def _axles(numbers: RideNumbers) -> Table:
    part, station = ("axle", "station") if _is_pitch_plane(numbers) else ("quarter car", "wheel")
    headers = (part, *numbers.axles)
    rows = list(_rows([(label.format(station), name) for label, name in _AXLE_ROWS], list(numbers.axles.values())))
    for label, kind, name in _PEAK_ROWS:
        peaks = [
            numbers.peaks.get(kind if axle == "axle" else f"{kind}_{axle}", {}).get(name) for axle in numbers.axles
        ]
        rows.append((label, *(_cell(one) for one in peaks)))
    title = f"{numbers.vehicle}, load {numbers.load}: axles, ± one standard uncertainty"
    return Table(title, headers, tuple(rows), frozenset(headers[1:]))


def _plates(numbers: RideNumbers) -> Table:
    headers = ("wheel", "static load, N", "EUSAMA, %", "resonance, Hz", "EGEA, °", "limit 35°")
    rows = [
        (
            ", ".join(wheels),
            _cell(own["static_load"]),
            _cell(own.get("least_load"), 100.0),
            _cell(own.get("resonance")),
            _cell(own.get("least_phase"), float(np.rad2deg(1.0))),
            _judged(own.get("least_phase")),
        )
        for wheels in _alike(numbers)
        for own in [numbers.plates[wheels[0]]]
    ]
    title = "Suspension tester, plate ±3 mm: minimum wheel load (EUSAMA), minimum phase shift (EGEA)"
    return Table(title, headers, tuple(rows), frozenset(headers[1:5]), ("resonance, Hz",))


def _alike(numbers: RideNumbers) -> list[tuple[str, ...]]:
    """Return the wheels, those with the same numbers together: left and right of a vehicle whose sides are alike."""
    found: dict[str, list[str]] = {}
    for wheel, own in numbers.plates.items():
        on_roads = [
            f"{estimate.value:.6g}" if estimate.value is not None else ""
            for one in numbers.roads
            for estimate in one.wheels[wheel].values()
        ]
        found.setdefault(f"{[str(one) for one in own.values()]}{on_roads}", []).append(wheel)
    return [tuple(wheels) for wheels in found.values()]


def _judged(estimate: Estimate | None) -> str:
    """Return whether the limit of the phase shift is met, as far as the 95 % interval tells."""
    if estimate is None or estimate.interval95 is None:
        return "-"
    low, high = estimate.interval95
    if low is None or high is None:
        return "-"
    return "met" if low >= PHASE_LIMIT else "not met" if high < PHASE_LIMIT else "undecided"


def _drives(numbers: RideNumbers) -> Iterator[tuple[str, int]]:
    for i, one in enumerate(numbers.roads):
        yield f"{one.road}, {3.6 * one.speed:.3g} km/h", i


def _comfort(numbers: RideNumbers) -> Iterator[Table]:
    """Yield the tables of weighted accelerations, and of vibration dose values."""
    places = list(numbers.options.places)
    axes = list(numbers.roads[0].body) if numbers.roads else []
    headers = ("road", *places, *(f"{axis}, rad/s²" for axis in axes))
    rows = [
        (
            label,
            *(_cell(numbers.roads[i].places[place]["weighted"]) for place in places),
            *(_cell(numbers.roads[i].body[axis]["weighted"]) for axis in axes),
        )
        for label, i in _drives(numbers)
    ]
    turning = f"; {' and '.join(axes)} W_e" if axes else ""
    title = f"Weighted acceleration (ISO 2631-1): vertical W_k, m/s² rms{turning}"
    yield Table(title, headers, tuple(rows), frozenset(headers[1:]), headers[1 + len(places) :])
    doses = [
        (label, *(_cell(numbers.roads[i].places[place]["vibration_dose"]) for place in places))
        for label, i in _drives(numbers)
    ]
    title = f"Vibration dose value of {numbers.options.duration / 3600:g} h, vertical, m/s^1.75"
    yield Table(title, ("road", *places), tuple(doses), frozenset(places))


def _seats(numbers: RideNumbers) -> Iterator[Table]:
    """Yield the table of horizontal motion at places with a height, if there are any."""
    places = [name for name, place in numbers.options.places.items() if len(place) == 3]
    if not places or not numbers.roads:
        return
    kinds = [("forward_weighted", "forward"), ("left_weighted", "left"), ("total", "total")]
    kinds = [kind for kind in kinds if kind[0] in numbers.roads[0].places[places[0]]]
    headers = ("road", *(f"{place}, {word}" for place in places for _, word in kinds))
    rows = [
        (label, *(_cell(numbers.roads[i].places[place][name]) for place in places for name, _ in kinds))
        for label, i in _drives(numbers)
    ]
    title = "Horizontal acceleration by pitch and roll, W_d, and vibration total value, m/s² rms"
    yield Table(title, headers, tuple(rows), frozenset(headers[1:]))


def _wheels(numbers: RideNumbers) -> Table:
    wheels = _alike(numbers)
    names = [", ".join(own) for own in wheels]
    headers = ("road", *(f"load {name}" for name in names), *(f"travel {name}, mm" for name in names))
    rows = [
        (
            label,
            *(_cell(numbers.roads[i].wheels[own[0]]["load_coefficient"]) for own in wheels),
            *(_cell(numbers.roads[i].wheels[own[0]]["travel"], 1e3) for own in wheels),
        )
        for label, i in _drives(numbers)
    ]
    title = "Wheels: dynamic load over static load, and suspension travel, rms"
    return Table(title, headers, tuple(rows), frozenset(headers[1:]), headers[1 + len(wheels) :])


def _half_cars(numbers: RideNumbers) -> Iterator[Table]:
    if numbers.half_cars:
        title, part, pitch = (
            ("Pitch plane", "both sides together", "pitch plane")
            if _is_pitch_plane(numbers)
            else ("Half cars", "half car", "pitch, one side")
        )
        names = {"pitch": pitch, "roll": "roll, both axles"}
        headers = (part, *(names[plane] for plane in numbers.half_cars))
        rows = tuple(_rows(_HALF_ROWS, list(numbers.half_cars.values())))
        yield Table(title, headers, rows, frozenset(headers[1:]))

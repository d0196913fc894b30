"""Sections about the parameters: estimates, prior knowledge, correlation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from markupsafe import Markup

from sprung.report.page.sections.context import Context
from sprung.report.page.summary import symbol_parts
from sprung.report.pictures.curves import curve_pictures
from sprung.report.pictures.parameters import half_width, limits_percent
from sprung.results import (
    Result,
    Setup,
    characteristics_tables,
    damper_tables,
    meaning_of,
    other_quantities,
    ratios_table,
    sensors_table,
)
from sprung.tables import Table, unit_text, value_cells, with_minus_signs
from sprung.uncertainty import Estimate, round_by_uncertainty
from sprung.units import quantity_name
from sprung.vehicle import Layout, Sensor, VehicleModel, layout_of

_CLOSE = 0.9
"""Correlation above which a pair of parameters is listed."""

_STRENGTHS = (0.3, 0.5, 0.7, 0.9)
"""Correlations at which the shade of a cell gets darker."""


_SUBSYSTEM: Mapping[VehicleModel, str] = {
    "full": "of the quarter car of each axle: half of the sprung mass on the axle",
    "pitch-plane": "of each axle alone: the sprung mass on the axle",
    "roll-plane": "of the quarter car of one side: half of the sprung mass",
    "quarter": "of the quarter car: its sprung mass",
}
"""The uncoupled subsystem that frequencies and damping ratios of ride and wheel hop belong to, and its sprung mass."""


def symbol(name: str) -> Markup:
    """Return a parameter's name as a formula writes it."""
    letter, index = symbol_parts(name)
    return Markup("{}<sub>{}</sub>").format(letter, index) if index else Markup("{}").format(letter)


def characteristics(result: Result) -> Context | None:
    """Return masses, loads, centre of gravity, ride and wheel hop."""
    tables = characteristics_tables(result.name, result.derived)
    subsystem = _SUBSYSTEM[layout_of(result.parameters).model]
    return {"tables": tables, "subsystem": subsystem} if tables else None


def parameters(result: Result) -> Context:
    """Return every parameter with its interval; none of a rejected result."""
    estimates = {} if result.verdict.state == "reject" else {**result.parameters, **other_quantities(result.derived)}
    half = half_width(estimates)
    layout = layout_of(result.parameters)
    rows = [_parameter(name, estimate, half, layout) for name, estimate in estimates.items()]
    profiled = [name for name, estimate in estimates.items() if estimate.interval_from == "profile"]
    scale_free = not result.scale.known and bool(result.scale.per_total_mass)
    return {
        "rows": rows,
        "half": f"{half:g}",
        "profiled": ", ".join(profiled),
        "undetermined": result.unidentifiable,
        "ratios": ratios_table(result.scale.per_total_mass) if scale_free else None,
    }


def curves(result: Result) -> Context | None:
    """Return the force curves of dampers, springs and tyres."""
    pictures = list(curve_pictures(result.curves).values())
    text = (
        "Force of each damper, spring and tyre, mean of left and right, with its 95 % band. Solid: the range that the drops "
        "reached, its ends marked by rings. Dashed: beyond it, extrapolated by the model."
    )
    friction = [
        f"{friction} at each {name.removeprefix('damper_')} wheel"
        for name, curve in result.curves.items()
        if (friction := curve.friction) is not None and friction.value is not None
    ]
    notes = (
        [f"Dry friction acts beside the dampers and is not part of the curves: {', '.join(friction)}."]
        if friction
        else []
    )
    tables = damper_tables(result.curves)
    return {"text": text, "pictures": pictures, "tables": tables, "notes": notes} if pictures else None


def _parameter(name: str, estimate: Estimate, half: float, layout: Layout) -> Context:
    value, std, percent, unit, status = value_cells(estimate)
    row: Context = {
        "name": name,
        "symbol": symbol(name),
        "meaning": meaning_of(name, layout),
        "value": with_minus_signs(value),
        "std": std,
        "percent": percent,
        "unit": unit,
        "status": status,
        "bar": None,
        "instead": "exact" if status == "known" else "not determined" if status == "unidentifiable" else "",
    }
    limits = limits_percent(estimate)
    if limits is not None and estimate.interval95 is not None:
        low, high = (float(np.clip(60 + 60 * limit / half, 0, 120)) for limit in limits)
        row["bar"] = {
            "low": f"{low:.1f}",
            "high": f"{high:.1f}",
            "more_low": limits[0] < -half,
            "more_high": limits[1] > half,
        }
        ends = [_limit(limit, estimate.std) for limit in estimate.interval95]
        row["description"] = f"{name}: 95 % interval from {ends[0]} to {ends[1]} {unit}".rstrip()
    return row


def _limit(limit: float | None, std: float | None) -> str:
    return "open" if limit is None else round_by_uncertainty(limit, std or abs(limit) or 1.0)[0]


def known(result: Result) -> Context:
    """Return the table of what was known beforehand beside its estimates."""
    headers = ("quantity", "known value", "±", "estimate", "± ", "unit", "difference")
    rows = []
    for name, prior in result.setup.known.items():
        value, std = round_by_uncertainty(prior.value, prior.std)
        estimate, estimate_std, *_ = value_cells(prior.found) if prior.std else ("fixed", "")
        difference = "" if prior.missed is None else f"{prior.missed:.1f} standard uncertainties"
        rows.append((name, value, std or "exact", estimate, estimate_std, unit_text(prior.unit), difference))
    table = Table("Known beforehand", headers, tuple(rows), frozenset(headers[1:5]))
    heights = ", ".join(f"{key.replace('_', ' ')} {value:g} m" for key, value in result.setup.heights.items())
    return {
        "known": table,
        "fixed": any(prior.missed is not None and not prior.std for prior in result.setup.known.values()),
        "heights": heights,
        "loads": list(_loads(result.setup, layout_of(result.parameters))),
        "sensors": _sensors(result.setup),
        "of_sensors": sensors_table(result.sensors) if result.sensors else None,
    }


def _loads(setup: Setup, layout: Layout) -> Iterator[str]:
    for load in setup.loads:
        mass = load.total_mass(layout)
        if load.added is not None:
            added = load.added
            yield (f"{load.name}: {mass:g} kg in all, as totals (I_yy {added.I_yy:g} kg m², I_xx {added.I_xx:g} kg m²)")
        elif load.items:
            places = "; ".join(
                f"{item.mass:g} kg "
                + (f"on wheel {item.on}" if item.position is None else f"at {_place(item.position)}")
                + (" on a seat" if item.is_soft else "")
                for item in load.items
            )
            yield f"{load.name}: {mass:g} kg in all: {places}"


def _place(position: tuple[float, float, float]) -> str:
    return "(" + ", ".join(f"{part:g}" for part in position).replace("-", "\N{MINUS SIGN}") + ") m"


def _measures(sensor: Sensor) -> str:
    """Return what a sensor measures, in words."""
    about = "" if sensor.axis == "vertical" else f" in {sensor.axis}"
    of = "" if sensor.relative_to is None else f" relative to {sensor.relative_to}"
    return f"{quantity_name(sensor.quantity)}{about}{of}"


def _sensors(setup: Setup) -> Table:
    headers = ("channel", "measures", "on", "position, m", "points", "unit", "range", "logger")
    rows = tuple(
        (
            sensor.channel,
            _measures(sensor),
            sensor.on or "",
            "" if sensor.position is None else _place(sensor.position).removesuffix(" m"),
            sensor.direction,
            sensor.unit or "",
            "" if sensor.range is None else f"{sensor.range:g}",
            sensor.logger or "",
        )
        for sensor in setup.sensors
    )
    return Table("Sensors", headers, rows)


def correlation(result: Result) -> Context | None:
    """Return the correlation matrix of the estimates, and its largest entries in words."""
    names, matrix = result.correlation.names, result.correlation.matrix
    if len(names) < 2:
        return None
    pairs = sorted(
        (
            (matrix[i][j], names[i], names[j])
            for i in range(len(names))
            for j in range(i)
            if abs(matrix[i][j]) >= _CLOSE
        ),
        key=lambda pair: -abs(pair[0]),
    )
    listed = ", ".join(f"{first} and {second} ({_signed(value)})" for value, first, second in pairs[:8])
    more = f", and {len(pairs) - 8} more pairs" if len(pairs) > 8 else ""
    text = (
        f"Correlations of {_CLOSE} or more: {listed}{more}."
        if pairs
        else f"No two parameters have a correlation of {_CLOSE} or more."
    )
    rows = [
        (name, [_cell(value, i == j) for j, value in enumerate(row)])
        for i, (name, row) in enumerate(zip(names, matrix, strict=True))
    ]
    return {"text": text, "names": names, "rows": rows, "symbol": symbol}


def _cell(value: float, same: bool) -> dict[str, str]:
    if same:
        return {"text": "", "kind": ""}
    strength = sum(abs(value) >= threshold for threshold in _STRENGTHS)
    return {"text": _signed(value), "kind": f"{'p' if value > 0 else 'n'}{strength}" if strength else ""}


def _signed(value: float) -> str:
    # A correlation just below one must not be rounded to one, and zero has no sign.
    text = f"{value:.3f}" if 0.995 <= abs(value) < 1 - 1e-9 else f"{value + 0.0 if abs(value) >= 0.005 else 0.0:.2f}"
    return text.replace("-", "\N{MINUS SIGN}")

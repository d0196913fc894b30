"""The parameters: what was found, what was known, what is uncertain together."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from markupsafe import Markup

from sprung.report.page.sections.context import Context
from sprung.report.page.summary import symbol as parts_of
from sprung.report.pictures.parameters import half_width, limits_percent
from sprung.results import Result, Setup, characteristics_tables, meaning_of, other_quantities, ratios_table
from sprung.tables import Table, unit_text, value_cells
from sprung.uncertainty import Estimate, round_by_uncertainty

_CLOSE = 0.9
"""Correlation from which two parameters are to be read together."""

_STRENGTHS = (0.3, 0.5, 0.7, 0.9)
"""Correlations from which a cell is shaded more."""


def symbol(name: str) -> Markup:
    """Write a parameter as formulas have it."""
    letter, below = parts_of(name)
    return Markup("{}<sub>{}</sub>").format(letter, below) if below else Markup("{}").format(letter)


def characteristics(result: Result) -> Context | None:
    """Show masses, loads, centre of gravity, ride and wheel hop."""
    tables = characteristics_tables(result.name, result.derived)
    return {"tables": tables} if tables else None


def parameters(result: Result) -> Context:
    """Show every parameter with its interval; of a rejected result none."""
    found = {} if result.verdict.state == "reject" else {**result.parameters, **other_quantities(result.derived)}
    half = half_width(found)
    rows = [_parameter(name, one, half) for name, one in found.items()]
    profiled = [name for name, one in found.items() if one.interval_from == "profile"]
    left = not result.scale.known and bool(result.scale.per_total_mass)
    return {
        "rows": rows,
        "half": f"{half:g}",
        "opened": ", ".join(profiled),
        "undetermined": result.unidentifiable,
        "ratios": ratios_table(result.scale.per_total_mass) if left else None,
    }


def _parameter(name: str, found: Estimate, half: float) -> Context:
    value, std, percent, unit, status = value_cells(found)
    row: Context = {
        "name": name,
        "symbol": symbol(name),
        "meaning": meaning_of(name),
        "value": value,
        "std": std,
        "percent": percent,
        "unit": unit,
        "status": status,
        "bar": None,
        "instead": "exact" if status == "known" else "not determined" if status == "unidentifiable" else "",
    }
    limits = limits_percent(found)
    if limits is not None and found.interval95 is not None:
        low, high = (float(np.clip(60 + 60 * limit / half, 0, 120)) for limit in limits)
        row["bar"] = {
            "low": f"{low:.1f}",
            "high": f"{high:.1f}",
            "more_low": limits[0] < -half,
            "more_high": limits[1] > half,
        }
        ends = [_limit(limit, found.std) for limit in found.interval95]
        row["told"] = f"{name}: 95 % interval from {ends[0]} to {ends[1]} {unit}".rstrip()
    return row


def _limit(limit: float | None, std: float | None) -> str:
    return "an open end" if limit is None else round_by_uncertainty(limit, std or abs(limit) or 1.0)[0]


def known(result: Result) -> Context:
    """Return the table of what was known beforehand beside its estimates."""
    headers = ("quantity", "known before", "±", "found", "± ", "unit", "the recordings")
    rows = []
    for name, one in result.setup.known.items():
        value, std = round_by_uncertainty(one.value, one.std)
        found, found_std, *_ = value_cells(one.found) if one.std else ("held", "")
        says = "" if one.missed is None else f"differ by {one.missed:.1f} standard uncertainties"
        rows.append((name, value, std or "exact", found, found_std, unit_text(one.unit), says))
    table = Table("What was known", headers, tuple(rows), frozenset(headers[1:5]))
    heights = ", ".join(f"{key.replace('_', ' ')} {value:g} m" for key, value in result.setup.heights.items())
    return {"known": table, "heights": heights, "loads": list(_loads(result.setup)), "sensors": _sensors(result.setup)}


def _loads(setup: Setup) -> Iterator[str]:
    for load in setup.loads:
        if load.added is not None:
            added = load.added
            yield (
                f"{load.name}: {load.mass:g} kg in all, as totals (I_yy {added.I_yy:g} kg m², I_xx {added.I_xx:g} kg m²)"
            )
        elif load.items:
            places = "; ".join(
                f"{item.mass:g} kg "
                + (f"on wheel {item.on}" if item.position is None else f"at {_place(item.position)}")
                for item in load.items
            )
            yield f"{load.name}: {load.mass:g} kg in all: {places}"


def _place(position: tuple[float, float, float]) -> str:
    return "(" + ", ".join(f"{part:g}" for part in position).replace("-", "\N{MINUS SIGN}") + ") m"


def _sensors(setup: Setup) -> Table:
    headers = ("channel", "on", "position, m", "points", "unit", "range", "logger")
    rows = tuple(
        (
            sensor.channel,
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
    """Show which parameters are uncertain together."""
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
    told = ", ".join(f"{one} with {other} ({_signed(value)})" for value, one, other in pairs[:8])
    more = f", and {len(pairs) - 8} more pairs" if len(pairs) > 8 else ""
    said = (
        f"To be read together, as they are uncertain together: {told}{more}."
        if pairs
        else f"No two parameters are correlated by {_CLOSE} or more: each error bar can be read on its own."
    )
    rows = [
        (name, [_cell(value, i == j) for j, value in enumerate(row)])
        for i, (name, row) in enumerate(zip(names, matrix, strict=True))
    ]
    return {"said": said, "names": names, "rows": rows, "symbol": symbol}


def _cell(value: float, same: bool) -> dict[str, str]:
    if same:
        return {"text": "", "kind": ""}
    strength = sum(abs(value) >= least for least in _STRENGTHS)
    return {"text": _signed(value), "kind": f"{'p' if value > 0 else 'n'}{strength}" if strength else ""}


def _signed(value: float) -> str:
    # What is not quite one shall not look like it, and nothing shall have no sign.
    text = f"{value:.3f}" if 0.995 <= abs(value) < 1 else f"{value + 0.0 if abs(value) >= 0.005 else 0.0:.2f}"
    return text.replace("-", "\N{MINUS SIGN}")

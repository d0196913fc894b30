"""What each part of the report shows: the context of its template, or None where a result has nothing for it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import numpy as np
from markupsafe import Markup

from sprung.errors import Fault, InputError
from sprung.estimate import Estimate, round_by_uncertainty
from sprung.modal import stabilisation_diagram
from sprung.pipeline import DropReport, Result, Setup, meaning_of, modes_table, ratios_table
from sprung.report.animation import cars_of, wire_json
from sprung.report.car import wire_car
from sprung.report.check import drops_table
from sprung.report.decays import decays_by_load
from sprung.report.literature import literature_of
from sprung.report.pictures import (
    amplitude_pictures,
    half_width,
    limits_percent,
    motion_picture,
    near_picture,
    spectra_picture,
    stability_picture,
    whole_picture,
)
from sprung.report.validation import AMPLITUDES, COLUMNS, amplitude_table, validation_table
from sprung.report.words import symbol as parts_of
from sprung.tables import Table, unit_text, value_cells

Context = dict[str, Any]

_NOT_KEPT = "An older sprung wrote this result, without what is shown here: identify the campaign again."

_CLOSE = 0.9
"""Correlation from which two parameters are to be read together."""

_STRENGTHS = (0.3, 0.5, 0.7, 0.9)
"""Correlations from which a cell is shaded more."""


def symbol(name: str) -> Markup:
    """Write a parameter as formulas have it."""
    letter, below = parts_of(name)
    return Markup("{}<sub>{}</sub>").format(letter, below) if below else Markup("{}").format(letter)


def parameters(result: Result) -> Context:
    """Show every parameter with its interval."""
    found = {**result.parameters, **result.derived}
    half = half_width(found)
    rows = [_parameter(name, one, half) for name, one in found.items()]
    profiled = [name for name, one in found.items() if one.interval_from == "profile"]
    left = not result.scale.known and bool(result.scale.per_total_mass) and result.verdict.state != "reject"
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


def known(result: Result) -> Context | None:
    """Hold what was known beforehand against what was found."""
    if result.setup is None:
        return None
    headers = ("quantity", "known before", "±", "found", "± ", "unit", "the recordings")
    rows = []
    for name, one in result.setup.known.items():
        value, std = round_by_uncertainty(one.value, one.std)
        found, found_std, *_ = value_cells(one.found) if one.std else ("taken as it is", "")
        says = "" if one.missed is None else f"would have it {one.missed:.1f} standard uncertainties off"
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
            sensor.on,
            "" if sensor.position is None else _place(sensor.position).removesuffix(" m"),
            sensor.direction,
            sensor.unit or "",
            "" if sensor.range is None else f"{sensor.range:g}",
            sensor.logger or "",
        )
        for sensor in setup.sensors
    )
    return Table("Sensors", headers, rows)


def recordings(result: Result, few: bool, unfolded: bool) -> Context:
    """Show every recording, with what happened in it and what was wrong."""
    drawn, opened = [], False
    for drop in result.drops:
        recorded = result.recordings.get(drop.name)
        if recorded is None or not drop.channels:
            continue
        pictures = [whole_picture(drop, recorded), near_picture(drop, recorded)]
        # Of many that are alike one is shown as an example; whatever is wrong is shown.
        show = unfolded or not opened or (few and bool(drop.faults))
        opened = opened or show
        drawn.append(
            {
                "file": drop.file,
                "said": f"{drop.kind}, {drop.load}",
                "wrong": "left out" if drop.start is None else ", ".join(dict.fromkeys(drop.faults)),
                "limits": _limits(drop),
                "open": show,
                "pictures": [picture for picture in pictures if picture is not None],
            }
        )
    return {"overview": drops_table(result.drops), "faults": _joined(result.faults), "drawn": drawn}


def _limits(drop: DropReport) -> str:
    if drop.start is None or drop.end is None or not drop.why_start:
        return ""
    return f"Decay from {drop.start:.3f} s: {drop.why_start}; to {drop.end:.3f} s: {drop.why_end}."


def _joined(faults: tuple[Fault, ...]) -> list[Fault]:
    """Say once what was found alike in several places."""
    places: defaultdict[tuple[str, str, str], list[str]] = defaultdict(list)
    for fault in faults:
        places[fault.code, fault.what, fault.do].append(fault.where)
    return [Fault(code, ", ".join(where), what, do) for (code, what, do), where in places.items()]


def spectra(result: Result) -> Context | None:
    """Show the spectra of every load, with the identified modes."""
    pictures = [spectra_picture(one, result.modes[one.load]) for one in decays_by_load(result)]
    said = (
        "Spectra of the decays, in the mean over drops and sensors, beside those of the fitted vehicle. Lines: the damped "
        "frequencies of the identified modes."
    )
    return {"said": said, "pictures": pictures} if pictures else None


def stabilisation(result: Result) -> Context | None:
    """Show poles over the order of a model that knows nothing of vehicles."""
    pictures, notes = [], []
    for one in decays_by_load(result):
        try:
            records = [record - record.mean(axis=1, keepdims=True) for record in one.measured]
            pictures.append(stability_picture(one.load, stabilisation_diagram(records, one.rate)))
        except InputError as error:
            notes += [f"{one.load}: no diagram can be drawn ({problem.found})." for problem in error.problems]
    said = (
        "Models of growing order were fitted to the decays, without any vehicle in them: what vibrates stays where it is. "
        "Lines stand where poles stay. Wheel modes that lie closer than the noise allows appear as one."
    )
    return {"said": said, "pictures": pictures, "notes": notes} if pictures or notes else None


def modes(result: Result) -> Context:
    """Show the modes of the identified vehicle, moving, and their tables."""
    load, first = next(iter(result.modes.items()), ("", ()))
    car = wire_car(result)
    if result.verdict.state == "reject":
        return {"why_not": "the numbers of a vehicle that was rejected are worth nothing, and so are its modes"}
    if not any(mode.motion for mode in first):
        return {"why_not": "an older sprung wrote this result, without the shapes", "tables": _mode_tables(result)}
    shaped = [mode for mode in first if mode.frequency_std is not None]
    return {
        "cars": list(cars_of(car, shaped)),
        "wire": wire_json(car),
        "load": load,
        "missing": ", ".join(mode.name for mode in first if mode.frequency_std is None),
        "tables": _mode_tables(result),
    }


def _mode_tables(result: Result) -> list[Table]:
    return [modes_table(load, modes) for load, modes in result.modes.items()]


def motions(result: Result, few: bool) -> Context | None:
    """Hold what the body did against what the fitted vehicle does, drop by drop."""
    groups: dict[str, list[Any]] = {}
    for drop in result.drops:
        series = result.series.get(drop.name)
        picture = None if series is None else motion_picture(drop.name, series, result.validation.get(drop.name))
        if picture is not None:
            groups.setdefault(drop.load, []).append(picture)
    if not result.validation and not groups:
        return None
    return {
        "overview": validation_table(result.vehicle.name, result.validation),
        "columns": COLUMNS,
        "groups": [
            {"title": f"{load}: {len(pictures)} drop{'s' * (len(pictures) > 1)}", "pictures": pictures, "open": few}
            for load, pictures in groups.items()
        ],
    }


def amplitude(result: Result) -> Context | None:
    """Show equivalent frequency and damping of the body's modes against amplitude."""
    if not result.amplitude:
        return None
    load = result.amplitude[0].load
    said = (
        f"Body modes, {load}. {AMPLITUDES} A linear vehicle has one frequency at every amplitude; where springs rub, the "
        "frequency rises as the motion dies."
    )
    pictures = amplitude_pictures(result.amplitude)
    return {"said": said, "pictures": pictures, "tables": [amplitude_table(load, result.amplitude)]}


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


def next_step(result: Result) -> Context:
    """Say what to measure next."""
    if result.next_step is not None:
        return {"said": f"{result.next_step[0].upper()}{result.next_step[1:]}".rstrip(".") + "."}
    if result.verdict.state == "reject":
        return {
            "said": "First the reasons of the verdict: what does not fit the model tells nothing of what to measure next."
        }
    return {"said": _NOT_KEPT}


def settings(result: Result) -> Context:
    """Tell every setting, version, file and checksum."""
    fit = result.fit
    pairs = [
        ("method", fit.method),
        ("model", f"seven degrees of freedom{', with ' + ', '.join(fit.model) if fit.model else ''}"),
        ("half-distances", f"{fit.tracks}"),
        ("why this model", fit.why),
        ("axes of the inertias", fit.axes),
        ("drops used from", "their release on" if fit.since == "release" else "when the last tyre was down"),
        (
            "fit",
            (
                f"{fit.samples} samples, {fit.iterations} steps, {'converged' if fit.converged else 'not converged'}; "
                f"{fit.starts_agreeing} of {fit.starts} starts agree"
            ),
        ),
        ("error bars", _bars(result)),
        ("noise, m/s² rms", ", ".join(f"{name} {value:.3g}" for name, value in fit.noise.items())),
    ]
    tables = []
    if fit.path:
        headers = ("tried", "gain", "asked", "fitted", "taken")
        rows = tuple(
            (
                one.extra,
                f"{one.gain:.0f}",
                f"{one.asked:.0f}",
                "yes" if one.fitted else "no",
                "yes" if one.taken else "no",
            )
            for one in fit.path
        )
        title = "The way to the model: gain in twice the log-likelihood, and what is asked"
        tables.append(Table(title, headers, rows, frozenset(headers[1:3])))
    if (setup := result.setup) is not None:
        model = setup.model
        asked = {
            "tracks": model.tracks,
            "extras": None if model.extras is None else ", ".join(model.extras) or "none",
            "forbidden": ", ".join(model.forbid) or None,
            "fall": None if model.fall is None else "yes" if model.fall else "no",
        }
        pairs.append(
            ("asked in the campaign file", "; ".join(f"{key}: {value or 'left open'}" for key, value in asked.items()))
        )
        pairs.append(
            ("asked beside it", "; ".join(f"{key}: {value}" for key, value in setup.options.items()) or "nothing")
        )
        pairs.append(("software", ", ".join(f"{name} {number}" for name, number in setup.software.items())))
        files = tuple((one.name, f"{one.size}", one.sha256) for one in setup.files)
        if files:
            tables.append(Table("Files", ("file", "bytes", "SHA-256"), files, frozenset(("bytes",))))
    return {"pairs": [pair for pair in pairs if pair[1]], "tables": tables}


def _bars(result: Result) -> str:
    fit = result.fit
    if fit.inflation <= 1:
        return "as white noise makes them"
    because = f", because of {fit.inflated_by}" if fit.inflated_by not in {None, "nothing"} else ""
    return f"{fit.inflation**0.5:.2f} times as wide as white noise would make them{because}"


def literature(result: Result) -> Context:
    """Name what was written on the methods that were used."""
    return {"works": list(literature_of(result))}

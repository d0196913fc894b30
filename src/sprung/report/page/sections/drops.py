"""Every drop: its recording, what was wrong, and measured against simulated."""

from __future__ import annotations

from collections import defaultdict

from sprung.checking import DropReport
from sprung.errors import Fault
from sprung.report.page.sections.context import Context
from sprung.report.pictures.motions import motion_picture
from sprung.report.pictures.recordings import near_picture, whole_picture
from sprung.report.terminal.check import drops_table
from sprung.report.terminal.validation import COLUMNS, validation_table
from sprung.results import Result


def recordings(result: Result, unfolded: bool) -> Context:
    """Show every recording, with what happened in it and what was wrong."""
    drawn, shown = [], _shown(result)
    for drop in result.drops:
        recorded = result.recordings.get(drop.name)
        if recorded is None or not drop.channels:
            continue
        pictures = [whole_picture(drop, recorded), near_picture(drop, recorded)]
        drawn.append(
            {
                "file": drop.label,
                "said": f"{drop.kind}, {drop.load}",
                "wrong": "left out" if drop.start is None else ", ".join(dict.fromkeys(drop.faults)),
                "limits": _limits(drop),
                "open": unfolded or drop.name in shown,
                "pictures": [picture for picture in pictures if picture is not None],
            }
        )
    return {"overview": drops_table(result.drops), "faults": _joined(result.faults), "drawn": drawn}


def _shown(result: Result) -> set[str]:
    """Return the names of the drops to look at first: the one that is explained worst, and those with faults."""
    residuals = {name: one.residual for name, one in result.validation.items()}
    worst = max(residuals, key=residuals.__getitem__) if residuals else next((drop.name for drop in result.drops), "")
    return {worst, *(drop.name for drop in result.drops if drop.faults)}


def _limits(drop: DropReport) -> str:
    if drop.start is None or drop.end is None or not drop.why_start:
        return ""
    fit = "" if drop.fit_start is None else f" The fit uses it from {drop.fit_start:.3f} s on: {drop.why_fit}."
    return f"Decay from {drop.start:.3f} s: {drop.why_start}; to {drop.end:.3f} s: {drop.why_end}.{fit}"


def _joined(faults: tuple[Fault, ...]) -> list[Fault]:
    """Say once what was found alike in several places."""
    places: defaultdict[tuple[str, str, str], list[str]] = defaultdict(list)
    for fault in faults:
        places[fault.code, fault.what, fault.do].append(fault.where)
    return [Fault(code, ", ".join(where), what, do) for (code, what, do), where in places.items()]


def motions(result: Result, unfolded: bool) -> Context:
    """Return the motion of the body in each drop, measured and simulated, with the errors."""
    groups: dict[str, list[Context]] = {}
    shown = _shown(result)
    for drop in result.drops:
        if drop.name in result.series:
            validated = result.validation[drop.name]
            groups.setdefault(drop.load, []).append(
                {
                    "picture": motion_picture(drop.name, result.series[drop.name], validated),
                    "said": f"residual {validated.residual:.2f} times the noise",
                    "open": unfolded or drop.name in shown,
                }
            )
    return {
        "overview": validation_table(result.name, result.validation),
        "columns": COLUMNS,
        "groups": [
            {"title": f"{load}: {len(drops)} drop{'s' * (len(drops) > 1)}", "drops": drops}
            for load, drops in groups.items()
        ],
    }

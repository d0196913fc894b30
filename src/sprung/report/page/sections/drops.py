"""Sections about the drops: recordings, faults, measured and simulated motion."""

from __future__ import annotations

from sprung.assessment import motions_of
from sprung.checking import DropReport
from sprung.errors import merge_faults
from sprung.report.excitations import limits_text, readings_text, records_text
from sprung.report.page.sections.context import Context
from sprung.report.pictures.motions import motion_picture, motions_text
from sprung.report.pictures.recordings import beginning_title, landing_picture, recording_picture
from sprung.report.terminal.check import drops_table
from sprung.report.terminal.validation import COLUMNS, validation_table
from sprung.results import Result
from sprung.vehicle import layout_of


def recordings(result: Result, unfolded: bool) -> Context:
    """Return every recording with its events and faults."""
    drawn, unfolded_drops = [], _unfolded_drops(result)
    for drop in result.drops:
        recorded = result.recordings.get(drop.name)
        if recorded is None or not drop.channels:
            continue
        pictures = [recording_picture(drop, recorded), landing_picture(drop, recorded)]
        drawn.append(
            {
                "file": drop.label,
                "caption": f"{drop.kind}, {drop.load}",
                "warning": "left out" if drop.start is None else ", ".join(drop.faults),
                "limits": _limits(drop),
                "open": unfolded or drop.name in unfolded_drops,
                "pictures": [picture for picture in pictures if picture is not None],
            }
        )
    return {
        "overview": drops_table(result.drops),
        "faults": merge_faults(result.faults),
        "drawn": drawn,
        "readings": readings_text(result.drops),
        "record": records_text(result.drops, plural=False),
        "beginning": beginning_title(result.drops),
    }


def _unfolded_drops(result: Result) -> set[str]:
    """Return the names of the drop with the largest residual and of those with faults."""
    residuals = {name: validated.residual for name, validated in result.validation.items()}
    worst = max(residuals, key=residuals.__getitem__) if residuals else next((drop.name for drop in result.drops), "")
    return {worst, *(drop.name for drop in result.drops if drop.faults)}


def _limits(drop: DropReport) -> str:
    fit = "" if drop.fit_start is None else f" The fit begins at {drop.fit_start:.3f} s ({drop.why_fit})."
    return f"{limits}{fit}" if (limits := limits_text(drop)) else ""


def motions(result: Result, unfolded: bool) -> Context:
    """Return the motion of the body in each drop, measured and simulated, with the errors."""
    groups: dict[str, list[Context]] = {}
    layout = layout_of(result.parameters)
    unfolded_drops = _unfolded_drops(result)
    for drop in result.drops:
        if drop.name in result.series:
            validated = result.validation[drop.name]
            groups.setdefault(drop.load, []).append(
                {
                    "picture": motion_picture(drop.name, result.series[drop.name], validated, layout),
                    "caption": f"residual {validated.residual:.2f} times the noise",
                    "open": unfolded or drop.name in unfolded_drops,
                }
            )
    return {
        "accelerations": motions_text(motions_of(layout)),
        "overview": validation_table(result.name, result.validation, layout),
        "columns": COLUMNS,
        "groups": [
            {"title": f"{load}: {len(drops)} drop{'s' * (len(drops) > 1)}", "drops": drops}
            for load, drops in groups.items()
        ],
    }

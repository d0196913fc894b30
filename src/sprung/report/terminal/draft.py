"""A drafted campaign, for the terminal: the drops that were found, and what is missing."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.drafting import DraftCampaign
from sprung.report.terminal.layout import hanging, table

_TOLD = 5
"""Events that are no drops which are told one by one."""


def draft_view(draft: DraftCampaign) -> RenderableType:
    """Show what a draft found and what it lacks.

    Parameters
    ----------
    draft
        From `sprung.draft`.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    parts: list[RenderableType] = [_drops(draft), Text(), _sensors(draft), Text()]
    others = [hanging("  - ", each) for each in _others(draft)]
    if others:
        parts += [Text("Besides", style="bold"), *others, Text()]
    if draft.missing:
        parts += [Text("Missing, to be filled in", style="bold")]
        parts += [hanging("  - ", Text.assemble((f"{where}: ", "yellow"), what)) for where, what in draft.missing]
    return Group(*parts)


def _drops(draft: DraftCampaign) -> RenderableType:
    headers = ("recording", "release s", "until s", "length s", "load", "wheels", "drop")
    rows = [
        [
            " + ".join(drop.files),
            f"{drop.found.release:.3f}",
            f"{drop.found.end:.2f}",
            f"{drop.found.end - drop.found.landing:.2f}",
            drop.load or "?",
            " ".join(drop.wheels) or "?",
            drop.kind or "?",
        ]
        for drop in draft.drops
    ]
    count = f"{len(rows)} drop{'s' * (len(rows) != 1)}"
    return table(f"{draft.name}: {count} found", headers, rows, headers[1:4], ("until s", "length s", "drop"))


def _sensors(draft: DraftCampaign) -> RenderableType:
    headers = ("channel", "on", "unit", "points", "coupling", "clips at")
    rows = [
        [
            sensor.channel,
            sensor.on if sensor.on != "wheel" else "wheel ?",
            sensor.unit or "?",
            sensor.direction,
            sensor.coupling,
            "" if sensor.full_scale is None else f"{sensor.full_scale:.4g}",
        ]
        for sensor in draft.sensors
    ]
    return table("Sensors", headers, rows, ("clips at",), ("coupling", "clips at"))


def _others(draft: DraftCampaign) -> Iterator[str]:
    """Tell of everything that did not become part of the campaign."""
    for file in draft.files:
        if not file.drops and not file.refused:
            yield f"{file.name}: no drop, nothing in it moves"
        for event in file.refused[:_TOLD]:
            yield f"{file.name}: no drop at {event.time:.3f} s: {event.why}"
        if file.events > min(len(file.refused), _TOLD):
            yield f"{file.name}: {file.events - min(len(file.refused), _TOLD)} more events that are no drops"
    left_out = {item for file in draft.files for item in file.left_out.items()}
    yield from (f"'{channel}' is no sensor: {why}" for channel, why in sorted(left_out))
    for name, problems in draft.unreadable.items():
        yield f"{name} was not read: found {problems[0].found}; expected {problems[0].expected}. {problems[0].do}"

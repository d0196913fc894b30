"""The draft of a campaign file, for the terminal."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.drafting import DraftCampaign
from sprung.report.terminal.layout import hanging_text, render_rows

_LISTED = 5
"""Other events that are listed one by one."""


def draft_view(draft: DraftCampaign) -> RenderableType:
    """Return the view of a draft: detected drops, sensors, and missing items.

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
    others = [hanging_text("  - ", text) for text in _others(draft)]
    if others:
        parts += [Text("Not used", style="bold"), *others, Text()]
    if draft.missing:
        parts += [Text("Missing, to be completed", style="bold")]
        parts += [hanging_text("  - ", Text.assemble((f"{where}: ", "yellow"), what)) for where, what in draft.missing]
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
    return render_rows(f"{draft.name}: {count} detected", headers, rows, headers[1:4], ("until s", "length s", "drop"))


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
    return render_rows("Sensors", headers, rows, ("clips at",), ("coupling", "clips at"))


def _others(draft: DraftCampaign) -> Iterator[str]:
    """Yield everything that is not part of the draft, with the reason."""
    for file in draft.files:
        if not file.drops and not file.rejected:
            yield f"{file.name}: no drop, no motion"
        for event in file.rejected[:_LISTED]:
            yield f"{file.name}: event at {event.time:.3f} s is no drop: {event.why}"
        if file.events > min(len(file.rejected), _LISTED):
            yield f"{file.name}: {file.events - min(len(file.rejected), _LISTED)} other events are no drops"
    left_out = {item for file in draft.files for item in file.left_out.items()}
    yield from (f"'{channel}' is not a sensor: {why}" for channel, why in sorted(left_out))
    for name, problems in draft.unreadable.items():
        yield f"{name} cannot be read: found {problems[0].found}; expected {problems[0].expected}. {problems[0].do}"
